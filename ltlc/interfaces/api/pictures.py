"""Pictures of monitors (SVG) and formulas (LaTeX), for notebooks; nothing but the standard library is needed."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ltlc.analysis.comparison.measure import successors
from ltlc.interfaces.pages.graphs import Edge, graph_svg
from ltlc.semantics.ltl import TRUE, Atom, Formula, Not, conjunction, disjunction
from ltlc.semantics.monitor import Monitor, Target


def monitor_svg(monitor: Monitor) -> str:
    """`monitor` as a picture."""
    states = range(len(monitor.verdicts))
    edges = [Edge(q, r, (_label(guard(monitor, q, r)),)) for q in states for r in successors(monitor, q)]
    return graph_svg(monitor.verdicts, edges)


def _label(letters: Formula) -> str:
    return "any" if letters == TRUE else str(letters)


def guard(monitor: Monitor, source: int, target: int) -> Formula:
    """The letters that lead from `source` to `target`, as a disjunction of the ways there."""
    return disjunction(_ways(monitor, monitor.edges[source], target, ()))


def _ways(monitor: Monitor, at: Target, target: int, answers: tuple[Formula, ...]) -> Iterator[Formula]:
    if at >= 0:
        if at == target:
            yield conjunction(answers)
        return
    decision = monitor.decisions[~at]
    atom = Atom(monitor.atoms[decision.atom])
    yield from _ways(monitor, decision.high, target, (*answers, atom))
    yield from _ways(monitor, decision.low, target, (*answers, Not(atom)))


_LATEX = {
    "&": r"\wedge ",
    "|": r"\vee ",
    "->": r"\rightarrow ",
    "!": r"\neg ",
    "1": r"\top ",
    "0": r"\bot ",
    "X[!]": r"\mathsf{X}^{!}\,",
    **{operator: rf"\mathbin{{\mathsf{{{operator}}}}}" for operator in "UWRM"},
    **{operator: rf"\mathsf{{{operator}}}\," for operator in "GFX"},
}

_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|X\[!\]|->|[a-z_][a-z0-9_]*|\S')


def formula_latex(formula: Formula) -> str:
    """`formula` for a page that shows LaTeX."""
    return "$" + "".join(map(_latex, _TOKEN.findall(str(formula)))) + "$"


def _latex(token: str) -> str:
    if token in _LATEX:
        return _LATEX[token]
    if token in "()":
        return token
    name = re.sub(r"([\\{}_^#&$%~])", lambda match: _ESCAPES.get(match[0], "\\" + match[0]), token.strip('"'))
    return rf"\text{{{name}}}"


_ESCAPES = {"\\": r"\backslash ", "^": r"\^{}", "~": r"\~{}"}
