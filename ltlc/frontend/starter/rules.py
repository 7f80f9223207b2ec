"""The rules of a topic as lines of a file: with limits that were measured, or with `?` in their place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from textwrap import wrap

from ltlc.base.source import quoted
from ltlc.dataclass import dataclass
from ltlc.frontend.starter.measured import LEAST_REGULAR, Arrivals, Measured, Probe, Values, duration, time_limit
from ltlc.frontend.starter.recipes import Recipe, Rule
from ltlc.semantics.durations import UNITS

FRESH = Rule("fresh", "There is a message at least every ?.", "always age({any}) <= ?")
FRESH_LATER = Rule(
    FRESH.label,
    "Once the first message has come, there is one at least every ?.",
    "after new {any}, always age({any}) <= ?",
)
COMES = Rule("comes", "The first message comes within ? of the start.", "eventually new {any} within ?")
SIZE = Rule("size", "It always has ? elements.", "always len({value}) == ?")

WIDTH = 118
"""So wide comments are."""

LEAST_START, LEAST_GAP = UNITS["s"], 10 * UNITS["ms"]
"""Limits on time are at least these, until the first message and between two."""

LEAST_RATE = 3
"""So many messages in a window are a rate at least."""

LEAST_COUNT = 10
"""A field without a recipe needs at least so many values to be worth a property."""


@dataclass(frozen=True, slots=True)
class Line:
    """A rule that is stated, or `is_offered` behind a `#`: its label, text and what it says in English."""

    label: str
    english: str
    text: str
    is_offered: bool = False

    def written(self, label: str) -> Iterator[str]:
        """Its lines in a file, labelled."""
        yield from comment(self.english)
        yield f"{'# ' if self.is_offered else ''}{label}: {self.text}"


def comment(text: str) -> list[str]:
    """`text` in lines of a comment."""
    return wrap(text, WIDTH, initial_indent="# ", subsequent_indent="# ", break_on_hyphens=False)


@dataclass(frozen=True, slots=True)
class Subject:
    """A topic that rules are about: its signals by what their names end in, and the kinds of their values.

    The kind `list` is that of numbers in any number.
    """

    topic: str
    recipe: Recipe
    names: Mapping[str, str]
    kinds: Mapping[str, str]

    def probes(self) -> list[Probe]:
        """What has to be measured of it."""
        of_kind = {"string": ("{}", "string"), "list": ("len({})", "number")}
        named = ((self.names[suffix], of_kind[kind]) for suffix, kind in self.kinds.items() if kind in of_kind)
        return [
            Probe(f"new {self.names['any']}", "predicate"),
            *(rule.probe(self.names) for rule in self.recipe.rules),
            *(Probe(text.format(name), kind) for name, (text, kind) in named),
        ]

    def unmeasured(self) -> Iterator[Line]:
        """The rules if only the type is known."""
        yield from () if self.recipe.is_stream else [self._line(COMES)]
        yield self._line(FRESH, is_offered=not self.recipe.is_stream)
        for rule in self.recipe.rules:
            yield self._line(rule, is_offered=rule.only_offered)

    def measured(self, arrivals: Arrivals, measured: Measured) -> Iterator[Line]:
        """The rules with what was measured."""
        yield from self._timing(arrivals)
        for rule in self.recipe.rules:
            yield from self._judged(rule, measured.values.get(rule.probe(self.names), Values()))
        for suffix, kind in self.kinds.items():
            name = self.names[suffix]
            if kind == "list":
                yield from self._size(suffix, name, measured.values.get(Probe(f"len({name})", "number"), Values()))
            if kind == "string":
                yield from self._strings(suffix, name, measured.values.get(Probe(name, "string"), Values()))

    def _line(self, rule: Rule, value: str = "?", *, is_offered: bool = False, remark: str = "") -> Line:
        english, text = rule.english.replace("?", value), rule.text.format(**self.names).replace("?", value)
        return Line(rule.label, f"{english} {remark}".rstrip(), text, is_offered)

    def _timing(self, came: Arrivals) -> Iterator[Line]:
        """When messages come."""
        gap = time_limit(came.gap, LEAST_GAP)
        is_late = came.start > gap
        if is_late or not came.are_regular:
            remark = f"It came after {duration(came.start)}." if came.start else "It came at once."
            yield self._line(COMES, duration(time_limit(came.start, LEAST_START)), remark=remark)
        if came.usual:
            remark = f"Usually one came every {duration(came.usual)}; the longest gap was {duration(came.gap)}."
            fresh = FRESH_LATER if is_late else FRESH
            doubt = "" if came.are_regular else f" {_doubt(came)}"
            yield self._line(fresh, duration(gap), is_offered=not came.are_regular, remark=remark + doubt)
        if came.are_regular and came.fewest * 4 // 5 >= LEAST_RATE:
            yield self._rate(came, came.fewest * 4 // 5)

    def _rate(self, came: Arrivals, count: int) -> Line:
        """How many messages come in any time, `count` in `came.window`."""
        window = came.window // UNITS["s"]
        rate, text = f"{count / window:g}", f"always rate({self.names['any']}) >= {count / window:g} Hz over {window} s"
        if came.start > came.usual:
            text = f"after once new {self.names['any']} {count} times, {text}"
        english = f"There are at least {rate} messages a second. The fewest in {window} s were {came.fewest}."
        return Line("rate", english, text)

    def _judged(self, rule: Rule, found: Values) -> Iterator[Line]:
        """A rule, if the recording does not contradict it; without a number from it, only offered."""
        is_known = found.count >= (LEAST_COUNT if rule.only_offered else 1)
        if "?" not in rule.text:
            held = is_known and not found.most
            remark = "" if held or not found.count else "This recording violates it."
            yield from () if rule.only_offered and not held else [self._line(rule, is_offered=not held, remark=remark)]
            return
        limit = found.limit(rule.is_upper) if is_known else None
        is_counter = rule.only_offered and found.only_grow
        if limit is not None and not is_counter and float(limit) < rule.beyond:
            extreme, which = (found.most, "most") if rule.is_upper else (found.least, "least")
            yield self._line(rule, limit, remark=f"The {which} was {extreme:.4g}.")
        elif not rule.only_offered:
            is_same = found.least == found.most
            values = f"{found.most:.4g} throughout" if is_same else f"between {found.least:.4g} and {found.most:.4g}"
            remark = f"It was {values}." if found.count else ""
            yield self._line(rule, is_offered=True, remark=remark)

    def _size(self, suffix: str, name: str, found: Values) -> Iterator[Line]:
        """How many elements an array has, if that is always the same."""
        if found.count and found.least == found.most:
            size = f"{found.most:g}"
            label = f"{suffix}_{SIZE.label}".lstrip("_")
            yield Line(label, SIZE.english.replace("?", size), SIZE.text.format(value=name).replace("?", size))

    def _strings(self, suffix: str, name: str, found: Values) -> Iterator[Line]:
        """Which of a few strings there are, each of which was there twice on average."""
        if (
            found.are_few
            and all(map(str.isprintable, map(str, found.different)))
            and found.count >= max(LEAST_COUNT, 2 * len(found.different))
        ):
            label = f"{suffix}_known".lstrip("_")
            listed = ", ".join(sorted(quoted(str(each)) for each in found.different))
            english = "It is one of those in the recording." if len(found.different) > 1 else "It never changes."
            yield Line(label, english, f"always {name} in {{{listed}}}")


def _doubt(came: Arrivals) -> str:
    """Why messages are not taken for a stream."""
    few = came.count < LEAST_REGULAR
    return f"{came.count} messages are too few to state it." if few else "That is too irregular to state it."
