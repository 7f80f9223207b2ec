"""A specification with `?` in it: its properties with values there, and which values are possible."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Severity
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.frontend.language import in_order, read_source, types_for
from ltlc.frontend.language.each import refusals
from ltlc.frontend.language.parameters import NAME, Parameter, Role, filled, parameters, with_copies
from ltlc.frontend.language.resolve import folded, resolve
from ltlc.frontend.syntax import tree as syntax
from ltlc.frontend.syntax.parse import parse
from ltlc.inputs.messages.definitions import MessageTypes
from ltlc.monitoring.mining.monotone import Monotony, NotMonotoneError
from ltlc.monitoring.mining.values import Values, values
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.encodings import EPISODE
from ltlc.specification.specification import PropertySpecification, Specification

SAMPLES: dict[Role, tuple[str | Nanoseconds, str | Nanoseconds]] = {
    Role.THRESHOLD: ("1", "2"),
    Role.MARGIN: ("1", "2"),
    Role.DURATION: (10**9, 2 * 10**9),
}
"""Two values, the larger one second, for finding out what a property is like."""


@dataclass(frozen=True, slots=True, eq=False)
class Sought:
    """A parameter, the label and line of its property, and the values that it can have."""

    parameter: Parameter
    label: str
    line: int
    values: Values


@dataclass(frozen=True, slots=True)
class Trial:
    """The value with this number, of those that what is sought can have."""

    sought: Sought
    number: int

    @property
    def text(self) -> str:
        """The value as the language writes it."""
        return self.sought.values.text(self.number)

    @property
    def rounded(self) -> Trial:
        """The same value, or a slightly weaker one that is easier to read."""
        return Trial(self.sought, self.sought.values.rounded(self.number))

    @property
    def command(self) -> syntax.PropertyCommand:
        """The property with that value."""
        return filled(self.sought.parameter, self.sought.values.literal(self.number), self.text)

    def is_of(self, specification: PropertySpecification) -> bool:
        """Whether that is the property with this value, or one of those that its `forall` stands for."""
        return specification.span == self.sought.parameter.command.span and specification.names[NAME] == self.text


@dataclass(frozen=True)
class Template:
    """A specification of which some values are `sought`; scopes are read as episodes.

    `sample` is what it says with some values.
    """

    source: Source
    tree: syntax.SyntaxTree
    types: MessageTypes
    sample: Specification
    sought: tuple[Sought, ...]

    def specification(self, trials: Iterable[Trial]) -> Specification:
        """The specification with the values of `trials`, and some value for the other parameters.

        All properties are there, for a run, its ticks and its timeout begin with the first of them.
        """
        copies: dict[Parameter, list[syntax.PropertyCommand]] = {each.parameter: [] for each in self.sought}
        for trial in trials:
            copies[trial.sought.parameter].append(trial.command)
        for sought in self.sought:
            copies[sought.parameter] = copies[sought.parameter] or [Trial(sought, 0).command]
        specification, findings = resolve(self.source, with_copies(self.tree, copies), self.types, EPISODE)
        assert specification is not None, findings
        return specification

    def text(self, trials: Iterable[Trial]) -> str:
        """The text of the specification with the values of `trials`."""
        return self.source.replaced(Span(0, len(self.source.text)), _written(trials))

    def property_text(self, trial: Trial) -> str:
        """The property of `trial`, its label and `forall` included, on one line."""
        return folded(self.source, trial.sought.parameter.command.span, _written([trial]))


def _written(trials: Iterable[Trial]) -> dict[Span, str]:
    return {trial.sought.parameter.span: trial.text for trial in trials}


def load(
    path: Path, message_paths: Sequence[str], recordings: Sequence[Path] = ()
) -> tuple[Template | None, list[Diagnostic]]:
    """The specification in the file at `path`, None if it has errors, and the findings about it.

    The messages that `recordings` define are known, too.
    """
    source = read_source(path)
    if isinstance(source, Diagnostic):
        return None, [source]
    types, problems = types_for(source, message_paths, recordings)
    tree, syntax_errors = parse(source)
    found, misplaced = parameters(source, tree)
    smaller, findings = resolve(source, _with_samples(tree, found, 0), types, EPISODE)
    told = [each for each in findings if each.code != "LTL840"]
    diagnostics = [*problems, *syntax_errors, *misplaced, *told]
    if not found and not _has_errors(diagnostics):
        message = "no property has a `?`"
        help = "write `?` for a threshold, a margin or a bound, as in `never robot.velocity > ?`"
        diagnostics.append(diagnostic("LTL843", source, None, message, help=help))
    if smaller is None or _has_errors(diagnostics):
        return None, in_order(diagnostics)
    if unfit := refusals(smaller, "mined"):
        return None, unfit
    larger, findings = resolve(source, _with_samples(tree, found, 1), types, EPISODE)
    assert larger is not None, findings
    sought = [_sought(parameter, smaller, larger) for parameter in found]
    diagnostics += [each for each in sought if isinstance(each, Diagnostic)]
    if _has_errors(diagnostics):
        return None, in_order(diagnostics)
    known = tuple(each for each in sought if isinstance(each, Sought))
    return Template(source, tree, types, smaller, known), in_order(diagnostics)


def _has_errors(diagnostics: Iterable[Diagnostic]) -> bool:
    return any(each.severity is Severity.ERROR for each in diagnostics)


def _with_samples(tree: syntax.SyntaxTree, found: Sequence[Parameter], which: int) -> syntax.SyntaxTree:
    """`tree` with the smaller or the larger sample in place of each parameter."""
    copies = {each: [replace(filled(each, SAMPLES[each.role][which], ""), names={})] for each in found}
    return with_copies(tree, copies)


def _sought(parameter: Parameter, smaller: Specification, larger: Specification) -> Sought | Diagnostic:
    """What is sought in place of `parameter`, or why nothing can be."""
    pairs = zip(smaller.properties, larger.properties, strict=True)
    of_it = [(one, other) for one, other in pairs if one.span == parameter.command.span]
    sample, _ = of_it[0]
    label = sample.label.rpartition("[")[0] if sample.names else sample.label
    try:
        ways = [Monotony(one, other) for one, other in of_it]
    except NotMonotoneError as error:
        message = f"there is no tightest value for `{label}`: {error.reason}"
        return diagnostic("LTL842", smaller.source, parameter.span, message, help=error.help)
    direction = ways[0].direction
    return Sought(parameter, label, sample.line, values(parameter.role, direction, [way.numbers for way in ways]))
