"""The page of `ltlc serve` in a real browser."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import chromium
import pytest
from bag_support import Sent, mcap, odometry, ros1, rosbag2
from test_serve import served

from ltlc.frontend.syntax.lexer import FUNCTIONS, KEYWORDS, QUANTIFIERS
from ltlc.interfaces.serve.server import Server
from ltlc.interfaces.serve.start import Start

pytestmark = [pytest.mark.live, pytest.mark.skipif(bool(chromium.MISSING), reason=chromium.MISSING)]

TAKEN = "document.title = 'taken'"
HOSTILE = f'</textarea></svg><script>{TAKEN}</script><img src=x onerror="{TAKEN}">{{{{ 7*7 }}}}'
QUOTED = HOSTILE.replace('"', '\\"')
TEXT = "never robot.velocity > 2\n"
TAB, ENTER, LEFT, UP, RIGHT, DOWN = "\ue004", "\ue007", "\ue012", "\ue013", "\ue014", "\ue015"
CONTROL = "\ue009"


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with served(Start("<b>props</b>.txt", TEXT)) as server:
        yield server


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[chromium.Browser]:
    with chromium.browser(tmp_path_factory.mktemp("chromium")) as opened:
        yield opened


@pytest.fixture
def browser(opened: chromium.Browser, server: Server) -> Iterator[chromium.Browser]:
    """The page as it begins; whatever a test does, the console has nothing to complain about."""
    opened.visit("about:blank")
    opened.visit(server.address)
    opened.run("performance.now = () => 0")  # keys that come late are undone with those before, as they are meant
    wait_for_verdict(opened, "presumably satisfied")
    yield opened
    assert opened.complaints() == []


def wait_for_verdict(browser: chromium.Browser, verdict: str) -> None:
    browser.wait_until(f"return document.querySelector('#properties .badge')?.textContent.endsWith('{verdict}')")


def write(browser: chromium.Browser, text: str) -> None:
    """Replace the text as if it was typed."""
    script = "const area = document.getElementById('text'); area.focus(); area.select();"
    browser.run(script + "document.execCommand('insertText', false, arguments[0])", text)


def press(browser: chromium.Browser, *keys: str) -> None:
    actions = [{"type": type_, "value": key} for key in keys for type_ in ("keyDown", "keyUp")]
    browser.act({"type": "key", "id": "keyboard", "actions": actions})


def click(browser: chromium.Browser, selector: str) -> None:
    """Click what is there, or will be."""
    script = f"const element = document.querySelector({json.dumps(selector)});"
    browser.wait_until(f"{script} element?.click(); return Boolean(element)")


def cells(browser: chromium.Browser, name: str) -> list[str]:
    found: list[str] = browser.run(
        "return [...document.querySelectorAll('#table input')].filter((e) => e.dataset.name === arguments[0])"
        ".map((e) => e.value)",
        name,
    )
    return found


def centre(browser: chromium.Browser, selector: str) -> dict[str, int]:
    script = """
    const element = document.querySelector(arguments[0]);
    element.scrollIntoView({ block: 'center' });
    const { left, top, width, height } = element.getBoundingClientRect();
    return { x: Math.round(left + width / 2), y: Math.round(top + height / 2), width, height };
    """
    found: dict[str, int] = browser.run(script, selector)
    return found


def test_whoever_types_a_property_and_a_value_that_breaks_it_sees_the_violation(browser: chromium.Browser) -> None:
    browser.run("const area = document.getElementById('text'); area.focus(); area.select()")
    press(browser, *"never robot.velocity > 3")
    browser.wait_until("return document.querySelector('.property')?.textContent === 'never robot.velocity > 3'")
    assert "speed of robot is never more than 3" in browser.run("return document.querySelector('.english').textContent")
    browser.run("document.querySelector('[aria-label=\"robot.velocity, step 2\"]').select()")
    press(browser, *"3.5")
    wait_for_verdict(browser, "violated")
    assert "robot.velocity: 3.5" in browser.run("return document.querySelector('.figure').textContent")
    shown = browser.run("return [...document.querySelectorAll('#table .verdict')].map((e) => e.textContent)")
    assert shown == ["(✓) presumably satisfied"] * 2 + ["✗ violated"] * 3
    assert browser.run("return document.querySelectorAll('#machine .state.violated.passed').length") == 1


def test_a_mistake_is_marked_in_the_text_and_a_click_mends_it(browser: chromium.Browser) -> None:
    write(browser, "never robot.velocity = 2\n")
    browser.wait_until("return document.querySelectorAll('.findings .error').length")
    assert browser.run("return document.querySelector('mark.error').textContent") == "="
    click(browser, ".findings .fix")
    browser.wait_until("return document.getElementById('text').value === 'never robot.velocity == 2\\n'")
    browser.wait_until("return !document.querySelector('.findings .error')")
    browser.run("document.execCommand('undo')")
    assert browser.run("return document.getElementById('text').value") == "never robot.velocity = 2\n"


def test_what_the_analyses_find_comes_after_what_the_front_end_says(browser: chromium.Browser) -> None:
    write(browser, "never robot.velocity > 2\nagain: never robot.velocity > 3\n")
    browser.wait_until("return document.querySelector('.findings')?.textContent.includes('LTL602')")
    assert browser.run("return document.getElementById('state').textContent") == "1 warning"


def test_the_property_under_the_cursor_is_the_one_that_is_told(browser: chromium.Browser) -> None:
    write(browser, "slow: never robot.velocity > 2\nmoves: eventually robot.velocity > 1\n")
    browser.wait_until("return document.querySelectorAll('#properties button').length === 2")
    for line, text in ((40, "eventually robot.velocity > 1"), (3, "never robot.velocity > 2")):
        browser.run("document.getElementById('text').setSelectionRange(arguments[0], arguments[0])", line)
        browser.wait_until(f"return document.querySelector('.property').textContent === '{text}'")


def tokens(browser: chromium.Browser, kind: str) -> list[str]:
    found: list[str] = browser.run(
        "return [...document.querySelectorAll(`.marks .${arguments[0]}`)].map((e) => e.textContent)", kind
    )
    return found


def test_every_keyword_and_function_of_the_language_has_a_colour(browser: chromium.Browser) -> None:
    write(browser, "\n".join([*sorted(KEYWORDS), *(f"x < {name}(y)" for name in (*FUNCTIONS, *QUANTIFIERS))]))
    assert tokens(browser, "keyword") == sorted(KEYWORDS)
    assert tokens(browser, "function") == [*FUNCTIONS, *QUANTIFIERS]
    colour = "return getComputedStyle(document.querySelector(arguments[0])).color"
    kinds = (".marks", ".token.keyword", ".token.function")
    assert len({browser.run(colour, kind) for kind in kinds}) == len(kinds)


def test_words_in_names_strings_and_comments_are_no_keywords(browser: chromium.Browser) -> None:
    text = (
        "decl after_x /always/x String.data # never\n"
        'until_: after new after_x, never after_x == "not # \\"or\\"" and new.until + limit > 2.5 and x1 < 1e-3\n'
        "in_time: within 500 ms, x > 3 # 7 s\n"
    )
    write(browser, text)
    assert tokens(browser, "keyword") == ["decl", "after", "new", "never", "and", "and", "within"]
    assert tokens(browser, "string") == ['"not # \\"or\\""']
    assert tokens(browser, "comment") == ["# never", "# 7 s"]
    assert tokens(browser, "number") == ["2.5", "1e-3", "500 ms", "3"]
    assert tokens(browser, "label") == ["until_", "in_time"]
    assert (tokens(browser, "topic"), tokens(browser, "type")) == (["/always/x"], ["String.data"])
    lines = browser.run("return [...document.querySelector('.marks').children].map((e) => e.textContent)")
    assert [line.rstrip("\u200b ") for line in lines] == text.split("\n")


def test_the_coloured_text_wraps_where_the_text_under_the_cursor_wraps(browser: chromium.Browser) -> None:
    write(browser, "\n\n".join("not " + length * "x" + " " for length in range(100)))
    script = """
    const area = document.getElementById('text'), height = document.querySelector('.marks').offsetHeight;
    Object.assign(area.style, { height: 0, alignSelf: 'start' });
    return [area.scrollHeight, height];
    """
    of_text, of_colours = browser.run(script)
    assert of_text == of_colours


def test_a_place_beyond_the_basic_plane_is_marked_where_it_is(browser: chromium.Browser) -> None:
    write(browser, 'decl m /m String.data\nnever m == "🤖🤖" and robot.velocty > 2\n')
    browser.wait_until("return document.querySelector('mark.error')")
    assert browser.run("return document.querySelector('mark.error').textContent") == "velocty"


def test_whoever_writes_markup_into_texts_and_values_sees_it_as_text(browser: chromium.Browser) -> None:
    assert browser.run("return document.getElementById('title').textContent") == "<b>props</b>.txt"
    write(browser, f'decl m /m String.data\nalways m == "{QUOTED}" # {HOSTILE}\n')
    browser.wait_until("return document.querySelector('#table input[data-name=m]')")
    browser.run(
        "const cell = document.querySelector('#table input[data-name=m]'); cell.value = arguments[0];"
        "cell.dispatchEvent(new Event('input', { bubbles: true }))",
        HOSTILE + "!",
    )
    wait_for_verdict(browser, "violated")
    assert HOSTILE[:60] in browser.run("return document.querySelector('.figure').textContent")
    browser.run("document.getElementById('explain').open = true")
    browser.wait_until("return document.querySelector('#explain table')")
    write(browser, f"never {HOSTILE}\n")
    browser.wait_until("return document.querySelector('.findings .error')")
    assert browser.run("return document.title") == "Try ltlc"
    assert browser.run("return document.querySelectorAll('img, main script, h1 b').length") == 0


@pytest.mark.parametrize(("width", "scheme"), [(480, "dark"), (1280, "light")])
def test_it_fits_any_width_in_light_and_dark(
    browser: chromium.Browser, server: Server, width: int, scheme: str
) -> None:
    browser.visit("about:blank")
    browser.visit(server.address, width, scheme)
    wait_for_verdict(browser, "presumably satisfied")
    browser.run("document.getElementById('explain').open = true")
    browser.wait_until("return document.querySelector('#explain table')")
    assert browser.run("return document.documentElement.scrollWidth") <= width
    background = browser.run("return getComputedStyle(document.body).backgroundColor")
    assert (background == "rgb(15, 19, 24)") == (scheme == "dark")


def test_keys_are_enough_to_edit_a_run(browser: chromium.Browser) -> None:
    count = len(cells(browser, "time"))
    browser.run("document.querySelector('[aria-label=\"robot.velocity, step 0\"]').focus()")
    press(browser, *[ENTER] * count, *"9")
    assert cells(browser, "robot.velocity") == ["0"] * count + ["9"]
    assert cells(browser, "time")[-1] == str(count)
    wait_for_verdict(browser, "violated")
    press(browser, UP)
    assert (
        browser.run("return document.activeElement.getAttribute('aria-label')") == f"robot.velocity, step {count - 1}"
    )
    press(browser, DOWN, TAB, TAB, ENTER)
    assert len(cells(browser, "time")) == count
    wait_for_verdict(browser, "presumably satisfied")


def test_a_curve_is_changed_with_keys(browser: chromium.Browser) -> None:
    browser.run("document.querySelector('.curve').focus()")
    press(browser, RIGHT, RIGHT, LEFT, *[UP] * 30)
    changed = [float(cell) for cell in cells(browser, "robot.velocity")]
    assert changed[1] > 2
    assert set(changed[:1] + changed[2:]) == {0}
    wait_for_verdict(browser, "violated")


def test_a_curve_is_drawn_with_the_pointer(browser: chromium.Browser) -> None:
    place = centre(browser, ".curve")
    x, y = place["x"] - place["width"] // 2, place["y"] - place["height"] // 2
    moves = [(x + 2, place["y"]), (x + place["width"] - 2, y + 2)]
    steps: list[dict[str, Any]] = [{"type": "pointerMove", "x": int(a), "y": int(b), "duration": 0} for a, b in moves]
    steps.insert(1, {"type": "pointerDown", "button": 0})
    mouse = {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}}
    browser.act({**mouse, "actions": [*steps, {"type": "pointerUp", "button": 0}]})
    drawn = [float(cell) for cell in cells(browser, "robot.velocity")]
    assert drawn == sorted(drawn)
    assert drawn[-1] > 2 > drawn[0] > 0
    wait_for_verdict(browser, "violated")


def step(name: str, at: int) -> str:
    return f"document.querySelector('[aria-label=\"{name}, step {at}\"]')"


def type_in_cell(browser: chromium.Browser, at: int, text: str) -> None:
    browser.run(f"{step('robot.velocity', at)}.select()")
    press(browser, *text)


def undo(browser: chromium.Browser, key: str = "z") -> None:
    keys = [("keyDown", CONTROL), ("keyDown", key), ("keyUp", key), ("keyUp", CONTROL)]
    actions = [{"type": type_, "value": value} for type_, value in keys]
    browser.act({"type": "key", "id": "keyboard", "actions": actions})


def test_edits_of_the_text_and_the_run_are_undone_in_turn_and_redone(browser: chromium.Browser) -> None:
    assert browser.run("return document.getElementById('undo').disabled")
    type_in_cell(browser, 1, "1.5")
    type_in_cell(browser, 2, "9")
    wait_for_verdict(browser, "violated")
    write(browser, "never robot.velocity > 20\n")
    wait_for_verdict(browser, "presumably satisfied")
    click(browser, "#table .row-tools button")
    seen = [["0", "0", "1.5", "9", "0", "0"], ["0", "1.5", "9", "0", "0"], ["0", "1.5", "9", "0", "0"]]
    seen += [["0", "1.5", "0", "0", "0"], ["0"] * 5]
    assert cells(browser, "robot.velocity") == seen[0]
    for wanted in seen[1:]:
        undo(browser)
        assert cells(browser, "robot.velocity") == wanted
    assert browser.run("return document.getElementById('text').value") == TEXT
    assert browser.run("return document.getElementById('undo').disabled")
    undo(browser, "y")
    undo(browser, "y")
    wait_for_verdict(browser, "violated")
    undo(browser, "y")
    wait_for_verdict(browser, "presumably satisfied")
    click(browser, "#redo")
    assert cells(browser, "robot.velocity") == seen[0]
    assert browser.run("return document.getElementById('redo').disabled")


def test_an_example_that_was_opened_gives_back_text_and_run_when_it_is_undone(browser: chromium.Browser) -> None:
    type_in_cell(browser, 0, "1.5")
    write(browser, "always robot.velocity > 1 # mine")
    browser.run(
        "const examples = document.getElementById('examples'); examples.value = 1;"
        "examples.dispatchEvent(new Event('change'))"
    )
    browser.wait_until("return document.querySelectorAll('#table tbody tr').length !== 5")
    click(browser, "#undo")
    wait_for_verdict(browser, "violated")
    assert browser.run("return document.getElementById('text').value") == "always robot.velocity > 1 # mine"
    assert cells(browser, "robot.velocity") == ["1.5", "0", "0", "0", "0"]


def test_an_edit_after_an_undo_cannot_be_redone_over(browser: chromium.Browser) -> None:
    type_in_cell(browser, 1, "1")
    undo(browser)
    type_in_cell(browser, 2, "2")
    undo(browser, "y")
    assert cells(browser, "robot.velocity") == ["0", "0", "2", "0", "0"]


def test_a_text_with_a_mistake_is_undone_with_the_cursor_where_it_was(browser: chromium.Browser) -> None:
    browser.run("const area = document.getElementById('text'); area.focus(); area.setSelectionRange(20, 20)")
    press(browser, *">>")
    browser.wait_until("return document.querySelector('.findings .error')")
    undo(browser)
    browser.wait_until("return !document.querySelector('.findings .error')")
    assert browser.run("return document.getElementById('text').selectionStart") == 20
    assert cells(browser, "robot.velocity") == ["0"] * 5


def test_columns_of_many_signals_scroll_while_the_step_and_the_page_stay(browser: chromium.Browser) -> None:
    write(browser, "".join(f"never signal_{number}.velocity > {number}\n" for number in range(1, 21)))
    browser.wait_until("return document.querySelectorAll('.curve').length === 20")
    wait_for_verdict(browser, "presumably satisfied")
    assert browser.run("return document.documentElement.scrollWidth <= innerWidth")
    script = """
    const table = document.getElementById('table'), left = table.getBoundingClientRect().left;
    table.scrollLeft = 500;
    return [table.scrollLeft, table.querySelector('tbody th').getBoundingClientRect().left - left];
    """
    assert browser.run(script) == [500, 0]
    assert browser.run(
        "const { scrollHeight, clientHeight } = document.getElementById('curves');"
        "return scrollHeight > 2 * clientHeight && clientHeight <= innerHeight"
    )


def test_an_example_run_is_loaded_by_a_click(browser: chromium.Browser) -> None:
    browser.run("document.getElementById('explain').open = true")
    click(browser, "#explain .example-run button")
    wait_for_verdict(browser, "violated")


def test_a_run_that_tells_encodings_apart_is_loaded_and_judged_under_each(browser: chromium.Browser) -> None:
    write(browser, "after_until robot.distance.s < 1, robot.distance.s > 1, eventually robot.velocity == 0\n")
    browser.wait_until("return document.querySelectorAll('.curve').length === 2")
    browser.run("document.getElementById('compare').open = true")
    click(browser, "#compare .example-run button")
    verdicts = "[...document.querySelectorAll('[data-encoding]')].slice(0, 2).map((e) => e.textContent)"
    wanted = ["(✓) presumably satisfied", "(✗) presumably violated"]
    browser.wait_until(f"return JSON.stringify({verdicts}) === JSON.stringify({wanted})")


def test_a_table_that_is_pasted_is_the_run(browser: chromium.Browser) -> None:
    browser.run("document.getElementById('paste').click()")
    browser.run(
        "document.getElementById('csv-text').value = arguments[0];document.querySelector('#csv [value=take]').click()",
        'time,robot.velocity,other\n0.1,1,5\n0.2,"2.5",6\n',
    )
    wait_for_verdict(browser, "violated")
    assert cells(browser, "time") == ["0.1", "0.2"]
    assert "no property reads the column `other`" in browser.run(
        "return document.getElementById('remarks').textContent"
    )


DROP = """const [name, content] = arguments, files = new DataTransfer();
files.items.add(new File([Uint8Array.from(atob(content), (c) => c.charCodeAt(0))], name));
document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: files, bubbles: true, cancelable: true }));"""


def drop(browser: chromium.Browser, name: str, content: bytes) -> None:
    browser.run(DROP, name, b64encode(content).decode())


def test_a_table_that_is_dropped_is_the_run_and_the_violated_property_is_chosen(browser: chromium.Browser) -> None:
    write(browser, "slow: never robot.velocity > 9\nslower: never robot.velocity > 2\n")
    browser.wait_until("return document.querySelectorAll('#properties button').length === 2")
    browser.run("document.querySelector('#properties button').click()")
    drop(browser, "drive.CSV", b"time,robot.velocity\n0,1\n1,3\n")
    browser.wait_until("return document.querySelectorAll('#properties button')[1].ariaPressed === 'true'")
    assert cells(browser, "robot.velocity") == ["1", "3"]


BAGS: dict[str, Callable[[Path, list[Sent]], Path]] = {
    "drive.mcap": lambda folder, sent: mcap(folder / "drive.mcap", sent),
    "drive.bag": lambda folder, sent: ros1(folder / "drive.bag", sent),
    "drive.db3": lambda folder, sent: next(rosbag2(folder / "drive", sent).glob("*.db3")),
}


@pytest.mark.parametrize("name", BAGS)
def test_a_bag_that_is_dropped_is_the_run(browser: chromium.Browser, tmp_path: Path, name: str) -> None:
    sent = [odometry(second * 10**9, twist__twist__linear__x=second / 2) for second in range(8)]
    write(browser, "object robot /odom Odometry\nnever robot.velocity > 2\n")
    wait_for_verdict(browser, "presumably satisfied")
    drop(browser, name, BAGS[name](tmp_path, sent).read_bytes())
    wait_for_verdict(browser, "violated")
    assert cells(browser, "time") == [str(second) for second in range(8)]
    assert cells(browser, "robot.velocity") == ["0", "0.5", "1", "1.5", "2", "2.5", "3", "3.5"]


def test_a_table_with_columns_by_topic_and_field_is_the_run_when_it_is_dropped(browser: chromium.Browser) -> None:
    write(browser, "decl speed /odom Odometry.twist.twist.linear.x\nnever speed > 2\n")
    browser.wait_until("return document.querySelector('#table [data-name=\"speed\"]')")
    drop(browser, "drive.csv", b"__time,/odom/twist/twist/linear/x\n1700000000.5,1\n1700000002,3\n")
    wait_for_verdict(browser, "violated")
    assert (cells(browser, "time"), cells(browser, "speed")) == (["0", "1.5"], ["1", "3"])


def test_a_recording_is_opened_by_its_button_too(browser: chromium.Browser) -> None:
    browser.run("document.getElementById('file').addEventListener('click', (event) => event.preventDefault())")
    browser.run("document.getElementById('file').addEventListener('click', () => { window.asked = true; })")
    browser.run("document.getElementById('open').click()")
    assert browser.run("return window.asked")
    browser.run(
        """const [content] = arguments, files = new DataTransfer(), input = document.getElementById("file");
        files.items.add(new File([content], "drive.jsonl"));
        input.files = files.files;
        input.dispatchEvent(new Event("change"));""",
        '{"time": 0, "robot.velocity": 1}\n{"time": 2, "robot.velocity": 3}\n',
    )
    wait_for_verdict(browser, "violated")
    assert cells(browser, "time") == ["0", "2"]


def test_of_a_long_recording_that_is_dropped_the_page_says_what_is_not_there(browser: chromium.Browser) -> None:
    lines = "".join(f'{{"time": {number}, "robot.velocity": 1}}\n' for number in range(2500))
    drop(browser, "long.jsonl", lines.encode())
    browser.wait_until("return document.getElementById('opened').textContent.includes('only the first 1999 rows')")


@pytest.mark.parametrize(
    ("name", "said"),
    [("drive.exe", "drive.exe is not a recording"), ("drive.mcap", "drive.mcap"), ("drive.jsonl", "not JSON")],
)
def test_a_file_that_is_no_recording_is_refused_when_it_is_dropped(
    browser: chromium.Browser, name: str, said: str
) -> None:
    before = cells(browser, "robot.velocity")
    drop(browser, name, b"time,robot.velocity\n0,1\n")
    browser.wait_until(
        "const opened = document.getElementById('opened').textContent;"
        f"return opened.startsWith('error') && opened.includes({json.dumps(said)})"
    )
    assert cells(browser, "robot.velocity") == before


def test_a_file_that_is_too_large_is_refused_when_it_is_dropped(browser: chromium.Browser) -> None:
    browser.run(
        """const files = new DataTransfer(), file = new File([], "drive.mcap");
        Object.defineProperty(File.prototype, "size", { value: 64000001, configurable: true });
        files.items.add(file);
        document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: files, bubbles: true, cancelable: true }));"""
    )
    assert "larger than 64 MB" in browser.run("return document.getElementById('opened').textContent")


def test_a_signal_that_comes_back_has_the_cells_that_it_had(browser: chromium.Browser) -> None:
    browser.run("document.querySelector('[aria-label=\"robot.velocity, step 1\"]').select()")
    press(browser, *"1.25")
    write(browser, "never car.velocity > 2\n")
    browser.wait_until("return document.querySelector('#table [data-name=\"car.velocity\"]')")
    wait_for_verdict(browser, "presumably satisfied")
    assert browser.run("return document.getElementById('remarks').textContent") == ""
    write(browser, TEXT)
    browser.wait_until("return document.querySelector('#table [data-name=\"robot.velocity\"]')")
    assert cells(browser, "robot.velocity")[1] == "1.25"


def test_what_cannot_be_a_value_is_told_and_no_verdict_is_made_up(browser: chromium.Browser) -> None:
    browser.run("document.querySelector('[aria-label=\"robot.velocity, step 1\"]').select()")
    press(browser, *"fast")
    browser.wait_until("return document.getElementById('remarks').textContent.includes('is not a number')")
    shown = browser.run("return [...document.querySelectorAll('#table .verdict')].map((e) => e.textContent)")
    assert shown[1:] == [""] * (len(shown) - 1)


@pytest.mark.parametrize("written", ["", "-1", "0"])
def test_a_time_that_does_not_follow_is_told_or_taken(browser: chromium.Browser, written: str) -> None:
    browser.run("document.querySelector('[aria-label=\"time, step 1\"]').select()")
    press(browser, "\ue017", *written)
    wanted = "presumably satisfied" if written == "0" else ""
    browser.wait_until(
        "const [first, second] = document.querySelectorAll('#table .verdict');"
        f"return first.textContent && second.textContent.endsWith('{wanted}')"
        f"&& Boolean(second.textContent) === Boolean('{wanted}')"
    )


def test_a_run_is_given_more_steps_that_hold_what_was_there(browser: chromium.Browser) -> None:
    browser.run("document.querySelector('[aria-label=\"robot.velocity, step 2\"]').select()")
    press(browser, *"1.5")
    browser.run(
        "document.getElementById('count').value = 9; document.getElementById('every').value = 0.5;"
        "document.getElementById('even').click()"
    )
    assert cells(browser, "time") == ["0", "0.5", "1", "1.5", "2", "2.5", "3", "3.5", "4"]
    assert cells(browser, "robot.velocity") == ["0"] * 4 + ["1.5"] * 2 + ["0"] * 3


@pytest.mark.parametrize(
    ("wave", "wanted"),
    [
        ("constant", [1, 1, 1, 1, 1]),
        ("step", [1, 1, 3, 3, 3]),
        ("ramp", [1, 1.5, 2, 2.5, 3]),
        ("sine", [2, 3, 2, 1, 2]),
    ],
)
def test_a_signal_is_filled_with_a_wave_between_two_values(
    browser: chromium.Browser, wave: str, wanted: list[float]
) -> None:
    browser.run(
        "document.getElementById('wave').value = arguments[0]; document.getElementById('fill-from').value = 1;"
        "document.getElementById('fill-to').value = 3; document.querySelector('#fill button').click()",
        wave,
    )
    assert [float(cell) for cell in cells(browser, "robot.velocity")] == wanted
    wait_for_verdict(browser, "presumably satisfied" if max(wanted) <= 2 else "violated")
    undo(browser)
    assert cells(browser, "robot.velocity") == ["0"] * 5


def test_a_step_whose_time_is_no_number_is_not_filled(browser: chromium.Browser) -> None:
    browser.run("document.querySelector('[aria-label=\"time, step 4\"]').select()")
    press(browser, *"soon")
    browser.run("document.getElementById('wave').value = 'ramp'; document.querySelector('#fill button').click()")
    assert [float(cell) for cell in cells(browser, "robot.velocity")] == [0, 0.333333, 0.666667, 1, 0]


def test_what_is_no_number_and_no_boolean_is_not_offered_to_be_filled(browser: chromium.Browser) -> None:
    write(browser, 'decl m /m String.data\ndecl on /on Bool.data\nalways (m == "a" or on)\n')
    browser.wait_until("return document.querySelector('#table input[data-name=on]')")
    assert browser.run("return [...document.getElementById('fill-signal').options].map((e) => e.value)") == ["on"]
    browser.run("document.getElementById('wave').value = 'step'; document.querySelector('#fill button').click()")
    assert cells(browser, "on") == ["false"] * 2 + ["true"] * 3
    write(browser, 'decl m /m String.data\nalways m == "a"\n')
    browser.wait_until("return document.getElementById('fill').hidden")


def test_the_address_keeps_the_text_and_the_run(browser: chromium.Browser, server: Server) -> None:
    browser.run("document.querySelector('[aria-label=\"robot.velocity, step 0\"]').select()")
    press(browser, *"7")
    write(browser, "# Ünïcödé 🤖\nnever robot.velocity > 6\n")
    wait_for_verdict(browser, "violated")
    browser.wait_until("return location.hash.length > 20")
    browser.run("document.getElementById('share').click()")
    address = browser.run("return location.href")
    browser.visit("about:blank")
    browser.visit(address)
    wait_for_verdict(browser, "violated")
    assert browser.run("return document.getElementById('text').value") == "# Ünïcödé 🤖\nnever robot.velocity > 6\n"
    assert cells(browser, "robot.velocity")[0] == "7"


def test_everything_that_can_be_used_has_a_name(browser: chromium.Browser) -> None:
    script = """
    const named = (e) => e.getAttribute('aria-label') || e.getAttribute('aria-labelledby') || e.labels?.length
      || e.textContent.trim();
    const usable = document.querySelectorAll('button, a, input, select, textarea, summary, [tabindex], [role]');
    return [...usable].filter((e) => !named(e) && e.role !== 'status').map((e) => e.outerHTML.slice(0, 80));
    """
    assert browser.run(script) == []


def test_nothing_is_fetched_from_elsewhere(browser: chromium.Browser, server: Server) -> None:
    fetched = browser.run("return performance.getEntriesByType('resource').map((each) => each.name)")
    assert fetched
    assert [name for name in fetched if not name.startswith(server.address)] == []
