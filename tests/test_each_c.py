"""`each` in C: a table of ids that does what the definition says, and is read back; what it cannot do is refused."""

from __future__ import annotations

import random
import re
import subprocess
import textwrap
from collections.abc import Mapping
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest
from each_by_definition import HEAD, ONE_TOPIC, give, random_rows
from effort import fewer_runs
from replaying import MESSAGES, judged
from stepping import from_text

import ltlc
from ltlc.assurance.c_library import Library, compiler
from ltlc.assurance.c_programs import c_programs
from ltlc.assurance.c_table import Table
from ltlc.assurance.compiled_program import VERDICTS
from ltlc.assurance.library import Loaded
from ltlc.assurance.reading.c.files import written
from ltlc.assurance.reading.outcomes import Difference
from ltlc.assurance.replay import Deviation, Replayed
from ltlc.backends.c import emit
from ltlc.backends.python.load import load_plan
from ltlc.base.errors import UnusableInput
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.runtime.slice_steps import Slices
from ltlc.specification.expressions import Signal

RESPONSE = f"{HEAD}p: each g of id limit 3: always (kind == 1 implies eventually kind == 2 within 20 ns)"
LIVES = (
    f"{HEAD}p: each g of id limit 3: "
    "after_until new dist, age(dist) > 25 ns, always (kind == 1 implies eventually kind == 2)"
)
ARRAYS = """
decl id   /track action_msgs/GoalStatusArray.status_list[].goal_info.stamp.sec
decl dist /track action_msgs/GoalStatusArray.status_list[].goal_info.stamp.nanosec
decl kind /track action_msgs/GoalStatusArray.status_list[].status
decl v    /odom std_msgs/Float64.data
"""
TEXTS = {
    "response": RESPONSE,
    "lives": LIVES,
    "no clock": f"{HEAD}p: each g of id limit 3: always (kind == 1 implies eventually kind == 2)",
    "nothing as new": f"{HEAD}p: each g of id limit 3: never (kind == 1 and @{{kind, -1}} == 2)",
    "two topics": f"{HEAD}p: each g of id, fid limit 3: always (kind == 1 implies eventually prog > 2 within 20 ns)",
    "ages from birth": f"{HEAD}p: each g of id, fid limit 3: always age(prog) <= 30 ns",
    "a topic of all": f"{HEAD}p: each g of id limit 3: never (dist < 1 and v > @{{v, -1}})",
    "a topic of all, in time": (
        f"{HEAD}p: each g of id limit 3: always (dist < 1 implies eventually (stop and dist < 2) within 20 ns)"
    ),
    "latches": f"{HEAD}p: each g of id limit 3: always dist <= @{{dist, opening}} + 2",
    "the past": f"{HEAD}p: each g of id limit 3: always (kind == 2 implies once kind == 1 within 30 ns)",
    "counts": f"{HEAD}p: each g of id limit 3: never once kind == 1 2 times within 30 ns",
    "elements": f"{ARRAYS}p: each g of id limit 3: always (kind == 1 implies eventually dist > v within 20 ns)",
}


def outcome(text: str, right: str = "", wrong: str = "") -> Replayed | Deviation:
    """What the replay says of the property; of the text of the source, `right` is replaced."""
    compiled, specification = from_text(text)
    files = emit(compiled, specification)
    assert right in files.source
    object.__setattr__(files, "source", files.source.replace(right, wrong))
    programs = c_programs(files, compiled, specification, MESSAGES)
    assert programs is not None
    with nullcontext() if right else fewer_runs():
        return judged(compiled[0], programs[0])


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_a_table_in_c_judges_the_slices_of_the_definition(text: str) -> None:
    assert isinstance(outcome(text), Replayed)


def difference(text: str, in_file: str = "", right: str = "", wrong: str = "") -> str | None:
    """What reading back finds; in the header or the source, `right` is replaced."""
    compiled, specification = from_text(text)
    files = emit(compiled, specification)
    texts = {"h": files.header, "c": files.source}
    if in_file:
        assert right in texts[in_file]
        texts[in_file] = texts[in_file].replace(right, wrong)
    (found,) = written(texts["h"], texts["c"], compiled)
    read = found if isinstance(found, Difference) else found.read_back()
    return read.reason if isinstance(read, Difference) else None


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_a_table_in_c_is_read_back(text: str) -> None:
    assert difference(text) is None


FAULTS = {
    "what others said before": ("a topic of all", "slice->monitors = all->unborn;", "props_init(&slice->monitors);"),
    "what others say": ("a topic of all", "    go_on(all, time, samples);\n    return true;", "    return true;"),
    "a slice in the place of one that is dropped": (
        "a topic of all, in time",
        "if (!slice->is_taken || !settle(all, place)) {\n            place++;\n        }",
        "(void)settle(all, place);\n        place++;",
    ),
    "an id that stands elsewhere": ("response", "&& all->slices[place].id != id", ""),
    "what is owed": ("response", "is_owed = is_owed ||", "is_owed = false &&"),
    "what has started": ("response", "all->has_started ||", "false &&"),
    "deadlines": ("response", "right < left ? right : left", "right > left ? right : left"),
    "time that goes back": ("response", " || time < all->time)", ")"),
}


@pytest.mark.parametrize(("name", "right", "wrong"), FAULTS.values(), ids=FAULTS)
def test_a_fault_in_a_table_is_noticed_by_replay_and_by_reading_back(name: str, right: str, wrong: str) -> None:
    assert isinstance(outcome(TEXTS[name], right, wrong), Deviation)
    assert difference(TEXTS[name], "c", right, wrong) is not None


CHANGES = {
    "the limit": ("h", "PROPS_LIMIT = 3", "PROPS_LIMIT = 4"),
    "places": ("h", "PROPS_PLACES = 6", "PROPS_PLACES = 3"),
    "the type of ids": ("h", "    uint8_t id;", "    int8_t id;"),
    "what a place knows": ("h", "    bool lacks_beginning;\n", ""),
    "where ids stand": ("c", "mixed >> 32)", "mixed >> 31)"),
    "a slice behind one that is dropped": ("c", "home > next);", "home < next);"),
    "what is dropped": ("c", ".state == 0;", ".state <= 1;"),
    "marks": ("c", "all->left_out > 0u", "all->left_out > 1u"),
    "what is counted": ("c", "all->left_out = counted(all->left_out, 1u);", "all->left_out += 1u;"),
    "a new slice": ("c", "props_init(&slice->monitors);", ""),
    "what is asked of an id": (
        "c",
        "return all->slices[place].is_taken ? &all->slices[place] : NULL;",
        "return &all->slices[place];",
    ),
    "a function more": ("c", "/* Where the search", "static void f(void) {}\n/* Where the search"),
}


@pytest.mark.parametrize(("in_file", "right", "wrong"), CHANGES.values(), ids=CHANGES)
def test_what_is_changed_in_a_table_is_not_what_it_has_to_be(in_file: str, right: str, wrong: str) -> None:
    assert difference(RESPONSE, in_file, right, wrong) is not None


def test_a_table_without_slices_and_slices_without_a_table_are_not_read_back() -> None:
    (sliced,), specification = from_text(RESPONSE)
    (plain,), whole = from_text(RESPONSE.replace("each g of id limit 3: ", ""))
    for files, compiled in ((emit([sliced], specification), plain), (emit([plain], whole), sliced)):
        (found,) = written(files.header, files.source, [compiled])
        assert isinstance(found, Difference)


FULL = f"{HEAD}p: each g of id limit 5: "


@pytest.mark.parametrize("number", [0, 1, 2, 5, 8, 9, 11, 12, 14, 17])
def test_ids_that_find_no_place_are_left_out_as_by_rows(number: int) -> None:
    path, text = compiler(), FULL + ONE_TOPIC[number]
    assert path is not None
    require_as_by_rows(text, Library(emit(*from_text(text)), path))


def require_as_by_rows(text: str, library: Loaded) -> None:
    """A table in a library finds of random runs, whose ids are more than there is place for, what rows do."""
    plan, signals = load_plan(*from_text(text)), library.numbers
    for seed in range(20):
        rows, table = ByRows(Session(plan)), Table(library)
        (track,) = rows.tracks
        for time, topic, values in random_rows(random.Random(seed), 80, range(14)):
            if topic not in rows.session.fields:
                continue
            give(rows, (time, topic, values))
            sample = {signal: values[signal.name] for signal in signals if signal.name in values}
            take(table, time, topic, values, sample)
            assert isinstance(track.slices, Slices)
            ids = track.slices.ids
            assert table.left_out() == ids.left_out
            assert VERDICTS[table.show(0)[0]] is track.verdict
            assert {i for i in range(14) if (shown := table.show_of(i)) and shown[0].value == "violated"} == set(
                ids.violated
            )


def take(table: Table, time: int, topic: str, values: Mapping[str, object], sample: dict[Signal, Any]) -> None:
    """A message comes, with an id or without one."""
    if topic == "/track":
        table.step_of(time, int(str(values["id"])), sample, topic)
    else:
        assert table.step(time, sample, [topic])


EACH = "each g of id limit 3: never kind == 1"
REFUSED = {
    "no limit": ("each g of id: never kind == 1", "write `limit N`"),
    "too many": ("each g of id limit 99999999: never kind == 1", "`limit 99999999`"),
    "strings": ('decl name /n String.data\neach g of name limit 3: never name == "a"', "`name`, whose ids"),
    "an id as a value": ("each g of id limit 3: never g == kind", "`g`, an id that is read as a value"),
    "ticks": (f"_rate_ = 10\n{EACH}", "`_rate_`"),
    "a run that ends": (f"_timeout_ = 10\n{EACH}", "`_timeout_`"),
    "news that begin a slice": ("each g of id limit 3: always (new stop implies new id)", "/estop"),
    "ages of what has none": ("each g of id limit 3: always (dist < 1 implies age(stop) <= 1 s)", "/estop"),
    "other properties": (f"{EACH}\nnever dist > 2", "a file of its own"),
    "ids of two types": ("decl big /b UInt64.data\neach g of id, big limit 3: never kind == 1 and new big", "uint64"),
    "who is gone": (f"{ARRAYS}each g of id limit 3: never gone id", "`gone id`"),
    "bytes": ("decl u /u action_msgs/GoalInfo.goal_id\neach g of u limit 3: never new u", "bytes"),
}


@pytest.mark.parametrize("target", ["c", "rust"])
@pytest.mark.parametrize(("text", "said"), REFUSED.values(), ids=REFUSED)
def test_what_a_table_cannot_judge_is_refused_by_name(text: str, said: str, target: str) -> None:
    with pytest.raises(UnusableInput) as refused:
        ltlc.build(text if "decl id" in text else HEAD + text, target)
    assert {each.code for each in refused.value.diagnostics} == {"LTL708"}
    assert any(said in f"{each.message}; {each.help}" for each in refused.value.diagnostics)


PROGRAMS = {
    "motors": "motor 3 since 3000 ms",
    "answers": "1 answered, 1 not, first that of 0 ms",
}


@pytest.mark.parametrize(("name", "prints"), PROGRAMS.items(), ids=PROGRAMS)
def test_the_programs_of_the_documentation_print_what_it_says(name: str, prints: str, tmp_path: Path) -> None:
    page = (Path(__file__).parent.parent / "docs" / "c.md").read_text()
    blocks = [textwrap.dedent(each) for each in re.findall(r"(?:^    .*\n|^\n)+", page, re.MULTILINE)]
    text = next(each for each in blocks if f"# {name}.txt" in each)
    (tmp_path / "main.c").write_text(next(each for each in blocks if f"{name}.h" in each))
    files = emit(*from_text(text), name)
    (tmp_path / f"{name}.c").write_text(files.source)
    (tmp_path / f"{name}.h").write_text(files.header)
    flags = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-ffp-contract=off"]
    subprocess.run([compiler() or "cc", *flags, "main.c", f"{name}.c", "-o", name], cwd=tmp_path, check=True)
    done = subprocess.run([f"./{name}"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.stdout, done.returncode) == (f"{prints}\n", 1)
    assert f"`{prints}`" in page
