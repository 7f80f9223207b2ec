"""A specification to start with: what is usually said of the topics that a robot has, to be changed by its author."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, count

from ltlc.base.source import Source
from ltlc.frontend.language.define import is_topic
from ltlc.frontend.layout import layout
from ltlc.frontend.starter.recipes import Recipe, Rule, recipe_for
from ltlc.frontend.starter.topics import Topic
from ltlc.frontend.syntax.lexer import (
    CONTEXTUAL,
    FOREIGN_PREFIXES,
    FOREIGN_WORDS,
    FUNCTIONS,
    KEYWORDS,
    QUANTIFIERS,
    RESERVED,
)
from ltlc.inputs.messages.definitions import MessageTypes, shipped
from ltlc.semantics.durations import UNITS

__all__ = ["starter"]

OWN = frozenset({"/rosout", "/parameter_events", "/events/write_split", "/events/read_split"})
"""Topics that ROS and its recorder have for themselves."""

_WIDTH = 118
_HEAD = (
    "What the robot must do: a start, made by `ltlc new` from {origin}. The numbers are guesses. Change them, take "
    "away what does not fit, and take the `#` off what does. `ltlc check` says what is wrong with this file, "
    "`ltlc run` judges recordings by it, `ltlc build` makes a monitor of it, and where a `?` stands for a number, "
    "`ltlc mine` finds one."
)
_OF_BAG = (
    " Some of its message types are known from the bag alone: `ltlc check --recording {bag}` and "
    "`ltlc build --msg-path {bag}` know them, too."
)
_WORDS = frozenset(
    [*KEYWORDS, *CONTEXTUAL, *RESERVED, *FUNCTIONS, *QUANTIFIERS, *UNITS, *FOREIGN_WORDS, "opening"]
    + [word.lower() for word in FOREIGN_PREFIXES]
)
"""What a name had better not be."""

_STOPS = Rule(
    "stops",
    "Whenever something is nearer than 0.5 m, it stands within a second.",
    "always (min({scan}) < 0.5 implies eventually abs({speed}) < 0.05 within 1 s)",
    only_offered=True,
)


def starter(topics: Sequence[Topic], types: MessageTypes, origin: str, bag: str = "") -> str | None:
    """A specification about `topics`, which come from `origin`; None if nothing can be said of any of them.

    Where it names types that only the `bag` defines, it says how they are known to other commands.
    `ltlc check` finds nothing in it, and no error in it when the `#` is off everything that it offers.
    """
    recipes = [(topic, _recipe(topic, types)) for topic in topics]
    left_out = [f"{topic.name} [{topic.type}]: {recipe}" for topic, recipe in recipes if isinstance(recipe, str)]
    used = _Names()
    sections = [_section(topic, recipe, types, used) for topic, recipe in recipes if not isinstance(recipe, str)]
    if not sections:
        return None
    head = _HEAD.format(origin=origin)
    if bag and any(section.topic.type not in shipped() for section in sections):
        head += _OF_BAG.format(bag=bag)
    lines = [*_comment(head), ""]
    lines += [line for section in sections for line in (*section.lines, "")]
    lines += [line for rule, names in _together(sections) for line in _rule(rule, rule.label, names, used)]
    lines += ["", "# Omitted:", *(line for each in left_out for line in _comment(each))] if left_out else []
    text = layout(Source("", "\n".join(lines)))
    assert isinstance(text, str)
    return text


def _recipe(topic: Topic, types: MessageTypes) -> Recipe | str:
    """What can be said of `topic`, or why it is left out."""
    if topic.name in OWN:
        return "it is about ROS, not about the robot"
    if topic.is_silent:
        return "no message on it was recorded"
    if not is_topic(topic.name):
        return "the name is not a valid topic"
    if ", " in topic.type:
        return "it has messages of several types"
    if topic.type not in types.messages:
        return "the type is unknown; `--msg-path` adds the messages of a package or a bag"
    return recipe_for(topic.type, types)


class _Names:
    """Names of signals and labels, each given once."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def new(self, wanted: str) -> str:
        """`wanted`, or that with a number."""
        name = next(n for n in chain([wanted], (f"{wanted}_{k}" for k in count(2))) if n not in self._taken)
        self._taken.add(name)
        return name


@dataclass(frozen=True, slots=True)
class _Section:
    """What is said of one topic: the `names` of its signals are by what they end in."""

    topic: Topic
    names: dict[str, str]
    lines: tuple[str, ...]


def _section(topic: Topic, recipe: Recipe, types: MessageTypes, used: _Names) -> _Section:
    base = _base(topic.name)
    names = {suffix: used.new(f"{base}_{suffix}" if suffix else base) for suffix in recipe.signals}
    names["any"] = next(iter(names.values()))
    stated = " ".join(rule.text.format(**names) for rule in recipe.rules if not rule.only_offered)
    words = set(re.findall(r"\w+", stated))
    declarations = [
        f"{'' if names[suffix] in words else '# '}decl {names[suffix]} {topic.name} {_short(topic.type, types)}"
        + (f".{path}" if path else "")
        + (f"  # {remark}" if remark else "")
        for suffix, (path, remark) in recipe.signals.items()
    ]
    rules = [line for rule in recipe.rules for line in _rule(rule, f"{base}_{rule.label}", names, used)]
    return _Section(topic, names, (f"# {topic.name} [{topic.type}]", *declarations, *rules))


def _rule(rule: Rule, label: str, names: dict[str, str], used: _Names) -> Iterator[str]:
    yield f"# {rule.english}"
    yield f"{'# ' if rule.only_offered else ''}{used.new(label)}: {rule.text.format(**names)}"


def _together(sections: Sequence[_Section]) -> Iterator[tuple[Rule, dict[str, str]]]:
    """What is said of a laser scanner and of odometry in the same namespace."""
    moving = {_namespace(each): each for each in reversed(sections) if each.topic.type == "nav_msgs/msg/Odometry"}
    for each in sections:
        if each.topic.type == "sensor_msgs/msg/LaserScan" and _namespace(each) in moving:
            yield _STOPS, {"scan": each.names["any"], "speed": moving[_namespace(each)].names["speed"]}


def _namespace(section: _Section) -> str:
    return section.topic.name.rpartition("/")[0]


def _base(topic: str) -> str:
    """What signals of `topic` are called."""
    name = re.sub(r"[\W_]+", "_", topic).strip("_")
    return f"topic_{name}".rstrip("_") if not name or name[0].isdigit() or name.lower() in _WORDS else name


def _short(message: str, types: MessageTypes) -> str:
    """The shortest name by which the language knows the type."""
    package, _, short = message.rpartition("/")
    names = (short, f"{package.partition('/')[0]}/{short}")
    return next((name for name in names if types.find(name) == [message]), message)


def _comment(text: str) -> list[str]:
    return textwrap.wrap(text, _WIDTH, initial_indent="# ", subsequent_indent="# ", break_on_hyphens=False)
