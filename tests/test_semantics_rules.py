"""Several rules under one `always`, with bounds and without: their encoding means what the denotation says."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st
from strategies import predicates, properties

from ltlc.semantics import finite
from ltlc.semantics import properties as p
from ltlc.semantics.denotation import satisfies
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.instants import Step, instants
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import trackers_of

ATOMS = ("a", "b", "c")
PREDICATES = predicates(ATOMS)
BOUNDED = st.builds(
    lambda duration, keyword, predicate: p.Within(duration, keyword(p.Now(predicate))),
    st.integers(1, 4),
    st.sampled_from([p.Eventually, p.Always, p.Never]),
    PREDICATES,
)
RULES = st.recursive(
    st.one_of(BOUNDED, properties(ATOMS, depth=1)),
    lambda inner: st.one_of(
        st.builds(p.And, inner, inner),
        st.builds(lambda trigger, then: p.Implies(p.Now(trigger), then), PREDICATES, inner),
    ),
    max_leaves=4,
)


@st.composite
def runs(draw: st.DrawFn) -> tuple[list[Step], int]:
    """A few steps, and until when is looked."""
    letters = draw(st.lists(st.frozensets(st.sampled_from(ATOMS)), min_size=1, max_size=5))
    time, steps = 0, []
    for letter in letters:
        steps.append(Step(time, letter))
        time += draw(st.sampled_from([0, 1, 1, 2, 3, 5]))
    return steps, steps[-1].time + draw(st.integers(0, 5))


@given(RULES, runs())
def test_rules_joined_under_one_always_mean_what_they_say(rule: p.Property, seen: tuple[list[Step], int]) -> None:
    steps, until = seen
    property_ = p.Always(rule)
    formula = encode(property_, EPISODE)
    run = TimedRun(trackers_of(formula), [], 0)
    word = [*(letter for step in steps for letter in run.step(*step)), *run.hold(until)]
    assert finite.holds(formula, tuple(word)) == satisfies(instants(steps, until, []), property_)
