"""The document of evidence: what is read is what was written, and no byte can be changed unnoticed."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ltlc.assurance.evidence.document import (
    END,
    Claim,
    Document,
    Head,
    Line,
    NotCovered,
    StatedAtom,
    Summed,
    digest,
    letters_text,
    printed,
    summed,
)
from ltlc.assurance.evidence.parsing import UnreadableEvidence, parsed, parsed_all
from ltlc.base.provenance import FileDigest
from ltlc.semantics.verdicts import Verdict

NAMES = st.text(st.characters(exclude_categories=["C", "Z"]), min_size=1, max_size=8)
TIMES = st.integers(0, 10**19 - 1)
HEX = st.integers(0, 16**64 - 1).map("{:064x}".format)
FIELDS = st.fixed_dictionaries({"topic": NAMES, "type": NAMES, "path": st.lists(NAMES | st.integers(0, 9), max_size=3)})
SIDES = st.floats(allow_nan=False, allow_infinity=False) | st.integers() | st.booleans() | NAMES | FIELDS
ATOMS = st.builds(StatedAtom, NAMES, st.fixed_dictionaries({"call": st.just("<"), "of": st.lists(SIDES, max_size=3)}))


@st.composite
def claims(draw: st.DrawFn) -> Claim:
    atoms = tuple(draw(st.lists(ATOMS, max_size=3)))
    numbers = st.sets(st.integers(0, len(atoms) - 1), max_size=3) if atoms else st.just(set[int]())
    gaps = draw(st.lists(st.integers(0, 10**9), max_size=4))
    times = [sum(gaps[: n + 1]) for n in range(len(gaps))]
    lines = tuple(Line(time, tuple(sorted(draw(numbers)))) for time in times)
    letters = draw(st.just(lines) | st.builds(Summed, st.integers(0, 10**9), HEX))
    requirement = draw(st.none() | NAMES)
    return Claim(
        draw(NAMES), draw(NAMES), atoms, draw(TIMES), letters, draw(TIMES), draw(st.sampled_from(Verdict)), draw(TIMES),
        requirement, tuple(draw(st.lists(NAMES, max_size=2))),
    )  # fmt: skip


HEADS = st.builds(
    Head, NAMES, st.tuples(NAMES, HEX), HEX,
    st.lists(st.builds(FileDigest, NAMES, TIMES, HEX), min_size=1, max_size=3).map(tuple),
    st.lists(st.tuples(NAMES, HEX), max_size=2).map(tuple),
    st.none() | st.floats(1e-3, 1e6).map(repr), st.none() | TIMES, st.booleans(), st.none() | TIMES, st.none() | TIMES,
)  # fmt: skip
DOCUMENTS = st.builds(
    Document, HEADS, st.lists(claims() | st.builds(NotCovered, NAMES.filter(lambda n: ":" not in n), NAMES)).map(tuple)
)

EXAMPLE = printed(
    Document(
        Head(
            "1.0.0 (1f3a5c7e9b2d)",
            ("props.txt", "a" * 64),
            "b" * 64,
            (FileDigest("run.mcap", 300, "c" * 64),),
            rate="5.0",
        ),
        (
            Claim(
                "slow",
                "never v > 2",
                (StatedAtom("v > 2", {"call": ">", "of": [1.0, 2.0]}),),
                5,
                (Line(5, ()), Line(9, (0,))),
                9,
                Verdict.VIOLATED,
                9,
            ),
            NotCovered("often", "it counts"),
        ),
    )
)


@given(DOCUMENTS)
def test_what_is_written_is_read_again(document: Document) -> None:
    assert parsed(printed(document)) == document


@given(st.lists(DOCUMENTS, min_size=1, max_size=3))
def test_documents_can_be_appended_to_one_another(documents: list[Document]) -> None:
    assert parsed_all("".join(map(printed, documents))) == tuple(documents)


@given(st.integers(0, len(EXAMPLE) - 1), st.sampled_from("0123456789abcdef {}\n+") | st.just(""))
def test_a_byte_that_is_changed_or_missing_is_noticed(place: int, by: str) -> None:
    changed = EXAMPLE[:place] + by + EXAMPLE[place + 1 :]
    assert changed == EXAMPLE or isinstance(parsed(changed), UnreadableEvidence)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("+4 a0", "+04 a0"),
        ("+4 a0", "+4 a1"),
        ("+4 a0", "+4 a0 a0"),
        ("at 5", "+5"),
        ("+4 a0", "at 9 a0"),
        ('"of":[1.0', '"of": [1.0'),
        ('"of":[1.0', '"of":[NaN'),
        ('"of":[1.0', '"of":[1e400'),
        ('"of":[1.0,2.0]', '"of":[1.0,2.0],"of":[1.0,2.0]'),
        ("verdict violated 9", "verdict violated 9 "),
        ("verdict violated 9", "verdict broken 9"),
        ("until 9\n", ""),
        ("recording run.mcap 300 sha256 " + "c" * 64 + "\n", ""),
        ("ltlc-evidence 2", "ltlc-evidence 1"),
        ("it counts", "it counts\nmore"),
    ],
)
def test_a_document_that_is_not_as_it_would_be_written_is_refused_even_if_its_digest_is_right(
    old: str, new: str
) -> None:
    text = EXAMPLE[: EXAMPLE.index(END)].replace(old, new)
    assert text != EXAMPLE[: EXAMPLE.index(END)]
    assert isinstance(parsed(f"{text}{END}{digest(text)}\n"), UnreadableEvidence)


def test_the_line_that_is_wrong_is_named() -> None:
    found = parsed(EXAMPLE.replace("verdict violated 9", "verdict violated soon"))
    assert isinstance(found, UnreadableEvidence)
    assert EXAMPLE.split("\n")[found.line - 1] == "verdict violated 9"
    assert "verdict violated soon" in found.message


@pytest.mark.parametrize("cut", range(1, 80, 7))
def test_a_document_that_is_cut_off_is_refused(cut: int) -> None:
    assert isinstance(parsed(EXAMPLE[:-cut]), UnreadableEvidence)


def test_a_name_that_does_not_fit_on_a_line_cannot_be_written() -> None:
    head = Head("1", ("a\nb", "a" * 64), "b" * 64, (FileDigest("run.mcap", 300, "c" * 64),))
    with pytest.raises(ValueError, match="does not fit"):
        printed(Document(head, ()))


def test_a_sum_is_that_of_the_lines_as_they_are_written() -> None:
    lines = (Line(5, ()), Line(9, (0, 2)), Line(9, (1,)))
    assert "".join(letters_text(lines)) == "at 5\n+4 a0 a2\n+0 a1\n"
    assert summed(lines) == Summed(3, digest("at 5\n+4 a0 a2\n+0 a1\n"))
