"""Gives every name its meaning and every expression its type: from the syntax tree to a specification."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Label
from ltlc.base.source import Source, Span
from ltlc.frontend.language.built import Built, Context
from ltlc.frontend.language.clocks import has_clocks
from ltlc.frontend.language.define import Definitions, settings
from ltlc.frontend.language.each import head_of, inside, instances_of, of_instance, speaks_of_its_ids
from ltlc.frontend.language.forall import of_copy, words, written_out
from ltlc.frontend.language.guards import guards, read_as_commands
from ltlc.frontend.language.misread import report_similar, second_on_line
from ltlc.frontend.language.names import Checker, Names
from ltlc.frontend.language.parameters import NAME as PARAMETER
from ltlc.frontend.language.requirements import Requirements
from ltlc.frontend.language.scopes import Scopes
from ltlc.frontend.syntax import tree as syntax
from ltlc.inputs.messages.definitions import MessageTypes
from ltlc.semantics import properties
from ltlc.semantics.encodings import Encoding
from ltlc.semantics.timed_atoms import News, atoms_within, counts_of
from ltlc.specification.alphabet import alphabet
from ltlc.specification.guards import Guard
from ltlc.specification.specification import Definition, DefinitionKind, PropertySpecification, Specification

GLOBAL = (syntax.Model, syntax.ObjectFromTopic, syntax.ObjectAtPlace, syntax.Zone, syntax.Message)
"""Commands that hold for the whole file, wherever they stand, as settings do."""

MAX_FINDINGS = 200
"""After so many findings the rest of a file is not looked at."""

_WORD = re.compile(r"\w+")
_LOST_DEFINITION = re.compile(r"\b(?:decl|model|object|message)\s+(\w+)|\b(\w+)\s*=(?!=)")
_COMMENT = re.compile(r'("(?:[^"\\\n]|\\.)*")|#[^\n]*')


def resolve(
    source: Source, tree: syntax.SyntaxTree, types: MessageTypes, encoding: Encoding
) -> tuple[Specification | None, list[Diagnostic]]:
    """The specification that `tree` states, to be read by `encoding`; None if there are errors, which are collected."""
    checker = checker_of(source, tree, types, encoding)
    found = sound_part(checker, tree)
    return (None if checker.has_failed else found), checker.diagnostics


def checker_of(source: Source, tree: syntax.SyntaxTree, types: MessageTypes, encoding: Encoding) -> Checker:
    """What looks up names in `tree`, before any is defined."""
    return Checker(source, types, encoding, _lost_definitions(tree), names=Names(everywhere=_defined(tree)))


def sound_part(checker: Checker, tree: syntax.SyntaxTree) -> Specification:
    """The specification of the properties of `tree` without errors; `checker` collects all findings."""
    states_none = not any(isinstance(command, syntax.PropertyCommand) for command in tree.commands)
    tree = written_out(checker, tree)
    chosen = settings(checker, tree)
    checker.margin, checker.rate = chosen.margin, chosen.rate
    scopes = Scopes(checker)
    definitions = Definitions(checker, scopes)
    stated = _Stated(checker, definitions, scopes)
    used = _used(tree)
    found: tuple[Guard, ...] = ()
    for command in tree.commands:
        if isinstance(command, GLOBAL):
            definitions.enter(command)
    for command in tree.commands:
        if not isinstance(command, GLOBAL):
            definitions.enter(command)
        if len(checker.diagnostics) >= MAX_FINDINGS:
            checker.gave_up = True
            break
        if isinstance(command, syntax.PropertyCommand):
            stated.add(command)
    else:
        found = guards(checker, tree, stated.found)
        used.update(read_as_commands(checker, found, used))
        _report_unused(checker, used)
        report_similar(checker, tree)
        if states_none and tree.lost is None:
            checker.report(
                "LTL306", Span(0, 0), "the file has no property", help="for example `never robot.velocity > 2`"
            )
    listed = tuple(
        Definition(kind, word.text, word.span, word.text in used) for kind, word in checker.names.definitions
    )
    return Specification(checker.source, tuple(stated.found), listed, chosen.rate, chosen.timeout, found, chosen.lead)


def _defined(tree: syntax.SyntaxTree) -> dict[str, Span]:
    """The names that the file defines somewhere, with the place of the first definition."""
    defining = (syntax.Declaration, *GLOBAL, syntax.Association)
    found: dict[str, Span] = {}
    for command in tree.commands:
        if isinstance(command, defining):
            found.setdefault(command.name.text, command.name.span)
    return found


def _lost_definitions(tree: syntax.SyntaxTree) -> frozenset[str]:
    """The names that are probably defined in the parts of the text that could not be parsed."""
    return frozenset(name for match in _LOST_DEFINITION.findall(tree.lost or "") for name in match if name)


class _Stated:
    """The properties of a file, one after the other; `found` are those in which no error was reported."""

    def __init__(self, checker: Checker, definitions: Definitions, scopes: Scopes) -> None:
        self.checker = checker
        self.definitions = definitions
        self.scopes = scopes
        self.labels = _Labels(checker)
        self.requirements = Requirements(checker)
        self.found: list[PropertySpecification] = []
        self._last: syntax.PropertyCommand | None = None
        self._is_sound = True

    def add(self, command: syntax.PropertyCommand) -> None:
        """Enter a property; one that may have been meant as a part of the last one is reported instead."""
        last, self._last = self._last, command
        if last is not None and syntax.runs_on(self.checker.source.text, last, command):
            if self._is_sound:
                self.checker.diagnostics.append(second_on_line(self.checker.source, last, command))
            self._is_sound = False
            return
        requirement = self.requirements.of(command)
        before = len(self.checker.diagnostics)
        found = _property(self.checker, self.definitions, self.scopes, command, self.labels.of(command))
        self.checker.diagnostics[before:] = [of_copy(d, command.names) for d in self.checker.diagnostics[before:]]
        self._is_sound = found is not None
        if found is not None:
            self.found.append(replace(found, requirement=requirement, is_assumed=command.is_assumed))


class _Labels:
    """The labels of properties, the author's or `line N`."""

    def __init__(self, checker: Checker) -> None:
        self.checker = checker
        self.seen: dict[str, Span] = {}
        self.on_line: dict[int, dict[Span, int]] = {}

    def of(self, command: syntax.PropertyCommand) -> str:
        """The label of the next property of the file."""
        line = self.checker.source.position(command.span.start).line
        on_line = self.on_line.setdefault(line, {})
        number = on_line.setdefault(command.span, len(on_line) + 1)
        copy = f"[{', '.join(word.text for word in command.names.values())}]" if command.names else ""
        if command.label is None:
            return (f"line {line}" if number == 1 else f"line {line}.{number}") + copy
        label = command.label.text + copy
        if label in self.seen:
            first = Label(self.seen[label], "first here")
            self.checker.report("LTL106", command.label.span, f"two properties are called `{label}`", first)
        self.seen.setdefault(label, command.label.span)
        return label


def _property(
    checker: Checker, definitions: Definitions, scopes: Scopes, command: syntax.PropertyCommand, label: str
) -> PropertySpecification | None:
    """One property, its atoms in the order of first use; None if an error was reported."""
    if not definitions.is_manageable(command):
        return None
    context = Context(label)
    match command.property:
        case syntax.EachOf() as each:
            return _of_each_id(checker, scopes, replace(command, property=each.body), each, context)
        case syntax.EachMessage() as each:
            of = instances_of(checker, each)
            built = None if of is None else of_instance(scopes, of, each, context)
            found = _stated(checker, command, built, context)
            return found and replace(found, slicing=of)
        case node:
            return _stated(checker, command, scopes.property(node, context, in_scope=True), context, is_whole=True)


def _of_each_id(
    checker: Checker, scopes: Scopes, command: syntax.PropertyCommand, each: syntax.EachOf, context: Context
) -> PropertySpecification | None:
    """The property of `command` for `each` id."""
    head = head_of(checker, each)
    if head is None:
        return None
    with inside(checker, head, each.variable.span):
        built = scopes.property(command.property, context, in_scope=True)
        found = _stated(checker, command, built, context)
    found = found and replace(found, slicing=head.slicing)
    return found if found is not None and speaks_of_its_ids(checker, each, found) else None


def _stated(
    checker: Checker, command: syntax.PropertyCommand, built: Built | None, context: Context, is_whole: bool = False
) -> PropertySpecification | None:
    """One property that was `built`, with the atoms of `context`; if it is not `is_whole`, that of an `each`."""
    if built is None or not has_clocks(checker, built, is_whole):
        return None
    parts = list(properties.predicates(built.property))
    parts += [count.operand for part in parts for count in counts_of(part)]
    deciding = {atom.name: atom for part in parts for atom in atoms_within(part)}
    atoms = tuple(context.atoms[name] for name in deciding if name in context.atoms)
    written = _written(checker.source, command)
    ordinary = tuple(atom for atom in atoms if not isinstance(deciding[atom.name], News))
    return PropertySpecification(
        label=context.label,
        line=checker.source.position(command.span.start).line,
        span=command.span,
        text=folded(checker.source, command.property.span, written),
        property=built.property,
        atoms=atoms,
        alphabet=alphabet(ordinary),
        spans=dict(built.spans()),
        names={variable: word.text for variable, word in command.names.items()},
        written=written,
    )


def _written(source: Source, command: syntax.PropertyCommand) -> dict[Span, str]:
    """What stands in `command` where the text has variables of `forall`, or a parameter."""
    references = (part for part, _ in syntax.walk(command.property) if isinstance(part, syntax.Reference))
    found = {word.span: word.text for part in references for word, _ in words(part)} if command.names else {}
    found |= {word.span: word.text for name, word in command.names.items() if name == PARAMETER}
    return {span: text for span, text in found.items() if source.text[span.start : span.end] != text}


def folded(source: Source, span: Span, written: Mapping[Span, str]) -> str:
    """The text at `span` without comments, its white space folded, names `written` out."""
    text = _COMMENT.sub(lambda match: match.group(1) or " ", source.replaced(span, written))
    return " ".join(text.split())


def _words(node: syntax.Node) -> set[str]:
    """The names that occur in `node`."""
    return {
        word.text
        for part, _ in syntax.walk(node)
        if isinstance(part, syntax.Reference)
        for word in (part.name, *part.steps)
        if isinstance(word, syntax.Word)
    }


def _used(tree: syntax.SyntaxTree) -> set[str]:
    """The names that properties use, through associations as well."""
    inside = {c.name.text: _words(c.value) for c in tree.commands if isinstance(c, syntax.Association)}
    queue = [w for c in tree.commands if isinstance(c, syntax.PropertyCommand | syntax.Setting) for w in _words(c)]
    queue += [w for c in tree.commands if isinstance(c, syntax.ObjectAtPlace | syntax.Message) for w in _words(c)]
    used: set[str] = set(_WORD.findall(tree.lost or ""))
    used.update(name.text for c in tree.commands if isinstance(c, syntax.Guard) for name in c.fallbacks)
    while queue:
        word = queue.pop()
        if word not in used:
            used.add(word)
            queue.extend(inside.get(word, ()))
    return used


_USERS = {DefinitionKind.MESSAGE: "guard"}
"""What uses the names that properties do not."""


def _report_unused(checker: Checker, used: set[str]) -> None:
    for kind, word in checker.names.definitions:
        is_lost = kind is DefinitionKind.MESSAGE and "guard" in used  # a word of what could not be parsed
        if word.text not in used and not is_lost:
            message = f"the {kind.value} `{word.text}` is not used by any {_USERS.get(kind, 'property')}"
            checker.diagnostics.append(diagnostic("LTL104", checker.source, word.span, message))
