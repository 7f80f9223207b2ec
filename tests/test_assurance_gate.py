"""The gate: certificates that do not convince are refused, letters that the alphabet lacks are noticed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from replaying import samples
from stepping import from_text
from support import compiled

from ltlc.assurance.certify import NotCertified, certify
from ltlc.assurance.exactness import checked_certificate
from ltlc.assurance.foresight import Foreseen, Unforeseen, foresight
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.certificate import Certificate
from ltlc.semantics.ltl import Atom
from ltlc.semantics.properties import Eventually, Now

DAMAGES: dict[str, Callable[[Certificate], Certificate]] = {
    "rejects": lambda right: replace(right, annotations=tuple(() for _ in right.annotations)),
    "not shown that every verdict that could be permanent is": lambda right: replace(
        right, witnesses=tuple(() for _ in right.witnesses)
    ),
}


@pytest.mark.parametrize("reason", DAMAGES)
def test_a_certificate_that_does_not_convince_the_checker_is_none(reason: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def damaged(*arguments: object) -> Certificate:
        right = certify(*arguments)  # type: ignore[arg-type]
        assert isinstance(right, Certificate)
        return DAMAGES[reason](right)

    stop = compiled(Eventually(Now(Atom("stopped"))))
    assert isinstance(checked_certificate(stop), Certificate)
    monkeypatch.setattr("ltlc.assurance.exactness.certify", damaged)
    refused = checked_certificate(stop)
    assert isinstance(refused, NotCertified)
    assert reason in refused.reason


FORESEEN = {
    "thresholds": "decl x /x Float64.data\nafter x < 1, never x > 3",
    "integers": "decl n /n Int8.data\nafter n < 1, never n > 2.5",
    "strings": 'decl mode /mode String.data\nafter mode == "a", never mode == "b"',
    "distances": "object robot /gt Pose\nobject cone at (1, 2, 3)\n"
    "after robot.distance.cone < 1, robot.distance.cone < 2",
    "slopes": "object robot /tf TFMessage\nafter robot.velocity > 1, robot.velocity < 0.5",
    "elements": "decl scan /scan LaserScan.ranges\nafter any(scan < 1), never any(scan > 3)",
    "counts": "decl scan /scan LaserScan.ranges\nafter count(scan < 1) >= 4, never count(scan < 1) >= 7",
    "ends": "decl scan /scan LaserScan.ranges\nafter min(scan) < 1, never min(scan) > 3",
    "slices": "decl scan /scan LaserScan.ranges\nafter any(scan[40:] < 1), never len(scan) < 60",
    "entries": "decl id /s action_msgs/GoalStatusArray.status_list[].goal_info.stamp.sec\n"
    "decl state /s action_msgs/GoalStatusArray.status_list[].status\n"
    "after any(id == 3 and state == 4), never all(state == 4)",
    "sets": 'decl mode /mode String.data\nalways mode in {"a", "b"}',
    "history": "decl x /x Float64.data\nafter x > @{x, -2}, x < @{x, -2}",
}


@pytest.mark.parametrize("text", FORESEEN.values(), ids=FORESEEN)
def test_every_letter_of_a_small_alphabet_is_found_and_no_other(text: str) -> None:
    [each], _ = from_text(text)
    assert foresight(each, samples(each)) == Foreseen(each.specification.alphabet.count())


@pytest.mark.parametrize("text", FORESEEN.values(), ids=FORESEEN)
def test_an_alphabet_that_lacks_any_of_its_letters_is_noticed(text: str) -> None:
    [each], _ = from_text(text)
    alphabet = each.specification.alphabet
    letters = tuple(alphabet.letters())
    for missing in letters:
        rest = Group(alphabet.atoms, tuple(letter for letter in letters if letter != missing))
        small = replace(each.specification, alphabet=Alphabet(alphabet.atoms, (rest,)))
        found = foresight(replace(each, specification=small), samples(each))
        assert isinstance(found, Unforeseen)
        assert found.letter == missing
        assert found.frames
