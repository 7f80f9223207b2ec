"""Evidence: the letters that `ltlc run --evidence` writes are those that a plain reader of the recording computes."""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any

import pytest
from effort import share_of
from evidencing import (
    BEGINNING,
    PROPERTIES,
    Messages,
    disagreements,
    evidence_of,
    judge_of,
    make,
    random_rows,
    said_of,
    specification,
    write_bag,
)
from rosbags.interfaces import Nodetype  # noqa: TID251
from rosbags.typesys import Stores, get_typestore  # noqa: TID251

from ltlc.assurance.evidence import recorded
from ltlc.assurance.evidence.definitions import definition_text
from ltlc.assurance.evidence.document import Claim, Document, Line, NotCovered, StatedAtom, Summed, digest, printed
from ltlc.assurance.evidence.parsing import parsed
from ltlc.assurance.evidence.seam import difference, differences
from ltlc.cli import main
from ltlc.inputs.messages.definitions import MessageTypes, shipped
from ltlc.inputs.recordings.reading import Offset, ReadOptions, Stamp
from ltlc.semantics.verdicts import Verdict

BAGS = Path(__file__).parents[2] / "shared" / "data" / "bags"
SECOND = 10**9


def floats(topic: str, *values: float) -> list[tuple[int, str, object]]:
    """A value each second."""
    name = {"/x": "std_msgs/msg/Float64", "/y": "std_msgs/msg/Float32"}[topic]
    return [(BEGINNING + n * SECOND, topic, make(name, data=value)) for n, value in enumerate(values)]


def claim_of(document: Document, label: str) -> Claim:
    [found] = (each for each in document.properties if each.label == label)
    assert isinstance(found, Claim)
    return found


@pytest.mark.parametrize("seed", range(share_of(15)))
def test_the_letters_of_random_bags_and_tables_are_those_that_are_computed_anew(seed: int, tmp_path: Path) -> None:
    assert list(disagreements(seed, tmp_path)) == []


def test_the_lines_say_where_a_letter_changes_and_when_it_was_decided(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", floats("/x", 1.0, 1.5, 3.0, 1.0))
    claim = claim_of(evidence_of(specification(["never x > 2"]), bag), "c0")
    violated_at = BEGINNING + 2 * SECOND
    assert claim.letters == (Line(BEGINNING, ()), Line(violated_at, (0,)))
    assert (claim.verdict, claim.until, claim.decided) == (Verdict.VIOLATED, violated_at, violated_at)


def test_evidence_is_the_same_bytes_each_time(tmp_path: Path) -> None:
    bag, text = write_bag(tmp_path / "bag", random_rows(Random(5))), specification(PROPERTIES)
    first, second = (printed(evidence_of(text, bag)) for _ in range(2))
    assert first == second
    assert printed(parsed(first)) == first  # type: ignore[arg-type]


def test_many_lines_are_summed_up_and_filled_in_by_the_reader(tmp_path: Path) -> None:
    values = [float(n % 2) * 3 for n in range(200)]
    bag = write_bag(tmp_path / "bag", floats("/x", *values))
    document = evidence_of(specification(["always (x > 2 implies eventually x < 1)"]), bag)
    assert isinstance(claim_of(document, "c0").letters, Summed)
    code, _ = said_of(document, bag, tmp_path / "--fill", tmp_path / "filled")
    assert code == 2
    code = recorded.main([str(tmp_path / "evidence.txt"), str(bag), "--fill", str(tmp_path / "filled")])
    filled = parsed((tmp_path / "filled").read_text(encoding="utf-8"))
    assert code == 0
    assert isinstance(filled, Document)
    letters = claim_of(filled, "c0").letters
    assert letters == tuple(Line(BEGINNING + n * SECOND, (0,) if n % 2 else (1,)) for n in range(200))
    assert replace(claim_of(filled, "c0"), letters=claim_of(document, "c0").letters) == claim_of(document, "c0")
    assert said_of(filled, bag)[0] == 0


Change = Callable[[Claim], Claim]


def moved(atom: StatedAtom, limit: float) -> StatedAtom:
    """The same comparison with another limit."""
    match atom.condition:
        case {"call": name, "of": [left, _]}:
            return StatedAtom(atom.name, {"call": name, "of": [left, limit]})
        case _:
            raise AssertionError(atom)


@pytest.mark.parametrize(
    "change",
    [
        lambda claim: replace(claim, letters=claim.letters[:-1]),
        lambda claim: replace(claim, letters=(*claim.letters, Line(claim.until, (0,)))),
        lambda claim: replace(claim, letters=(claim.letters[0]._replace(atoms=(0,)), *claim.letters[1:])),
        lambda claim: replace(claim, letters=(*claim.letters[:-1], Line(claim.until - 1, (0,)))),
        lambda claim: replace(claim, until=claim.until - 1, decided=claim.until - 1),
        lambda claim: replace(claim, decided=claim.until - 1),
        lambda claim: replace(claim, session=claim.session + 1),
        lambda claim: replace(claim, verdict=Verdict.NOT_STARTED),
        lambda claim: replace(claim, verdict=Verdict.PRESUMABLY_SATISFIED),
        lambda claim: replace(claim, atoms=(moved(claim.atoms[0], 1.2),)),
    ],
)
def test_a_claim_that_is_changed_is_refused(change: Change, tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", floats("/x", 1.0, 1.5, 3.0, 1.0))
    document = evidence_of(specification(["never x > 2"]), bag)
    changed = replace(document, properties=(change(claim_of(document, "c0")),))
    code, lines = said_of(changed, bag)
    assert code == 1
    assert "REFUSED" in lines[0]


def test_a_first_step_that_is_left_out_is_refused_though_the_next_has_its_time(tmp_path: Path) -> None:
    rows = [(BEGINNING, "/x", make("std_msgs/msg/Float64", data=value)) for value in (3.0, 1.0)]
    document = evidence_of(specification(["never x > 2"]), write_bag(tmp_path / "bag", rows))
    claim = claim_of(document, "c0")
    assert claim.letters == (Line(BEGINNING, (0,)), Line(BEGINNING, ()))
    fine = replace(claim, letters=claim.letters[1:], verdict=Verdict.PRESUMABLY_SATISFIED)
    code, lines = said_of(replace(document, properties=(fine,)), tmp_path / "bag")
    assert (code, lines[0].partition(" stated")[0]) == (1, "c0: REFUSED:")


def test_a_recording_with_another_value_is_refused_if_a_letter_changes_and_the_digests_are_set_right(
    tmp_path: Path,
) -> None:
    text = specification(["never x > 2", "never y > 2"])
    rows = [*floats("/x", 1.0, 1.5, 1.0), *floats("/y", 1.0, 1.0, 1.0)]
    document = evidence_of(text, write_bag(tmp_path / "bag", rows))
    rows[1] = (rows[1][0], "/x", make("std_msgs/msg/Float64", data=2.5))
    other = write_bag(tmp_path / "bag", rows)
    code, [line] = said_of(document, other)
    assert code == 1
    assert line.startswith("REFUSED: no recording has the files, sizes and SHA-256 that are written: bag/bag.mcap ")
    recordings = evidence_of(text, other).head.recordings
    code, lines = said_of(replace(document, head=replace(document.head, recordings=recordings)), other)
    assert code == 1
    assert [("REFUSED" in line) for line in lines] == [True, False]


def test_a_text_without_a_document_is_no_evidence(tmp_path: Path) -> None:
    assert said_of("", write_bag(tmp_path / "bag", floats("/x", 1.0))) == (
        2,
        ["recorded.py: the last line has not the digest of the lines before it"],
    )


@pytest.mark.parametrize("word", ["ltlc", "text", "session", "until", "verdict"])
def test_a_line_that_is_written_twice_is_refused(word: str, tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", floats("/x", 1.0, 3.0))
    rows = printed(evidence_of(specification(["never x > 2"]), bag)).splitlines()[:-1]
    [at] = (number for number, row in enumerate(rows) if row.startswith(f"{word} "))
    text = "".join(f"{row}\n" for row in [*rows[:at], f"{word} 1", *rows[at:]])
    code, [line] = said_of(f"{text}end sha256 {digest(text)}\n", bag)
    assert (code, line.rpartition(" is ")[2]) == (2, "not written as it should be")


def test_a_type_that_was_read_without_the_digest_of_its_definition_is_refused(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", floats("/x", 1.0, 3.0))
    document = evidence_of(specification(["never x > 2"]), bag)
    code, lines = said_of(replace(document, head=replace(document.head, definitions=())), bag)
    assert (code, lines) == (
        1,
        ["REFUSED: /x has std_msgs/msg/Float64, and how std_msgs/msg/Float64 is defined has to be written"],
    )


def test_messages_that_are_defined_otherwise_than_written_are_refused(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", floats("/x", 1.0, 3.0))
    document = evidence_of(specification(["never x > 2"]), bag)
    definitions = tuple((name, "0" * 64) for name, _ in document.head.definitions)
    code, [line] = said_of(replace(document, head=replace(document.head, definitions=definitions)), bag)
    assert (code, line.partition(",")[0]) == (1, "REFUSED: it has no messages")


@pytest.mark.parametrize(
    "condition",
    [
        {"call": ">", "of": [[1, 2], 2.0]},
        {"call": "root", "of": [2]},
        {"call": "<", "of": [{"call": "atan2", "of": []}, 2]},
        {"call": "<", "of": [{"count": True, "over": [[5]], "beside": []}, 2]},
        {"call": "<", "of": [{"topic": "/x", "type": "std_msgs/msg/Float64", "path": ["none"]}, 2]},
        {"call": "<", "of": [{"topic": "/x", "type": "std_msgs/msg/Float64", "path": []}, 2]},
    ],
)
@pytest.mark.parametrize("timeout", ["", "_timeout_ = 5\n"])
def test_an_atom_that_is_no_condition_cannot_be_checked(
    condition: dict[str, object], timeout: str, tmp_path: Path
) -> None:
    bag = write_bag(tmp_path / "bag", floats("/x", 1.0, 3.0))
    document = evidence_of(timeout + specification(["never x > 2"]), bag)
    claim = claim_of(document, "c0")
    forged = replace(claim, atoms=(StatedAtom("x > 2", condition),))
    code, lines = said_of(replace(document, properties=(forged,)), bag)
    assert code == 2
    assert "NOT COVERED: " in lines[-1]


def test_a_byte_that_is_changed_is_refused_by_the_reader(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", floats("/x", 1.0, 3.0))
    text = printed(evidence_of(specification(["never x > 2"]), bag))
    changed = text.replace("ltlc 1", "ltlc 2", 1)
    assert changed != text
    assert said_of(text, bag)[0] == 0
    problem = "recorded.py: the last line has not the digest of the lines before it"
    assert said_of(changed, bag) == (2, [problem])


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    "reading",
    [
        ReadOptions(since=Offset(SECOND)),
        ReadOptions(until=Offset(2 * SECOND)),
        ReadOptions(since=Offset(SECOND // 2), until=Offset(10**12)),
        ReadOptions(stamp=Stamp.HEADER),
    ],
)
def test_a_part_of_a_recording_and_the_times_of_headers_are_covered(
    reading: ReadOptions, seed: int, tmp_path: Path
) -> None:
    rows = [*random_rows(Random(100 + seed)), (BEGINNING + 60 * SECOND, "/x", Messages(Random(1)).of("/x"))]
    text = specification([text for text in PROPERTIES if "age" not in text or "and b" not in text])
    document = evidence_of(text, write_bag(tmp_path / "bag", rows), reading)
    code, lines = said_of(document, tmp_path / "bag")
    assert [line for line in lines if "the letters are as stated" not in line] == []
    assert code == 0


@pytest.mark.parametrize("sign", [1, -1])
def test_an_integer_that_is_no_double_is_compared_exactly(sign: int, tmp_path: Path) -> None:
    rows = [(BEGINNING, "/i", make("std_msgs/msg/Int64", data=sign * (2**53 + 1)))]
    text = specification(["never i > 9007199254740992", "never i < -9007199254740992"])
    document = evidence_of(text, write_bag(tmp_path / "bag", rows))
    assert claim_of(document, f"c{(1 - sign) // 2}").letters == (Line(BEGINNING, (0,)),)
    assert said_of(document, tmp_path / "bag")[0] == 0


@pytest.mark.parametrize(("name", "value"), [("a", 1.0), ("b", 2.0), ("c", None), ("z", None)])
def test_an_entry_of_one_list_is_found_at_the_index_of_its_name_in_another(name: str, value: float | None) -> None:
    message = SimpleNamespace(name=["a", "b", "c"], position=[1.0, 2.0])
    assert recorded.value_at(message, ["position", ["parallel", "name", name]]) == value


def test_the_times_of_headers_are_those_of_the_lines(tmp_path: Path) -> None:
    rows = []
    for number, speed in enumerate((1.0, 3.0)):
        message = Messages(Random(1)).of("/q")
        message.pose.position.x = speed
        message.header.stamp = make("builtin_interfaces/msg/Time", sec=1_700_000_000 + number, nanosec=5)
        rows.append((BEGINNING + number, "/q", message))
    text = specification(["never thing.position.x > 2"])
    document = evidence_of(text, write_bag(tmp_path / "bag", rows), ReadOptions(stamp=Stamp.HEADER))
    stamps = 1_700_000_000 * SECOND + 5, 1_700_000_001 * SECOND + 5
    assert claim_of(document, "c0").letters == (Line(stamps[0], ()), Line(stamps[1], (0,)))
    assert said_of(document, tmp_path / "bag")[0] == 0


def test_a_message_at_the_very_time_of_from_is_in_the_part_that_is_judged(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", floats("/x", 1.0, 3.0, 1.0))
    document = evidence_of(specification(["never x > 2"]), bag, ReadOptions(since=Offset(SECOND)))
    assert claim_of(document, "c0").letters == (Line(BEGINNING + SECOND, (0,)),)
    assert said_of(document, bag)[0] == 0


@pytest.mark.parametrize("head", [{"timeout": SECOND}, {"is_by_header": True}])
def test_where_the_run_depends_on_all_properties_nothing_is_claimed_of_some(
    head: dict[str, Any], tmp_path: Path
) -> None:
    bag = write_bag(tmp_path / "bag", floats("/x", 1.0, 3.0))
    document = evidence_of(specification(["never x > 2", "never x > 9"]), bag)
    dropped = replace(document, properties=(document.properties[0], NotCovered("c1", "it is not")))
    assert said_of(dropped, bag)[0] == 0
    code, lines = said_of(replace(dropped, head=replace(document.head, **head)), bag)
    assert (code, lines[-1]) == (
        1,
        "REFUSED: something is claimed of some properties only, though the run depends on all",
    )


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("rate", ["", "_rate_ = 5\n"])
def test_a_timeout_ends_the_run_after_the_first_step_of_a_property(rate: str, seed: int, tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", random_rows(Random(200 + seed)))
    some = [text for text in PROPERTIES if "and b)" not in text]
    document = evidence_of(specification(some, f"{rate}_timeout_ = 3 s\n"), bag)
    assert document.head.timeout == 3 * SECOND
    code, lines = said_of(document, bag)
    assert [line for line in lines if "the letters are as stated" not in line] == []
    assert code == 0


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("after age(x) > 1 s, always x < @{x, opening} + 1", "an age opens or closes a scope"),
        ("after_until x < 2, new y, x < @{x, opening} + 1", "between two steps"),
        ("each g of i: always age(i) <= 1 s or g > 1", "ages, for each id"),
        ("each new x: after y > 1, always x < @{x, opening}", "values at openings, from each message on"),
        ("each new x: eventually y > 1 within [1 s, 2 s]", "an interval, from each message on"),
        ("always (new x implies not previously new x)", "a nanosecond ago"),
    ],
)
def test_what_is_not_covered_is_said_in_the_document_and_to_the_user(text: str, reason: str, tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", [*floats("/x", 1.0, 3.0), *floats("/y", 1.0)])
    report = judge_of(specification([text, "never y > 2"])).judge(bag)
    assert report.evidence is not None
    first, second = report.evidence.properties
    assert isinstance(first, NotCovered)
    assert reason in first.reason
    assert isinstance(second, Claim)
    [told] = (each for each in report.diagnostics if each.code == "LTL851")
    assert reason in told.message


def test_ages_that_count_from_different_messages_before_the_first_step_are_not_covered(tmp_path: Path) -> None:
    rows = [*floats("/x", 1.0), *[(BEGINNING + SECOND, "/y", make("std_msgs/msg/Float32", data=1.0))]]
    rows.append((BEGINNING + 2 * SECOND, "/b", make("std_msgs/msg/Bool", data=True)))
    text = specification(["always (b implies age(x) <= 1 s and age(y) <= 5 s)", "always (b implies age(y) <= 5 s)"])
    apart, alone = evidence_of(text, write_bag(tmp_path / "bag", rows)).properties
    assert isinstance(apart, NotCovered)
    assert isinstance(alone, Claim)
    assert alone.session == BEGINNING + SECOND


def test_a_table_whose_column_is_called_like_an_expression_is_not_covered(tmp_path: Path) -> None:
    table = tmp_path / "run.csv"
    table.write_text("time,x,y,x - y\n0,1,1,0\n1,3,1,2\n")
    over, alone = evidence_of(specification(["never @{x - y, -1} > 2", "never x > 2"]), table).properties
    assert over == NotCovered("c0", "the table has a column `x - y`, which is no field and no named signal")
    assert isinstance(alone, Claim)


def test_signals_of_a_table_that_are_not_those_of_the_specification_are_noticed_by_the_seam(tmp_path: Path) -> None:
    table, text = tmp_path / "run.csv", specification(["never x > 2", "never y > 2"])
    table.write_text("time,x,y\n0,1,1\n1,3,1\n")
    document = evidence_of(text, table)
    first, second = document.head.signals
    assert seam(document, text) == []
    for signals in (
        (first,),
        (second, first),
        (first._replace(name="y"), second),
        (first._replace(type="int8"), second),
    ):
        assert seam(replace(document, head=replace(document.head, signals=signals)), text)


def test_a_cell_of_a_table_that_is_another_is_refused_if_the_digests_are_set_right(tmp_path: Path) -> None:
    table, text = tmp_path / "run.csv", specification(["never x > 2"])
    table.write_text("time,x\n0,1\n1,3\n")
    document = evidence_of(text, table)
    assert said_of(document, table)[0] == 0
    table.write_text("time,x\n0,1\n1,2\n")
    recordings = evidence_of(text, table).head.recordings
    code, [line] = said_of(replace(document, head=replace(document.head, recordings=recordings)), table)
    assert (code, line) == (1, "c0: REFUSED: stated: +1000000000 a0; computed: nothing")


def seam(document: Document, text: str) -> list[str]:
    """Where a document, or one of its claims, is not about a specification."""
    of = judge_of(text).specification
    claims = (each for each in document.properties if isinstance(each, Claim))
    return [*differences(document, of), *(found for each in claims if (found := difference(each, of)))]


def test_the_seam_finds_nothing_in_what_was_written(tmp_path: Path) -> None:
    text = specification(PROPERTIES, "_rate_ = 5\n")
    bag = write_bag(tmp_path / "bag", random_rows(Random(3)))
    assert seam(evidence_of(text, bag), text) == []


def changed_atoms(document: Document) -> list[Document]:
    """Each with one number, name or word of one atom changed."""
    found = []
    for number, claim in enumerate(document.properties):
        assert isinstance(claim, Claim)
        for place, atom in enumerate(claim.atoms):
            for condition in changed(atom.condition):
                atoms = (*claim.atoms[:place], StatedAtom(atom.name, condition), *claim.atoms[place + 1 :])
                others = document.properties[:number], document.properties[number + 1 :]
                found.append(replace(document, properties=(*others[0], replace(claim, atoms=atoms), *others[1])))
    return found


def changed(part: Any) -> list[Any]:
    match part:
        case bool():
            return [not part]
        case int() | float():
            return [2 * part + 1]
        case str():
            return [{"<": "<=", "<=": "<", ">": ">=", ">=": ">"}.get(part, f"{part}x")]
        case list():
            return [[*part[:n], new, *part[n + 1 :]] for n, each in enumerate(part) for new in changed(each)]
        case dict():
            return [part | {key: new} for key, each in part.items() for new in changed(each)]
        case _:
            return []


def test_an_atom_that_is_something_else_is_noticed_by_the_seam(tmp_path: Path) -> None:
    text = specification(PROPERTIES)
    document = evidence_of(text, write_bag(tmp_path / "bag", random_rows(Random(3))))
    mutants = changed_atoms(document)
    assert len(mutants) > 400
    tried = Random(1).sample(mutants, share_of(len(mutants)))
    assert [mutant for mutant in tried if not seam(mutant, text)] == []


def test_other_labels_texts_rates_and_specifications_are_noticed_by_the_seam(tmp_path: Path) -> None:
    text = specification(["never x > 2"])
    document = evidence_of(text, write_bag(tmp_path / "bag", floats("/x", 1.0)))
    claim, head = claim_of(document, "c0"), document.head
    for other in (
        replace(document, properties=(replace(claim, label="c1"),)),
        replace(document, properties=(replace(claim, text="never x > 3"),)),
        replace(document, properties=(replace(claim, requirement="REQ-1"),)),
        replace(document, properties=(replace(claim, atoms=()),)),
        replace(document, properties=()),
        replace(document, head=replace(head, rate="5.0")),
        replace(document, head=replace(head, timeout=1)),
        replace(document, head=replace(head, specification=("props.txt", "0" * 64))),
    ):
        assert seam(other, text)


def test_definitions_of_messages_are_the_same_to_both_sides() -> None:
    store, types = get_typestore(Stores.ROS2_JAZZY), MessageTypes(shipped())
    names = sorted(types.messages.keys() & store.fielddefs.keys())
    assert len(names) > 150
    differing = [name for name in names if definition_text(name, types) != recorded.layout(store, Nodetype.NAME, name)]
    assert differing == []


@pytest.mark.skipif(not BAGS.is_dir(), reason="there are no recordings of others in ../shared/data")
@pytest.mark.parametrize("name", ["tb3_kf", "mobrob_odom"])
def test_recordings_of_others_have_the_letters_that_are_computed_anew(name: str, tmp_path: Path) -> None:
    text = """decl v /odom nav_msgs/Odometry.twist.twist.linear.x
decl x /odom nav_msgs/Odometry.pose.pose.position.x
model robot: position /odom Odometry.pose.pose.position ;
fast: never v > 0.2
silent: always age(v) <= 50 ms
far: always abs(x - @{x, -1}) < 0.01
stands: always (v > 0.1 implies eventually v < 0.05 within 3 s)
speed: always robot.velocity < 1
"""
    [*bags] = (path.parent for path in (BAGS / name).rglob("metadata.yaml"))
    assert bags
    for bag in bags:
        found = judge_of(text).judge(bag).evidence
        assert found is not None
        (tmp_path / "evidence.txt").write_text(printed(found), encoding="utf-8")
        assert recorded.main([str(tmp_path / "evidence.txt"), str(bag)]) == 0


def test_the_reader_is_printed_as_it_is_and_imports_nothing_of_ltlc(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["certify", "--show-reader"])
    assert ended.value.code == 0
    shown = capsys.readouterr().out
    assert shown == Path(recorded.__file__).read_text(encoding="utf-8")
    imported = {alias for node in ast.walk(ast.parse(shown)) for alias in names_of(node)}
    assert imported - sys.stdlib_module_names == {"numpy", "pyarrow", "rosbags"}


def names_of(node: ast.AST) -> list[str]:
    """The packages that a statement imports."""
    if isinstance(node, ast.Import):
        return [alias.name.partition(".")[0] for alias in node.names]
    return [str(node.module).partition(".")[0]] if isinstance(node, ast.ImportFrom) else []
