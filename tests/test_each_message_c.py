"""`each new` in C: instances that do what the definition says, and are read back; what they cannot do is refused."""

from __future__ import annotations

import random
from typing import Any

import pytest
from each_by_definition import HEAD, give, random_rows
from effort import share_of
from stepping import from_text
from test_each_c import difference, outcome
from test_each_message import MANY

import ltlc
from ltlc.assurance.c_library import Library, compiler
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
from ltlc.runtime.slice_ids import Messages
from ltlc.runtime.slices import OpenedSlices
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Signal
from ltlc.specification.specification import Instances

EACH = f"{HEAD}p: each new prog limit 3: "
ANSWERED = f"{EACH}eventually (new kind and dist == @{{prog, opening}}) within 20 ns"
TEXTS = {
    **{text: f"{EACH}{text}" for text in MANY},
    "an opening": ANSWERED,
    "a value that is held": f"{EACH}initially v < 2",
    "a topic that is not read": f"{EACH}eventually stop within 15 ns",
    "ages": f"{EACH}initially age(stop) <= 40 ns",
    "the past": f"{EACH}initially ((historically v < 3 for 10 ns) or once new prog)",
    "counts": f"{EACH}never once new stop 3 times within 40 ns",
    "no clock": f"{EACH}eventually kind == 2",
    "only an opening": f"{EACH}eventually (new kind and dist == @{{prog, opening}})",
    "a string": f"decl name /n String.data\ndecl other /o String.data\n{HEAD}"
    "p: each new prog limit 3: eventually (new name and name == @{other, opening}) within 20 ns",
}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_instances_in_c_do_what_the_definition_says(text: str) -> None:
    assert isinstance(outcome(text), Replayed)


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_instances_in_c_are_read_back(text: str) -> None:
    assert difference(text) is None


FAULTS = {
    "what came before": ("a value that is held", "one->monitors = all->before;", "props_init(&one->monitors);"),
    "what comes later": ("an opening", "    go_on(all, time, samples);\n    return", "    return"),
    "that it is this message": ("an opening", "one->monitors.signals.new_prog_this_one = true;", ""),
    "which messages open": ("an opening", "opens = samples->has_prog", "opens = samples->has_dist"),
    "those that are merged": ("no clock", "counted(earlier->more, counted(one->more, 1u))", "earlier->more"),
    "values that tell instances apart": ("only an opening", " && one->prog_opening == other->prog_opening", ""),
    "clocks that do": ("a topic that is not read", "one->due_0 == other->due_0 && ", ""),
    "one that moves up": ("an opening", "all->open[all->count] = *one;", ""),
    "what is owed": ("no clock", "verdict == PROPS_PRESUMABLY_VIOLATED", "verdict == PROPS_SATISFIED"),
    "deadlines": ("an opening", "right < left ? right : left", "right > left ? right : left"),
    "time that goes back": ("an opening", " || time < all->time)", ")"),
    "the session": ("ages", "!props_begin(&all->before, time)", "false"),
}


@pytest.mark.parametrize(("name", "right", "wrong"), FAULTS.values(), ids=FAULTS)
def test_a_fault_in_instances_is_noticed_by_replay_and_by_reading_back(name: str, right: str, wrong: str) -> None:
    assert isinstance(outcome(TEXTS[name], right, wrong), Deviation)
    assert difference(TEXTS[name], "c", right, wrong) is not None


CHANGES = {
    "the limit": ("h", "PROPS_LIMIT = 3", "PROPS_LIMIT = 4"),
    "what an instance knows": ("h", "    uint32_t more;\n", ""),
    "a count": ("h", "    uint32_t no_step;\n", ""),
    "a flag more": ("h", "    bool has_prog : 1;\n", "    bool has_prog : 1;\n    bool new_prog_this_one : 1;\n"),
    "places": ("c", "all->count < PROPS_LIMIT", "all->count <= PROPS_LIMIT"),
    "what is left out": ("c", "all->left_out = counted(all->left_out, 1u);", ""),
    "what is said of a message without a place": ("c", "return has_place || !opens;", "return true;"),
    "what is counted": ("c", "? UINT32_MAX : count + more", "? 0u : count + more"),
    "the first": ("c", "own->since < all->first.since", "own->since > all->first.since"),
    "the last": ("c", "own->since >= all->last.since", "own->since < all->last.since"),
    "what is satisfied": ("c", "all->satisfied = counted(all->satisfied, many);", ""),
    "when one is compared with others": ("c", " || old_state != own->state", ""),
    "only this message": ("c", "one->monitors.signals.new_prog_this_one = false;\n        has", "has"),
    "a message that is no step": ("c", "own->invalid != invalid", "false"),
    "a step of all": ("c", "samples->has_dist || samples->has_prog || ", "samples->has_dist || "),
    "a function more": ("c", "/* A count, and", "static void f(void) {}\n/* A count, and"),
}


@pytest.mark.parametrize(("in_file", "right", "wrong"), CHANGES.values(), ids=CHANGES)
def test_what_is_changed_in_instances_is_not_what_it_has_to_be(in_file: str, right: str, wrong: str) -> None:
    assert difference(ANSWERED, in_file, right, wrong) is not None


def test_instances_are_not_read_back_as_a_property_of_whole_runs_nor_the_other_way_round() -> None:
    (of_messages,), specification = from_text(TEXTS["no clock"])
    (plain,), whole = from_text(TEXTS["no clock"].replace("each new prog limit 3: ", ""))
    for files, compiled in ((emit([of_messages], specification), plain), (emit([plain], whole), of_messages)):
        (found,) = written(files.header, files.source, [compiled])
        assert isinstance(found, Difference)


@pytest.mark.parametrize("name", TEXTS)
def test_messages_find_places_as_by_rows(name: str) -> None:
    path = compiler()
    assert path is not None
    require_as_by_rows(TEXTS[name], Library(emit(*from_text(TEXTS[name])), path))


def require_as_by_rows(text: str, library: Loaded) -> None:
    """Instances in a library find of random runs, with more messages than there is place for, what rows do."""
    compiled, specification = from_text(text)
    plan = load_plan(compiled, specification)
    opener = specification.properties[0].slicing
    assert isinstance(opener, Instances)
    for seed in range(share_of(30)):
        rows, instances = ByRows(Session(plan)), library.monitors()
        (track,) = rows.tracks
        for time, topic, values in random_rows(random.Random(seed), 80, range(14)):
            if topic not in rows.session.fields:
                continue
            give(rows, (time, topic, values))
            sample: dict[Signal, Any] = {s: values[s.name] for s in library.numbers if s.name in values}
            assert isinstance(track.slices, OpenedSlices)
            ids = track.slices.ids
            assert isinstance(ids, Messages)
            before = instances.show(0)[3]
            assert instances.step(time, sample, [topic]) == (ids.left_out == before)
            verdict, violated, owing, left_out = instances.show(0)
            assert (left_out, instances.show(1)[3]) == (ids.left_out, ids.unopened)
            assert (VERDICTS[verdict], violated) == (track.verdict, ids.failed)
            owed = [one for one in ids.slices.values() if one.verdict is Verdict.PRESUMABLY_VIOLATED]
            assert owing == sum(1 + ids.more[one.id] for one in owed)


EACH_NEW = "each new prog limit 3: never kind == 1"
REFUSED = {
    "no limit": ("each new prog: never kind == 1", "write `limit N`"),
    "too many": ("each new prog limit 99999999: never kind == 1", "`limit 99999999`"),
    "ticks": (f"_rate_ = 10\n{EACH_NEW}", "`_rate_`"),
    "a run that ends": (f"_timeout_ = 10\n{EACH_NEW}", "`_timeout_`"),
    "other properties": (f"{EACH_NEW}\nnever dist > 2", "a file of its own"),
}


@pytest.mark.parametrize("target", ["c", "rust"])
@pytest.mark.parametrize(("text", "said"), REFUSED.values(), ids=REFUSED)
def test_what_instances_cannot_do_is_refused_by_name(text: str, said: str, target: str) -> None:
    with pytest.raises(UnusableInput) as refused:
        ltlc.build(HEAD + text, target)
    assert {each.code for each in refused.value.diagnostics} == {"LTL708"}
    assert any(said in f"{each.message}; {each.help}" for each in refused.value.diagnostics)
