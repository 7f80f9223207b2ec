"""Functions that take messages apart: for each topic one, with plain attribute access."""

from __future__ import annotations

import keyword
from collections import Counter
from collections.abc import Sequence
from dataclasses import field

from ltlc.backends.names import Names, variable
from ltlc.backends.python.code import Group, layout, literal, tuple_of
from ltlc.backends.trees import INDENT, LINE_LENGTH, Call, Text, prose
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.specification.expressions import Bytes, Each, Field, Match, Parallel, PathStep
from ltlc.specification.specification import fields

Place = tuple[PathStep, ...]


@dataclass(frozen=True, slots=True)
class ReadTopic:
    """A topic, the full name of its message type, and where in a message the fields are, in the order of the plan."""

    name: str
    message: str
    paths: tuple[Place, ...]


def read_topics(compiled: Sequence[Compiled]) -> list[ReadTopic]:
    """The topics that the properties read, in the order of first use, as the plan has it."""
    readings = dict.fromkeys(
        reading for c in compiled for signal in c.specification.signals() for reading in fields(signal)
    )
    by_topic: dict[str, list[Field]] = {}
    for _, source in readings:
        by_topic.setdefault(source.topic, []).append(source)
    return [ReadTopic(name, of[0].message, tuple(f.path for f in of)) for name, of in by_topic.items()]


def topics_code(topics: Sequence[ReadTopic], taken: frozenset[str]) -> tuple[list[str], list[str]]:
    """The functions that read messages, and the lines of `topics_to_read`; the names in `taken` are not redefined."""
    names = Names(taken)
    functions = {topic.name: names.unique(f"read_{variable(topic.name)}") for topic in topics}
    readers = ["\n".join(_Reader(topic).lines(functions[topic.name])) for topic in topics]
    entries = [line for topic in topics for line in _entry(topic, functions[topic.name]).lines(INDENT * 2, ",")]
    return readers, [
        "def topics_to_read() -> Sequence[Topic]:",
        f'{INDENT}"""The topics that are read, with what takes their messages apart."""',
        f"{INDENT}return (",
        *entries,
        f"{INDENT})",
    ]


def _entry(topic: ReadTopic, function: str) -> Group:
    """What `topics_to_read` says of a topic: also the paths of its fields, if names are all that leads to each."""
    items: list[Group | str] = [literal(topic.name), literal(topic.message), function]
    if all(isinstance(step, str) for path in topic.paths for step in path):
        items.append(tuple_of(tuple_of(literal(str(step)) for step in path) for path in topic.paths))
    return Group("Topic(", tuple(items), ")")


@dataclass
class _Reader:
    """Writes the function for one topic."""

    topic: ReadTopic
    assignments: list[str] = field(default_factory=list)
    variables: dict[Place, str] = field(default_factory=dict)
    names: Names = field(default_factory=lambda: Names(frozenset({"message", "each", "entry", "item", "parallel"})))

    def lines(self, name: str) -> list[str]:
        """The function called `name`."""
        self._name_common_parts()
        values = [self._value(path) for path in self.topic.paths]
        return [
            f"def {name}(message: Any) -> Sequence[Value]:",
            f'{INDENT}"""Fields of {prose(self.topic.name)}, {prose(self.topic.message)}."""',
            *self.assignments,
            *_returned(values),
        ]

    def _name_common_parts(self) -> None:
        """Give what several fields are in a name of its own."""
        parents = Counter(path[:-1] for path in self.topic.paths if path and all(isinstance(s, str) for s in path))
        for place, uses in parents.items():
            if place and uses > 1:
                self._assign(place, str(place[-1]), layout(f"{INDENT}{{}} = ", Text(self._plain(place))))

    def _assign(self, place: Place, wanted: str, lines: Sequence[str]) -> str:
        name = self.names.unique(variable(wanted))
        self.assignments += [line.replace("{}", name, 1) for line in lines]
        self.variables[place] = name
        return name

    def _plain(self, place: Place) -> str:
        """Code for a place that every message has."""
        if place in self.variables:
            return self.variables[place]
        return _within(self._plain(place[:-1]), place[-1]) if place else "message"

    def _value(self, path: Place) -> list[str]:
        """The item of the tuple of values for a field."""
        if not path:
            return [f"{INDENT * 2}True,"]
        if Each() in path:
            return self._each(path[: path.index(Each())], path[path.index(Each()) + 1 :])
        root = self._last_uncertain(path)
        if not root:
            return [f"{INDENT * 2}{self._plain(path)},"]
        variable_ = self._uncertain(root)
        code = variable_
        for step in path[len(root) :]:
            code = _within(code, step)
        if code == variable_:
            return [f"{INDENT * 2}{code},"]
        line = f"{INDENT * 2}None if {variable_} is None else {code},"
        if len(line) <= LINE_LENGTH:
            return [line]
        return [f"{INDENT * 2}None", f"{INDENT * 2}if {variable_} is None", f"{INDENT * 2}else {code},"]

    def _each(self, items: Place, path: Place) -> list[str]:
        """The item of the tuple of values for the fields at `path` in each of the messages `items`."""
        element = "each"
        for step in path:
            element = _within(element, step)
        root = self._last_uncertain(items)
        guard = f"None if {self._uncertain(root)} is None else " if root else ""
        found = f"[{element} for each in {self._inside(items)}]"
        line = f"{INDENT * 2}{guard}{found},"
        if len(line) <= LINE_LENGTH:
            return [line]
        inner = [f"{INDENT * 3}{element}", f"{INDENT * 3}for each in {self._inside(items)}"]
        return [f"{INDENT * 2}{guard}[", *inner, f"{INDENT * 2}],"]

    def _last_uncertain(self, path: Place) -> Place:
        """The longest part of `path` that ends in an element which a message may not have."""
        ends = [n + 1 for n, step in enumerate(path) if not isinstance(step, str | Bytes)]
        return path[: ends[-1]] if ends else ()

    def _uncertain(self, place: Place) -> str:
        """The variable that holds the element at `place`, or None."""
        if place in self.variables:
            return self.variables[place]
        found, wanted = self._lookup(place)
        outer = self._last_uncertain(place[:-1])
        if not outer:
            return self._assign(place, wanted, layout(f"{INDENT}{{}} = ", found))
        guard = Text(f"None if {self._uncertain(outer)} is None else ")
        return self._assign(place, wanted, layout(f"{INDENT}{{}} = {guard.text}", found))

    def _lookup(self, place: Place) -> tuple[Call, str]:
        """The call that finds the element at `place`, and what to call the element."""
        *before, step = place
        items = self._inside(tuple(before))
        match step:
            case Match(key, value):
                return Call("entry", (Text(items), Text(literal(key)), Text(literal(value)))), value
            case Parallel(names, value):
                siblings = _attribute(self._inside(tuple(before[:-1])), names)
                return Call("parallel", (Text(items), Text(siblings), Text(literal(value)))), f"{value}_{before[-1]}"
            case _:
                return Call("item", (Text(items), Text(str(step)))), f"{before[-1]}_{step}"

    def _inside(self, place: Place) -> str:
        """Code for a place, given that the elements on the way to it are there."""
        root = self._last_uncertain(place)
        code = self._uncertain(root) if root else "message"
        for step in place[len(root) :]:
            code = _attribute(code, str(step))
        return code


def _returned(values: Sequence[list[str]]) -> list[str]:
    """The statement that returns `values`, each an item of a tuple and its lines."""
    if len(values) == 1 and len(values[0]) == 1:
        (line,) = values[0]
        short = f"{INDENT}return ({line.strip()})"
        if len(short) <= LINE_LENGTH:
            return [short]
    return [f"{INDENT}return (", *(line for value in values for line in value), f"{INDENT})"]


def _within(code: str, step: PathStep) -> str:
    """Code for what `step` leads to, in what every message has or an element that is there."""
    match step:
        case int():
            return f"{code}[{step}]"
        case Bytes():
            return f"bytes_text(bytes({code}))"
        case _:
            return _attribute(code, str(step))


def _attribute(code: str, name: str) -> str:
    """Code for a field of a message; one that Python cannot name is asked for by its text."""
    if name.isidentifier() and not keyword.iskeyword(name):
        return f"{code}.{name}"
    return f"getattr({code}, {literal(name)})"
