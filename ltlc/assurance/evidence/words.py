"""How a recording was judged, and the conditions of atoms, in words.

They are made from the data that is checked, not from what an author called them.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence

from ltlc.assurance.evidence.counting import counted
from ltlc.assurance.evidence.document import Claim, Head
from ltlc.semantics.durations import duration_text, seconds_text
from ltlc.semantics.ltl import to_text

Json = object

_RELATIONS = {
    "<": "is less than",
    "<=": "is at most",
    "==": "equals",
    "!=": "differs from",
    ">=": "is at least",
    ">": "is greater than",
    "same": "is",
}


def settings_in_words(head: Head) -> Iterator[str]:
    """How the recording was judged, where it was not judged as it is."""
    if head.rate is not None:
        yield f"sampled {head.rate} times a second"
    if head.timeout is not None:
        yield f"a run ends after {seconds_text(head.timeout)} s"
    if head.is_by_header:
        yield "messages have the times of their headers"
    if head.since is not None:
        yield f"only from {seconds_text(head.since)} s on"
    if head.until is not None:
        yield f"only up to {seconds_text(head.until)} s"


def atoms_in_words(claim: Claim) -> Iterator[tuple[str, str, str]]:
    """What letters are made of, and what is counted: how it is called in them, how it is written, and what it is."""
    names = [f"a{number}" for number in range(len(claim.atoms) + len(claim.scopes))]
    for number, (name, atom) in enumerate(zip(names, claim.atoms, strict=False)):
        opens = "; this opens an instance" if number == claim.opens else ""
        yield name, atom.name, f"{in_words(atom.condition)}{opens}"
    for name, scope in zip(names[len(claim.atoms) :], claim.scopes, strict=True):
        spans = (
            f"from step {first} {'on' if end is None else f'up to, not including, {end}'}" for first, end in scope.open
        )
        yield name, f"scope {scope.number} is open", ", ".join(spans) or "never"
    if claim.key is not None:
        yield "", "ids", _value(claim.key)
    for stated in claim.counts:
        of = counted(stated, names)
        within = "so far" if of.within is None else f"in the last {duration_text(of.within)}"
        how = "has begun to hold" if of.begins else "has occurred"
        presumed = f", or no more than {duration_text(of.within)} have passed" if of.presumed and of.within else ""
        yield "", stated.name, f"{to_text(of.operand)} {how} {of.times} times or more {within}{presumed}"


def in_words(condition: Json) -> str:
    """A condition, or a predicate that is made of conditions."""
    match condition:
        case bool(truth):
            return "true" if truth else "false"
        case {"not": operand, **rest} if not rest:
            return f"not ({in_words(operand)})"
        case {"and": [*parts], **rest} if not rest:
            return " and ".join(f"({in_words(part)})" for part in parts)
        case {"or": [*parts], **rest} if not rest:
            return " or ".join(f"({in_words(part)})" for part in parts)
        case {"op": "true", "left": left, **rest} if not rest:
            return _value(left)
        case {"op": str(op), "left": left, "right": right, **rest} if op in _RELATIONS and rest.keys() <= {"margin"}:
            margin = f", with a margin of {_value(rest['margin'])}" if rest else ""
            return f"{_value(left)} {_RELATIONS[op]} {_value(right)}{margin}"
        case _:
            return _as_it_is(condition)


def _value(of: Json) -> str:
    """An expression."""
    match of:
        case {"topic": str(topic), "type": str(type_), "path": [*path], **rest} if not rest:
            return f"{_path(path)} of {topic} ({type_})" if path else f"{topic} ({type_})"
        case {"message": [*topics], **rest} if not rest:
            return f"a message is on {' or '.join(map(str, topics))}"
        case {"new": [*topics], **rest} if not rest:
            return f"a message with a value comes on {' or '.join(map(str, topics))}"
        case {"ago": ago, "of": samples, **rest} if not rest:
            return f"[{_value(samples)}, {ago} samples before]"
        case {"recent": ago, "of": samples, **rest} if not rest:
            return f"[the latest sample and the {ago} before it of {_value(samples)}]"
        case {"slope": True, "of": samples, **rest} if not rest:
            return f"[the change per second of {_value(samples)}]"
        case {"sampled": value, **rest} if rest.keys() <= {"when"}:
            return f"[{_value(value)}, when {in_words(rest['when'])}]" if rest else f"[{_value(value)}, as sampled]"
        case {"instead": value, "of": samples, **rest} if rest.keys() <= {"news"}:
            news = f", or without a message on {' or '.join(map(str, _list(rest['news'])))}" if rest else ""
            return f"[{_value(samples)}; {_value(value)} before it has one{news}]"
        case {"opening": value, "scope": number, **rest} if not rest:
            return f"[{_value(value)} when scope {_value(number)} opened]"
        case {"slice": [first, last], "of": array, **rest} if not rest:
            said = f"from {_end(first, 'the first')} up to, not including, {_end(last, 'the end')}"
            return f"[the elements of {_value(array)} {said}]"
        case {"element": array, **rest} if not rest:
            return f"an element of {_value(array)}"
        case {"count": predicate, **rest} if rest.keys() <= {"over"}:
            lists = [", ".join(map(_value, _list(one))) for one in _list(rest.get("over", []))]
            over = f" over ({') and ('.join(lists)})" if lists else ""
            return f"the number of elements with ({in_words(predicate)}){over}"
        case {"predicate": predicate, **rest} if not rest:
            return f"whether ({in_words(predicate)})"
        case {"call": str(name), "of": [*operands], **rest} if not rest:
            return _call(name, operands)
        case {"number": str(number), **rest} if not rest:
            return number
        case list():
            return f"({', '.join(map(_value, of))})"
        case _:
            return _as_it_is(of)


def _call(name: str, operands: Sequence[Json]) -> str:
    told = [_value(each) for each in operands]
    if name == "neg":
        return f"-({told[0]})"
    return f"({f' {name} '.join(told)})" if name in "+-*/" and len(told) > 1 else f"{name}({', '.join(told)})"


def _path(steps: Sequence[Json]) -> str:
    """The field of a message as the language writes it."""
    text = ""
    for step in steps:
        match step:
            case str():
                text += f".{step}"
            case ["match" | "parallel" as kind, key, value]:
                text += f"[{kind} {json.dumps(key)} == {json.dumps(value)}]"
            case ["each"]:
                text += "[]"
            case ["own"]:
                text += "[of the id]"
            case _:
                text += f"[{json.dumps(step)}]"
    return text.removeprefix(".")


def _end(number: Json, otherwise: str) -> str:
    return otherwise if number is None else str(number)


def _list(of: Json) -> Sequence[Json]:
    return of if isinstance(of, list) else [of]


def _as_it_is(of: Json) -> str:
    """What is a number, a string or of a form that is not known, as JSON."""
    return json.dumps(of, ensure_ascii=False, sort_keys=isinstance(of, Mapping))
