"""What editors get of ltlc: the colours of the TextMate grammar; the extension for VS Code, packaged and started."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

import ltlc
from ltlc.base.source import Source
from ltlc.frontend.syntax import parse as parsing
from ltlc.frontend.syntax.lexer import HEADS, KEYWORDS, PREFIXES, Token, next_token

ROOT = Path(__file__).parents[1]
EXTENSION = ROOT / "editors" / "vscode"
GRAMMAR = ROOT / "editors" / "textmate" / "ltlc.tmLanguage.json"
MODULES = EXTENSION / "node_modules"

pytestmark = pytest.mark.skipif(
    not (shutil.which("node") and (MODULES / ".package.json").exists()),
    reason="no node, or no packages from npm (scripts/environment)",
)

OPERATORS = ("==", "!=", "<", "<=", ">", ">=", "+", "-", "*", "/", "@", "=")
SCOPES = {
    **dict.fromkeys(KEYWORDS | PREFIXES | (HEADS.keys() - {"rate"}) | {"zone", *OPERATORS}, "keyword."),
    "true": "constant.language.",
    "false": "constant.language.",
    "NUMBER": "constant.numeric.",
    "TIMES": "constant.numeric.",
    "HERTZ": "constant.numeric.",
    "DURATION": "constant.numeric.duration.",
    "PARAMETER": "variable.parameter.",
    "STRING": "string.quoted.",
    "TOPIC": "string.unquoted.topic.",
    "TYPE": "entity.name.type.",
    "MESSAGE_TYPE": "entity.name.type.",
    "SETTING": "variable.language.setting.",
    "QUANTIFIER": "support.function.",
    "rate": "support.function.",
    "TEMPLATE": "variable.other.",
}
"""What each terminal of the grammar is to a theme."""

RESERVED = ("keyword.", "comment.", "constant.numeric.", "constant.language.", "string.", "invalid.")
"""What a name, a bracket or a comma never is."""

FIXTURES = sorted([*(ROOT / "examples").rglob("*.txt"), *(ROOT / "tests" / "fixtures").rglob("*.txt")])


ENVIRONMENT = {**os.environ, "NODE_PATH": str(MODULES), "PYTHONPATH": str(ROOT)}
"""Where node finds the packages of the extension, and its server this ltlc."""


def scopes(texts: list[str]) -> list[list[list[str]]]:
    """Of each character of each text, the scopes that the grammar gives it."""
    command: list[str | Path] = ["node", ROOT / "tests" / "editors" / "tokens.js", GRAMMAR]
    done = subprocess.run(
        command, env=ENVIRONMENT, input=json.dumps(texts), stdout=subprocess.PIPE, text=True, check=True
    )
    return [[scopes for piece, scopes in pieces for _ in piece] for pieces in json.loads(done.stdout)]


def tokens(text: str, monkeypatch: pytest.MonkeyPatch) -> list[Token]:
    """The tokens that the compiler reads in `text`, but for those that it says are not written like this."""
    read = {}

    def reading(parsed: str, offset: int, acceptable: Any) -> Token:
        token = next_token(parsed, offset, acceptable)
        if acceptable and len(parsed) == len(text):  # not what may be meant by a line
            read[token.span.start] = token
        return token

    with monkeypatch.context() as patch:
        patch.setattr(parsing, "next_token", reading)
        parsing.parse(Source("props.txt", text))
    return [token for token in read.values() if not token.problem]


def is_coloured(token: Token, scopes: list[list[str]]) -> bool:
    """Whether each character of `token` has the scope of its terminal."""
    wanted = SCOPES.get(token.terminal)
    for each in scopes[token.span.start : token.span.end]:
        if wanted and not any(scope.startswith(wanted) for scope in each):
            return False
        if not wanted and any(scope.startswith(RESERVED) for scope in each):
            return False
    return True


def wrongly_coloured(texts: list[str], monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, Token]]:
    """The tokens that the grammar takes for something else than the compiler does, each with its text."""
    coloured = zip(texts, scopes(texts), strict=True)
    return [(text, t) for text, found in coloured for t in tokens(text, monkeypatch) if not is_coloured(t, found)]


def test_every_token_of_every_fixture_has_the_colour_of_what_the_compiler_takes_it_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    texts = [path.read_text(encoding="utf-8") for path in FIXTURES]
    assert len(texts) > 100
    assert wrongly_coloured(texts, monkeypatch) == []


def test_comments_and_line_breaks_between_any_two_words_change_no_colour(monkeypatch: pytest.MonkeyPatch) -> None:
    texts = [path.read_text(encoding="utf-8") for path in FIXTURES]
    broken = [re.sub(r'(?m)"[^"\n]*"|#.*|^guard .*|(?<=\S) (?=\S)', spread, text) for text in texts]
    assert wrongly_coloured(broken, monkeypatch) == []


def spread(match: re.Match[str]) -> str:
    """A blank as a comment and a line break; strings, comments and guards, each on a line, as they are."""
    return " # never /odom 3 s\n\n" if match.group() == " " else match.group()


def test_a_comment_is_coloured_as_one_and_nothing_else_is() -> None:
    texts = [path.read_text(encoding="utf-8") for path in FIXTURES if '"' not in path.read_text(encoding="utf-8")]
    for text, found in zip(texts, scopes(texts), strict=True):
        comments = {place for match in re.finditer(r"#.*", text) for place in range(*match.span())}
        assert {i for i, each in enumerate(found) if any(s.startswith("comment.") for s in each)} == comments


def test_a_declaration_that_is_being_typed_leaves_the_next_line_its_colours() -> None:
    begun = ("decl", "decl speed", "decl speed /odom", "model robot: position", "object sign", "_rate_ =")
    texts = [f"{line}\nnever x" for line in begun]
    for text, found in zip(texts, scopes(texts), strict=True):
        assert "keyword.control.temporal.ltlc" in found[text.index("never")], text


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the extension where it is installed from its package."""
    folder = tmp_path_factory.mktemp("installed")
    package = folder / "ltlc.vsix"
    command: list[str | Path] = [MODULES / ".bin" / "vsce", "package", "--allow-missing-repository", "--out", package]
    subprocess.run(command, cwd=EXTENSION, capture_output=True, check=True)
    with zipfile.ZipFile(package) as archive:
        archive.extractall(folder)
    return folder / "extension"


def test_the_package_has_the_grammar_the_licence_and_the_version_of_ltlc(installed: Path) -> None:
    manifest = json.loads((installed / "package.json").read_text(encoding="utf-8"))
    assert (installed / manifest["contributes"]["grammars"][0]["path"]).read_bytes() == GRAMMAR.read_bytes()
    assert (installed / "LICENSE.txt").read_bytes() == (ROOT / "LICENSE").read_bytes()
    assert manifest["version"] == ltlc.__version__


def test_the_package_has_of_npm_what_runs_with_its_licences_and_no_more(installed: Path) -> None:
    modules = installed / "node_modules"
    names = {path.name for path in modules.iterdir()}
    assert "vscode-languageclient" in names
    assert not names & {"vscode-textmate", "vscode-oniguruma", "@vscode"}
    assert all(any(path.glob("[Ll][Ii][Cc][Ee][Nn][Ss][Ee]*")) for path in modules.iterdir())
    assert not [path for path in modules.rglob("*") if path.suffix in (".ts", ".map") or path.stem == "README"]


def started(extension: Path, specification: Path, *awaited: str, path: object) -> list[dict[str, Any]]:
    """What a person sees with `specification` open in a stand-in for VS Code, where the setting `ltlc.path` is `path`.

    They click on a lens as soon as there is what is awaited, and close the editor when there is the last of it.
    """
    settings = json.dumps({"path": str(path), "arguments": []})
    command: list[str | Path] = ["node", ROOT / "tests" / "editors" / "vscode.js", extension, specification, settings]
    waiting = list(awaited)
    with subprocess.Popen(command, env=ENVIRONMENT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as editor:
        assert editor.stdin is not None
        assert editor.stdout is not None
        seen = []
        for line in editor.stdout:
            seen.append(json.loads(line))
            if waiting and waiting[0] in seen[-1]:
                del waiting[0]
                print(file=editor.stdin, flush=True) if waiting else editor.stdin.close()
    assert editor.returncode == 0
    return seen


@pytest.fixture(scope="module")
def seen(installed: Path) -> list[dict[str, Any]]:
    """What a person sees with the server of this ltlc, of a specification with a property and a name without use."""
    if not find_spec("pygls"):
        pytest.skip("no pygls here")
    specification = installed.parent / "props.ltlc"
    specification.write_text("decl v /v Float64.data\ndecl w /w Float64.data\n\nlimit: never v > 2\n")
    return started(installed, specification, "diagnostics", "opened", path=Path(sys.executable).with_name("ltlc"))


@pytest.mark.live
def test_the_installed_extension_shows_what_the_server_finds(seen: list[dict[str, Any]]) -> None:
    assert {code for each in seen for code, _ in each.get("diagnostics", ())} == {"LTL104"}
    assert [each["message"] for each in seen if "message" in each] == []
    assert seen[-1] == {"deactivated": True}


@pytest.mark.live
def test_a_click_on_the_lens_of_a_property_opens_its_automaton_in_the_browser(seen: list[dict[str, Any]]) -> None:
    (page,) = (each["opened"] for each in seen if "opened" in each)
    assert page.startswith("file://")
    assert page.endswith(".html")


def test_without_ltlc_the_extension_says_what_to_do_and_offers_its_setting(installed: Path, tmp_path: Path) -> None:
    seen = started(installed, tmp_path / "props.ltlc", "activated", path=tmp_path / "ltlc")
    *_, message = (each["message"] for each in seen if "message" in each)
    assert "ltlc lsp` does not start: there is no such command" in message
    assert "or set `ltlc.path`" in message
    assert {"executed": ["workbench.action.openSettings", "ltlc.path"]} in seen


def test_where_the_server_is_not_installed_the_extension_says_what_ltlc_says(installed: Path, tmp_path: Path) -> None:
    (tmp_path / "ltlc").write_text("#!/bin/sh\necho usage >&2\necho pygls is missing >&2\nexit 2\n")
    (tmp_path / "ltlc").chmod(0o755)
    seen = started(installed, tmp_path / "props.ltlc", "activated", path="./ltlc")
    *_, message = (each["message"] for each in seen if "message" in each)
    assert "`./ltlc lsp` does not start: pygls is missing. " in message
