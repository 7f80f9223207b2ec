"""`forall`: a property of several names, written out once for each of them before anything else is looked at."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from itertools import pairwise, permutations
from math import perm
from typing import Any

from ltlc.base.diagnostics import Diagnostic, Label
from ltlc.base.fixes import respell
from ltlc.base.source import Span
from ltlc.frontend.language.names import Checker
from ltlc.frontend.language.primitives import RELATIONS
from ltlc.frontend.syntax import tree as syntax

MAX_COPIES = 10_000
"""How many properties the `forall` of one file may stand for."""

_VARIABLE = re.compile(r"\{(\w+)\}")


def written_out(checker: Checker, tree: syntax.SyntaxTree) -> syntax.SyntaxTree:
    """`tree` with each `forall` as the properties that it stands for; its errors are reported."""
    commands: list[syntax.Command] = []
    count = 0
    for command in tree.commands:
        if not isinstance(command, syntax.PropertyCommand) or not isinstance(command.property, syntax.Forall):
            _check_templates(checker, command, {})
            commands.append(command)
            continue
        _check(checker, command.property, {})
        count += _count(command.property)
        if count > MAX_COPIES:
            message = f"with this, `forall` stands for {count:,} properties; the limit is {MAX_COPIES:,}"
            checker.report("LTL307", command.property.span, message)
            break
        commands.extend(_copies(command, command.names, command.property))
    return replace(tree, commands=tuple(commands))


def _count(node: syntax.Node) -> int:
    """How many properties `node` stands for."""
    return perm(len(node.names), len(node.variables)) * _count(node.body) if isinstance(node, syntax.Forall) else 1


def _copies(
    command: syntax.PropertyCommand, names: Mapping[str, syntax.Word], node: syntax.Node
) -> Iterator[syntax.PropertyCommand]:
    """`node` for each choice of different names for its variables, beside the `names` that are chosen."""
    if not isinstance(node, syntax.Forall):
        texts = {variable: name.text for variable, name in names.items()}
        yield replace(command, property=_with(texts, node), names=names)
        return
    variables = [variable.text for variable in node.variables]
    for chosen in permutations(node.names, len(variables)):
        yield from _copies(command, {**names, **dict(zip(variables, chosen, strict=True))}, node.body)


def _with(names: Mapping[str, str], node: Any) -> Any:
    """`node`, or a tuple of nodes, with `names` in place of their variables."""
    if isinstance(node, tuple):
        return tuple(_with(names, each) for each in node)
    if isinstance(node, syntax.Reference):
        name, *steps = (_word(names, part, is_name) for part, is_name in _parts(node))
        return replace(node, name=name, steps=tuple(steps))
    if not isinstance(node, syntax.Node) or isinstance(node, syntax.Word):
        return node
    return replace(node, **{f.name: _with(names, getattr(node, f.name)) for f in fields(node) if f.name != "span"})


def _word(names: Mapping[str, str], word: Any, is_name: bool) -> Any:
    if not isinstance(word, syntax.Word):
        return word
    text = names.get(word.text, word.text) if is_name else word.text
    return replace(word, text=_VARIABLE.sub(lambda match: names.get(match[1], match[0]), text))


def words(node: syntax.Reference) -> Iterator[tuple[syntax.Word, bool]]:
    """The words of `node`, and whether each is the name of a thing: the first, and that of another object."""
    return ((part, is_name) for part, is_name in _parts(node) if isinstance(part, syntax.Word))


def _parts(node: syntax.Reference) -> Iterator[tuple[syntax.Step, bool]]:
    yield node.name, True
    for before, step in pairwise((node.name, *node.steps)):
        yield step, before is not node.name and isinstance(before, syntax.Word) and before.text in RELATIONS


def _check(checker: Checker, node: syntax.Node, outer: Mapping[str, Span]) -> None:
    """Report what is wrong with the variables and the names of `node`, which stands in those of `outer`."""
    if not isinstance(node, syntax.Forall):
        _check_templates(checker, node, outer)
        return
    variables = dict(outer)
    for variable in node.variables:
        _check_variable(checker, node, variable, variables)
        variables.setdefault(variable.text, variable.span)
    _check_names(checker, node)
    _check(checker, node.body, variables)


def _check_variable(checker: Checker, node: syntax.Forall, variable: syntax.Word, others: Mapping[str, Span]) -> None:
    text = variable.text
    places = {
        "is already a variable here": others.get(text),
        "has another meaning in this file": checker.names.everywhere.get(text),
        "is both a variable and a name of the set": next((n.span for n in node.names if n.text == text), None),
    }
    for wrong, place in places.items():
        if place is not None:
            first, help = Label(place, "here"), "give the variable another name"
            checker.report("LTL109", variable.span, f"`{text}` {wrong}", first, help=help)
            return
    if text not in _variables(node.body):
        name = node.names[0].text
        help = f"in the property, `{text}` stands for `{name}`, and `{{{text}}}_battery` for `{name}_battery`"
        checker.report("LTL109", variable.span, f"the property does not use `{text}`", help=help)


def _variables(node: syntax.Node) -> set[str]:
    """What may be variables in `node`."""
    found = set()
    for part, _ in syntax.walk(node):
        if isinstance(part, syntax.Reference):
            for word, is_name in words(part):
                found.update(_VARIABLE.findall(word.text) or [word.text] * is_name)
    return found


def _check_names(checker: Checker, node: syntax.Forall) -> None:
    first: dict[str, Span] = {}
    for name in node.names:
        if name.text in first:
            message = f"`{name.text}` is in the set twice"
            checker.report("LTL109", name.span, message, Label(first[name.text], "first here"))
        first.setdefault(name.text, name.span)
    if len(node.names) < len(node.variables):
        place = node.names[0].span.to(node.names[-1].span)
        message = f"{len(node.variables)} variables need as many different names; the set has {len(node.names)}"
        checker.report("LTL109", place, message, help="use more names or fewer variables")


def _check_templates(checker: Checker, node: syntax.Node, variables: Mapping[str, Span]) -> None:
    """Report names with braces in which no variable stands."""
    for part, _ in syntax.walk(node):
        if isinstance(part, syntax.Reference):
            for word, _ in words(part):
                for unknown in (name for name in _VARIABLE.findall(word.text) if name not in variables):
                    start = checker.source.text.index(f"{{{unknown}}}", word.span.start) + 1
                    near = respell(Span(start, start + len(unknown)), unknown, variables)
                    help = near or f"`forall {unknown} in {{…}}: …` makes it one"
                    message = f"`{unknown}` in `{word.text}` is not a variable of a `forall`"
                    checker.report("LTL109", word.span, message, help=help)


def of_copy(found: Diagnostic, names: Mapping[str, syntax.Word]) -> Diagnostic:
    """`found`, reported for the copy of a property in which `names` replace its variables."""
    if not names:
        return found
    chosen = ", ".join(f"`{variable}` is `{name.text}`" for variable, name in names.items())
    return replace(found, message=f"{found.message} (where {chosen})")
