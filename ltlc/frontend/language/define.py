"""The commands that define names: declarations, models, objects, associations, settings."""

from __future__ import annotations

import math
import re

from ltlc.base.diagnostics import Diagnostic, Help, Label
from ltlc.base.fixes import respell, writing
from ltlc.base.source import Span
from ltlc.dataclass import dataclass
from ltlc.frontend.language.built import Context
from ltlc.frontend.language.durations import LONGEST, nanoseconds, of_seconds
from ltlc.frontend.language.evaluate import literal, value
from ltlc.frontend.language.names import Associated, Checker, ModelAttribute, Simulator, Sort
from ltlc.frontend.language.primitives import MODELLED, PRIMITIVES
from ltlc.frontend.language.references import kind
from ltlc.frontend.language.scopes import Scopes
from ltlc.frontend.language.signals import SIMULATORS, SOURCES, Landmark, Tracked, from_field
from ltlc.frontend.language.types import message_type, type_path
from ltlc.frontend.language.values import Message, Value
from ltlc.frontend.language.zones import zone
from ltlc.frontend.syntax import tree as syntax
from ltlc.frontend.syntax.lexer import skip_blank
from ltlc.frontend.syntax.parse import MAX_DEPTH
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.expressions import Field, Signal, ValueType
from ltlc.specification.guards import LEAD
from ltlc.specification.specification import DefinitionKind

MOST_RATE = 1e6
"""Hz; beyond, ticks of today cannot be distinguished in doubles."""

SETTINGS = ("_rate_", "_timeout_", "_margin_", "_lead_", "_simulator_")

MAX_SIZE = 10_000
"""How many nodes a property may have when its associations are written out."""

MAX_TOPIC = 247
"""How long the name of a topic may be in ROS 2, its leading slash included."""

_TOPIC = re.compile(r"(?:~/|/)?[A-Za-z_]\w*(?:/[A-Za-z_]\w*)*(?:\[\d{1,3}\])?", re.ASCII)


@dataclass
class Settings:
    """The settings of a file, with their defaults."""

    rate: float | None = None
    timeout: Nanoseconds | None = None
    margin: float = 0.0
    lead: Nanoseconds = LEAD


def settings(checker: Checker, tree: syntax.SyntaxTree) -> Settings:
    """The settings of a file, which may stand anywhere in it."""
    found = Settings()
    seen: dict[str, syntax.Setting] = {}
    for command in tree.commands:
        if not isinstance(command, syntax.Setting):
            continue
        name = command.name.text
        if name in seen:
            first = Label(seen[name].span, "first here")
            checker.report("LTL403", command.name.span, f"`{name}` is set twice", first)
            continue
        seen[name] = command
        _set(checker, command, found)
    return found


def _set(checker: Checker, command: syntax.Setting, found: Settings) -> None:
    name = command.name.text
    if name not in SETTINGS:
        listed = "the settings are " + ", ".join(f"`{s}`" for s in SETTINGS)
        help = respell(command.name.span, name, SETTINGS, is_closed=True) or listed
        if name == "_default_margin_":
            help = Help("did you mean `_margin_`?", (writing(command.name.span, "_margin_", is_certain=True),))
        checker.report("LTL401", command.name.span, f"there is no setting `{name}`", help=help)
        return
    if name == "_simulator_":
        _set_simulator(checker, command)
        return
    if name == "_timeout_":
        found.timeout = _duration(checker, command, "60 s")
        return
    if name == "_lead_":
        found.lead = _duration(checker, command, "10 ms") or LEAD
        return
    number = literal(checker, command.value)
    if number is None:
        return
    most = MOST_RATE if name == "_rate_" else math.inf
    if not 0 <= number <= most or math.isinf(number) or (number == 0 and name != "_margin_"):
        bound = "at least 0" if name == "_margin_" else "greater than 0"
        bound += f" and at most {most:.0f}" if name == "_rate_" else ""
        unit = " (steps per second)" if name == "_rate_" else ""
        checker.report("LTL402", command.value.span, f"`{name}` must be a number{unit} {bound}")
        return
    setattr(found, name.strip("_"), number)


def _duration(checker: Checker, command: syntax.Setting, example: str) -> Nanoseconds | None:
    """A duration, or a number of seconds; None if an error was reported."""
    node = command.value
    if isinstance(node, syntax.DurationLiteral):
        duration = nanoseconds(checker, node)
    else:
        number = literal(checker, node)
        duration = None if number is None else of_seconds(number)
    if duration is None or 0 < duration < LONGEST:
        return duration
    message = (
        f"`{command.name.text}` must be a duration such as `{example}`, or a number of seconds, "
        "greater than 0 and less than a century"
    )
    checker.report("LTL402", node.span, message)
    return None


def _set_simulator(checker: Checker, command: syntax.Setting) -> None:
    chosen = command.value
    options = ", ".join(f"`{s}`" for s in SIMULATORS)
    if isinstance(chosen, syntax.Word):
        topic = topic_name(checker, syntax.Word(chosen.span, chosen.text.replace("{name}", "name")))
        if "{name}" not in chosen.text:
            message = "the topic would be the same for every object: it must contain `{name}`"
            checker.report("LTL402", chosen.span, message, help="for example `/model/{name}/odometry`")
        elif topic is not None:
            checker.names.simulator = Simulator(chosen.text)
        return
    name = chosen.name.text if isinstance(chosen, syntax.Reference) and not chosen.steps else ""
    if name not in SIMULATORS:
        message = f"`{checker.written(chosen)}` is not a simulator"
        listed = f"write one of {options}, or a topic with `{{name}}` in it"
        help = respell(chosen.span, name, SIMULATORS, is_closed=True) or listed
        checker.report("LTL402", chosen.span, message, help=help)
        return
    checker.names.simulator = Simulator(*SIMULATORS[name])


def is_topic(text: str) -> bool:
    """Whether `text` can be the name of a topic; one without a leading `/` or `~` is below the root.

    Flight logs have instances of topics, which are numbers in brackets.
    """
    return _TOPIC.fullmatch(text) is not None and len(text) + (text[0] not in "/~") <= MAX_TOPIC


def topic_name(checker: Checker, word: syntax.Word) -> str | None:
    """The topic as ROS 2 knows it, with its leading slash; None if it cannot be one."""
    text = word.text
    if is_topic(text):
        return text if text[0] in "/~" else f"/{text}"
    help = "a topic is names joined by single `/`; a name has letters, digits and `_` and does not begin with a digit"
    checker.report("LTL108", word.span, f"`{text}` is not a valid topic name", help=help)
    return None


class Definitions:
    """Takes the commands of a file one after the other and enters what they define."""

    def __init__(self, checker: Checker, scopes: Scopes) -> None:
        self.checker = checker
        self.scopes = scopes
        self.names = checker.names

    def enter(self, command: syntax.Node) -> None:
        """Define what `command` defines, if anything."""
        match command:
            case syntax.Declaration():
                if self._is_new(command.name, DefinitionKind.DECLARATION):
                    self.names.declarations[command.name.text] = self._field(command, command.name.text)
            case syntax.Model():
                if self._is_new(command.name, DefinitionKind.MODEL):
                    self._model(command)
            case syntax.ObjectFromTopic():
                if self._is_new(command.name, DefinitionKind.OBJECT):
                    self.names.objects[command.name.text] = self._tracked(command)
            case syntax.ObjectAtPlace():
                if self._is_new(command.name, DefinitionKind.OBJECT):
                    self.names.objects[command.name.text] = self._place(command)
            case syntax.Message():
                self._is_new(command.name, DefinitionKind.MESSAGE)
            case syntax.Zone():
                if self._is_new(command.name, DefinitionKind.ZONE):
                    found = zone(self.checker, command)
                    self.names.associations[command.name.text] = Associated(
                        command, Sort.VALUE, 1, 1, found, found is not None
                    )
            case syntax.Association():
                if self._is_new(command.name, DefinitionKind.ASSOCIATION):
                    self.names.associations[command.name.text] = self._association(command)
            case _:
                pass

    def _is_new(self, name: syntax.Word, kind: DefinitionKind) -> bool:
        """Whether `name` can be defined as `kind` here; a model and an object may share a name."""
        pair = {DefinitionKind.MODEL, DefinitionKind.OBJECT}
        for other, word in self.names.definitions:
            if word.text == name.text and (other is kind or not {other, kind} <= pair):
                help: str | Help = ""
                if kind is DefinitionKind.ASSOCIATION:
                    equals = skip_blank(self.checker.source.text, name.span.end)
                    fix = writing(Span(equals, equals + 1), "==")
                    help = Help("`=` defines a name; values are compared with `==`", (fix,))
                first = Label(word.span, f"first defined here, as {_article(other)}")
                self.checker.report("LTL102", name.span, f"`{name.text}` is defined twice", first, help=help)
                return False
        self.names.definitions.append((kind, name))
        return True

    def _field(self, command: syntax.Declaration, name: str) -> Value | None:
        """The value that a declaration, or an attribute of a model, reads from its topic."""
        topic = topic_name(self.checker, command.topic)
        found = type_path(self.checker.source, command.type, self.checker.types)
        if isinstance(found, Diagnostic):
            self.checker.diagnostics.append(found)
            return None
        if topic is None:
            return None
        self.names.topics.setdefault(topic, (found.message, command.type.span))
        field = Field(topic, found.message, found.path, found.numbers)
        if found.kind == "message":
            return Message(Signal(name, ValueType.BOOLEAN, field), command.type.span)
        return from_field(name, found.kind, field)

    def _model(self, command: syntax.Model) -> None:
        attributes: dict[str, ModelAttribute] = {}
        self.names.models[command.name.text] = attributes
        for attribute in command.attributes:
            name = attribute.name.text
            if name in attributes:
                first = Label(attributes[name].span, "first here")
                message = f"the model has two attributes `{name}`"
                self.checker.report("LTL102", attribute.name.span, message, first)
                continue
            attributes[name] = ModelAttribute(self._attribute(command.name.text, attribute), attribute.name.span)

    def _attribute(self, model: str, attribute: syntax.Declaration) -> Value | None:
        name = attribute.name.text
        if name not in MODELLED:
            if name in PRIMITIVES:
                message = f"`{name}` is a primitive and cannot be an attribute of a model"
                self.checker.report("LTL102", attribute.name.span, message, help="choose another name")
                return None
            return self._field(attribute, f"{model}.{name}")
        found = self._field(attribute, f"{model}.model.{name}")
        if found is not None and found.noun != f"a {MODELLED[name]}" and found.noun != f"an {MODELLED[name]}":
            needed = "a quaternion" if MODELLED[name] == "orientation" else "a vector"
            message = f"the {name} of a model must be {needed}, not {found.noun}"
            self.checker.report("LTL205", attribute.type.span, message)
            return None
        return found

    def _tracked(self, command: syntax.ObjectFromTopic) -> Tracked | None:
        topic = topic_name(self.checker, command.topic)
        message = message_type(self.checker.source, command.type, self.checker.types)
        if isinstance(message, Diagnostic):
            self.checker.diagnostics.append(message)
            return None
        if message not in SOURCES:
            sources = ", ".join(f"`{source.rpartition('/')[2]}`" for source in SOURCES)
            text = f"`{message}` does not give the ground truth of an object"
            self.checker.report("LTL208", command.type.span, text, help=f"the types that do are {sources}")
            return None
        return None if topic is None else Tracked(command.name.text, topic, message)

    def _place(self, command: syntax.ObjectAtPlace) -> Landmark | None:
        numbers = [literal(self.checker, coordinate) for coordinate in command.coordinates]
        x, y, z = numbers
        if x is None or y is None or z is None:
            return None
        return Landmark(command.name.text, (x, y, z))

    def _association(self, command: syntax.Association) -> Associated:
        """An association, checked by itself; what depends on where it is used is checked there."""
        size, depth = self._measure(command.value)
        what = kind(self.checker, command.value)
        if not self._is_manageable(size, depth, command.name.span):
            return Associated(command.value, what, size, depth, sound=False)
        if what == Sort.VALUE:
            found = value(self.checker, command.value)
            return Associated(command.value, what, size, depth, found, found is not None)
        sound = self.scopes.property(command.value, Context(), in_scope=False) is not None
        return Associated(command.value, what, size, depth, None, sound)

    def is_manageable(self, command: syntax.PropertyCommand) -> bool:
        """Whether a property is small and shallow enough with its associations written out; else that is reported."""
        return self._is_manageable(*self._measure(command.property), command.property.span)

    def _measure(self, node: syntax.Node) -> tuple[int, int]:
        """The number of nodes and the depth of `node` with its associations written out."""
        size, deepest = 0, 0
        for part, depth in syntax.walk(node):
            inside = self._expanded(part)
            size += inside.size if inside else 1
            deepest = max(deepest, depth + (inside.depth if inside else 0))
        return size, deepest

    def _expanded(self, node: syntax.Node) -> Associated | None:
        """The association that `node` begins with and that will be written out."""
        found = self.names.associations.get(node.name.text) if isinstance(node, syntax.Reference) else None
        return found if found is not None and found.sound else None

    def _is_manageable(self, size: int, depth: int, place: Span) -> bool:
        if size <= MAX_SIZE and depth <= MAX_DEPTH:
            return True
        what = f"{size} parts" if size > MAX_SIZE else f"{depth} levels"
        limit = MAX_SIZE if size > MAX_SIZE else MAX_DEPTH
        message = f"with its associations expanded this has {what}; the limit is {limit}"
        self.checker.report("LTL307", place, message)
        return False


def _article(kind: DefinitionKind) -> str:
    return f"an {kind.value}" if kind.value[0] in "ao" else f"a {kind.value}"
