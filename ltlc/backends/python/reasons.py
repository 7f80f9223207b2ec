"""What the runtime explains violations by: the conditions of a property, with their texts."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

from ltlc.backends.clock_words import lateness
from ltlc.backends.python.code import Group, literal, tuple_of
from ltlc.backends.python.remembered import remembered
from ltlc.backends.spelling import Speller
from ltlc.backends.steps import clock_names
from ltlc.backends.trees import Call, Code, Text
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.program import lowering
from ltlc.program.properties import Words, words
from ltlc.semantics.timed_atoms import Age, Clock, Historically, Once
from ltlc.semantics.trackers import trackers_of
from ltlc.specification import expressions as e
from ltlc.specification.atoms import Atom
from ltlc.specification.functions import Function
from ltlc.specification.text import with_constant


@dataclass(frozen=True)
class Reasons:
    """What a violation of a property is explained by."""

    compiled: Compiled

    @cached_property
    def _words(self) -> Words:
        return words(self.compiled.specification, self.compiled.machine)

    @cached_property
    def asked(self) -> list[Atom]:
        """The conditions, by their numbers."""
        by_name = {atom.name: atom for atom in self.compiled.specification.atoms}
        return [by_name[name] for name in self._words.atoms]

    def conditions(self, speller: Speller) -> list[Code]:
        """Each with its text, whether it holds, and what it compares."""
        return [self._condition(speller, atom) for atom in self.asked]

    def _condition(self, speller: Speller, atom: Atom) -> Code:
        text = with_constant(self.compiled.specification.as_written(atom.name), atom.condition)
        sides = lowering.sides(atom.condition)
        parts = [Text(literal(text)), *map(speller.code, (lowering.condition(atom.condition), *sides))]
        match atom.condition:
            case e.Comparison(_, relation) if sides and relation.opposite is not None:
                parts.append(Text(literal(relation.value)))
        return Call("Condition", tuple(parts))

    def arguments(self) -> Iterator[Group | str]:
        """What the description of a property has, beside the function of its conditions."""
        machine = self.compiled.machine
        if machine.clocks:
            yield tuple_of(self._clocks(), "clocks=(", wide=True)
        yield tuple_of(map(str, self._words.steps), "edges=(")
        if machine.is_timed:
            yield tuple_of(map(str, self._words.expires), "held_edges=(")
        yield tuple_of((str(tuple(decision)) for decision in self._words.decisions), "decisions=(")
        if before := list(remembered(self.compiled.formula, self._words)):
            texts = ((literal(self.compiled.specification.as_written(name)), *map(str, more)) for name, *more in before)
            yield tuple_of((tuple_of(each) for each in texts), "remembered=(")
        if elements := list(self._elements()):
            yield tuple_of(elements, "elements=(")
        if entries := list(self._constants()):
            yield Group("constants={", tuple(entries), "}")

    def _clocks(self) -> Iterator[Group]:
        """The clocks of the program, with what they decide: of `age(s) <= D` and the like, that it holds no more."""
        names = clock_names(self.compiled.machine)
        clocks = [tracker for tracker in trackers_of(self.compiled.formula) if tracker.bounds]
        for name, tracker in zip(names, clocks, strict=False):  # those of counts come after them
            late, said = isinstance(tracker.subject, Clock | Historically), tracker.atoms
            if isinstance(tracker.subject, Clock):
                said = tuple(lateness(tracker.subject, bound) for bound in tracker.bounds)
            texts, bounds = tuple_of(map(literal, said)), tuple_of(map(str, tracker.bounds))
            is_recent = ["is_recent=True"] if isinstance(tracker.subject, Once) else []
            more = ["True"] if isinstance(tracker.subject, Age) else is_recent
            yield Group("Clock(", (literal(name), texts, bounds, str(late), *more), ")")
        for name, count in zip(names[len(clocks) :], self.compiled.specification.counts(), strict=True):
            yield Group("Clock(", (literal(name), tuple_of([literal(count.name)]), "()", "False"), ")")

    def _elements(self) -> Iterator[Group]:
        """The conditions that one element of arrays decides, with the places of these among the inputs."""
        inputs = self.compiled.specification.inputs()
        for number, atom in enumerate(self.asked):
            arrays, is_extreme = _arrays(atom.condition)
            if arrays and all(array in inputs for array in arrays):
                places = (str(inputs.index(array)) for array in arrays)
                yield Group("Elements(", (str(number), tuple_of(places), *(["True"] if is_extreme else [])), ")")

    def _constants(self) -> Iterator[str]:
        """By the name of what is compared with a constant of a message, what that calls its values."""
        found: dict[str, dict[float, str]] = {}
        for atom in self.asked:
            match atom.condition:
                case e.Comparison(e.Current(signal), _, e.Number(constants=constants)) if constants:
                    found.setdefault(signal.name, {}).update(constants)
        for name, constants_ in found.items():
            entries = (f"{value:g}: {literal(constant)}" for value, constant in constants_.items())
            yield f"{literal(name)}: {{{', '.join(entries)}}}"


def _arrays(condition: e.Condition) -> tuple[list[e.Expression], bool]:
    """The arrays an element of which decides the condition, and whether that is the least or greatest; or none."""
    match condition:
        case e.Comparison(_, relation) if relation.opposite is None:
            return [], False
        case e.Comparison(e.Count(over=()) as count):
            arrays, is_extreme = [element.array for element in count.elements], False
        case e.Comparison(e.Call(Function.MIN | Function.MAX, (array,)) as call) if call.array is not None:
            arrays, is_extreme = [array], True
        case _:
            return [], False
    found = [_whole(array) for array in arrays]
    return [array for array in found if array is not None] if None not in found else [], is_extreme


def _whole(array: e.Expression) -> e.Expression | None:
    """The array that this is, or is a part of that does not depend on where it ends."""
    match array:
        case e.Slice(whole, start, stop) if (start or 0) >= 0 and (stop is None or stop >= 0):
            return whole
        case e.Slice():
            return None
        case _:
            return array
