"""The language server as an editor meets it: a process, messages over pipes, texts that change."""

from __future__ import annotations

import random
import re
import signal
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from editor_client import PATIENCE, URI, Editor
from fuzzing import SPECIFICATIONS, WORDS
from processes import children_of

from ltlc.cli import main

pytestmark = pytest.mark.live

TEXT = """decl speed /speed Float64.data
# 𝒳 wide
fast: never speed > 2
object sign at (1, 0, 0) "𝒳" 𝒳
"""

SOUND = "decl speed /speed Float64.data\nfast: never speed > 2\nnever speed > 1\n"


@pytest.fixture(scope="module")
def editor() -> Iterator[Editor]:
    """An editor with a server, one for all of these tests."""
    pytest.importorskip("pygls", reason="needs the extra `editor`")
    with Editor() as editor:
        yield editor


def position(text: str, word: str, number: int = 0) -> tuple[int, int]:
    """Where `word` begins for the time with this number, in lines and units of UTF-16."""
    offset = -1
    for _ in range(number + 1):
        offset = text.index(word, offset + 1)
    line = text.rfind("\n", 0, offset) + 1
    return text.count("\n", 0, offset), len(text[line:offset].encode("utf-16-le")) // 2


def marked(text: str, place: dict[str, Any]) -> str:
    """The text of a range of one line."""
    start, end = place["start"], place["end"]
    assert start["line"] == end["line"]
    line = text.split("\n")[start["line"]].encode("utf-16-le")
    return str(line[2 * start["character"] : 2 * end["character"]], "utf-16-le")


def edited(text: str, edits: list[dict[str, Any]]) -> str:
    """`text` after edits of one line each."""
    lines = [line.encode("utf-16-le") for line in text.split("\n")]
    for edit in sorted(edits, key=lambda e: (e["range"]["start"]["line"], -e["range"]["start"]["character"])):
        start, end = edit["range"]["start"], edit["range"]["end"]
        line = lines[start["line"]]
        new = edit["newText"].encode("utf-16-le")
        lines[start["line"]] = line[: 2 * start["character"]] + new + line[2 * end["character"] :]
    return "\n".join(line.decode("utf-16-le") for line in lines)


def eventually(is_so: Callable[[], bool]) -> bool:
    """Whether something is so before patience ends."""
    end = time.monotonic() + PATIENCE
    while not is_so():
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


def test_a_fault_is_reported_where_it_is_as_soon_as_it_is_typed(editor: Editor) -> None:
    editor.open(SOUND)
    assert editor.diagnostics() == []
    text = SOUND + 'always "𝒳" == "𝒳" and spede > 2\n'
    editor.type(text)
    (found,) = editor.diagnostics()
    assert (found["code"], found["severity"], marked(text, found["range"])) == ("LTL101", 1, "spede")
    assert "nothing called `spede` is defined\nhelp: did you mean `speed`?" in found["message"]


def test_analyses_follow_with_what_they_refer_to_and_the_lenses_are_asked_for_anew(editor: Editor) -> None:
    editor.open(SOUND)
    assert editor.diagnostics() == []
    (found,) = editor.diagnostics()
    assert found["code"] == "LTL602"
    assert [marked(SOUND, other["location"]["range"]) for other in found["relatedInformation"]] == ["never speed > 1"]
    editor.next("workspace/codeLens/refresh")
    assert [lens["command"]["title"] for lens in editor.ask("codeLens")] == ["2 states, can hold, can fail"] * 2


def test_what_a_comment_suppresses_is_not_reported_and_is_not_called_idle_before_the_analyses(editor: Editor) -> None:
    editor.open(SOUND.replace("fast: never speed > 2", "fast: never speed > 2  # ltlc: ignore LTL602"))
    assert editor.diagnostics() == []
    assert editor.diagnostics() == []


def test_a_key_ends_the_analyses_and_their_processes(editor: Editor) -> None:
    editor.open(slow())
    assert editor.diagnostics() == []
    assert eventually(lambda: bool(children_of(editor.process.pid)))
    editor.type("never speed > 2\n")
    assert [found["code"] for found in editor.diagnostics()] == ["LTL101"]
    assert eventually(lambda: not children_of(editor.process.pid))


def slow() -> str:
    """A specification of which the analyses take long."""
    signals = [f"decl s{n} /s{n} Float64.data" for n in range(12)]
    events = [f"s{n} > {k} and s{(n + k) % 12} < s{(n + 5) % 12}" for n in range(12) for k in range(1, 9)]
    rules = [f"after_until {events[n - 7]}, {event}, eventually ({events[n - 2]})" for n, event in enumerate(events)]
    return "\n".join([*signals, *rules]) + "\n"


def test_the_text_in_the_editor_counts_not_that_on_disk(editor: Editor, tmp_path: Path) -> None:
    path = tmp_path / "props.txt"
    path.write_text("never speed > 2\n", encoding="utf-8")
    editor.open(SOUND, path.as_uri())
    assert editor.diagnostics(path.as_uri()) == []
    assert path.read_text(encoding="utf-8") == "never speed > 2\n"


def test_places_are_right_behind_wide_characters_and_in_lines_that_end_as_in_windows(editor: Editor) -> None:
    text = 'decl m /m String.data\r\ndecl speed /s Float64.data\r\nnever m == "𝒳𝒳" and speed > 2\r\n'
    editor.open(text)
    editor.diagnostics()
    found = editor.ask("hover", position(text, "speed", 1))
    assert "Read from `/s`" in found["contents"]["value"]
    assert marked(text, found["range"]) == "speed"


def test_a_definition_and_its_uses_are_found_and_renamed(editor: Editor) -> None:
    editor.open(SOUND)
    place = position(SOUND, "speed", 2)
    assert [where["range"]["start"]["line"] for where in editor.ask("definition", place)] == [0]
    uses = editor.ask("references", place, context={"includeDeclaration": True})
    assert [marked(SOUND, use["range"]) for use in uses] == ["speed"] * 3
    assert len(editor.ask("documentHighlight", place)) == 3
    assert marked(SOUND, editor.ask("prepareRename", place)) == "speed"
    changes = editor.ask("rename", place, newName="v")["changes"]
    assert edited(SOUND, changes[URI]) == SOUND.replace(" speed", " v").replace("/speed", "/speed")


def test_a_name_that_cannot_be_given_is_refused_with_a_message(editor: Editor) -> None:
    editor.open(SOUND)
    params = {"textDocument": {"uri": URI}, "position": {"line": 0, "character": 6}, "newName": "always"}
    error = editor.answer("textDocument/rename", params)["error"]
    assert error["message"] == "with this name, `always` is a keyword and cannot be a name"


def test_words_are_offered_while_they_are_typed(editor: Editor) -> None:
    text = "never robot.vel\n" + SOUND
    editor.open(text)
    items = editor.ask("completion", (0, 15))["items"]
    velocity = next(item for item in items if item["label"] == "velocity")
    assert marked(text, velocity["textEdit"]["range"]) == "vel"


def test_an_action_that_is_carried_out_mends_the_text(editor: Editor) -> None:
    editor.open(SOUND)
    editor.diagnostics()
    (found,) = editor.diagnostics()
    actions = editor.ask("codeAction", range=found["range"], context={"diagnostics": [found]})
    suppress = next(action for action in actions if action["title"].startswith("suppress LTL602"))
    editor.type(edited(SOUND, suppress["edit"]["changes"][URI]))
    assert editor.diagnostics() == []
    assert editor.diagnostics() == []


def test_an_action_shows_the_page_of_a_code(editor: Editor) -> None:
    editor.open("never speed > 2\n")
    (found,) = editor.diagnostics()
    actions = editor.ask("codeAction", range=found["range"], context={"diagnostics": [found]})
    command = next(action["command"] for action in actions if "page of LTL101" in action["title"])
    path = editor.request("workspace/executeCommand", command)
    assert Path(path).read_text(encoding="utf-8").startswith("# LTL101")
    assert editor.next("window/showDocument")["params"]["uri"].endswith("LTL101.md")


@pytest.mark.parametrize(("wanted", "some"), [("quickfix", True), ("refactor", False)])
def test_an_editor_gets_the_kinds_of_actions_that_it_asks_for(editor: Editor, wanted: str, some: bool) -> None:
    editor.open("never speed > 2\n")
    (found,) = editor.diagnostics()
    context = {"diagnostics": [found], "only": [wanted]}
    assert bool(editor.ask("codeAction", range=found["range"], context=context)) is some


def test_the_tokens_are_those_of_the_text(editor: Editor) -> None:
    editor.open(TEXT)
    kinds = editor.offered["capabilities"]["semanticTokensProvider"]["legend"]["tokenTypes"]
    data = editor.ask("semanticTokens/full")["data"]
    line = character = 0
    found = []
    for lines, units, length, kind, _ in zip(*[iter(data)] * 5, strict=True):
        character = units if lines else character + units
        line += lines
        start, end = ({"line": line, "character": units} for units in (character, character + length))
        found.append((marked(TEXT, {"start": start, "end": end}), kinds[kind]))
    expected = [
        ("decl", "keyword"),
        ("speed", "variable"),
        ("/speed", "namespace"),
        ("Float64.data", "type"),
        ("# 𝒳 wide", "comment"),
        ("fast", "event"),
        ("never", "keyword"),
        ("speed", "variable"),
        (">", "operator"),
        ("2", "number"),
        ("object", "keyword"),
        ("sign", "class"),
        ("at", "keyword"),
    ]
    assert found[: len(expected)] == expected
    assert found[-2] == ('"𝒳"', "string")


def test_the_text_is_laid_out_as_ltlc_format_does_it(editor: Editor) -> None:
    editor.open("decl  speed /speed   Float64.data\n\n\nnever speed>2")
    options = {"tabSize": 4, "insertSpaces": True}
    (edit,) = editor.ask("formatting", options=options)
    assert edit["newText"] == "decl speed /speed Float64.data\n\nnever speed > 2\n"
    assert edit["range"]["end"] == {"line": 3, "character": 13}
    editor.type("never never (\n")
    assert editor.ask("formatting", options=options) is None


def test_the_outline_names_properties_by_their_labels(editor: Editor) -> None:
    editor.open(SOUND)
    assert [symbol["name"] for symbol in editor.ask("documentSymbol")] == ["speed", "fast", "line 3"]


def test_the_lens_of_a_property_leads_to_a_page_with_its_automaton(editor: Editor) -> None:
    editor.open('decl m /m String.data\nfast: never m == "<b>"\n')
    (lens,) = editor.ask("codeLens")
    path = editor.request("workspace/executeCommand", lens["command"])
    page = Path(path).read_text(encoding="utf-8")
    assert "<svg" in page
    assert "<b>" not in page
    assert not re.search(r"(src|href)=", page)
    shown = editor.next("window/showDocument")["params"]
    assert (shown["uri"], shown["external"]) == (Path(path).as_uri(), True)


def test_the_lens_of_a_property_that_is_gone_says_so(editor: Editor) -> None:
    editor.open(SOUND)
    arguments = [URI, "no_such"]
    assert editor.request("workspace/executeCommand", {"command": "ltlc.showAutomaton", "arguments": arguments}) is None
    assert "there is no longer a property no_such" in editor.next("window/showMessage")["params"]["message"]


def test_a_text_that_is_closed_has_no_findings(editor: Editor) -> None:
    other = "file:///home/robot/other.txt"
    editor.open("never speed > 2\n", other)
    assert editor.diagnostics(other) != []
    editor.notify("textDocument/didClose", {"textDocument": {"uri": other}})
    while (published := editor.next("textDocument/publishDiagnostics")["params"])["uri"] != other:
        pass  # the analyses of a text of another test
    assert published["diagnostics"] == []


OF_PLACES = ("hover", "completion", "definition", "documentHighlight")


@pytest.mark.parametrize("seed", range(12))
def test_every_question_about_a_broken_text_has_an_answer(editor: Editor, seed: int) -> None:
    draw = random.Random(seed)
    text = draw.choice(SPECIFICATIONS).read_text(encoding="utf-8")
    editor.open(text)
    for _ in range(4):
        start = draw.randrange(len(text) + 1)
        end = min(len(text), start + draw.choice([0, 1, 5, 40]))
        text = text[:start] + draw.choice(["", *draw.choices(WORDS, k=4)]) + text[end:]
        editor.type(text)
        line = draw.randrange(text.count("\n") + 2)
        for question in OF_PLACES:
            editor.ask(question, (line, draw.randrange(60)))
        editor.ask("references", (line, draw.randrange(60)), context={"includeDeclaration": True})
        for question in ("codeLens", "documentSymbol", "semanticTokens/full"):
            editor.ask(question)
        everywhere = {"start": {"line": 0, "character": 0}, "end": {"line": 10**6, "character": 0}}
        editor.ask("codeAction", range=everywhere, context={"diagnostics": []})
    assert editor.process.poll() is None


def test_what_is_no_message_does_not_end_the_server(editor: Editor) -> None:
    editor.notify("no/such/notification", {})
    assert "error" in editor.answer("textDocument/noSuchRequest", {})
    editor.open(SOUND)
    assert editor.diagnostics() == []


def test_the_server_says_nothing_of_faults_of_its_own(editor: Editor) -> None:
    assert b"Traceback" not in b"".join(editor.errors)


def test_a_server_that_was_shut_down_ends_well_and_leaves_no_page_behind() -> None:
    with Editor(capabilities={"general": {"positionEncodings": ["utf-8"]}}) as editor:
        assert editor.offered["capabilities"]["positionEncoding"] == "utf-8"
        text = 'decl m /m String.data decl v /v Bool.data\nnever m == "é𝒳" and v\n'
        editor.open(text)
        before = len('never m == "é𝒳" and '.encode())
        assert editor.ask("hover", (1, before))["range"]["start"] == {"line": 1, "character": before}
        (lens,) = editor.ask("codeLens")
        path = Path(editor.request("workspace/executeCommand", lens["command"]))
        assert path.exists()
        assert editor.end() == 0
    assert not path.parent.exists()


def test_a_server_whose_editor_is_gone_ends_with_its_analyses() -> None:
    with Editor() as editor:
        editor.open(slow())
        assert editor.diagnostics() == []
        assert eventually(lambda: bool(children_of(editor.process.pid)))
        children = children_of(editor.process.pid)
        assert editor.process.stdin is not None
        editor.process.stdin.close()
        assert editor.process.wait(PATIENCE) == 1
        assert eventually(lambda: not any(Path(f"/proc/{child}").exists() for child in children))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("text", ["slow", "none"])
def test_a_signal_ends_a_server_with_its_analyses_and_its_folder(number: int, text: str, tmp_path: Path) -> None:
    with Editor(temporary=tmp_path) as editor:
        children: set[int] = set()
        if text == "slow":
            editor.open(slow())
            assert editor.diagnostics() == []
            assert eventually(lambda: bool(children_of(editor.process.pid)))
            children |= children_of(editor.process.pid)
        assert len(list(tmp_path.iterdir())) == 1
        editor.process.send_signal(number)
        assert editor.process.wait(PATIENCE) == -number
        assert eventually(lambda: not any(Path(f"/proc/{child}").exists() for child in children))
        assert list(tmp_path.iterdir()) == []
        assert b"Traceback" not in b"".join(editor.errors)


BAD_PARAMETERS: list[Any] = [
    None,
    [],
    {},
    {"textDocument": 3},
    {"textDocument": {"uri": URI}, "position": {"line": "a", "character": 0}},
    {"textDocument": {"uri": URI}, "position": None},
]


@pytest.mark.parametrize("parameters", BAD_PARAMETERS)
@pytest.mark.parametrize("method", ["textDocument/hover", "textDocument/rename", "workspace/executeCommand"])
def test_a_request_with_bad_parameters_is_answered_with_an_error(editor: Editor, method: str, parameters: Any) -> None:
    assert editor.answer(method, parameters)["error"]["code"] == -32602
    assert editor.process.poll() is None
    assert b"Traceback" not in b"".join(editor.errors)


def test_without_pygls_the_command_says_how_to_get_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "lsprotocol", None)  # which comes with pygls
    monkeypatch.delitem(sys.modules, "ltlc.interfaces.editor.server", raising=False)
    assert main(["lsp"]) == 2
    assert "LTL808" in (err := capsys.readouterr().err)
    assert "run `pip install 'ltlc[editor]'`" in err
