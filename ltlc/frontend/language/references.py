"""What a reference stands for: the one place where names are looked up, with 'did you mean' for what is not there.

A reference is a name and the steps after it. The name is looked up among associations, declarations, attributes of
models, objects of the simulation, and messages, whose constants have short names; the steps lead on from what it is.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import takewhile

from ltlc.base.diagnostics import Fix, Help, Label
from ltlc.base.fixes import put, respell, write, writing
from ltlc.base.source import Span
from ltlc.frontend.language.names import Associated, Checker, Sort
from ltlc.frontend.language.primitives import ERRORS, MODELLED, PRIMITIVES, QUANTITIES, RELATIONS
from ltlc.frontend.language.signals import Thing, Tracked, components, from_field
from ltlc.frontend.language.types import MAX_DIGITS, message_type, messages_on, values_in
from ltlc.frontend.language.values import Array, Message, Orientation, Scalar, Text, Truth, Value, Vector, expressions
from ltlc.frontend.syntax import tree as syntax
from ltlc.frontend.syntax.lexer import FUNCTIONS, KEYWORDS, RESERVED, TEMPORAL, next_token
from ltlc.inputs.messages.definitions import Constant
from ltlc.inputs.messages.definitions import Message as Definition
from ltlc.specification.expressions import Boolean, Current, Each, Field, Number, Slice, String, inputs
from ltlc.specification.functions import INSIDE
from ltlc.specification.specification import fields

_NO_NAMES = {
    "nan": "omit this comparison: a sample that is NaN makes no step, and reports state how many there were",
    "each": "write `each NAME of KEY: P` for each value of KEY, or `each new SIGNAL: P` from each message on",
    "guard": "the form is `guard TOPIC to TOPIC else NAME`",
    "message": "the form is `message NAME {FIELD.FIELD: VALUE}`",
    "assume": "the form is `assume PROPERTY`",
}
"""Words that mean something in other languages, or lack what belongs to them here."""

MOST_OFFERED = 3
"""So many names are offered for an abbreviation at most."""

_REFERENCE = re.compile(r"([\w.\[\]:]*\w|[\w.\[\]:]*\])\s*\.\s*\Z")
"""A reference at the end of a text, with the point behind it."""

_SYNONYMS = {
    **dict.fromkeys(("speed", "vel", "v"), "velocity"),
    **dict.fromkeys(("pos", "pose", "location"), "position"),
    **dict.fromkeys(("heading", "angle"), "orientation"),
    **dict.fromkeys(("dist", "distance_to"), "distance"),
}
"""What others call the primitives."""


def kind(checker: Checker, node: syntax.Node) -> str:
    """Whether `node` is a value, a state predicate, or a property with temporal keywords."""
    match node:
        case syntax.Temporal() | syntax.Within():
            return Sort.TEMPORAL
        case syntax.Comparison() | syntax.Membership() | syntax.Rate() | syntax.Past() | syntax.StrayBound():
            return Sort.STATE
        case syntax.Quantified(_, quantifier) if quantifier.text != "count":
            return Sort.STATE
        case syntax.Call(_, function) if function.text == INSIDE:
            return Sort.STATE
        case syntax.Negation() | syntax.Connective():
            temporal = any(kind(checker, child) == Sort.TEMPORAL for child in syntax.children(node))
            return Sort.TEMPORAL if temporal else Sort.STATE
        case _:
            pass
    named = property_named(checker, node)
    return named.kind if named else Sort.VALUE


def property_named(checker: Checker, node: syntax.Node) -> Associated | None:
    """The association of a property that `node` is a use of, if it is one."""
    if not isinstance(node, syntax.Reference) or node.steps:
        return None
    found = checker.names.associations.get(node.name.text)
    return found if found is not None and found.kind != Sort.VALUE else None


def referent(checker: Checker, node: syntax.Reference) -> Value | None:
    """The value that `node` stands for; None if an error was reported, here or where its name is defined."""
    names, name = checker.names, node.name.text
    if name in names.associations:
        return _associated(checker, node)
    if name in names.declarations:
        return member(checker, node.steps, names.declarations[name])
    attribute = names.models.get(name, {}).get(_first_word(node))
    if attribute is not None and _first_word(node) not in PRIMITIVES:
        return member(checker, node.steps[1:], attribute.value)
    if name in checker.lost:
        return None
    if name in names.objects or name in names.models:
        return _of_object(checker, node)
    if name in names.everywhere:
        _used_before(checker, node)
        return None
    if _first_word(node) in PRIMITIVES:
        return _of_object(checker, node)
    if is_short_constant(checker, node):
        return constant_beside(checker, node, None)
    unknown(checker, node)
    return None


def _first_word(node: syntax.Reference) -> str:
    """The first step, if it is a word."""
    return node.steps[0].text if node.steps and isinstance(node.steps[0], syntax.Word) else ""


def _associated(checker: Checker, node: syntax.Reference) -> Value | None:
    found = checker.names.associations[node.name.text]
    if found.sound and found.kind != Sort.VALUE:
        checker.report("LTL206", node.span, f"`{node.name.text}` is a property, but a value is needed here")
        return None
    return member(checker, node.steps, found.value)


def _used_before(checker: Checker, node: syntax.Reference) -> None:
    defined = Label(checker.names.everywhere[node.name.text], "defined here")
    message = f"`{node.name.text}` is used before its definition"
    checker.report("LTL103", node.name.span, message, defined, help="move the definition up")


def is_unknown(checker: Checker, node: syntax.Node) -> bool:
    """Whether `node` is a single word that nothing is called by."""
    if not isinstance(node, syntax.Reference) or node.steps:
        return False
    names, name = checker.names, node.name.text
    return name not in checker.lost | names.everywhere.keys() | names.objects.keys() | names.models.keys()


def unknown(checker: Checker, node: syntax.Reference, other: Value | None = None, defined: str = "") -> None:
    """Report that `node` is not defined; what it is compared with may show what was meant.

    What it would be `defined` by is by default a declaration.
    """
    name = node.name.text
    if name.lower() in _NO_NAMES:
        message = f"nothing called `{name}` is defined"
        checker.report("LTL101", node.name.span, message, help=_NO_NAMES[name.lower()])
        return
    if name.lower() in ("inf", "infinity"):
        infinite = Help("infinity is written `(1 / 0)`", (writing(node.name.span, "(1 / 0)"),))
        checker.report("LTL101", node.name.span, f"nothing called `{name}` is defined", help=infinite)
        return
    if name in RESERVED or not name.isascii() or "{" in name:
        return
    after = next_token(checker.source.text, node.span.end, ()).terminal
    step = node.steps[0] if node.steps else None
    known = checker.names.visible() if step else [*checker.names.visible(), *KEYWORDS, *FUNCTIONS]
    help: str | Help | None = respell(node.name.span, name, known)
    if isinstance(step, syntax.Word) and not help:
        message = f"`{name}` has no `{step.text}`: it is neither declared nor a primitive"
        checker.report("LTL105", step.span, message, help=_known_as(step, PRIMITIVES) or "")
        return
    help = (other and _as_value(checker, node, other)) or help or _abbreviation(checker, node.name)
    if after in TEMPORAL or after == "forall":
        help = help or Help(f"a label ends with a colon: `{name}: …`", (put(node.name.span.end, ":"),))
    help = help or defined or f"`decl {name} TOPIC TYPE.FIELD` declares a signal of that name"
    checker.report("LTL101", node.name.span, f"nothing called `{name}` is defined", help=help)


def _abbreviation(checker: Checker, name: syntax.Word) -> Help | None:
    """The only names that are declared and stand at the beginning of `name`, or at whose beginning it stands."""
    declared = [each for each in checker.names.declarations if each.startswith(name.text) or name.text.startswith(each)]
    return write(*(writing(name.span, each) for each in declared)) if 0 < len(declared) <= MOST_OFFERED else None


def _as_value(checker: Checker, node: syntax.Reference, other: Value) -> Help | None:
    """How the value `node` is written that is compared with `other`: as a string, or a constant of its message."""
    name = node.name.text
    if isinstance(other, Text):
        return Help(f'a string is written `"{name}"`', (writing(node.name.span, f'"{name}"'),))
    signals = [i.signal for e in expressions(other) for i in inputs(e)]
    for field in (s.definition for s in signals[:1] if isinstance(s.definition, Field)):
        for message in reversed(messages_on(field, checker.types)):
            constants = checker.types.messages[message].constants
            if found := next((c for c in constants if c == name or c.endswith(f"_{name}")), None):
                fix = writing(node.name.span, f"{message}.{found}")
                return Help(f"{fix.title} for the constant", (fix,))
    return None


def _of_object(checker: Checker, node: syntax.Reference) -> Value | None:
    """The value of the primitive of an object that `node` (`robot.distance.stop_sign`) names."""
    steps = [step for step in node.steps if isinstance(step, syntax.Word)]
    if len(steps) < len(node.steps):
        checker.report("LTL212", node.span, f"`{checker.written(node)}` has no elements")
        return None
    if not steps:
        help = f"say which of its values, as in `{node.name.text}.position`"
        checker.report("LTL206", node.span, f"`{node.name.text}` is an object, but a value is needed here", help=help)
        return None
    primitive = steps[0].text
    if primitive not in PRIMITIVES:
        _no_primitive(checker, node.name.text, steps[0])
        return None
    of = _thing(checker, node.name)
    if of is None:
        return None
    if primitive in RELATIONS:
        other = _other(checker, of, steps)
        return None if other is None else RELATIONS[primitive](checker, of, other, steps)
    if primitive in ERRORS:
        attribute, error = ERRORS[primitive]
        return error(checker, of, _believed(checker, of, attribute, steps[0]), steps)
    return QUANTITIES[primitive](checker, of, steps)


def ground_truth(checker: Checker, node: syntax.Node) -> Value | None:
    """Where the object is that `node` is nothing but the name of, if it is one."""
    if not isinstance(node, syntax.Reference) or node.steps:
        return None
    of = checker.names.objects.get(node.name.text)
    x, y, z = (of and components(of, "position")) or (None, None, None)
    return Vector((x, y, z), node.name.text) if of and x and y and z else None


def messages(checker: Checker, node: syntax.Node) -> Message | None:
    """The messages of which no field is named that `node` is nothing but the name of, if it is."""
    if not isinstance(node, syntax.Reference):
        return None
    names, (first, *rest) = checker.names, (node.name.text, *node.steps)
    if rest:
        attribute = names.models.get(first, {}).get(_first_word(node))
        found = attribute.value if attribute and len(rest) == 1 else None
    else:
        found = names.declarations.get(first)
    return found if isinstance(found, Message) else None


def no_field(checker: Checker, place: Span, message: Message) -> None:
    """Report that `message` stands where a value is needed."""
    name, field = message.signal.name, message.signal.definition
    assert isinstance(field, Field)
    help = f"use `new {name}` or `age({name})`"
    written = checker.source.excerpt(message.declared)
    values = [f"{written}.{path}" for path in values_in(field.message, checker.types)[:MOST_OFFERED]]
    if values:
        help += f"; a value is declared with its path, as in {' or '.join(f'`{value}`' for value in values)}"
    text = f"`{name}` has no value: it is declared without a field of `{field.message}`"
    fixes = tuple(writing(message.declared, value) for value in values)
    checker.report("LTL220", place, text, help=Help(help, fixes))


def _known_as(step: syntax.Word, known: Sequence[str]) -> Help | None:
    """What is meant by the name of a primitive that others use, or that is misspelt."""
    if step.text in _SYNONYMS:
        return write(writing(step.span, _SYNONYMS[step.text]))
    return respell(step.span, step.text, known)


def _no_primitive(checker: Checker, name: str, step: syntax.Word) -> None:
    attributes = [a for a in checker.names.models.get(name, {}) if a not in MODELLED]
    known = [*PRIMITIVES, *attributes]
    help = _known_as(step, known) or "there are " + ", ".join(f"`{k}`" for k in known)
    checker.report("LTL105", step.span, f"`{name}` has no `{step.text}`", help=help)


def _thing(checker: Checker, word: syntax.Word) -> Thing | None:
    """The object `word`: as it is declared, else after the pattern of `_simulator_`; None after an error."""
    name = word.text
    if name in checker.names.objects:
        return checker.names.objects[name]
    if name in checker.names.everywhere and name not in checker.names.models:
        defined = Label(checker.names.everywhere[name], "defined here")
        checker.report("LTL206", word.span, f"`{name}` is not an object of the simulation", defined)
        return None
    checker.names.undeclared.setdefault(name, []).append(word.span)
    simulator = checker.names.simulator
    return Tracked(name, simulator.topic.replace("{name}", name), simulator.message)


def _other(checker: Checker, of: Thing, steps: Sequence[syntax.Word]) -> Thing | None:
    """The object after `.distance.`, `.distanceZ.` or `.orientation_between.`."""
    if len(steps) == 1:
        help = f"name it, as in `{of.name}.{steps[0].text}.stop_sign`"
        checker.report("LTL105", steps[0].span, f"`{steps[0].text}` needs a second object", help=help)
        return None
    if len(steps) > 2:
        checker.report("LTL105", steps[2].span, f"a number has no `{steps[2].text}`")
        return None
    return _thing(checker, steps[1])


def _believed(checker: Checker, of: Thing, attribute: str, place: syntax.Word) -> Value | None:
    """What the robot believes of itself: an attribute of its model."""
    model = checker.names.models.get(of.name, {})
    if attribute in model:
        return model[attribute].value
    help = f"`model {of.name}: {attribute} TOPIC TYPE.FIELD ;` declares where it is published"
    message = f"`{place.text}` needs the {attribute} that `{of.name}` believes it has"
    if of.name not in checker.lost:
        checker.report("LTL209", place.span, message, help=help)
    return None


def message_constant(checker: Checker, node: syntax.MessageConstant) -> Value | None:
    """A constant of a message that is written with its package; None if an error was reported."""
    message = message_type(checker.source, node.message, checker.types)
    if not isinstance(message, str):
        checker.diagnostics.append(message)
        return None
    definition, name = checker.types.messages[message], node.name.text
    if name in definition.constants:
        return _constant_value(definition.constants[name], _names(name, definition))
    _no_constant(checker, node.name, [message], message)
    return None


def is_short_constant(checker: Checker, node: syntax.Reference) -> bool:
    """Whether `node` is a constant of a message without its package: nothing else has the name."""
    name = node.name.text
    if not (name[0].isupper() and node.steps and checker.types.find(name)):
        return False
    return name not in checker.lost and name not in checker.names.everywhere and _first_word(node) not in PRIMITIVES


def constant_beside(checker: Checker, node: syntax.Reference, other: Value | None) -> Value | None:
    """The constant of a message without its package: of the message that `other` is from, if one is called so.

    Else it has to be the same in all messages of that name.
    """
    step, name = node.steps[0], node.name.text
    written = checker.written(step)
    known = checker.types.find(name)
    messages = [message for message in _origins(checker, other) if message in known] or known
    found = {m: c[written] for m in messages if written in (c := checker.types.messages[m].constants)}
    if not found or not isinstance(step, syntax.Word):
        _no_constant(checker, step, messages, messages[0] if len(messages) == 1 else name)
        return None
    if len(found) < len(messages) or len(set(found.values())) > 1:
        _ambiguous(checker, node, messages, list(found))
        return None
    message, value = next(iter(found.items()))
    return member(checker, node.steps[1:], _constant_value(value, _names(written, checker.types.messages[message])))


def _origins(checker: Checker, value: Value | None) -> list[str]:
    """The messages that the fields which `value` is made of stand in, the innermost first."""
    parts = [part for expression in (expressions(value) if value else ()) for part in inputs(expression)]
    paths = [checker.types.along(f.message, f.path) for part in parts for _, f in fields(part.signal)]
    return list(dict.fromkeys(type_.base for path in paths for type_ in reversed(path)))


def _ambiguous(checker: Checker, node: syntax.Reference, messages: Sequence[str], having: Sequence[str]) -> None:
    constant = checker.written(node.steps[0])
    message = f"several packages define `{node.name.text}` with different values of `{constant}`: {', '.join(messages)}"
    place = node.name.span.to(node.steps[0].span)
    help = write(*(writing(place, f"{message.replace('/msg/', '/')}.{constant}") for message in having))
    checker.report("LTL202", node.span, message, help=help)


def _no_constant(checker: Checker, name: syntax.Node, messages: list[str], shown: str) -> None:
    known = [c for m in messages for c in checker.types.messages[m].constants]
    written = checker.written(name)
    longer = next((c for c in known if c.endswith(f"_{written}")), None)
    listed = "its constants are " + ", ".join(known) if known else "it has no constants"
    help = respell(name.span, written, known, is_closed=True) or listed
    if longer is not None:
        help = Help(f"did you mean `{longer}`?", (writing(name.span, longer),))
    checker.report("LTL214", name.span, f"`{shown}` has no constant `{written}`", help=help)


def _names(written: str, message: Definition) -> tuple[tuple[float, str], ...]:
    """What values go by the names of constants of `message`; of several names, that most like the one `written`."""
    names: dict[float, str] = {}
    for name, value in message.constants.items():
        if not isinstance(value, str | bool):
            alike = [name, *([names[value]] if value in names else [])]
            names[value] = max(alike, key=lambda each: _common(each, written))
    return tuple(names.items())


def _common(left: str, right: str) -> int:
    """How many characters two texts begin with alike."""
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(left, right, strict=False)))


def _constant_value(found: Constant, names: tuple[tuple[float, str], ...]) -> Value:
    if isinstance(found, bool):
        return Truth(Boolean(found))
    return Text(String(found)) if isinstance(found, str) else Scalar(Number(found, constants=names))


def member(checker: Checker, steps: Sequence[syntax.Step], base: Value | None) -> Value | None:
    """What `steps` select in `base`: components of vectors, angles of orientations, elements of arrays."""
    current = base
    for step in steps:
        if current is None:
            return None
        if isinstance(current, Message):
            no_field(checker, step.span, current)
            return None
        match step:
            case syntax.NumberLiteral():
                current = _element(checker, step, current)
            case syntax.Range():
                current = _slice(checker, step, current)
            case syntax.Word():
                current = _component(checker, step, current)
    return current


def _component(checker: Checker, step: syntax.Word, base: Value) -> Value | None:
    choices: dict[str, Value] = {}
    if isinstance(base, Vector):
        choices = dict(zip("xyz", map(Scalar, base.components), strict=True))
    if isinstance(base, Orientation):
        choices = {angle: Scalar(e) for angle, e in base.angles}
        choices |= dict(zip("xyzw", map(Scalar, base.components), strict=True))
    if step.text in choices:
        return choices[step.text]
    help: str | Help = respell(step.span, step.text, choices, is_closed=True) or " ".join(f"`.{c}`" for c in choices)
    if isinstance(base, Array) and step.text in FUNCTIONS:
        of = _REFERENCE.search(checker.source.text, 0, step.span.start)
        if of is not None:
            help = write(writing(Span(of.start(), step.span.end), f"{step.text}({of[1]})"))
    if isinstance(base, Scalar):
        point = checker.source.text.rindex(".", 0, step.span.start)
        omit = Fix(f"omit `.{step.text}`", ((Span(point, step.span.end), ""),))
        help = Help(f"it is already a number: {omit.title}", (omit,))
    checker.report("LTL105", step.span, f"{base.noun} has no `{step.text}`", help=help)
    return None


def _element(checker: Checker, step: syntax.NumberLiteral, base: Value) -> Value | None:
    """An element of an array that is a signal; a signal itself."""
    if not isinstance(base, Array):
        help = "for an earlier sample, write `@{v, -1}`" if step.text.startswith("-") else ""
        checker.report("LTL212", step.span, f"{base.noun} has no elements", help=help)
        return None
    if not step.text.isdigit() or len(step.text) > MAX_DIGITS:
        help = "an index is written `[0]`"
        if step.text.startswith("-"):
            help = f"an index counts from the beginning; `[{step.text}:]` are the elements from there to the end"
        checker.report("LTL212", step.span, f"`{step.text}` is not an index", help=help)
        return None
    if not isinstance(base.expression, Current):
        what = "a slice" if isinstance(base.expression, Slice) else "an earlier sample of an array"
        checker.report("LTL212", step.span, f"{what} has no elements that are signals", help="name that of the array")
        return None
    array = base.expression.signal
    assert isinstance(array.definition, Field)
    index = int(step.text)
    of_each = Each() in array.definition.path
    path = tuple(index if s == Each() else s for s in array.definition.path) + (() if of_each else (index,))
    return from_field(f"{array.name}[{index}]", base.elements.value, replace(array.definition, path=path))


def _slice(checker: Checker, step: syntax.Range, base: Value) -> Value | None:
    """Some elements of an array, as Python counts them."""
    if not isinstance(base, Array):
        help = "for the last samples, write `@{v, -9:}`" if step.start and step.start.text.startswith("-") else ""
        checker.report("LTL212", step.span, f"{base.noun} has no elements", help=help)
        return None
    ends = [end for end in (step.start, step.stop) if end is not None]
    wrong = next((e for e in ends if not e.text.removeprefix("-").isdigit() or len(e.text) > MAX_DIGITS), None)
    if wrong is not None:
        help = "a slice is written `[80:100]` or `[-10:]`"
        checker.report("LTL212", wrong.span, f"`{wrong.text}` is not an index", help=help)
        return None
    start, stop = (None if end is None else int(end.text) for end in (step.start, step.stop))
    return replace(base, expression=Slice(base.expression, start, stop))
