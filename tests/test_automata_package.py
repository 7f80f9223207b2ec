"""The package as others see it: when Spot is imported, what happens without it, and that results are reproducible."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from ltlc.automata import translate, translate_by_progression
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.ltl import And, Atom, Formula, Or, Until, atoms, eventually, globally, implies, weak_until

P, Q, R, S = map(Atom, "pqrs")

FORMULAS: list[Formula] = [
    globally(implies(Q, weak_until(implies(P, Until(R, S)), R))),
    And(eventually(P), Or(globally(eventually(Q)), eventually(globally(R)))),
    implies(eventually(R), Until(implies(P, Until(Q, S)), R)),
]

PRINT_MONITORS = """
import test_automata_package as t
print([t.both(f) for f in t.FORMULAS])
"""


def both(formula: Formula) -> str:
    alphabet = Alphabet(atoms(formula))
    return f"{translate(formula, alphabet)} {translate_by_progression(formula, alphabet)}"


def python(program: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
        cwd=os.path.dirname(__file__),
        env={**os.environ, **environment},
    )


@pytest.mark.parametrize("seed", ["0", "1", "4242"])
def test_monitors_do_not_depend_on_the_run_of_python(seed: str) -> None:
    printed = python(PRINT_MONITORS, PYTHONHASHSEED=seed)
    assert printed.stdout.strip() == str([both(f) for f in FORMULAS]), printed.stderr


def test_monitors_do_not_depend_on_what_was_translated_before() -> None:
    forwards = [both(f) for f in FORMULAS]
    backwards = [both(f) for f in reversed(FORMULAS)]
    assert backwards[::-1] == forwards


def test_importing_the_package_does_not_import_spot() -> None:
    program = "import sys, ltlc.automata; print('spot' in sys.modules)"
    assert python(program).stdout.strip() == "False"


def test_without_spot_the_error_says_what_to_install() -> None:
    program = (
        "import sys; sys.modules['spot'] = None\n"
        "from ltlc.automata import SpotMissing, translate\n"
        "from ltlc.semantics.alphabet import Alphabet\n"
        "from ltlc.semantics.ltl import TRUE\n"
        "try: translate(TRUE, Alphabet(()))\n"
        "except SpotMissing as error: print(error)"
    )
    assert "pip install spottl" in python(program).stdout


def test_a_module_of_the_same_name_that_is_not_spot_is_not_taken_for_it() -> None:
    program = (
        "import sys, types\n"
        "for name in ('spot', 'buddy'): sys.modules[name] = types.ModuleType(name)\n"
        "try: import ltlc.automata.engine\n"
        "except ImportError as error: print(error)"
    )
    assert "not the automata library" in python(program).stdout


@pytest.mark.parametrize("module", ["z3", "rosbags", "spot", "buddy"])
def test_an_engine_that_is_imported_in_automata_without_a_word_is_found(module: str) -> None:
    ruff = [sys.executable, "-m", "ruff", "check", "--select", "TID251", "--stdin-filename", "../ltlc/automata/new.py"]
    found = subprocess.run(
        ruff, input=f"import {module}\n", capture_output=True, text=True, check=False, cwd=os.path.dirname(__file__)
    )
    assert found.returncode == 1
    assert f"`{module}` is banned" in found.stdout
