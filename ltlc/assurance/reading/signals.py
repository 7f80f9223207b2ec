"""The signals of an emitted node: where they are read from, and how they are computed."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Sequence
from typing import Any, assert_never

from ltlc.assurance.reading.expressions import Reader, Target
from ltlc.assurance.reading.python import PythonFile, not_understood
from ltlc.assurance.reading.trees import Do, NotUnderstoodError, Return
from ltlc.program.expressions import Expression, Held, Kept, News, Read, Recent, Slope
from ltlc.program.lowering import has_sample, lowered, read
from ltlc.program.normal import normal
from ltlc.specification.expressions import Field, Match, Parallel, Signal

PYTHON = Target(lambda row, types: row.python(types), converts=True)


def data(node: ast.expr) -> Any:
    """Constants, what holds them, and calls of them, as tuples that begin with the name of what is called."""
    match node:
        case ast.Constant(value):
            return value
        case ast.UnaryOp(ast.USub(), ast.Constant(int() | float() as value)):
            return -value
        case ast.Tuple(elts):
            return tuple(map(data, elts))
        case ast.List(elts):
            return [*map(data, elts)]
        case ast.Dict(keys, values) if None not in keys:
            return {data(key): data(value) for key, value in zip(keys, values, strict=True) if key is not None}
        case ast.Call(ast.Name(name), arguments, keywords):
            return (name, *map(data, arguments), *((each.arg, data(each.value)) for each in keywords))
        case _:
            raise not_understood(node)


def input_data(wanted: Read) -> tuple[str | int, ...]:
    """An input in the runtime's terms."""
    match wanted:
        case Held(signal, 0):
            return "Input", signal
        case Held(signal, ago):
            return "Input", signal, ago
        case Recent(signal, ago):
            return "Recent", signal, ago
        case Slope(signal):
            return "Slope", signal
        case News(signal):
            return "New", signal
        case Kept():
            raise TypeError("a value at an opening is not an input")
        case _:
            assert_never(wanted)


def require_signals(file: PythonFile, said: ast.expr | None, wanted: Iterable[Signal]) -> None:
    """Raises NotUnderstoodError unless `said` are the signals `wanted`, each after those that it is computed from."""
    signals = _with_parts(wanted)
    known: set[str] = set()
    for node in said.elts if isinstance(said, ast.Tuple) else ():
        name = _require_signal(file, node, signals, known)
        if name in known:
            raise NotUnderstoodError(f"the signal `{name}` occurs twice")
        known.add(name)
    if known != signals.keys():
        raise NotUnderstoodError(f"the signal `{min(signals.keys() - known)}` is missing")


def _with_parts(wanted: Iterable[Signal]) -> dict[str, Signal]:
    """Signals with all that they are computed from, by their names."""
    todo = list(wanted)
    for signal in todo:
        todo += [part.signal for part in signal.inputs]
    return {signal.name: signal for signal in todo}


def _require_signal(file: PythonFile, node: ast.expr, signals: dict[str, Signal], known: set[str]) -> str:
    """The name of the signal that `node` describes, as it is."""
    match node:
        case ast.Call(ast.Name("Derived"), [ast.Constant(str(name)), given, *functions], []) if name in signals:
            definition = signals[name].definition
            if isinstance(definition, Field):
                raise NotUnderstoodError(f"the signal `{name}` is computed, but should be read")
            parts = tuple(map(read, signals[name].inputs))
            if data(given) != tuple(map(input_data, parts)) or not known >= {part.signal for part in parts}:
                raise NotUnderstoodError(f"the signal `{name}` does not receive what it is computed from")
            right = [lowered(definition), *([] if signals[name].when is None else [has_sample(signals[name])])]
            if len(functions) != len(right):
                raise NotUnderstoodError(f"the signal `{name}` has other functions")
            for function, expression in zip(functions, right, strict=True):
                if expression_of(file, function, parts) != normal(expression):
                    raise NotUnderstoodError(f"`{ast.unparse(function)}` does not compute `{name}`")
            return name
        case ast.Call(ast.Name("Reading"), [ast.Constant(str(name)), *_]) if name in signals:
            if data(node) != _reading(signals[name]):
                raise NotUnderstoodError(f"the signal `{name}` is read from the wrong place")
            return name
        case _:
            raise not_understood(node)


def _reading(signal: Signal) -> tuple[object, ...]:
    """Where a signal is read from, in the runtime's terms, which has a type of its own for wide integers."""
    source = signal.definition
    if not isinstance(source, Field):
        raise NotUnderstoodError(f"the signal `{signal.name}` is read, but should be computed")
    type_ = signal.type.value.replace("number", "integer") if signal.numbers.is_wide else signal.type.value
    entries = [step.value for step in source.path if isinstance(step, Match | Parallel)]
    return ("Reading", signal.name, source.topic, type_, *(("entry", entry) for entry in entries[:1]))


def expression_of(file: PythonFile, node: ast.expr, given: Sequence[Read]) -> Expression:
    """What a function of the values of `given` returns."""
    if not isinstance(node, ast.Name):
        raise not_understood(node)
    function = node.id
    method = file.function(function)
    match method.body:
        case (Return(value),) if not isinstance(value, Do):
            names = dict[str, Expression](zip(method.parameters, given, strict=True))
            return Reader(PYTHON, names, {}).expression(value)
        case _:
            raise NotUnderstoodError(f"`{function}` does more than compute a signal")
