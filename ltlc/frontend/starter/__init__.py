"""A specification to start with: usual properties of a robot's topics, to be changed by its author."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from textwrap import shorten

from ltlc.base.source import Source
from ltlc.frontend.language.define import is_topic
from ltlc.frontend.language.types import values_of
from ltlc.frontend.layout import layout
from ltlc.frontend.starter.measured import ROOM, ROOM_IN_TIME, Measured, Probe
from ltlc.frontend.starter.names import Names, name_of
from ltlc.frontend.starter.recipes import Recipe, constants_of, field_at, recipe_for
from ltlc.frontend.starter.rules import Line, Subject, comment
from ltlc.frontend.starter.topics import SILENT, Topic
from ltlc.inputs.messages.definitions import MessageTypes, shipped

__all__ = ["Draft"]

OWN = frozenset({"/rosout", "/parameter_events", "/events/write_split", "/events/read_split"})
"""Topics that ROS and its recorder have for themselves."""

LONGEST_REMARK = 80
"""Comments of message definitions are cut off here."""

_HEAD = "A start for what the robot must do, written by `ltlc new` from {origin}. "
_UNMEASURED = (
    "`ltlc mine` finds a number for each `?` in recordings of good runs; until then, `ltlc check` asks for it. "
    "Change what does not fit, and take the `#` off what does."
)
_MEASURED = (
    "All numbers were measured there. Limits leave room and are rounded outwards: {room:.0%} on values, a factor of "
    "{factor} on times. Change what does not fit, and take the `#` off what does. A `?` behind a `#` is a "
    "number that is not in this recording: `ltlc mine` finds it in others."
)
_OF_TABLE = (
    " The topics and the types of their messages are guessed from the columns of the table: change them to those of "
    "the robot."
)
_OWN_TYPES = (
    " Some message types are defined in this recording alone: `--msg-path {origin}` gives them to `ltlc check`, "
    "`explain` and `build`."
)
_STOPS = Line(
    "stops",
    "Whenever something is nearer than 0.5 m, it stands within ?.",
    "always (min({scan}) < 0.5 implies eventually abs({speed}) < 0.05 within ?)",
    is_offered=True,
)


class Draft:
    """Properties of `topics`, and why some are omitted."""

    def __init__(self, topics: Sequence[Topic], types: MessageTypes) -> None:
        used = self._names = Names()
        self._types = types
        self._subjects: list[tuple[Topic, Subject]] = []
        self._left_out: list[tuple[Topic, str]] = []
        for topic in topics:
            recipe = _recipe(topic, types)
            if isinstance(recipe, str):
                self._left_out.append((topic, recipe))
            else:
                self._subjects.append((topic, _subject(topic, recipe, types, used)))

    @property
    def is_empty(self) -> bool:
        """Whether no topic has properties."""
        return not self._subjects

    @property
    def omitted(self) -> list[str]:
        """Each topic without properties, and why."""
        return [f"{topic}: {why}" for topic, why in self._left_out]

    @property
    def declarations(self) -> str:
        """All signals."""
        return "\n".join(line for topic, of in self._subjects for _, line in _declarations(topic, of, self._types))

    @property
    def probes(self) -> list[Probe]:
        """What has to be measured, each once."""
        return list(dict.fromkeys(probe for _, subject in self._subjects for probe in subject.probes()))

    def text(self, origin: str, measured: Measured | None = None, *, is_table: bool = False) -> str:
        """A specification: topics and numbers come from `origin`. Without numbers that were `measured` it has `?`.

        `ltlc check` finds nothing else in it, and no error when the `#` is off all that it offers. Where it names types
        that only a recording defines, it says how they are known to other commands.
        """
        head = _HEAD.format(origin=origin) + (
            _UNMEASURED if measured is None else _MEASURED.format(room=ROOM, factor=ROOM_IN_TIME)
        )
        if is_table:
            head += _OF_TABLE
        elif measured is not None and any(topic.type not in shipped() for topic, _ in self._subjects):
            head += _OWN_TYPES.format(origin=origin)
        lines, labels = [*comment(head), ""], Names(self._names)
        left_out = list(self._left_out)
        for topic, subject in self._subjects:
            arrivals = measured and measured.arrivals.get(subject.topic)
            if measured is not None and arrivals is None:
                left_out.append((topic, SILENT))
                continue
            rules = subject.unmeasured() if not measured or not arrivals else subject.measured(arrivals, measured)
            lines += [*self._section(topic, subject, list(rules), labels), ""]
        lines += self._together(labels)
        lines += ["", "# Omitted:"] if left_out else []
        lines += [line for topic, why in left_out for line in comment(f"{topic}: {why}")]
        text = layout(Source("", "\n".join(lines)))
        assert isinstance(text, str), text
        return text

    def _section(self, topic: Topic, subject: Subject, rules: Sequence[Line], labels: Names) -> Iterator[str]:
        yield f"# {topic}"
        stated = {word for rule in rules if not rule.is_offered for word in re.findall(r"\w+", rule.text)}
        for name, line in _declarations(topic, subject, self._types):
            yield line if name in stated else f"# {line}"
        for rule in rules:
            yield from rule.written(labels.new(f"{name_of(topic.name)}_{rule.label}"))

    def _together(self, labels: Names) -> Iterator[str]:
        """Properties of a laser scanner and odometry in the same namespace."""
        moving = {_namespace(t): of for t, of in reversed(self._subjects) if t.type == "nav_msgs/msg/Odometry"}
        for topic, subject in self._subjects:
            if topic.type == "sensor_msgs/msg/LaserScan" and (other := moving.get(_namespace(topic))):
                names = {"scan": subject.names["any"], "speed": other.names["speed"]}
                yield from replace(_STOPS, text=_STOPS.text.format(**names)).written(labels.new(_STOPS.label))


def _recipe(topic: Topic, types: MessageTypes) -> Recipe | str:
    """The recipe for `topic`, or why it is omitted."""
    if topic.name in OWN:
        return "it is about ROS, not about the robot"
    if topic.omitted:
        return topic.omitted
    if not is_topic(topic.name):
        return "the name is not a valid topic"
    if ", " in topic.type:
        return "it has messages of several types"
    if topic.type not in types.messages:
        return "the type is unknown; `--msg-path` adds the messages of a package or a bag"
    recipe = recipe_for(topic.type, types)
    return recipe if not topic.fields else _only(recipe, topic, types)


def _only(recipe: Recipe, topic: Topic, types: MessageTypes) -> Recipe | str:
    """The recipe as far as the fields that a table has of `topic` go, or that they do not go far enough."""
    every = dict(values_of(topic.type, types))
    parts = {"vector": "xyz", "orientation": "xyzw"}
    kept = {}
    for suffix, (path, remark) in recipe.signals.items():
        field = path.replace("[]", "").replace(".", "/")
        needed = {f"{field}/{axis}".lstrip("/") for axis in parts.get(every.get(path, ""), "")} or {field}
        if needed <= topic.fields:
            kept[suffix] = path, remark
    names = {*kept, "any"} if next(iter(recipe.signals)) in kept else {*kept}
    rules = [rule for rule in recipe.rules if names.issuperset(re.findall(r"{(\w*)}", rule.text))]
    return replace(recipe, signals=kept, rules=tuple(rules)) if kept else "none of its usual fields is a column"


def _subject(topic: Topic, recipe: Recipe, types: MessageTypes, used: Names) -> Subject:
    base, every = name_of(topic.name), dict(values_of(topic.type, types))
    names = {suffix: used.new(f"{base}_{suffix}" if suffix else base) for suffix in recipe.signals}
    names["any"] = next(iter(names.values()))
    kinds = {}
    for suffix, (path, _) in recipe.signals.items():
        length, kind = field_at(topic.type, path, types)[2].length, every.get(path, "")
        kinds[suffix] = "list" if kind == "numbers" and length == 0 else kind
    return Subject(topic.name, recipe, names, kinds)


def _declarations(topic: Topic, subject: Subject, types: MessageTypes) -> Iterator[tuple[str, str]]:
    """The names of signals, and how they are declared, with what is remarked on them."""
    for suffix, (path, remark) in subject.recipe.signals.items():
        name = subject.names[suffix]
        owner, field, _ = field_at(topic.type, path, types)
        constants = constants_of(topic.type, path, types)
        listed = ", ".join(f"{constant} {value:g}" for constant, value in (constants[1] if constants else {}).items())
        remarked = shorten(remark or topic.comments.get((owner, field), "") or listed, LONGEST_REMARK, placeholder=" …")
        written = f"decl {name} {topic.name} {_short(topic.type, types)}" + (f".{path}" if path else "")
        yield name, written + (f"  # {remarked}" if remarked else "")


def _namespace(topic: Topic) -> str:
    return topic.name.rpartition("/")[0]


def _short(message: str, types: MessageTypes) -> str:
    """The shortest name by which the language knows the type."""
    package, _, short = message.rpartition("/")
    names = (short, f"{package.partition('/')[0]}/{short}")
    return next((name for name in names if types.find(name) == [message]), message)
