"""Formulas to measure with: the collections that come with Spot, random ones, and families that grow fast."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator

from ltlc.automata.engine import spot
from ltlc.automata.spot_syntax import parse
from ltlc.semantics.ltl import Formula

with warnings.catch_warnings():
    # As in `engine`, which has to come first: SWIG's types lack `__module__`.
    warnings.simplefilter("ignore", DeprecationWarning)
    from spot import gen  # noqa: TID251

Named = tuple[str, Formula]

_COLLECTIONS = {
    "dac": gen.LTL_DAC_PATTERNS,
    "eh": gen.LTL_EH_PATTERNS,
    "hkrss": gen.LTL_HKRSS_PATTERNS,
    "p": gen.LTL_P_PATTERNS,
}
"""Dwyer, Avrunin and Corbett 1998; Etessami and Holzmann 2000; Holeček et al. 2004; Pelánek 2007 (BEEM)."""

CORPORA = (*_COLLECTIONS, "random", "blowup")
"""The corpora, by name."""

RANDOM_ATOMS, RANDOM_SIZE = 4, (5, 20)
"""Random formulas have so many atoms, and trees of sizes from and to; Spot simplifies them first."""


def corpus(name: str, seed: int = 0, count: int = 100) -> list[Named]:
    """The formulas of the corpus called `name`, with their names; `seed` and `count` are for `random`.

    Raises KeyError if there is no such corpus.
    """
    if name == "random":
        return list(_random(seed, count))
    if name == "blowup":
        return list(_blowup())
    family = _COLLECTIONS[name]
    return [(f"{name} {k}", _pattern(family, k)) for k in range(1, gen.ltl_pattern_max(family) + 1)]


def _pattern(family: int, number: int) -> Formula:
    return parse(str(gen.ltl_pattern(family, number)))


def _random(seed: int, count: int) -> Iterator[Named]:
    formulas = spot.randltl(RANDOM_ATOMS, n=count, seed=seed, tree_size=RANDOM_SIZE, simplify=3)
    for number, formula in enumerate(formulas, 1):
        yield f"random {seed}/{number}", parse(str(formula))


def _blowup() -> Iterator[Named]:
    """Families with a parameter, each as far as some way of building still answers in seconds."""
    for name, family, largest in _SPOTS_FAMILIES:
        yield from ((f"{name}({n})", _pattern(family, n)) for n in range(1, largest + 1))
    for name, member, parameters in _OWN_FAMILIES:
        yield from ((f"{name}({n})", parse(member(n))) for n in parameters)


_SPOTS_FAMILIES = (
    ("rv-counter", gen.LTL_RV_COUNTER, 3),
    ("kv-psi", gen.LTL_KV_PSI, 2),
    ("ms-phi-h", gen.LTL_MS_PHI_H, 4),
    ("and-gf", gen.LTL_AND_GF, 6),
    ("gf-equiv", gen.LTL_GF_EQUIV, 4),
    ("go-theta", gen.LTL_GO_THETA, 4),
)
"""Counters (Rozier and Vardi 2007), Kupferman and Vardi 2005, Müller and Sickert 2017, Cichoń et al. 2009, Gastin and
Oddoux 2001."""


def _responses(n: int) -> str:
    return " & ".join(f"G(a{k} -> F b{k})" for k in range(n))


def _within(n: int) -> str:
    return f"G(a -> F[0:{n}] b)"


def _delay(n: int) -> str:
    return f"G(a <-> {'X ' * n}b)"


_OWN_FAMILIES: tuple[tuple[str, Callable[[int], str], range], ...] = (
    ("responses", _responses, range(1, 5)),
    ("within", _within, range(4, 21, 4)),
    ("delay", _delay, range(2, 9, 2)),
)
"""Conjunctions of n responses, `b` within n steps of `a`, and `a` as a copy of `b` n steps later."""
