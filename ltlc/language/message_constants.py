"""Constants that messages define, such as `GoalStatus.STATUS_ABORTED`."""

from __future__ import annotations

from ltlc.language.members import member
from ltlc.language.names import Checker
from ltlc.language.types import message_type
from ltlc.language.values import Scalar, Text, Truth, Value
from ltlc.messages.definitions import Constant
from ltlc.nearest import did_you_mean
from ltlc.specification.expressions import Boolean, Number, String
from ltlc.syntax import tree as syntax


def message_constant(checker: Checker, node: syntax.MessageConstant) -> Value | None:
    """A constant of a message that is written with its package; None if an error was reported."""
    message = message_type(checker.source, node.message, checker.types)
    if not isinstance(message, str):
        checker.diagnostics.append(message)
        return None
    constants = checker.types.messages[message].constants
    if node.name.text in constants:
        return _constant_value(constants[node.name.text])
    _no_constant(checker, node.name, [message], message)
    return None


def short_constant(checker: Checker, node: syntax.Reference) -> Value | None:
    """A constant of a message without its package: of the only known message of that name that has it."""
    step = node.steps[0]
    messages = checker.types.find(node.name.text)
    found = {m: c[step.text] for m in messages if step.text in (c := checker.types.messages[m].constants)}
    if not found or not isinstance(step, syntax.Word):
        _no_constant(checker, step, messages, node.name.text)
        return None
    if len(set(found.values())) > 1:
        options = ", ".join(f"`{m}.{step.text}`" for m in found)
        message = f"`{checker.written(node)}` has different values in {', '.join(found)}"
        checker.report("LTL202", node.span, message, help=f"write one of {options}")
        return None
    return member(checker, node.steps[1:], _constant_value(next(iter(found.values()))))


def _no_constant(checker: Checker, name: syntax.Node, messages: list[str], shown: str) -> None:
    known = [c for m in messages for c in checker.types.messages[m].constants]
    written = checker.written(name)
    help = did_you_mean(written, known) or ("its constants are " + ", ".join(known) if known else "it has no constants")
    checker.report("LTL214", name.span, f"`{shown}` has no constant `{written}`", help=help)


def _constant_value(found: Constant) -> Value:
    if isinstance(found, bool):
        return Truth(Boolean(found))
    return Text(String(found)) if isinstance(found, str) else Scalar(Number(float(found)))
