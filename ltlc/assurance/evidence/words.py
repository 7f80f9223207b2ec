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

_RELATIONS = {"<": "is less than", "<=": "is at most", "==": "equals", ">=": "is at least", ">": "is greater than"}


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
        yield "", "ids", in_words(claim.key)
    for stated in claim.counts:
        of = counted(stated, names)
        within = "so far" if of.within is None else f"in the last {duration_text(of.within)}"
        how = "has begun to hold" if of.begins else "has occurred"
        presumed = f", or no more than {duration_text(of.within)} have passed" if of.presumed and of.within else ""
        yield "", stated.name, f"{to_text(of.operand)} {how} {of.times} times or more {within}{presumed}"


def in_words(condition: Json, elements: Sequence[str] = ()) -> str:
    """A condition or another expression; in the predicate of a count, `elements` are the words for these."""

    def words(of: Json) -> str:
        return in_words(of, elements)

    match condition:
        case bool(truth):
            return "true" if truth else "false"
        case {"call": str(name), "of": [*operands], **rest} if not rest:
            return _call(name, operands, elements)
        case {"element": int(number), **rest} if not rest and 0 <= number < len(elements):
            return elements[number]
        case {"count": predicate, "over": [*lists], "beside": [*beside], **rest} if not rest:
            arrays = [[words(array) for array in _list(one)] for one in lists]
            inner = [*(f"an element of {each}" for one in arrays for each in one), *map(words, beside)]
            over = f" over ({') and ('.join(map(', '.join, arrays))})"
            return f"the number of elements with ({in_words(predicate, inner)}){over}"
        case {"topic": str(topic), "type": str(type_), "path": [*path], **rest} if not rest:
            return f"{_path(path)} of {topic} ({type_})" if path else f"{topic} ({type_})"
        case {"message": [*topics], **rest} if not rest:
            return f"a message comes on {' or '.join(map(str, topics))}"
        case {"new": [*topics], **rest} if not rest:
            return f"a message with a value comes on {' or '.join(map(str, topics))}"
        case {"ago": ago, "of": samples, **rest} if not rest:
            return f"[{words(samples)}, {ago} samples before]"
        case {"recent": ago, "of": samples, **rest} if not rest:
            return f"[the latest sample and the {ago} before it of {words(samples)}]"
        case {"slope": True, "of": samples, **rest} if not rest:
            return f"[the change per second of {words(samples)}]"
        case {"sampled": value, **rest} if rest.keys() <= {"when"}:
            return f"[{words(value)}, when {in_words(rest['when'])}]" if rest else f"[{words(value)}, as sampled]"
        case {"instead": value, "of": samples, **rest} if rest.keys() <= {"news"}:
            news = f", or without a message on {' or '.join(map(str, _list(rest['news'])))}" if rest else ""
            return f"[{words(samples)}; {words(value)} before it has one{news}]"
        case {"opening": value, "scope": number, **rest} if not rest:
            return f"[{words(value)} when scope {words(number)} opened]"
        case list():
            return f"({', '.join(map(words, condition))})"
        case _:
            return _as_it_is(condition)


def _call(name: str, operands: Sequence[Json], elements: Sequence[str]) -> str:
    said = [in_words(each, elements) for each in operands]
    match name, operands:
        case "<=", [{"call": "abs", "of": [{"call": "gap", "of": [one, other]}]}, _]:
            return f"{in_words(one, elements)} equals {in_words(other, elements)}, with a margin of {said[1]}"
        case _, [_, _] if name in _RELATIONS:
            return f"{said[0]} {_RELATIONS[name]} {said[1]}"
        case "not", [_]:
            return f"not ({said[0]})"
        case "and" | "or", [_, *_]:
            return f" {name} ".join(f"({each})" for each in said)
        case "number", [str(number)]:
            return number
        case "double", [_]:
            return f"{said[0]} as a double"
        case "neg", [_]:
            return f"-({said[0]})"
        case "+" | "-" | "*" | "/", [_, _, *_]:
            return f"({f' {name} '.join(said)})"
        case "slice", [_, first, last]:
            ends = f"from {_end(first, 'the first')} up to, not including, {_end(last, 'the end')}"
            return f"[the elements of {said[0]} {ends}]"
        case _:
            return f"{name}({', '.join(said)})"


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
