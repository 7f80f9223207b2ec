"""`each` and `each new` in Rust: what is printed of the tables in C does what the definition says, and is read back."""

from __future__ import annotations

import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
import test_each_c as ids
import test_each_message_c as instances
from each_by_definition import ONE_TOPIC
from replaying import MESSAGES, judged
from stepping import from_text
from test_backends_rust import library as library_of
from test_backends_rust import needs_rustc

from ltlc.assurance.c_programs import rust_programs
from ltlc.assurance.reading.outcomes import Difference
from ltlc.assurance.reading.rust import written
from ltlc.assurance.replay import Deviation, Replayed
from ltlc.assurance.rust_library import compiler
from ltlc.backends.rust import emit, file_of
from ltlc.cli import main

TEXTS = {f"each id: {name}": text for name, text in ids.TEXTS.items()}
TEXTS |= {f"each message: {name}": text for name, text in instances.TEXTS.items()}
ARRAYS = "decl scan /n LaserScan.ranges\ndecl other /o LaserScan.ranges\n"
TEXTS["each message: an array"] = (
    f"{ARRAYS}{instances.EACH}eventually (new scan and any(scan > 2) and all(@{{other, opening}} > 1)) within 20 ns"
)


def outcome(text: str, right: str = "", wrong: str = "") -> Replayed | Deviation:
    """What the replay says of the property; of the text of the file, `right` is replaced."""
    compiled, specification = from_text(text)
    file = file_of(compiled, specification)
    assert right in file.text
    file = replace(file, text=file.text.replace(right, wrong))
    (program,) = rust_programs(file, compiled, specification, MESSAGES) or ()
    return judged(compiled[0], program)


def difference(text: str, right: str = "", wrong: str = "") -> str | None:
    """What reading back finds; in the file, `right` is replaced."""
    compiled, specification = from_text(text)
    file = file_of(compiled, specification)
    assert right in file.text
    (found,) = written(file.text.replace(right, wrong), file.c.header, file.c.source, compiled)
    read = found if isinstance(found, Difference) else found.read_back()
    return read.reason if isinstance(read, Difference) else None


@needs_rustc
@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_tables_in_rust_do_what_the_definition_says(text: str) -> None:
    assert isinstance(outcome(text), Replayed)


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_tables_in_rust_are_read_back(text: str) -> None:
    assert difference(text) is None


RESPONSE, ANSWERED = TEXTS["each id: response"], TEXTS["each message: an opening"]
FAULTS = {
    "what others said before": ("each id: a topic of all", "monitors = self.unborn;", "monitors = Monitors::new();"),
    "a slice in the place of one that is dropped": (
        "each id: a topic of all, in time",
        "if !self.slices[place as usize].is_taken || !self.settle(place) {\n                place += 1;\n            }",
        "self.settle(place);\n            place += 1;",
    ),
    "an id that stands elsewhere": ("each id: response", "&& self.slices[place as usize].id != id", ""),
    "what is owed": ("each id: response", "is_owed = is_owed", "is_owed = false"),
    "deadlines": ("each id: response", "right < left", "right > left"),
    "time that goes back": ("each id: response", "time <= -NEVER || time >= NEVER || time < self.time", "false"),
    "which messages open": (
        "each message: an opening",
        "let opens = samples.prog.is_some()",
        "let opens = samples.dist.is_some()",
    ),
    "those that are merged": ("each message: no clock", "counted(self.open[place as usize].more, 1))", "0)"),
    "values that tell instances apart": (
        "each message: only an opening",
        "&& self.prog_opening == other.prog_opening",
        "",
    ),
    "the session": ("each message: ages", "!self.before.begin(time)", "false"),
}


@needs_rustc
@pytest.mark.parametrize(("name", "right", "wrong"), FAULTS.values(), ids=FAULTS)
def test_a_fault_in_a_table_is_noticed_by_replay_and_by_reading_back(name: str, right: str, wrong: str) -> None:
    assert isinstance(outcome(TEXTS[name], right, wrong), Deviation)
    assert difference(TEXTS[name], right, wrong) is not None


CHANGES = {
    "the limit": (RESPONSE, "pub const LIMIT: u32 = 3;", "pub const LIMIT: u32 = 4;"),
    "places": (RESPONSE, "pub const PLACES: u32 = 6;", "pub const PLACES: u32 = 3;"),
    "the type of ids": (RESPONSE, "pub id: u8,", "pub id: i8,"),
    "what a place knows": (RESPONSE, "    pub lacks_beginning: bool,\n", ""),
    "where ids stand": (RESPONSE, "mixed >> 32) as u32", "mixed >> 31) as u32"),
    "a product that is not whole": (RESPONSE, "mixed.wrapping_mul(", "mixed.wrapping_add("),
    "what is asked of an id": (
        RESPONSE,
        "fn slice_of(&self, id: u8) -> Option<&Slice>",
        "fn slice_of(&self, id: u8) -> Option<&Ids>",
    ),
    "what counts": (ANSWERED, "{ u32::MAX } else", "{ 0 } else"),
    "what there may be": (ANSWERED, "if let Some(samples) = samples {", "if let None = samples {"),
    "what is passed on": (ANSWERED, "self.go_on(time, Some(samples));", "self.go_on(time, None);"),
    "a message that is no step": (ANSWERED, ".invalid != invalid", ".invalid > u32::MAX - 1"),
    "what may come": (ANSWERED, "samples: Option<&Samples>", "samples: &Samples"),
    "what can be seen": (ANSWERED, "pub struct Instances", "struct Instances"),
    "a function more": (ANSWERED, "/// A count, and", "fn f() {}\n/// A count, and"),
}


@pytest.mark.parametrize(("text", "right", "wrong"), CHANGES.values(), ids=CHANGES)
def test_what_is_changed_in_a_table_is_not_what_it_has_to_be(text: str, right: str, wrong: str) -> None:
    assert difference(text, right, wrong) is not None


@needs_rustc
@pytest.mark.parametrize("number", [0, 1, 9, 14])
def test_ids_that_find_no_place_are_left_out_as_by_rows(number: int) -> None:
    text = ids.FULL + ONE_TOPIC[number]
    ids.require_as_by_rows(text, library_of(*from_text(text)))


@needs_rustc
@pytest.mark.parametrize("name", ["an opening", "no clock", "a string"])
def test_messages_find_places_as_by_rows(name: str) -> None:
    text = instances.TEXTS[name]
    instances.require_as_by_rows(text, library_of(*from_text(text)))


@needs_rustc
@pytest.mark.parametrize("text", [TEXTS["each id: a topic of all, in time"], TEXTS["each message: a string"]])
def test_a_table_needs_no_standard_library_and_gives_no_warning(text: str, tmp_path: Path) -> None:
    (tmp_path / "watch.rs").write_text(emit(*from_text(text)))
    (tmp_path / "lib.rs").write_text("#![no_std]\n#![deny(warnings)]\npub mod watch;\n")
    command = [str(compiler()), "--edition=2018", "--crate-type=lib", "--emit=metadata", "lib.rs"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("text", [RESPONSE, ANSWERED])
def test_certify_compares_and_reads_a_table(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("p.txt").write_text(text)
    assert main(["build", "p.txt", "--target", "rust", "-o", "p.rs", "--certificate", "p.cert", "-q"]) == 0
    command = ["certify", "p.txt", "p.cert", "--code", "p.rs", "-q"]
    assert main(command) == 0
    code = Path("p.rs").read_text()
    Path("p.rs").write_text(code.replace("self.left_out = counted(self.left_out, 1);", ""))
    assert main(command) == 1
