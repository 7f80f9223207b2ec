"""Evidence of counts, values at openings, instances and slices: what is right is accepted, what is edited refused."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from bag_support import FORMS, Sent, made
from evidencing import (
    BEGINNING,
    COUNTS,
    INSTANCES,
    OPENINGS,
    SLICES,
    TYPES,
    disagreements,
    evidence_of,
    make,
    random_rows,
    refusals,
    said_of,
    specification,
    write_bag,
    write_table,
)

from ltlc.assurance.evidence.document import (
    Claim,
    Document,
    Line,
    NotCovered,
    StatedCount,
    StatedScope,
    StatedSlice,
    Summed,
    printed,
)
from ltlc.assurance.evidence.parsing import UnreadableEvidence, parsed
from ltlc.semantics.verdicts import Verdict

SECOND = 10**9
RATES = ["always rate(x) >= 4 Hz over 1 s", "never rate(z) >= 3 Hz over 2 s"]


def rows(topic: str, *values: Any) -> list[tuple[int, str, Any]]:
    """A value each second."""
    name = {"/x": "std_msgs/msg/Float64", "/b": "std_msgs/msg/Bool"}[topic]
    return [(BEGINNING + n * SECOND, topic, make(name, data=value)) for n, value in enumerate(values)]


def bag_of(folder: Path, *given: list[tuple[int, str, Any]]) -> Path:
    return write_bag(folder / "bag", sorted((row for each in given for row in each), key=lambda row: row[0]))


def only(document: Document) -> Claim:
    [found] = document.properties
    assert isinstance(found, Claim)
    return found


def edited(document: Document, **changes: Any) -> Document:
    return replace(document, properties=(replace(only(document), **changes),))


def kinds(found: list[str]) -> set[str]:
    return {each.partition(":")[0] for each in found}


@pytest.mark.parametrize(
    "properties", [[*COUNTS, *RATES], OPENINGS, INSTANCES, SLICES], ids=["counts", "openings", "instances", "slices"]
)
def test_all_checks_accept_the_evidence_of_random_bags(properties: list[str], tmp_path: Path) -> None:
    verdicts: Counter[Verdict] = Counter()
    text = specification(properties)
    for seed in range(8):
        bag = write_bag(tmp_path / "bag", random_rows(Random(seed)))
        document = evidence_of(text, bag)
        assert refusals(document, text, bag) == []
        verdicts.update(each.verdict for each in document.properties if isinstance(each, Claim))
    assert min(verdicts[verdict] for verdict in (Verdict.VIOLATED, Verdict.PRESUMABLY_SATISFIED)) > 5


@pytest.mark.parametrize("seed", range(3))
def test_letters_of_these_forms_are_those_that_are_computed_anew_at_ticks_as_well(seed: int, tmp_path: Path) -> None:
    assert list(disagreements(seed, tmp_path, [*COUNTS, *OPENINGS, *INSTANCES, *SLICES])) == []


LISTS = """
decl ints /ints Int64MultiArray.data
decl locked /marks MarkerArray.markers[].frame_locked
p0: always nearest(0.5, ints) < 1
p1: never all(locked)
"""


def test_lists_of_wide_integers_and_empty_lists_of_booleans_are_read_anew(tmp_path: Path) -> None:
    marks, ints = "visualization_msgs/msg/MarkerArray", "std_msgs/msg/Int64MultiArray"
    lists = (np.array(each, np.int64) for each in ([2**60, 1], [2], [-(2**60)]))
    sent = [Sent("/ints", ints, BEGINNING + n, made(ints, data=each)) for n, each in enumerate(lists)]
    sent.append(Sent("/marks", marks, BEGINNING, made(marks)))
    bag = FORMS["mcap"](tmp_path, sent)
    document = evidence_of(LISTS, bag)
    assert [each.verdict for each in document.properties if isinstance(each, Claim)] == [Verdict.VIOLATED] * 2
    assert refusals(document, LISTS, bag) == []


def test_a_first_row_that_makes_no_step_may_have_the_time_at_which_the_session_begins(tmp_path: Path) -> None:
    text = specification(["eventually (new x and x <= 0.3)"])
    table = write_table(tmp_path / "table.csv", rows("/x", math.nan))
    document = evidence_of(text, table)
    assert only(document).verdict is Verdict.NOT_STARTED
    assert refusals(document, text, table) == []


def test_a_field_may_have_two_names_of_which_one_is_that_of_a_column(tmp_path: Path) -> None:
    text = "object robot /robot Odometry\np: never robot.velocity.y > 2\nq: never robot.velocity.linear.y > 2\n"
    (table := tmp_path / "table.csv").write_text("time,robot.velocity.y\n0,1.0\n1,3.0\n", encoding="utf-8")
    document = evidence_of(text, table)
    assert [each.verdict for each in document.properties if isinstance(each, Claim)] == [Verdict.VIOLATED] * 2
    assert refusals(document, text, table) == []


def test_ticks_of_what_waits_for_a_sample_do_not_begin_with_the_session(tmp_path: Path) -> None:
    text = specification(["always (new x implies x - @{x, when x >= 0} < 1)"], "_rate_ = 3\n")
    bag = bag_of(tmp_path, rows("/b", True, False), [(BEGINNING + SECOND // 2, *rows("/x", 1.0)[0][1:])])
    document = evidence_of(text, bag)
    assert document.head.rate == "3.0"
    letters = only(document).letters
    assert not isinstance(letters, Summed)
    assert letters[0].time == BEGINNING + SECOND // 2
    assert refusals(document, text, bag) == []


def test_an_age_that_the_monitor_ignores_is_in_the_letters_nevertheless(tmp_path: Path) -> None:
    text = specification(["after_until new x, new x, age(x) <= 0.3 s"], "_timeout_ = 3 s\n")
    bag = bag_of(tmp_path, rows("/x", 1.0, 2.0, -1.0))
    document = evidence_of(text, bag)
    assert [each.name for each in only(document).atoms] == ["new x", "message on x"]
    assert refusals(document, text, bag) == []


def test_a_bag_of_which_rosbags_finds_no_messages_is_not_covered_by_the_reader(tmp_path: Path) -> None:
    sent = [Sent(topic, TYPES[topic], time, message) for time, topic, message in rows("/x", 1.0, 3.0)]
    bag = FORMS["mcap with chunk index"](tmp_path, sent)
    assert said_of(evidence_of(specification(["never x > 2"]), bag), bag) == (
        2,
        ["NOT COVERED: rosbags reads only 0 of the 2 messages"],
    )


COUNTED = specification(["never once (new b and b) 3 times within 10 s"])


def test_what_is_counted_is_said_by_the_numbers_of_atoms_and_follows_from_the_letters(tmp_path: Path) -> None:
    bag = bag_of(tmp_path, rows("/b", True, False, True, True))
    document = evidence_of(COUNTED, bag)
    claim = only(document)
    assert claim.counts == (
        StatedCount("once (new b and b) 3 times within 10 s", "3 within 10000000000 and new a0 a1"),
    )
    assert (claim.verdict, claim.decided) == (Verdict.VIOLATED, BEGINNING + 3 * SECOND)
    assert refusals(document, COUNTED, bag) == []
    assert parsed(printed(document)) == document


@pytest.mark.parametrize(
    "said",
    [
        "2 within 10000000000 and new a0 a1",
        "4 within 10000000000 and new a0 a1",
        "3 and new a0 a1",
        "3 within 10000000001 and new a0 a1",
        "3 within 10000000000 begins and new a0 a1",
        "3 within 10000000000 presumed and new a0 a1",
        "3 within 10000000000 or new a0 a1",
        "3 within 10000000000 new a0",
        "3 within 10000000000 and a0 a1",
        "3 within 10000000000 and new a0 not a1",
        "3 within 10000000000 and new a0 a1 a1",
        "3 within 10000000000 and new a0",
        "3 within 10000000000 and new a0 a7",
        "0 within 10000000000 and new a0 a1",
        "3 within 0 and new a0 a1",
        "a0",
    ],
)
def test_a_count_that_is_edited_is_refused(said: str, tmp_path: Path) -> None:
    bag = bag_of(tmp_path, rows("/b", True, False, True, True))
    document = evidence_of(COUNTED, bag)
    [count] = only(document).counts
    found = refusals(edited(document, counts=(count._replace(said=said),)), COUNTED, bag)
    assert "specification: it counts something else" in found


def test_a_count_that_is_missing_or_there_twice_or_of_another_name_is_refused(tmp_path: Path) -> None:
    bag = bag_of(tmp_path, rows("/b", True, False, True, True))
    document = evidence_of(COUNTED, bag)
    [count] = only(document).counts
    for counts in ((), (count, count), (count._replace(name="once b"),)):
        assert kinds(refusals(edited(document, counts=counts), COUNTED, bag)) == {"judge", "specification"}


def test_a_verdict_that_only_another_count_would_have_is_refused_by_the_judge(tmp_path: Path) -> None:
    bag = bag_of(tmp_path, rows("/b", True, False, True, True))
    document = evidence_of(COUNTED, bag)
    early, letters = BEGINNING + 2 * SECOND, only(document).letters
    assert not isinstance(letters, Summed)
    lines = tuple(line for line in letters if line.time <= early)
    forged = edited(document, letters=lines, until=early, decided=early)
    assert kinds(refusals(forged, COUNTED, bag)) == {"judge"}


def test_a_count_ends_a_nanosecond_after_its_time_though_there_is_no_line(tmp_path: Path) -> None:
    text = specification(["always rate(b) >= 2 Hz over 1 s"])
    bag = bag_of(tmp_path, rows("/b", True), rows("/x", 1.0, 1.0, 1.0))
    document = evidence_of(text, bag)
    assert (only(document).verdict, only(document).decided) == (Verdict.VIOLATED, BEGINNING + SECOND + 1)
    assert refusals(document, text, bag) == []
    later = edited(document, until=BEGINNING + SECOND + 2, decided=BEGINNING + SECOND + 2)
    assert kinds(refusals(later, text, bag)) == {"judge"}


OPENED = specification(["after b, always x <= @{x, opening}"])


def test_a_letter_says_which_scopes_are_open_and_the_document_from_which_step_on(tmp_path: Path) -> None:
    bag = bag_of(tmp_path, rows("/x", 1.0, 2.0, 1.0, 3.0), rows("/b", False, False, True))
    document = evidence_of(OPENED, bag)
    claim = only(document)
    assert claim.scopes == (StatedScope(1, ((4, None),)),)
    x = {"topic": "/x", "type": "std_msgs/msg/Float64", "path": ["data"]}
    assert claim.atoms[1].condition == {"call": "<=", "of": [x, {"opening": x, "scope": 1}]}
    assert (claim.verdict, claim.decided) == (Verdict.VIOLATED, BEGINNING + 3 * SECOND)
    assert claim.letters == (
        Line(BEGINNING, (1,)),
        Line(BEGINNING + 2 * SECOND, (1,)),
        Line(BEGINNING + 2 * SECOND, (0, 1, 2)),
        Line(BEGINNING + 3 * SECOND, (0, 2)),
    ) or claim.letters == (
        Line(BEGINNING, (1,)),
        Line(BEGINNING + 2 * SECOND, (0, 1, 2)),
        Line(BEGINNING + 3 * SECOND, (0, 2)),
    )
    assert parsed(printed(document)) == document
    assert refusals(document, OPENED, bag) == []


@pytest.mark.parametrize(
    "spans",
    [
        (),
        ((3, None),),
        ((5, None),),
        ((4, 5),),
        ((0, 1), (4, None)),
        ((4, None), (5, None)),
        ((4, 9),),
        ((4, 5), (5, None)),
    ],
)
def test_a_scope_that_is_said_to_be_open_otherwise_is_refused(spans: Any, tmp_path: Path) -> None:
    bag = bag_of(tmp_path, rows("/x", 1.0, 2.0, 1.0, 3.0), rows("/b", False, False, True))
    document = evidence_of(OPENED, bag)
    assert "recorded" in kinds(refusals(edited(document, scopes=(StatedScope(1, spans),)), OPENED, bag))


def test_a_scope_that_opens_later_with_letters_to_match_is_refused_by_the_judge(tmp_path: Path) -> None:
    """Without the judge, the value at the opening could be any that the signal ever had."""
    bag = bag_of(
        tmp_path,
        rows("/x", 1.0, 2.0, 1.0, 3.0),
        [(BEGINNING + 2 * SECOND + 1, "/b", make("std_msgs/msg/Bool", data=True))],
    )
    document = evidence_of(OPENED, bag)
    assert only(document).scopes == (StatedScope(1, ((0, None),)),)
    end = BEGINNING + 3 * SECOND
    forged = edited(
        document,
        scopes=(StatedScope(1, ((1, None),)),),
        letters=(Line(end - SECOND + 1, (0, 1)), Line(end, (0, 1, 2))),
        verdict=Verdict.PRESUMABLY_SATISFIED,
        until=end,
        decided=end,
    )
    [refusal] = refusals(forged, OPENED, bag)
    assert refusal == "judge: it does not say which scopes are open"


def test_values_at_openings_are_taken_after_a_decision_too_at_the_time_of_which_there_are_more_steps(
    tmp_path: Path,
) -> None:
    text = specification(["(after b, always x >= @{x, opening}) and x < @{x, opening} + 3"])
    last = [(BEGINNING + SECOND, "/x", make("std_msgs/msg/Float64", data=value)) for value in (9.0, 0.5)]
    bag = bag_of(tmp_path, rows("/b", False), rows("/x", 1.0), last)
    document = evidence_of(text, bag)
    assert (only(document).verdict, only(document).decided) == (Verdict.VIOLATED, BEGINNING + SECOND)
    assert refusals(document, text, bag) == []


@pytest.mark.parametrize("number", [0, 2, 7])
def test_another_scope_is_refused(number: int, tmp_path: Path) -> None:
    bag = bag_of(tmp_path, rows("/x", 1.0, 2.0), rows("/b", True, True))
    document = evidence_of(OPENED, bag)
    [scope] = only(document).scopes
    changed = edited(document, scopes=(scope._replace(number=number),))
    found = refusals(changed, OPENED, bag)
    assert "specification: it takes values at the opening of other scopes" in found
    assert isinstance(parsed(printed(edited(document, scopes=()))), UnreadableEvidence)
    assert kinds(refusals(edited(document, scopes=(scope, scope)), OPENED, bag)) >= {"specification"}


def test_many_lines_with_openings_are_summed_up_and_filled_in_by_the_reader(tmp_path: Path) -> None:
    text = specification(["after_until b, not b, never x > @{x, opening} + 5"])
    changing = [n % 4 > 1 for n in range(200)]
    bag = bag_of(tmp_path, rows("/x", *(float(n % 3) for n in range(200))), rows("/b", *changing))
    document = evidence_of(text, bag)
    assert isinstance(only(document).letters, Summed)
    assert len(only(document).scopes[0].open) == 50
    assert refusals(document, text, bag) == []
    others = only(document).scopes[0].open[1:]
    assert kinds(refusals(edited(document, scopes=(StatedScope(1, others),)), text, bag)) >= {"recorded"}


def test_scopes_that_open_too_often_are_not_covered(tmp_path: Path) -> None:
    text = specification(["after_until b, not b, never x > @{x, opening} + 5"])
    bag = bag_of(tmp_path, rows("/x", 1.0), rows("/b", *(n % 2 == 0 for n in range(500))))
    [found] = evidence_of(text, bag).properties
    assert isinstance(found, NotCovered)
    assert "more than 200 times" in found.reason


ANSWERED = specification(["each new b: eventually x > 1 within 2 s"])


def test_each_message_opens_an_instance_and_the_first_that_is_violated_decides(tmp_path: Path) -> None:
    bag = bag_of(tmp_path, rows("/x", 0.0, 2.0, 0.0), rows("/b", *(True,) * 6))
    document = evidence_of(ANSWERED, bag)
    claim = only(document)
    assert (claim.opens, claim.atoms[0].name) == (0, "new b (this one)")
    assert claim.atoms[0].condition == {"new": ["/b"]}
    late = BEGINNING + 4 * SECOND + 1
    assert (claim.verdict, claim.until, claim.decided) == (Verdict.VIOLATED, late, late)
    assert refusals(document, ANSWERED, bag) == []
    assert parsed(printed(document)) == document


@pytest.mark.parametrize("verdict", [each for each in Verdict if each is not Verdict.PRESUMABLY_VIOLATED])
def test_a_verdict_that_no_instance_has_is_refused(verdict: Verdict, tmp_path: Path) -> None:
    last = [(BEGINNING + 4 * SECOND, "/b", make("std_msgs/msg/Bool", data=True))]
    bag = bag_of(tmp_path, rows("/b", True, True), rows("/x", 0.0, 2.0, 0.0, 0.0, 0.0), last)
    document = evidence_of(ANSWERED, bag)
    assert only(document).verdict is Verdict.PRESUMABLY_VIOLATED
    assert "judge" in kinds(refusals(edited(document, verdict=verdict), ANSWERED, bag))


def test_a_message_that_opens_no_instance_in_the_letters_is_refused(tmp_path: Path) -> None:
    """Whoever leaves out the message without an answer has letters that are not those of the recording."""
    bag = bag_of(tmp_path, rows("/x", 0.0, 2.0, 0.0), rows("/b", *(True,) * 6))
    document = evidence_of(ANSWERED, bag)
    letters = only(document).letters
    assert not isinstance(letters, Summed)
    opening = [number for number, line in enumerate(letters) if 0 in line.atoms]
    assert len(opening) > 2
    for number in opening:
        less = letters[number]._replace(atoms=tuple(n for n in letters[number].atoms if n != 0))
        forged = edited(document, letters=(*letters[:number], less, *letters[number + 1 :]))
        assert "recorded" in kinds(refusals(forged, ANSWERED, bag))


@pytest.mark.parametrize("opens", [None, 1])
def test_instances_that_another_atom_opens_or_none_are_refused(opens: int | None, tmp_path: Path) -> None:
    bag = bag_of(tmp_path, rows("/b", True, True), rows("/x", 0.0, 2.0))
    document = edited(evidence_of(ANSWERED, bag), opens=opens)
    assert "specification: instances are opened by something else" in refusals(document, ANSWERED, bag)


def test_messages_that_were_ignored_because_of_a_limit_are_not_covered(tmp_path: Path) -> None:
    text = specification(["each new b limit 1: eventually x > 1 within 2 s"])
    bag = bag_of(tmp_path, rows("/x", 0.0), rows("/b", True, True))
    [found] = evidence_of(text, bag).properties
    assert isinstance(found, NotCovered)
    assert "ignored because of its limit" in found.reason


FOLLOWED = specification(["each a of i: eventually (new x and x > 1 or a < 0) within 1500 ms"])


def ids(*given: int) -> list[tuple[int, str, Any]]:
    """A message with an id each second."""
    name = "std_msgs/msg/Int64"
    return [(BEGINNING + n * SECOND, "/i", make(name, data=value)) for n, value in enumerate(given)]


def sliced(folder: Path) -> tuple[Path, Document]:
    """Id 7 is answered, 5 is not, -1 needs no answer, and 9 waits for one."""
    bag = bag_of(folder, rows("/x", 0.0, 2.0, 0.0, 0.0, 0.0), ids(7, 7, 5, -1, 9))
    return bag, evidence_of(FOLLOWED, bag)


def test_each_id_has_letters_and_a_verdict_and_all_have_that_of_the_worst(tmp_path: Path) -> None:
    bag, document = sliced(tmp_path)
    claim, late = only(document), BEGINNING + 3 * SECOND + SECOND // 2 + 1
    assert claim.key == {"topic": "/i", "type": "std_msgs/msg/Int64", "path": ["data"]}
    assert [(each.id, each.verdict) for each in claim.slices] == [
        ("7", Verdict.SATISFIED),
        ("5", Verdict.VIOLATED),
        ("-1", Verdict.SATISFIED),
        ("9", Verdict.PRESUMABLY_VIOLATED),
    ]
    assert (claim.verdict, claim.decided, claim.letters) == (Verdict.VIOLATED, late, ())
    assert refusals(document, FOLLOWED, bag) == []
    assert parsed(printed(document)) == document


def test_a_slice_that_is_decided_has_the_values_of_what_comes_at_the_same_time(tmp_path: Path) -> None:
    text = specification(["each a of i: eventually x > 1 and new i"])
    last = [(BEGINNING + SECOND, "/x", make("std_msgs/msg/Float64", data=0.0))]
    bag = bag_of(tmp_path, rows("/x", 3.0), [(BEGINNING + SECOND, "/i", make("std_msgs/msg/Int64", data=7))], last)
    document = evidence_of(text, bag)
    [slice_] = only(document).slices
    assert (slice_.verdict, slice_.letters) == (
        Verdict.SATISFIED,
        (Line(BEGINNING + SECOND, (0, 1)), Line(BEGINNING + SECOND, ())),
    )
    assert refusals(document, text, bag) == []


def moved(slices: tuple[StatedSlice, ...], number: int, **changes: Any) -> tuple[StatedSlice, ...]:
    return (*slices[:number], replace(slices[number], **changes), *slices[number + 1 :])


@pytest.mark.parametrize(
    ("change", "checks"),
    [
        (lambda slices: slices[:1] + slices[2:], {"judge", "recorded"}),
        (lambda slices: slices[:3], {"recorded"}),
        (lambda slices: (*slices, slices[1]), {"judge", "recorded"}),
        (lambda slices: (slices[1], slices[0], *slices[2:]), {"recorded"}),
        (lambda slices: moved(slices, 0, id="8"), {"recorded"}),
        (lambda slices: moved(slices, 0, id="7.0"), {"recorded"}),
        (lambda slices: moved(slices, 0, id='"7"'), {"recorded"}),
        (lambda slices: moved(slices, 1, verdict=Verdict.PRESUMABLY_SATISFIED), {"judge", "recorded"}),
        (lambda slices: moved(slices, 3, verdict=Verdict.PRESUMABLY_SATISFIED), {"judge"}),
        (lambda slices: moved(slices, 3, letters=slices[1].letters), {"recorded"}),
        (lambda slices: moved(slices, 1, letters=slices[0].letters), {"judge", "recorded"}),
        (lambda slices: moved(slices, 1, until=slices[1].until - 1, decided=slices[1].until - 1), {"judge"}),
        (lambda slices: moved(slices, 3, until=slices[3].until - 1, decided=slices[3].until - 1), {"recorded"}),
    ],
)
def test_slices_that_are_edited_are_refused(change: Any, checks: set[str], tmp_path: Path) -> None:
    bag, document = sliced(tmp_path)
    changed = edited(document, slices=change(only(document).slices))
    assert checks <= kinds(refusals(changed, FOLLOWED, bag))


@pytest.mark.parametrize(
    "changes",
    [
        {"verdict": Verdict.PRESUMABLY_VIOLATED},
        {"verdict": Verdict.SATISFIED},
        {"until": BEGINNING + 4 * SECOND, "decided": BEGINNING + 4 * SECOND},
        {"until": BEGINNING, "decided": BEGINNING},
        {"letters": (Line(BEGINNING, (0,)),)},
    ],
)
def test_a_verdict_of_all_that_is_not_that_of_the_worst_is_refused(changes: Any, tmp_path: Path) -> None:
    bag, document = sliced(tmp_path)
    assert "judge" in kinds(refusals(edited(document, **changes), FOLLOWED, bag))


def test_ids_of_another_field_are_refused(tmp_path: Path) -> None:
    bag, document = sliced(tmp_path)
    key = {"topic": "/x", "type": "std_msgs/msg/Float64", "path": ["data"]}
    found = refusals(edited(document, key=key), FOLLOWED, bag)
    assert kinds(found) >= {"recorded", "specification"}


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("each j of jn: never (gone jn and position > 1)", "ids are gone"),
        ("each j of jn: always age(position) <= 1 s", "ages"),
        ("each a of i: after a > 0, x <= @{x, opening}", "values at openings"),
        ("each a of i, x: eventually a > 1", "several topics"),
        ("each a of i limit 1: always (a > 0 implies eventually x > 1)", "ignored because of its limit"),
    ],
)
def test_what_is_not_covered_of_slices_is_said(text: str, reason: str, tmp_path: Path) -> None:
    bag = bag_of(tmp_path, rows("/x", 0.0, 2.0, 0.0), ids(7, 5, 3))
    [found] = evidence_of(specification([text]), bag).properties
    assert isinstance(found, NotCovered)
    assert reason in found.reason


@pytest.mark.parametrize("setting", ["_rate_ = 5\n", "_timeout_ = 5\n"])
def test_ids_at_ticks_or_up_to_a_timeout_are_not_covered(setting: str, tmp_path: Path) -> None:
    bag = bag_of(tmp_path, rows("/x", 0.0), ids(7))
    [found] = evidence_of(f"{setting}{FOLLOWED}", bag).properties
    assert isinstance(found, NotCovered)
    assert "for each id" in found.reason


def test_ids_in_a_table_are_not_covered(tmp_path: Path) -> None:
    table = tmp_path / "run.csv"
    table.write_text("time,i,x\n0,1,0\n1,1,3\n")
    [found] = evidence_of(FOLLOWED, table).properties
    assert isinstance(found, NotCovered)
    assert "over a table" in found.reason


def test_more_ids_than_evidence_has_room_for_are_not_covered(tmp_path: Path) -> None:
    bag = bag_of(tmp_path, rows("/x", 0.0), ids(*range(101)))
    [found] = evidence_of(FOLLOWED, bag).properties
    assert isinstance(found, NotCovered)
    assert "more than 100 ids" in found.reason
