"""The pages of the diagnostics: each code of the front end is produced by its example and mended by what follows."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from ltlc.base import codes
from ltlc.base.source import Source, Span
from ltlc.frontend.language import load_text

EXAMPLE = re.compile(r"```ltlc\n(.*?)\n?```", re.DOTALL)

WITHOUT_TEXT = {"LTL901", "LTL902", "LTL903", "LTL905", "LTL906"}
"""Codes about files that no text shows; `test_language_files` produces them."""

FRONT_END = [code for code in codes.CODES if code < "LTL320" or "LTL4" < code < "LTL5" or code > "LTL9"]
"""The codes of syntax, names, types, properties, settings and files; 32x are about formulas and encodings."""


def examples(code: str) -> list[str]:
    return EXAMPLE.findall(codes.page(code))


@pytest.mark.parametrize("code", [code for code in FRONT_END if code not in WITHOUT_TEXT])
def test_the_example_of_a_page_gives_its_code_and_no_other(code: str) -> None:
    example, _ = examples(code)
    _, diagnostics = load_text(Source("example.txt", example))
    assert {d.code for d in diagnostics} == {code}


@pytest.mark.parametrize("code", [code for code in FRONT_END if code not in WITHOUT_TEXT])
def test_the_mended_example_has_nothing_to_be_said_about(code: str) -> None:
    _, mended = examples(code)
    specification, diagnostics = load_text(Source("example.txt", mended))
    assert specification is not None
    assert diagnostics == []


@pytest.mark.parametrize("code", codes.CODES)
def test_a_page_begins_with_its_code_and_name(code: str) -> None:
    assert codes.page(code).startswith(f"# {code}: {codes.CODES[code].name}\n")


def test_there_is_no_page_without_a_code() -> None:
    pages = {path.stem for path in Path(codes.__file__).parent.glob("*.md")}
    assert pages == set(codes.CODES)


def test_names_of_codes_are_unique() -> None:
    assert len({code.name for code in codes.CODES.values()}) == len(codes.CODES)


@pytest.mark.parametrize("text", ["LTL101", "ltl101", "101", "unknown-name", "Unknown-Name"])
def test_a_code_is_found_by_number_and_by_name(text: str) -> None:
    assert codes.find(text) == "LTL101"


def test_an_unknown_code_is_not_found() -> None:
    assert codes.find("LTL999") is None


def test_a_diagnostic_without_a_registered_code_cannot_be_made() -> None:
    with pytest.raises(KeyError):
        codes.diagnostic("LTL000", Source("x", ""), Span(0, 0), "nothing")
