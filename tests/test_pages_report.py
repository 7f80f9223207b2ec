"""The page of `ltlc run --report` as text: what it says, and what it leaves out."""

from __future__ import annotations

import base64
import json
import re
import zlib
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from stepping import from_text

from ltlc.cli import main
from ltlc.interfaces.pages import report as pages
from ltlc.interfaces.pages.machines import machine_picture
from ltlc.interfaces.pages.report import PageReport
from ltlc.monitoring.judging.run import Judge
from ltlc.runtime.times import Scale

DECLARATIONS = "decl v /v Float64.data\ndecl near /near Bool.data\n"
SVG = "{http://www.w3.org/2000/svg}"


def recorded(folder: Path, *rows: str, name: str = "run.csv") -> Path:
    (folder / name).write_text("".join(f"{row}\n" for row in ["time,v,near", *rows]))
    return folder / name


def page(text: str, *recordings: Path) -> str:
    compiled, specification = from_text(DECLARATIONS + text)
    made = PageReport(compiled, specification, len(recordings))
    judge = Judge(compiled, specification, keep_trails=True)
    for recording in recordings:
        collected = made.collector()
        made.add(judge.judge(recording, [collected.take]), collected)
    return made.html()


def data(html: str) -> Any:
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', html, re.DOTALL)
    assert found is not None
    return json.loads(found[1])


def numbers(document: Any, place: dict[str, Any]) -> list[float]:
    content = zlib.decompress(base64.b64decode(document["blobs"][place["blob"]]))
    values: list[float] = np.frombuffer(content, np.dtype(f"<{place['type']}")).tolist()
    return values


class Outline(HTMLParser):
    """Which elements are opened, and whether all are closed."""

    EMPTY = frozenset({"meta", "input"})

    def __init__(self, text: str) -> None:
        super().__init__()
        self.opened: list[str] = []
        self.open: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.opened.append(tag)
        if tag not in self.EMPTY:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.opened.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_times_and_values_are_those_of_the_recording(tmp_path: Path) -> None:
    html = page("never v > 2\n", recorded(tmp_path, "1,0.1,true", "1.5,2.3,true", "9,1,true"))
    document = data(html)
    (timeline,) = document["timelines"]
    (line,) = timeline["panels"][0]["lines"]
    assert np.cumsum(numbers(document, line["gaps"])).tolist() == [0, 5e8, 8e9]
    assert numbers(document, line["values"]) == [0.1, 2.3, 1.0]
    assert (timeline["end"], timeline["clock"]) == (8_000_000_000, {"zero": 0, "since": True})
    assert [(change["time"], change["verdict"]) for change in timeline["changes"]] == [
        (0, "presumably_satisfied"),
        (500_000_000, "violated"),
    ]


def test_a_limit_that_is_infinite_is_not_drawn(tmp_path: Path) -> None:
    (timeline,) = data(page("never v > 1e999\n", recorded(tmp_path, "0,1,true")))["timelines"]
    assert timeline["panels"][0]["limits"] == []


def test_episodes_and_deadlines_are_where_they_were(tmp_path: Path) -> None:
    text = "after_until near, not near, (always (v > 1 implies eventually v < 0 within 2 s))\n"
    rows = recorded(tmp_path, "0,0,false", "1,0,true", "2,2,true", "3,-1,true", "5,0,false")
    (timeline,) = data(page(text, rows))["timelines"]
    assert [(e["from"], e["to"]) for e in timeline["episodes"]] == [(10**9, 5 * 10**9)]
    assert [(d["from"], d["due"], d["to"]) for d in timeline["deadlines"]] == [(2 * 10**9, 4 * 10**9 + 1, 3 * 10**9)]


def test_a_page_is_well_formed_and_needs_nothing_from_elsewhere(tmp_path: Path) -> None:
    html = page("slow: never v > 2\nafter near, eventually v == 0\n", recorded(tmp_path, "0,1,true", "1,3,true"))
    outline = Outline(html)
    assert outline.open == []
    assert not {"link", "iframe", "img"} & set(outline.opened)
    assert not re.search(r"(src|href)=\"(?!#)", html)
    assert "http" not in re.sub(r'xmlns="http://www.w3.org/2000/svg"|http-equiv', "", html)


def test_nothing_on_a_page_has_the_name_of_something_else(tmp_path: Path) -> None:
    html = page("slow: never v > 2\nafter near, eventually v == 0\n", recorded(tmp_path, "0,1,true", "1,3,true"))
    names = re.findall(r'\bid="([^"]+)"', html)
    assert len(set(names)) == len(names)
    assert set(re.findall(r"url\(#([^)]+)\)", html)) <= set(names)


def test_the_failing_state_is_figure_one(tmp_path: Path) -> None:
    html = page("slow: never v > 2\n", recorded(tmp_path, "0,3,true"))
    assert "Figure 1.</strong> The failing state of slow." in html
    assert "Failing state:\n  v: 3.0" in html


def test_of_several_recordings_there_is_a_table_and_a_section_each(tmp_path: Path) -> None:
    good = recorded(tmp_path, "0,1,true", name="good.csv")
    bad = recorded(tmp_path, "0,3,true", name="bad.csv")
    html = page("slow: never v > 2\n", good, bad, tmp_path / "none.csv")
    assert html.count('<section class="recording"') == 3
    assert [len(data(html)["timelines"])] == [2]
    assert "there is no file" in html
    assert re.findall(r'<span class="badge \w+">(\d \w+(?: \w+)?)</span>', html) == [
        "1 violated",
        "1 presumably satisfied",
    ]


def test_what_is_left_out_is_said_and_what_is_violated_goes_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pages, "MOST_CARDS", 1)
    good = recorded(tmp_path, "0,1,true", name="good.csv")
    bad = recorded(tmp_path, "0,3,true", name="bad.csv")
    html = page("slow: never v > 2\nnever v > 9\n", good, bad)
    assert html.count('<article class="card"') == 2
    assert html.count("1 of its 2 properties are not drawn, to keep the page small.") == 2
    targets = set(re.findall(r'id="([^"]+)"', html))
    assert set(re.findall(r'href="#([^"]+)"', html)) <= targets
    assert "Figure 1." in html


def test_a_recording_without_a_row_has_a_page_that_says_so(tmp_path: Path) -> None:
    assert "No part of it could be judged." in page("never v > 2\n", recorded(tmp_path))


def test_a_damaged_recording_is_shown_up_to_the_damage(tmp_path: Path) -> None:
    html = page("never v > 2\n", recorded(tmp_path, "0,1,true", "1,x,true"))
    assert "it is damaged, and was judged up to there" in html
    assert "error[LTL803]" in html


def test_a_long_recording_is_drawn_by_its_extremes_which_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pages, "MOST_SAMPLES", 100)
    monkeypatch.setattr(pages, "LEAST_SAMPLES", 100)
    rows = [f"{n},{n * 7919 % 1000},true" for n in range(999)]
    document = data(html := page("never v > 998\n", recorded(tmp_path, *rows)))
    assert "999 samples" in html
    values = numbers(document, document["timelines"][0]["panels"][0]["lines"][0]["values"])
    assert (len(values) <= 200, max(values), min(values)) == (True, 999.0, 0.0)


def test_the_way_that_was_taken_is_marked_in_the_picture(tmp_path: Path) -> None:
    compiled, specification = from_text(DECLARATIONS + "always (near implies eventually v > 1 within 2 s)\n")
    recording = recorded(tmp_path, "0,0,false", "1,0,true", "9,0,false")
    report = Judge(compiled, specification, keep_trails=True).judge(recording)
    picture = machine_picture(compiled[0], report.trails[0], Scale(), "p")
    root = ElementTree.fromstring(picture.svg)
    groups = [group.get("class") or "" for group in root.findall(f"{SVG}g")]
    assert len([each for each in groups if each.startswith("edge") and each.endswith("taken")]) == 3
    assert [each for each in groups if "by-time" in each] == ["edge by-time taken"]
    assert [text for _, text in picture.letters][:2] == ["near", "v > 1"]
    assert report.trails[0].state == len(compiled[0].machine.states) - 1


def test_of_an_edge_of_steps_and_one_of_time_only_the_one_that_was_taken_is_marked(tmp_path: Path) -> None:
    compiled, specification = from_text(DECLARATIONS + "always age(v) < 500 ms\n")
    recording = recorded(tmp_path, "0,0,false", "1,0,true")
    report = Judge(compiled, specification, keep_trails=True).judge(recording)
    picture = machine_picture(compiled[0], report.trails[0], Scale(), "p")
    ways = [
        group for group in ElementTree.fromstring(picture.svg).findall(f"{SVG}g") if "edge" in group.get("class", "")
    ]
    told = {group.get("class"): group.findtext(f"{SVG}title") for group in ways}
    assert "0 → 1" in str(told["edge by-time taken"])
    assert [group.get("class") for group in ways if "0 → 1" in str(group.findtext(f"{SVG}title"))] == [
        "edge",
        "edge by-time taken",
    ]


def labels_of(svg: str) -> list[tuple[float, float, float, float]]:
    """Left, top, right and bottom of the labels of edges, a character taken for 5 pixels."""
    found = []
    for group in ElementTree.fromstring(svg).findall(f"{SVG}g"):
        lines = [] if "edge" not in group.get("class", "") else [*group.iter(f"{SVG}tspan")]
        if lines:
            x, tops = float(lines[0].get("x", "")), [float(line.get("y", "")) for line in lines]
            half = 2.5 * max(len(line.text or "") for line in lines)
            found.append((x - half, min(tops) - 9, x + half, max(tops) + 2))
    return found


@pytest.mark.parametrize(
    "text",
    [
        "after_until near, b, eventually c",
        "after_until near, b, always (v > 1 implies eventually c within 2 s)",
        "after near, until b, eventually c within 3 s",
        "(always (near implies eventually b)) and (always (b implies eventually c))",
        "after_until near, b, always c for 2 s",
        "eventually near and eventually b and eventually c",
    ],
)
def test_the_labels_of_a_monitor_overlap_neither_one_another_nor_a_state(text: str) -> None:
    (compiled,), _ = from_text(f"{DECLARATIONS}decl b /b Bool.data\ndecl c /c Bool.data\n{text}\n")
    svg = machine_picture(compiled, None, Scale(), "p").svg
    labels = labels_of(svg)
    circles = ElementTree.fromstring(svg).iter(f"{SVG}circle")
    middles = ((float(each.get("cx", "")), float(each.get("cy", ""))) for each in circles)
    states = [(x - 20, y - 20, x + 20, y + 20) for x, y in middles]
    assert len(labels) > len(states) > 2
    for number, (left, top, right, bottom) in enumerate(labels):
        for other in (*labels[number + 1 :], *states):
            assert right <= other[0] or other[2] <= left or bottom <= other[1] or other[3] <= top, svg


def test_a_recording_with_the_time_of_day_is_shown_from_its_beginning_on(tmp_path: Path) -> None:
    html = page("slow: never v > 2\n", recorded(tmp_path, "1700000000.5,1,true", "1700000002,3,true"))
    assert data(html)["timelines"][0]["clock"] == {"zero": 0, "since": True}
    assert "2. at +1.5 s" in html
    assert "From +0 s to +1.5 s (1.5 s); +0 s is 1700000000.5 s" in html


def test_a_page_draws_and_lists_all_violations(tmp_path: Path) -> None:
    rows = ("10,3,true", "11,1,true", "12.5,3,true", "13,1,true")
    html = page("slow: never v > 2\n", recorded(tmp_path, *rows))
    drawn = data(html)["timelines"][0]["violations"]
    assert drawn == [
        {"from": 0, "to": 1_000_000_000, "text": "1 s"},
        {"from": 2_500_000_000, "to": 3_000_000_000, "text": "0.5 s"},
    ]
    assert "All violations (2)" in html
    assert "<li>+2.5 s (step 2) for 0.5 s</li>" in html


def test_a_page_lists_all_violations_of_a_property_that_reads_the_past(tmp_path: Path) -> None:
    rows = ("0,1,false", "1,2,true", "2,1,false", "3,1,true", "4,1,false")
    html = page("never near and previously near", recorded(tmp_path, *rows))
    assert "All violations (2)" in html
    assert "is known" not in html


def test_what_a_finding_quotes_is_shown_as_code(tmp_path: Path) -> None:
    html = page("decl w /w Float64.data\nlow: never w > 1", recorded(tmp_path, "0,1,true"))
    assert "<code>low</code> cannot start" in html
    assert "`" not in re.sub(r"<(script|style)\b.*?</\1>", "", html, flags=re.DOTALL)


def test_of_a_large_monitor_only_the_way_is_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ltlc.interfaces.pages.machines.MOST_STATES", 1)
    html = page("after near, eventually v > 1\n", recorded(tmp_path, "0,0,false", "1,0,false"))
    assert "Only the path taken is shown: the monitor has" in html


def test_the_command_writes_the_page_with_english_and_examples(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "props.txt").write_text(f"{DECLARATIONS}slow: never v > 2\n")
    recording = recorded(tmp_path, "0,3,true")
    arguments = ["run", str(tmp_path / "props.txt"), str(recording), "--report", str(tmp_path / "out.html")]
    assert main([*arguments, "--format", "json"]) == 1
    json.loads(capsys.readouterr().out)
    html = (tmp_path / "out.html").read_text(encoding="utf-8")
    assert "v is never more than 2." in html
    assert "violated at the earliest" in html


def test_a_page_that_cannot_be_written_is_told_before_anything_is_judged(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "props.txt").write_text(f"{DECLARATIONS}slow: never v > 2\n")
    place = tmp_path / "missing" / "out.html"
    assert main(["run", str(tmp_path / "props.txt"), str(tmp_path / "no.csv"), "--report", str(place)]) == 2
    assert "out.html cannot be written" in capsys.readouterr().err
