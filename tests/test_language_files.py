"""Files that are no specifications, and the ways text is stored."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from ltlc.base.diagnostics import Diagnostic
from ltlc.frontend.language import load

PROPERTY = "never robot.velocity > 2\n"


def only(path: str | Path, message_paths: tuple[str, ...] = ()) -> Diagnostic:
    specification, diagnostics = load(path, message_paths)
    assert specification is None
    (diagnostic,) = diagnostics
    return diagnostic


def stored(folder: Path, content: bytes) -> Path:
    path = folder / "props.txt"
    path.write_bytes(content)
    return path


def test_a_file_that_is_not_there_is_reported(tmp_path: Path) -> None:
    assert only(tmp_path / "none.txt").code == "LTL901"


def test_a_folder_is_not_a_specification(tmp_path: Path) -> None:
    assert only(tmp_path).code == "LTL902"


def test_a_name_that_no_file_can_have_is_reported() -> None:
    assert only("\0").code == "LTL902"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_a_file_without_permission_is_reported(tmp_path: Path) -> None:
    path = stored(tmp_path, PROPERTY.encode())
    path.chmod(0)
    assert only(path).code == "LTL902"


@pytest.mark.parametrize("content", [b"", b"  \n\t\n", b"\xef\xbb\xbf"])
def test_an_empty_file_is_reported(tmp_path: Path, content: bytes) -> None:
    assert only(stored(tmp_path, content)).code == "LTL904"


def test_the_first_byte_that_is_not_utf_8_is_pointed_at(tmp_path: Path) -> None:
    found = only(stored(tmp_path, b"# fine\n# gr\xc3\xb6\xdfe\nnever x > 1\n"))
    assert found.code == "LTL903"
    assert found.primary is not None
    place = found.source.position(found.primary.span.start)
    assert (place.line, place.column) == (2, 6)
    assert "0xdf" in found.message


def test_utf_16_is_not_utf_8(tmp_path: Path) -> None:
    assert only(stored(tmp_path, PROPERTY.encode("utf-16"))).code == "LTL903"


@pytest.mark.parametrize("content", [b"\xef\xbb\xbf" + PROPERTY.encode(), PROPERTY.replace("\n", "\r\n").encode()])
def test_a_byte_order_mark_and_dos_line_breaks_are_accepted(tmp_path: Path, content: bytes) -> None:
    specification, diagnostics = load(stored(tmp_path, content))
    assert specification is not None
    assert diagnostics == []
    assert specification.properties[0].text == "never robot.velocity > 2"
    assert specification.properties[0].line == 1


def test_a_nul_byte_is_pointed_at(tmp_path: Path) -> None:
    found = only(stored(tmp_path, b"never robot.velocity > \x00"))
    assert found.code == "LTL011"
    assert "U+0000" in found.message


def test_ten_megabytes_are_not_read(tmp_path: Path) -> None:
    assert only(stored(tmp_path, b"x" * 10_000_000)).code == "LTL905"


def test_garbage_gives_a_bounded_number_of_diagnostics(tmp_path: Path) -> None:
    specification, diagnostics = load(stored(tmp_path, b") ( , = $ \n" * 5_000))
    assert specification is None
    assert 0 < len(diagnostics) <= 50


def test_many_unknown_names_give_a_bounded_number_of_diagnostics(tmp_path: Path) -> None:
    specification, diagnostics = load(stored(tmp_path, b"".join(b"never x%d > 1\n" % i for i in range(1_000))))
    assert specification is None
    assert 0 < len(diagnostics) <= 200


@pytest.mark.parametrize(
    "text",
    [
        "never " + "(" * 10_000 + "robot.velocity > 2" + ")" * 10_000,
        "never " + "not " * 10_000 + "(robot.velocity > 2)",
        "always " * 10_000 + "robot.velocity > 2",
        "never robot.velocity > " + "-" * 10_000 + "2",
        "never " + " and ".join(["robot.velocity > 2"] * 1_000),
        "never robot" + ".x" * 10_000 + " > 1",
        "never min(" + ", ".join(["robot.velocity"] * 5_000) + ") > 1",
        "never " + "(" * 10_000,
        "never x[" + "9" * 10_000 + "] > 1",
        "decl x /x LaserScan.ranges[" + "9" * 10_000 + "] never x > 1",
        "decl x /x LaserScan.ranges never x[" + "9" * 10_000 + "] > 1",
        "never @{robot.velocity, -" + "9" * 10_000 + "} > 1",
        "never @{robot.velocity, " + "9" * 10_000 + "} > 1",
        "never robot.velocity > " + "9" * 10_000,
        "s0 = robot.velocity > 1\n" + "".join(f"s{i + 1} = s{i} and s{i}\n" for i in range(100)) + "never s100",
        "s0 = robot.velocity > 1\n" + "".join(f"s{i + 1} = not s{i}\n" for i in range(1_000)) + "never s1000",
    ],
)
def test_deep_and_large_properties_are_compiled_or_refused_in_words(tmp_path: Path, text: str) -> None:
    specification, diagnostics = load(stored(tmp_path, text.encode()))
    assert specification is not None or diagnostics
    assert {d.code for d in diagnostics} <= {
        "LTL005",
        "LTL006",
        "LTL015",
        "LTL101",
        "LTL104",
        "LTL105",
        "LTL211",
        "LTL212",
        "LTL307",
    }
