"""The page of a campaign: what it says, and that it loads nothing and takes names for text."""

from __future__ import annotations

import os
import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote_to_bytes

import pytest
from test_campaigns import BROKEN, FAST, GOOD, SPECIFICATION, ran

MORE = """mode_: never speed > 99
idle: after_until distance < 0, distance > 1, never speed > 0
"""


class Reader(HTMLParser):
    """The tags of a page with their attributes, and its text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str]] = []
        self.text: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += [(name, value or "") for name, value in attrs]

    def handle_data(self, data: str) -> None:
        self.text += data.split("\n")


@pytest.fixture
def drives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "props.txt").write_text(SPECIFICATION + MORE)
    folder = tmp_path / "drives"
    folder.mkdir()
    for number in range(6):
        (folder / f"fast{number}.csv").write_text(FAST)
    (folder / "good.csv").write_text(GOOD)
    (folder / "broken.csv").write_text(BROKEN)
    return folder


def page(capsys: pytest.CaptureFixture[str]) -> Reader:
    ran(capsys, "drives", "--summary", "s.html")
    return Reader(Path("s.html").read_text(encoding="utf-8"))


@pytest.mark.usefixtures("drives")
def test_it_says_where_each_property_fails_with_the_first_violations_side_by_side(
    capsys: pytest.CaptureFixture[str],
) -> None:
    text = [line.strip() for line in page(capsys).text if line.strip()]
    start = text.index("Violated in 6 recordings. The first:")
    assert text[start - 3 : start] == ["limit", "never speed > 2", "speed is never more than 2."]
    assert text[start + 1 : start + 20] == [
        *(f"drives/fast{number}.csv" for number in range(4)),
        "recording",
        *["1 s"] * 4,
        "violated at",
        *["+1 s (step 1)"] * 4,
        "speed",
        *["2.5"] * 4,
    ]
    assert text.count("drives/fast5.csv") == 1
    assert "8 recordings: 6 with a violation, 1 in which all properties hold, 1 not judged to the end" in text


@pytest.mark.usefixtures("drives")
def test_it_says_what_was_never_triggered_in_any_recording(capsys: pytest.CaptureFixture[str]) -> None:
    text = [line.strip() for line in page(capsys).text if line.strip()]
    after = text[text.index("Never triggered in any recording") :]
    assert "idle:" in after
    assert "stop:" not in after
    assert any("line 3: " in line for line in after[after.index("Not judged to the end") :])


def test_what_a_message_quotes_is_shown_as_code(drives: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (drives / "worded.csv").write_text("time,speed,distance\n0,fast,5\n")
    ran(capsys, "drives", "--summary", "s.html")
    written = re.sub(r"<style>.*?</style>", "", Path("s.html").read_text(encoding="utf-8"), flags=re.DOTALL)
    assert "column <code>speed</code>: <code>fast</code> is not a number" in written
    assert "`" not in written


DRIVE = "time,speed,distance\n10,1,5\n11,{},5\n13,1,5\n15,{},5\n16,1,5\n20,1,5\n"


@pytest.mark.usefixtures("drives")
def test_a_timeline_marks_where_in_the_recording_the_property_is_violated(capsys: pytest.CaptureFixture[str]) -> None:
    Path("props.txt").write_text(f"{SPECIFICATION}once_: never (speed > 3 and once speed > 2)\n")
    Path("a.csv").write_text(DRIVE.format(2.5, 3.5))
    Path("b.csv").write_text("time,speed,distance\n1,2.5,5\n")
    Path("c.csv").write_text(DRIVE.format(1, 3))
    ran(capsys, "a.csv", "b.csv", "c.csv", "--summary", "s.html")
    written = Path("s.html").read_text(encoding="utf-8")
    parts = [
        [tuple(map(float, part)) for part in re.findall(r'class="bad" x="([\d.]+)" width="([\d.]+)"', cell)]
        for cell in re.findall(r"<svg.*?</svg>", written, re.DOTALL)
    ]
    assert parts == [[(20, 40), (100, 20)], [(100, 20)], [(100, 20)]]
    assert written.count('<span class="soft">10 s</span>') == 3


def test_a_link_leads_from_the_page_to_each_recording_that_fails_or_was_not_judged(
    drives: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("javascript:a b#?%41.csv", "\udcff ä.csv"):
        (drives / name).write_text(FAST)
    Path("out").mkdir()
    ran(capsys, "drives", "--summary", "out/s.html")
    read = Reader(Path("out/s.html").read_text(encoding="utf-8"))
    links = {value for name, value in read.attributes if name == "href"}
    assert {"../drives/fast0.csv", "../drives/javascript%3Aa%20b%23%3F%2541.csv"} <= links
    linked = {(Path("out") / os.fsdecode(unquote_to_bytes(link))).resolve() for link in links}
    assert linked == set(drives.resolve().iterdir()) - {drives.resolve() / "good.csv"}


def test_recordings_of_one_instant_have_a_page_without_timelines(
    drives: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for each in drives.iterdir():
        each.unlink()
    (drives / "fast.csv").write_text("time,speed\n0,3\n")
    assert "Violated in 1 recording" in " ".join(page(capsys).text)


def test_names_stay_text_and_nothing_is_loaded(drives: Path, capsys: pytest.CaptureFixture[str]) -> None:
    name = "<script src=x onerror=alert(1)>\"'&{{7*7}}\x1b\udcff.csv"
    (drives / name).write_text(FAST)
    (drives / "<b>broken.csv").write_text("time,<i>x\n0,1\nx\n")
    read = page(capsys)
    assert {"script", "img", "link", "iframe", "b", "i"}.isdisjoint(read.tags)
    assert not [each for each in read.attributes if each[0].startswith("on") or each[0] == "src"]
    assert all(re.fullmatch(r"[\w./%-]+", value) for name, value in read.attributes if name == "href")
    assert any("<script src=x onerror=alert(1)>\"'&{{7*7}}\\x1b\\udcff.csv" in line for line in read.text)
    assert not re.search(r"url\(|https?:|@import", Path("s.html").read_text(encoding="utf-8"))


def test_a_campaign_of_nothing_has_a_page_that_says_so(drives: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for path in drives.iterdir():
        path.unlink()
    assert any("0 recordings: nothing was judged" in line for line in page(capsys).text)
