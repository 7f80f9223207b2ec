"""Properties of HPL, the property language of HAROS (A. Santos and others).

HPL has no formulas; those here express its scopes and patterns as `docs/patterns.md` has them, a letter for each
message. A scope is the first one. A message that fits both sides of a pattern does not answer itself.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import field, replace
from functools import partial, reduce

from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.frontend.starter.columns import message_with
from ltlc.importing import formulas as f
from ltlc.importing.hpl_conditions import Conditions
from ltlc.importing.names import Kind, Signals
from ltlc.importing.operators import Measure
from ltlc.importing.requirement import Requirement
from ltlc.importing.values import FormulaError, Value
from ltlc.importing.writing import Reading, UnsayableError, Writer
from ltlc.inputs.messages.definitions import MessageTypes, shipped

NAME = "HPL"

_PATTERNS = ("causes", "requires", "forbids")
_CONSTANT = re.compile(r"[A-Z][A-Z0-9_]+")
"""What a message calls a value; without its type, the value is not known."""

_UNITS = {"ms": 10**6, "s": 10**9}
_EVENT = re.compile(r"\s*([/~]?[A-Za-z]\w*(?:/[A-Za-z]\w*)*)(?:\s+as\s+(\w+))?\s*(?=(\{)?)")


@dataclass(frozen=True)
class _Event:
    """A message on `topic` that fits `condition`; others refer to it as `alias`."""

    topic: str
    alias: str
    condition: str
    offset: int


_Events = tuple[_Event, ...]


@dataclass
class _Property:
    """A property as it is written. `scope` has what opens and closes it, `sides` the events of the pattern."""

    pattern: str
    opening: _Events
    closing: _Events
    sides: tuple[_Events, ...]
    within: int | None


@dataclass
class _Fields:
    """The fields that are read of each topic."""

    signals: Signals
    of: dict[str, dict[str, str]] = field(default_factory=dict)

    def news(self, topic: str) -> f.Formula:
        """Whether a message on `topic` comes."""
        self.of.setdefault(topic, {})
        return f.Atom(f"new {self.signals.name(topic)}")

    def value(self, topic: str, aliases: dict[str, str], path: str, offset: int) -> Value:
        """A field of the message, or with `@A.` in front of another one. Raises FormulaError."""
        if path.startswith("@"):
            alias, _, path = path[1:].partition(".")
            if alias not in aliases:
                raise FormulaError(f"`@{alias}` is no message that comes before", offset)
            inner = self.value(aliases[alias], {}, path, offset)
            return Value(f"@{{{inner.text}, opening}}", inner.kind, name=inner.name)
        if _CONSTANT.fullmatch(path):
            self.signals.unknown.add(path)
            self.signals.definitions.setdefault(path, f"{len(self.signals.unknown)}")
            return Value(self.signals.name(path), Kind.NUMBER)
        written = f"{topic}.{path}"
        self.of.setdefault(topic, {})[path] = written
        return Value(self.signals.name(written), self.signals.kind(written), name=written)


def read(source: Source, signals: Signals, measure: Measure) -> list[Requirement]:
    """The properties in a file."""
    found, fields = [], _Fields(signals)
    for number, (text, place, metadata) in enumerate(_properties(source), 1):
        name = metadata.get("id", f"{number}")
        title = " ".join(filter(None, (metadata.get("title"), metadata.get("description"))))
        requirement = Requirement(name, title, " ".join(text.split()), place, has_readings=False)
        try:
            found.append(_said(_parsed(text), requirement, fields, measure))
        except FormulaError as error:
            found.append(replace(requirement, problem=str(error)))
    types = MessageTypes(shipped())
    for topic, paths in fields.of.items():
        _declare(topic, paths, signals, types)
    return found


def _properties(source: Source) -> Iterator[tuple[str, Span, dict[str, str]]]:
    """Each property with what comments in front of it say."""
    metadata: dict[str, str] = {}
    start, offset, text = 0, 0, ""
    for line in [*source.text.splitlines(keepends=True), "globally"]:
        if text.strip() and (offset == len(source.text) or _is_over(text, line)):
            first = start + len(text) - len(text.lstrip())
            yield text.strip(), Span(first, first + len(text.strip())), metadata
            text, metadata = "", {}
        if comment := re.match(r"\s*#\s*(id|title|description)\s*:\s*\"?(.*?)\"?\s*$", line):
            metadata[comment[1]] = comment[2]
        elif not line.lstrip().startswith("#"):
            start = offset if not text.strip() else start
            text = line if not text.strip() else text + line
        offset += len(line)


def _is_over(text: str, line: str) -> bool:
    """Whether a property ends before `line`: one that begins, even misspelled, where it is whole, or has its colon."""
    if re.match(r"\s*(globally|after|until|#)", line):
        return ":" in re.sub(r"\{[^}]*\}", "", text)
    if not re.match(r"(?!(?:within|causes|requires|forbids|or|and)\b)\w", line):
        return False
    try:
        _parsed(text)
    except FormulaError:
        return False
    return True


class _Scanner:
    """Reads the events and words of a property."""

    def __init__(self, text: str) -> None:
        self.text, self.at = text, 0

    def word(self, *words: str) -> str:
        """One of `words`, if it comes next, or nothing."""
        found = re.compile(rf"\s*({'|'.join(words)})(?![\w/])").match(self.text, self.at)
        self.at = found.end() if found else self.at
        return found[1] if found else ""

    def need(self, *words: str) -> str:
        """One of `words`. Raises FormulaError."""
        found = self.word(*words)
        if not found:
            raise FormulaError(f"`{words[0]}` is expected in `{self.text[self.at :].strip()[:40]}`", self.at)
        return found

    def events(self) -> _Events:
        """A message, or several in parentheses. Raises FormulaError."""
        if not self._take("("):
            return (self._event(),)
        found = [self._event()]
        while self.word("or"):
            found.append(self._event())
        if not self._take(")"):
            raise FormulaError("a `)` is missing", self.at)
        return tuple(found)

    def take(self, sign: str) -> None:
        """A sign. Raises FormulaError."""
        if not self._take(sign):
            raise FormulaError(f"`{sign}` is expected in `{self.text[self.at :].strip()[:40]}`", self.at)

    def _take(self, sign: str) -> bool:
        found = re.compile(rf"\s*{re.escape(sign)}").match(self.text, self.at)
        self.at = found.end() if found else self.at
        return found is not None

    def _event(self) -> _Event:
        found = _EVENT.match(self.text, self.at)
        if not found:
            raise FormulaError(f"a topic is expected in `{self.text[self.at :].strip()[:40]}`", self.at)
        self.at, condition = found.end(), ""
        if found[3]:
            depth, begin = 0, self.at
            for at in range(begin, len(self.text)):
                depth += (self.text[at] == "{") - (self.text[at] == "}")
                if not depth:
                    break
            else:
                raise FormulaError("a `}` is missing", begin)
            condition, self.at = self.text[begin + 1 : at], at + 1
        return _Event(found[1], found[2] or "", condition, found.end() + 1)


def _parsed(text: str) -> _Property:
    """The parts of a property. Raises FormulaError."""
    scanner = _Scanner(text)
    scope = scanner.need("globally", "after", "until")
    opening = scanner.events() if scope == "after" else ()
    closing = scanner.events() if scope == "until" or (scope == "after" and scanner.word("until")) else ()
    scanner.take(":")
    pattern = scanner.word("no", "some")
    sides = [scanner.events()]
    if not pattern:
        pattern = scanner.need(*_PATTERNS)
        sides.append(scanner.events())
    within = None
    if scanner.word("within"):
        bound = re.compile(r"\s*(\d+(?:\.\d+)?)\s*(ms|s)").match(text, scanner.at)
        if not bound:
            raise FormulaError("a time in s or ms is expected", scanner.at)
        within, scanner.at = round(float(bound[1]) * _UNITS[bound[2]]), bound.end()
    if text[scanner.at :].strip():
        raise FormulaError(f"`{text[scanner.at :].strip()[:40]}` is not expected here", scanner.at)
    return _Property(pattern, opening, closing, tuple(sides), within)


def _said(of: _Property, requirement: Requirement, fields: _Fields, measure: Measure) -> Requirement:
    """`requirement` with its formula, or with a property where values of two messages meet. Raises FormulaError."""
    aliases = {event.alias: event.topic for event in of.opening if event.alias}
    first = {event.alias: event.topic for event in of.sides[0] if event.alias}
    refers = any(f"@{alias}." in event.condition for alias in first for side in of.sides[1:] for event in side)
    p, q = (_formula(side, aliases, fields, measure) for side in (of.opening, of.closing))
    r = _formula(of.sides[0], aliases, fields, measure)
    if refers:
        if of.pattern == "requires" or of.opening or of.closing or len(of.sides[0]) > 1:
            raise FormulaError("values of an earlier message cannot be compared with those of this one")
        s = _formula(of.sides[1], first, fields, measure)
        return replace(requirement, said=(_each(of, r, s, fields),), notes=(_VALUES,))
    s = _formula(of.sides[1], aliases, fields, measure) if of.sides[1:] else f.TRUE
    topics = [{event.topic for event in side} for side in of.sides]
    opening = {event.topic for event in of.opening}
    is_shared = bool(opening & set().union(*topics))  # a message that opens the scope is not in it
    begins = f.Previous(p) if is_shared else p
    scope = _Scope(begins if of.opening else f.TRUE, q, of.within, len(topics) > 1 and bool(topics[0] & topics[1]))
    forms = [scope.body(of.pattern, r, s), scope.by_past(of.pattern, r, s)]
    if of.opening:
        never = f.Not(f.eventually(begins))
        forms = [f.Or(f.Until(f.negated(begins), f.And(begins, body)), never) for body in forms]
    found = replace(requirement, meaning=forms[0], forms=tuple(dict.fromkeys(forms)))
    if not any("opening}" in part.text for part in f.subformulas(forms[0]) if isinstance(part, f.Atom)):
        return found
    return replace(found, meaning=None, said=(_first_said(forms),), notes=(_VALUES,))


def _first_said(forms: list[f.Formula]) -> str:
    """A property for one of several formulas that are equal. Raises FormulaError."""
    problem = ""
    for form in forms:
        try:
            return Writer(Reading(None), "").property(form)
        except UnsayableError as error:
            problem = problem or str(error)
    raise FormulaError(problem)


_VALUES = "it compares values of two messages, of which there is no formula to compare with"


def _formula(events: _Events, aliases: dict[str, str], fields: _Fields, measure: Measure) -> f.Formula:
    """That one of `events` happens."""
    found: list[f.Formula] = []
    for event in events:
        happens = fields.news(event.topic)
        if event.condition.strip():
            resolve = partial(fields.value, event.topic, aliases)
            read = Conditions(event.condition, fields.signals, measure, resolve)
            happens = f.And(happens, read.condition_alone())
        found.append(happens)
    return reduce(f.disjoined, found, f.FALSE)


@dataclass(frozen=True)
class _Scope:
    """The part of a run from `begins` on, up to the first `ends`; the pattern may be bounded by `within`.

    With `is_strict` both sides of the pattern are about one topic, so that a message must not answer itself.
    """

    begins: f.Formula
    ends: f.Formula
    within: int | None
    is_strict: bool

    def _is_open(self) -> f.Formula:
        """Whether nothing has ended the scope so far."""
        return f.Not(f.Since(f.TRUE, self._inside(self.ends))) if self.ends != f.FALSE else f.TRUE

    def _inside(self, event: f.Formula) -> f.Formula:
        """Whether `event` happens after the scope has begun."""
        return event if self.begins == f.TRUE else f.And(event, f.Since(f.TRUE, self.begins))

    def _throughout(self, condition: f.Formula) -> f.Formula:
        return f.always(condition) if self.ends == f.FALSE else f.weak_until(condition, self.ends)

    def _reaches(self, goal: f.Formula) -> f.Formula:
        return f.Until(f.negated(self.ends), goal, 0, self.within)

    def _avoids(self, goal: f.Formula) -> f.Formula:
        if self.within is not None:
            return f.always(f.negated(f.conjoined(goal, self._is_open())), 0, self.within)
        return f.weak_until(f.negated(goal), self.ends) if self.ends != f.FALSE else f.always(f.negated(goal))

    def _later(self, part: f.Formula) -> f.Formula:
        return f.Next(part) if self.is_strict else part

    def _earlier(self, event: f.Formula) -> f.Formula:
        found = f.Since(f.TRUE, self._inside(event), 0, self.within)
        return f.Previous(found) if self.is_strict else found

    def body(self, pattern: str, r: f.Formula, s: f.Formula) -> f.Formula:
        """The pattern, of the part of the run from where the scope begins."""
        match pattern:
            case "no":
                return self._avoids(r)
            case "some":
                return self._reaches(r)
            case "causes":
                return self._throughout(f.implies(r, self._later(self._reaches(s))))
            case "forbids":
                return self._throughout(f.implies(r, self._later(self._avoids(s))))
            case _:
                return self._throughout(f.implies(r, self._earlier(s)))

    def by_past(self, pattern: str, r: f.Formula, s: f.Formula) -> f.Formula:
        """The same as something that is always so: where the scope is open."""
        given = f.conjoined(r, self._is_open())
        match pattern:
            case "causes":
                return f.always(f.implies(given, self._reaches(s)))
            case "forbids" if self.within is not None and not self.is_strict:
                return f.always(f.implies(given, self._avoids(s)))
            case "forbids":
                return f.always(f.negated(f.conjoined(f.conjoined(s, self._is_open()), self._earlier(r))))
            case "requires":
                return f.always(f.implies(given, self._earlier(s)))
            case _:
                return self.body(pattern, r, s)


def _each(of: _Property, r: f.Formula, s: f.Formula, fields: _Fields) -> str:
    """A property from each message on, with whose values later ones are compared."""
    writer = Writer(Reading(None), "")
    bound = f" within {Reading(None).duration(of.within)}" if of.within is not None else ""
    body = f"{'eventually' if of.pattern == 'causes' else 'never'} ({writer.condition(s)}){bound}"
    if isinstance(r, f.And):
        body = f"(initially ({writer.condition(r.right)})) implies ({body})"
    return f"each {writer.condition(fields.news(of.sides[0][0].topic))}: {body}"


def _declare(topic: str, paths: dict[str, str], signals: Signals, types: MessageTypes) -> None:
    """Where the signals of a topic come from: HPL has its name and the fields, not the type."""
    name = f"~/{topic[1:].lstrip('/')}" if topic[:1] == "~" else topic if topic[:1] == "/" else f"/{topic}"
    kinds = {path: signals.kind(written) for path, written in paths.items()}
    paths = {path: of for path, of in paths.items() if not any(other.startswith(f"{path}[].") for other in paths)}
    steps = {tuple(re.sub(r"\[[^]]*\]", "", path).split(".")) for path in paths}
    message = None if steps <= {("data",)} else message_with(steps, types)
    if message is None:
        numbers = [path for path, kind in kinds.items() if kind not in (Kind.BOOLEAN, Kind.STRING, Kind.NUMBERS)]
        if len(numbers) > 1:
            indexed = {path: f"std_msgs/Float64MultiArray.data[{n}]" for n, path in enumerate(numbers)}
        else:
            indexed = dict.fromkeys(numbers, Kind.NUMBER.value)
        for path, written in paths.items():
            signals.places[written] = f"{name} {indexed.get(path) or kinds[path].value}"
        base = next(
            (place.split(" ")[1].split(".")[0] for w, place in signals.places.items() if w in paths.values()), ""
        )
        signals.places[topic] = f"{name} {base or 'std_msgs/Empty'}"
        return
    package, _, short = message.rpartition("/")
    type_ = f"{package.partition('/')[0]}/{short}"
    signals.places[topic] = f"{name} {type_}"
    for path, written in paths.items():
        signals.places[written] = f"{name} {type_}.{path}"
