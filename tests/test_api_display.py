"""What results of the Python interface show of themselves in a notebook, and that hostile text is text there."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import chromium
import pytest

import ltlc
from ltlc.interfaces.api.results import Run

pytestmark = pytest.mark.live

HOSTILE = (
    "<script>parent.document.title = document.title = 'taken'</script><img src=x onerror=\"document.title='taken'\">"
)

PROPS = """decl v /v Float64.data
decl mode /mode String.data
slow: never v > 2
answer: always (v > 1 implies eventually mode == "HOSTILE" within 3 s)
""".replace("HOSTILE", HOSTILE.replace('"', '\\"'))


def drive(top: float) -> Run:
    rows = [{"time": step / 10, "v": top * step / 60, "mode": HOSTILE if step % 20 else "b"} for step in range(60)]
    return ltlc.run(PROPS, rows)


@pytest.fixture(scope="module")
def cells() -> list[Any]:
    return [ltlc.check(PROPS + "low: always v < 1\nhigh: always v > 2\n"), drive(3), drive(1), ltlc.build(PROPS, "hoa")]


def outside_frames(html: str) -> str:
    return re.sub(r"<iframe.*?</iframe>", "", html, flags=re.DOTALL)


def test_hostile_text_is_text_in_all_that_is_shown(cells: list[Any]) -> None:
    for cell in cells:
        html = cell._repr_html_()
        assert "<script" not in html
        assert "<img" not in html
    assert "&lt;script&gt;" in outside_frames(cells[0]._repr_html_())


def test_findings_are_a_table_with_their_places_and_examples(cells: list[Any]) -> None:
    html = cells[0]._repr_html_()
    assert re.search(r"<td>error</td><td>LTL601</td><td>3:1</td><td>`slow` and `high` cannot hold together", html)
    assert "<details><summary>LTL601" in html
    assert "<td>slow</td><td>never v &gt; 2</td><td>can hold, can fail</td>" in html


def test_verdicts_and_failing_states_are_there_without_frames_and_scripts(cells: list[Any]) -> None:
    html = outside_frames(cells[1]._repr_html_())
    assert "<td>slow</td><td>violated</td><td>+4.1 s (step 41)</td>" in html
    assert "Failing state:\n  v: 2.05" in html
    assert "<iframe" not in html


def test_a_build_shows_each_monitor_with_what_the_gate_checked(cells: list[Any]) -> None:
    html = cells[3]._repr_html_()
    assert html.count("<svg") == 2
    assert "certified; as defined on" in html
    names = re.findall(r'<marker id="([^"]+)"', html)
    assert len(set(names)) == 2


def test_a_run_that_was_stepped_shows_its_verdicts_and_has_no_page() -> None:
    live = ltlc.monitor(PROPS)
    live.step({"v": 3, "mode": "b"}, 0.0)
    run = live.finish()
    assert "<td>slow</td><td>violated</td>" in run._repr_html_()
    assert "<iframe" not in run._repr_html_()
    with pytest.raises(ltlc.UnusableInput, match="a monitor does not keep its rows"):
        run.page()


def test_the_page_of_a_run_is_that_of_the_command(cells: list[Any]) -> None:
    assert cells[1].page().startswith("<!DOCTYPE html>")
    assert "about:srcdoc" not in cells[1].page()


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory, cells: list[Any]) -> Iterator[chromium.Browser]:
    if chromium.MISSING:
        pytest.skip(chromium.MISSING)
    folder = tmp_path_factory.mktemp("notebook")
    body = "\n".join(f"<div>{cell._repr_html_()}</div>" for cell in cells)
    page = folder / "notebook.html"
    page.write_text(f"<!DOCTYPE html><meta charset=utf-8><title>notebook</title><body>{body}</body>")
    with chromium.browser(folder) as opened:
        opened.open(page)
        yield opened
        assert opened.complaints() == []


def enter(browser: chromium.Browser, frame: int) -> None:
    """Go into a frame whose timelines are to be seen, and wait until one is drawn."""
    browser.enter(None)
    browser.run("document.querySelectorAll('iframe')[arguments[0]].scrollIntoView()", frame)
    browser.enter(frame)
    browser.run("timelines[0].canvas.scrollIntoView()")
    browser.wait_until("return timelines[0].isLoaded")


@pytest.mark.parametrize("frame", [0, 1])
def test_each_cell_draws_its_own_timelines(browser: chromium.Browser, frame: int) -> None:
    enter(browser, frame)
    assert browser.run("return timelines.length") == 2
    painted = """
    const { width, height } = timelines[0].canvas;
    const pixels = timelines[0].canvas.getContext("2d").getImageData(0, 0, width, height).data;
    return new Set(new Uint32Array(pixels.buffer)).size;
    """
    browser.wait_until(f"return (() => {{ {painted} }})() > 5")


@pytest.mark.parametrize("frame", [0, 1])
def test_a_frame_holds_its_content_also_when_more_is_unfolded(browser: chromium.Browser, frame: int) -> None:
    content = "return [document.documentElement.offsetHeight, innerHeight]"
    enter(browser, frame)
    browser.wait_until(f"return new Set((() => {{ {content} }})()).size === 1")
    before, _ = browser.run(content)
    browser.run("for (const each of document.querySelectorAll('details')) each.open = !each.open")
    browser.wait_until(f"return document.documentElement.offsetHeight !== {before}")
    browser.wait_until(f"return new Set((() => {{ {content} }})()).size === 1")
    browser.run("for (const each of document.querySelectorAll('details')) each.open = !each.open")
    browser.wait_until(f"return innerHeight === {before}")


def test_scrolling_a_notebook_goes_on_over_timelines(browser: chromium.Browser) -> None:
    enter(browser, 0)
    browser.run("scrolled = 0")
    browser.enter(None)
    browser.run("scrollTo(0, scrollY + 10)")
    browser.enter(0)
    browser.wait_until("return scrolled > 0")


def test_links_of_a_frame_stay_in_it(browser: chromium.Browser) -> None:
    enter(browser, 0)
    browser.run("document.querySelector('table.overview a').click()")
    assert browser.run("return location.href").startswith("about:srcdoc#recording-0-property-")
    assert browser.run("return timelines.length") == 2


def test_a_link_in_a_frame_scrolls_the_notebook_to_where_it_leads(browser: chromium.Browser) -> None:
    enter(browser, 0)
    browser.enter(None)
    browser.run("scrollTo(0, 0)")
    browser.enter(0)
    browser.run("document.querySelector('table.overview tr:last-child a').click()")
    browser.enter(None)
    browser.wait_until("return scrollY > 900")


def test_a_frame_cannot_reach_the_notebook(browser: chromium.Browser) -> None:
    enter(browser, 0)
    reach = "try { parent.document.title = 'taken'; return 'reached' } catch { return 'refused' }"
    assert browser.run(reach) == "refused"
    browser.enter(None)
    assert browser.run("return document.title") == "notebook"
