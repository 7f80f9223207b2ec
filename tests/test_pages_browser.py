"""The page of `ltlc run --report` in a real browser."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import chromium
import pytest

from ltlc.cli import main

pytestmark = [pytest.mark.live, pytest.mark.skipif(bool(chromium.MISSING), reason=chromium.MISSING)]

HOSTILE = "<script>document.title = 'taken'</script><img src=x onerror=\"document.title = 'taken'\">"

PROPS = """decl v /v Float64.data
decl near /near Bool.data
decl mode /mode String.data
slow: never v > 2
stop: after_until near, not near, eventually v =={0.1} 0
answer: always (near implies eventually mode == "HOSTILE" within 3 s)
""".replace("HOSTILE", HOSTILE.replace('"', '\\"'))


def rows() -> Iterator[str]:
    quoted = '"' + HOSTILE.replace('"', '""') + '"'
    yield "time,v,near,mode"
    for step in range(400):
        mode = quoted if step % 100 > 60 else "driving"
        yield f"{step / 10},{2.05 * abs(math.sin(step / 60)):.4f},{'true' if 100 < step < 150 else 'false'},{mode}"


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("page")
    (folder / "props.txt").write_text(PROPS)
    recording = folder / "<b>drive & 'co'.csv"
    recording.write_text("".join(f"{row}\n" for row in rows()))
    assert main(["run", str(folder / "props.txt"), str(recording), "--report", str(folder / "out.html")]) == 1
    return folder / "out.html"


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[chromium.Browser]:
    with chromium.browser(tmp_path_factory.mktemp("chromium")) as opened:
        yield opened


def view(browser: chromium.Browser) -> tuple[float, float]:
    found = browser.run("const { from, to } = timelines[0].view; return [from, to]")
    return found[0], found[1]


def span(browser: chromium.Browser) -> float:
    start, end = view(browser)
    return end - start


def centre(browser: chromium.Browser) -> dict[str, int]:
    script = """
    const canvas = timelines[0].canvas;
    canvas.scrollIntoView({ block: 'center' });
    const { left, top, width, height } = canvas.getBoundingClientRect();
    return { x: Math.round(left + width / 2), y: Math.round(top + height / 2) };
    """
    found: dict[str, int] = browser.run(script)
    # that the page has scrolled is told before the next frame is drawn
    browser.run("return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))")
    browser.wait_until("return performance.now() - scrolled > 500 || scrolled === 0")
    return found


def pointer(*steps: dict[str, Any]) -> dict[str, Any]:
    return {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": list(steps)}


def to(place: dict[str, int], right: int = 0) -> dict[str, Any]:
    return {"type": "pointerMove", "x": place["x"] + right, "y": place["y"], "duration": 0}


@pytest.mark.parametrize("width", [400, 1280])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_opens_at_any_width_in_light_and_dark_without_a_complaint(
    browser: chromium.Browser, page: Path, width: int, scheme: str
) -> None:
    browser.open(page, width, scheme)
    assert browser.complaints() == []
    assert browser.run("return document.documentElement.scrollWidth") <= width
    background = browser.run("return getComputedStyle(document.body).backgroundColor")
    assert (background == "rgb(15, 19, 24)") == (scheme == "dark")
    assert (
        browser.run("return document.getElementById('theme').textContent") == {"light": "Dark", "dark": "Light"}[scheme]
    )


def test_what_is_drawn_has_the_colours_of_the_verdicts(browser: chromium.Browser, page: Path) -> None:
    browser.open(page)
    browser.wait_until("return Number(timelines[0].element.dataset.drawn) > 0")
    script = """
    const [timeline] = timelines, colour = arguments[0];
    const lane = timeline.lanes[0];
    const x = timeline.x(arguments[1]), y = lane.top + 3;
    return [...timeline.pen.getImageData(Math.round(x), Math.round(y), 1, 1).data].slice(0, 3);
    """
    failed = browser.run("return timelines[0].failure().time")
    assert browser.run(script, "", failed + 1e9) == [179, 38, 30]
    assert browser.run(script, "", failed - 1e9) == [191, 227, 198]


def test_the_button_changes_between_light_and_dark(browser: chromium.Browser, page: Path) -> None:
    browser.open(page)
    browser.run("document.getElementById('theme').click()")
    assert browser.run("return getComputedStyle(document.body).backgroundColor") == "rgb(15, 19, 24)"
    assert browser.run("return document.getElementById('theme').getAttribute('aria-pressed')") == "true"


def test_whoever_writes_scripts_into_names_and_values_sees_them_as_text(browser: chromium.Browser, page: Path) -> None:
    browser.open(page)
    assert browser.run("return document.title") == "props.txt on <b>drive & 'co'.csv"
    assert browser.run("return document.querySelectorAll('img, h1 b, h2 b').length") == 0
    assert HOSTILE in browser.run("return timelines[2].content.panels.find(p => p.kind === 'string').names")


def test_the_wheel_zooms_where_the_pointer_is_and_a_double_click_shows_the_whole(
    browser: chromium.Browser, page: Path
) -> None:
    browser.open(page)
    place, whole = centre(browser), span(browser)
    browser.act(pointer(to(place, 1), to(place)))
    at = browser.run("return timelines[0].cursor")
    wheel = {"type": "scroll", "x": place["x"], "y": place["y"], "deltaX": 0, "deltaY": -120, "duration": 0}
    browser.act({"type": "wheel", "id": "wheel", "actions": [wheel]})
    browser.wait_until(f"return timelines[0].view.to - timelines[0].view.from < {0.8 * whole}")
    assert browser.run("return timelines[0].time(timelines[0].x(arguments[0]))", at) == pytest.approx(at)
    start, end = view(browser)
    assert (at - start) / (end - start) == pytest.approx(0.5, abs=0.02)
    press, release = {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}
    browser.act(pointer(to(place), press, release, press, release))
    assert span(browser) == pytest.approx(whole)


def test_the_wheel_scrolls_the_page_where_there_is_nothing_to_zoom_out_to(
    browser: chromium.Browser, page: Path
) -> None:
    browser.open(page)
    place, whole = centre(browser), span(browser)
    before = browser.run("return scrollY")
    wheel = {"type": "scroll", "x": place["x"], "y": place["y"], "deltaX": 0, "deltaY": 120, "duration": 0}
    browser.act({"type": "wheel", "id": "wheel", "actions": [wheel]})
    browser.wait_until(f"return scrollY > {before}")
    assert span(browser) == whole


def test_dragging_moves_what_is_shown_and_all_timelines_with_it(browser: chromium.Browser, page: Path) -> None:
    browser.open(page)
    place = centre(browser)
    browser.run("timelines[0].view.zoom(0.25)")
    start, end = view(browser)
    down, up = {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}
    browser.act(pointer(to(place), down, to(place, 100), up))
    moved, _ = view(browser)
    width = browser.run("return timelines[0].width - 12")
    assert (start - moved) / (end - start) == pytest.approx(100 / width, rel=0.02)
    assert browser.run("return new Set(timelines.map(each => each.view)).size") == 1


def test_keys_zoom_move_and_go_to_the_violation(browser: chromium.Browser, page: Path) -> None:
    browser.open(page)
    browser.run("timelines[0].canvas.focus()")

    def press(key: str) -> None:
        keys = [{"type": "keyDown", "value": key}, {"type": "keyUp", "value": key}]
        browser.act({"type": "key", "id": "keyboard", "actions": keys})

    whole = span(browser)
    press("+")
    assert span(browser) == pytest.approx(whole / 2)
    start, _ = view(browser)
    press("\ue014")
    assert view(browser)[0] > start
    press("0")
    assert span(browser) == pytest.approx(whole)
    press("n")
    press("n")
    assert browser.run("return timelines[0].cursor === timelines[0].failure().time")
    assert "violated · v: 2.0" in browser.run("return timelines[0].output.textContent")


def test_zooming_keeps_the_violation_where_it_is_and_the_cursor_if_there_is_one(
    browser: chromium.Browser, page: Path
) -> None:
    browser.open(page)
    place = "return timelines[0].x(arguments[0] ?? timelines[0].failure().time)"
    browser.run("timelines[0].act('in')")  # where both ends could stay, there is nothing to keep
    before = browser.run(place)
    browser.run("timelines[0].act('in')")
    assert browser.run(place) == pytest.approx(before, abs=1)
    time = browser.run(
        "const [one] = timelines, time = (3 * one.view.from + one.view.to) / 4; one.point(time); return time"
    )
    before = browser.run(place, time)
    browser.run("timelines[0].act('in')")
    assert browser.run(place, time) == pytest.approx(before, abs=1)


COLOURS_DRAWN = """return timelines.map(({ canvas }) => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  return new Set(new Uint32Array(data.buffer)).size;
})"""


def test_on_paper_all_timelines_are_drawn_in_light_colours_and_all_details_unfolded(
    browser: chromium.Browser, page: Path
) -> None:
    browser.open(page, scheme="dark")
    browser.wait_until("return timelines.every(each => each.isLoaded)")
    folded = browser.run("return document.querySelectorAll('details:not([open])').length")
    assert folded
    browser.run("dispatchEvent(new Event('beforeprint'))")
    browser.run("for (const each of timelines) each.resize()")  # as the layout of paper has it
    assert min(browser.run(COLOURS_DRAWN)) > 5
    assert browser.run("return [...timelines[0].pen.getImageData(0, 0, 1, 1).data]") == [255, 255, 255, 255]
    assert not browser.run("return document.querySelectorAll('details:not([open])').length")
    browser.run("dispatchEvent(new Event('afterprint'))")
    assert browser.run("return document.querySelectorAll('details:not([open])').length") == folded
    assert browser.run("return isDark()")


def test_the_picture_of_a_monitor_fits_its_column(browser: chromium.Browser, page: Path) -> None:
    browser.open(page, width=360)
    browser.run("for (const each of document.querySelectorAll('details')) each.open = true")
    wide = (
        "return [...document.querySelectorAll('.picture')].filter(each => each.scrollWidth > each.clientWidth).length"
    )
    assert browser.run(wide) == 0


def test_the_age_of_a_message_is_told_and_drawn_with_its_limit(browser: chromium.Browser, tmp_path: Path) -> None:
    (tmp_path / "props.txt").write_text(
        "decl v /v Float64.data\ndecl w /w Float64.data\nalways (age(v) <= 0.5 s or w > 9)\n"
    )
    (tmp_path / "run.csv").write_text("time,v,w\n0,,1\n0.25,1,\n0.5,,1\n1.25,2,\n2,,2\n")
    arguments = [str(tmp_path / "run.csv"), "--report", str(tmp_path / "out.html")]
    assert main(["run", str(tmp_path / "props.txt"), *arguments]) == 1
    browser.complaints()
    browser.open(tmp_path / "out.html")
    told = [browser.run(f"return timelines[0].told({time}e9)").split(" · ")[-1] for time in (0.125, 0.25, 1.25, 1.75)]
    assert told == ["age(v): 0.125 s", "age(v): 0 s", "age(v): 0 s", "age(v): 0.5 s"]
    least, most = browser.run("return timelines[0].content.panels[1].range")
    assert least < 0
    assert most > 1
    assert browser.run("return timelines[0].content.panels[1].limits[0].value") == 0.5
    assert browser.complaints() == []


def test_nothing_is_fetched(browser: chromium.Browser, page: Path) -> None:
    browser.open(page)
    assert browser.run("return performance.getEntriesByType('resource').map(each => each.name)") == []


def test_everything_that_can_be_used_has_a_name(browser: chromium.Browser, page: Path) -> None:
    browser.open(page)
    script = """
    const named = (e) => e.getAttribute('aria-label') || e.getAttribute('aria-labelledby') || e.textContent.trim();
    const usable = document.querySelectorAll('button, a, canvas, input, summary, [tabindex], [role]');
    return [...usable].filter((e) => !named(e) && !e.closest('label')).map((e) => e.outerHTML.slice(0, 80));
    """
    assert browser.run(script) == []


def contrast(first: list[float], second: list[float]) -> float:
    """As WCAG 2 defines it."""

    def luminance(colour: list[float]) -> float:
        parts = [c / 255 for c in colour]
        linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance(first), luminance(second)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_stands_out_from_what_is_behind_it(browser: chromium.Browser, page: Path, scheme: str) -> None:
    browser.open(page, scheme=scheme)
    colours = browser.run("return colours")

    def rgb(name: str) -> list[float]:
        return [float(part) for part in colours[name].removeprefix("rgb(").rstrip(")").split(",")]

    verdicts = ["violated", "presumably_violated", "presumably_satisfied", "satisfied", "not_started"]
    pairs = [(verdict, f"{verdict}-text") for verdict in verdicts]
    pairs += [("surface", name) for name in ("text", "quiet", "link", "limit", "bound", "signal")]
    assert {pair: contrast(*map(rgb, pair)) for pair in pairs if contrast(*map(rgb, pair)) < 4.5} == {}
