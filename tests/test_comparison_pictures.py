"""Pictures are well formed, whatever the atoms are called, and show every state and edge."""

from xml.etree import ElementTree

from hypothesis import given, settings
from strategies import HARD_NAMES, alphabets, formulas

from ltlc.analysis.comparison.measure import edges
from ltlc.automata import translate
from ltlc.interfaces.api.pictures import formula_latex, guard, monitor_svg
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.finite import holds
from ltlc.semantics.ltl import Atom, Formula, disjunction, eventually

SVG = "{http://www.w3.org/2000/svg}"


@settings(max_examples=50)
@given(formulas(max_leaves=5), alphabets())
def test_a_picture_has_a_circle_for_each_state_and_a_path_for_each_edge(formula: Formula, alphabet: Alphabet) -> None:
    monitor = translate(formula, alphabet)
    picture = ElementTree.fromstring(monitor_svg(monitor))
    assert len(picture.findall(f".//{SVG}circle")) == len(monitor.verdicts)
    assert len(picture.findall(f"{SVG}g/{SVG}path")) == edges(monitor)


@settings(max_examples=50)
@given(formulas(max_leaves=5))
def test_a_guard_holds_for_exactly_the_letters_that_lead_there(formula: Formula) -> None:
    alphabet = Alphabet(("a", "b", "c"))
    monitor = translate(formula, alphabet)
    for letter in alphabet.letters():
        for state in range(len(monitor.verdicts)):
            for target in range(len(monitor.verdicts)):
                assert holds(guard(monitor, state, target), (letter,)) == (monitor.step(state, letter) == target)


def test_names_are_shown_as_they_are() -> None:
    formula = eventually(disjunction(map(Atom, HARD_NAMES)))
    picture = ElementTree.fromstring(monitor_svg(translate(formula, Alphabet(HARD_NAMES))))
    assert picture is not None
    assert formula_latex(Atom("a_b")) == r"$\text{a\_b}$"
