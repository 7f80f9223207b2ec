"""`ltlc certify --code`: a file is accepted if it is what ltlc emits for certified monitors, and steps as they do."""

from __future__ import annotations

import random
import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from effort import share_of
from emitted_mutants import bare, c_mutants, python_mutants
from quick_gate import quick_gate

from ltlc import cli
from ltlc.assurance.afresh import c, packages, python
from ltlc.assurance.afresh.files import code_at, compared
from ltlc.assurance.afresh.outcomes import Equal, Unequal
from ltlc.assurance.reading.c.parsing import parsed
from ltlc.backends import emit
from ltlc.base.revision import commit_text

PROPERTIES = """\
decl d /d Float32.data
decl v /v Float64.data
decl j /j Float64.data
near: never (d < 1 and v > 2)
answered: always (v > 1 implies eventually d < 2 within 3 s)
past: always (abs(v - @{v, -2}) < 5 or age(j) <= 2 s)
"""
GROUPED = "int f(int a, int b, int c)"
FILES = {"python": "code.py", "ros2": "node.py", "c": "code.c", "ament": "pkg"}


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what `ltlc build` makes of PROPERTIES for each target, and with their certificates."""
    folder = tmp_path_factory.mktemp("built")
    (folder / "props.txt").write_text(PROPERTIES)
    for target, name in FILES.items():
        options = ["--target", target, "-o", str(folder / name), "--certificate", str(folder / "props.cert"), "-q"]
        with quick_gate():
            assert cli.main(["build", str(folder / "props.txt"), *options]) == 0
    return folder


@dataclass
class Certify:
    """Copies of what was built, to be changed and certified."""

    folder: Path
    capsys: pytest.CaptureFixture[str]

    def __call__(self, name: str, *options: str) -> tuple[int, str]:
        self.capsys.readouterr()
        files = (str(self.folder / each) for each in ("props.txt", "props.cert", name))
        properties, certificate, code = files
        exit_code = cli.main(["certify", properties, certificate, "--code", code, *options])
        shown = self.capsys.readouterr()
        return exit_code, shown.out + shown.err

    def changed(self, name: str, right: str, wrong: str) -> tuple[int, str]:
        """What is said of the file or package `name` after a change in the one file that has `right`."""
        path = self.folder / name
        paths = [each for each in path.rglob("*") if each.is_file()] if path.is_dir() else [path]
        (path,) = [each for each in paths if right in each.read_text()]
        path.write_text(path.read_text().replace(right, wrong, 1))
        return self(name)


@pytest.fixture
def certify(built: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Certify:
    shutil.copytree(built, tmp_path / "copy")
    return Certify(tmp_path / "copy", capsys)


@pytest.mark.parametrize("name", FILES.values())
def test_what_was_built_is_accepted_and_each_function_is_said_to_be_compared(certify: Certify, name: str) -> None:
    exit_code, shown = certify(name)
    assert exit_code == 0
    assert "equal, " in shown
    assert "near: its steps, read back, match the certified monitor" in shown
    assert {"code.c": "judge, hold", "code.py": "Near.__init__, Near.step"}.get(name, "Session.") in shown


def refusal(built: Path, name: str, right: str, wrong: str) -> str:
    """What comparing says of a change in the one file, or that of a package, that has `right`, if that is refused."""
    code = code_at(built / name)
    changed = next((each for each, text in code.texts.items() if right in text), None)
    assert changed is not None, (name, right)
    beside = {changed, *code.texts} if code.target == "c" else {changed}
    texts = {each: code.texts[each] for each in code.texts if each in beside}
    found = compared(replace(code, texts={**texts, changed: texts[changed].replace(right, wrong, 1)}), texts)
    return "\n".join(outcome.at(each) for each, outcome in found if isinstance(outcome, Unequal))


CHANGES = {
    "nothing is judged": ("code.c", "    judge(monitors, time, samples);\n", "", "in `code_step`"),
    "no clock step": ("code.c", "    hold(monitors, time);\n", "", "in `pass`"),
    "guard of time": ("code.c", "time < monitors->time", "time <= monitors->time", "in `pass`"),
    "since": ("code.c", "self->since = time;", "", "in `"),
    "another verdict": ("code.c", "verdict)monitors->answered", "verdict)monitors->near", "in `code_verdict_of`"),
    "a swapped sample": ("code.c", "= samples->d;", "= samples->v;", "in `judge`"),
    "a header": ("code.h", "float d;", "double d;", "code.h:"),
    "a header for C++": ("code.hpp", "return code_step(", "return !code_step(", "code.hpp:"),
    "trigraphs": ("code.c", "#include <float.h>", "#include <float.h> // ??/", "code.c:"),
    "a line that goes on": ("code.c", "#include <float.h>", "#include <float.h> // \\ ", "code.c:"),
    "a lone carriage return": (
        "code.c",
        "    hold(monitors, time);",
        "// \r    hold(monitors, time);",
        "carriage return",
    ),
    "no NaN": ("node.py", "if not d <= INFINITY", "if False", "in `"),
    "another field": ("node.py", "(message.data,)", "(message.layout,)", "in `"),
    "the session": ("node.py", "signals.SIGINT, signals.SIGTERM", "signals.SIGINT,", "node.py:"),
    "another name": ("node.py", '"props_monitor",', '"other_monitor",', "in `monitor`"),
    "another encoding": ("node.py", '"""A ROS', '# coding: utf-7\n"""A ROS', "utf-7"),
    "another specification": ("node.py", '"sha256": "', '"sha256": "0', "node.py:"),
    "another specification of a package": ("pkg", '"sha256": "', '"sha256": "0', "properties.py:"),
    "code in the place of a commit": ("node.py", '"commit": ', '"commit": exit() or ', "node.py:"),
    "a relation": ("code.py", "d < 1.0", "d <= 1.0", "in `Near.step`"),
    "of a package": ("pkg", "d < 1.0", "d <= 1.0", "in `Near.step`"),
    "what starts it": ("pkg", "(signal.SIGINT, signal.SIGTERM)", "(signal.SIGTERM,)", "in `main`"),
    "its parameters": ("pkg", "on_violation: continue", "on_violation: end", "config/"),
    "what it depends on": ("pkg", "<exec_depend>rclpy</exec_depend>", "", "package.xml:"),
    "its properties": ("pkg", "decl d /d Float32.data", "decl d /e Float32.data", "properties.txt:1"),
}


@pytest.mark.parametrize(("name", "right", "wrong", "said"), CHANGES.values(), ids=CHANGES)
def test_a_changed_file_is_refused_with_the_place_of_the_change(
    built: Path, name: str, right: str, wrong: str, said: str
) -> None:
    assert said in refusal(built, name, right, wrong)


@pytest.mark.parametrize("change", ["nothing is judged", "another field", "a relation", "what starts it"])
def test_of_a_changed_file_nothing_is_read_back(certify: Certify, change: str) -> None:
    name, right, wrong, said = CHANGES[change]
    exit_code, shown = certify.changed(name, right, wrong)
    assert exit_code == 1
    assert said in shown
    assert "nothing was read back" in shown


C_CHANGES = (
    # a statement that is missing, or there twice
    ("    monitors->signals.new_j = samples->new_j;\n", ""),
    ("    monitors->has_session = true;\n", ""),
    ("    monitors->time = time;\n", ""),
    ("        self->invalid++;\n", ""),
    ("    self->apart++;\n", "    self->apart++;\n    self->apart++;\n"),
    ("    self->held_0 = value < 5.0;\n", ""),
    ("        signals->v[signals->v_latest] = samples->v;\n", ""),
    ("            signals->v_count++;\n", ""),
    ("    monitors->answered.due = CODE_NEVER;\n", ""),
    ("        answered_expire(&monitors->answered);\n", ""),
    ("    first_steps(monitors, time);\n", ""),
    # an operator
    ("v > 2.0", "v >= 2.0"),
    ("d >= 2.0f", "d > 2.0f"),
    ("v > 1.0 && d", "v > 1.0 || d"),
    ("while (time > monitors->answered.due)", "while (time >= monitors->answered.due)"),
    ("while (time > monitors->past.due)", "if (time > monitors->past.due)"),
    ("ago <= latest", "ago < latest"),
    ("latest + depth - ago", "latest + depth + ago"),
    ("|| signals->d != signals->d", "&& signals->d != signals->d"),
    ("signals->has_started && all", "signals->has_started || all"),
    ("if (monitors->has_session)", "if (!monitors->has_session)"),
    ("if (!pass(monitors, time))", "if (pass(monitors, time))"),
    # an operand
    ("near_step(&monitors->near, time, signals->d", "near_step(&monitors->near, time, signals->v[0]"),
    ("const int64_t time = self->due + 1;", "const int64_t time = self->due;"),
    ("past(signals->v_latest, 2u, 3u)", "past(signals->v_latest, 1u, 3u)"),
    ("next = monitors->answered.due + 1;", "next = monitors->past.due + 1;"),
    ("return monitors->near.invalid;", "return monitors->near.apart;"),
    ("return monitors->answered.since;", "return monitors->near.since;"),
    ("monitors->answered.verdict != CODE_NOT_STARTED", "monitors->near.verdict != CODE_NOT_STARTED"),
    # a constant
    ("self->state = 2;", "self->state = 1;"),
    ("INT64_C(3000000000)", "INT64_C(3000000001)"),
    ("monitors->time = INT64_MIN;", "monitors->time = 0;"),
    ("d < 1.0f", "d < 1.0"),
    ("signals->v_count >= 3u", "signals->v_count >= 2u"),
    ("CODE_PRESUMABLY_VIOLATED;", "CODE_PRESUMABLY_SATISFIED;"),
    ("together ? 1u : 0u", "together ? 0u : 1u"),
    # a parenthesis
    ("!(samples->has_v || samples->has_d)", "!samples->has_v || samples->has_d"),
    ("time <= -CODE_NEVER || time >= CODE_NEVER", "(time <= -CODE_NEVER || time) >= CODE_NEVER"),
    # what is said to the preprocessor
    ("#include <math.h>\n", "#include <math.h>\n#define fabs(x) (x)\n"),
    ("__FINITE_MATH_ONLY__ != 0", "__FINITE_MATH_ONLY__ != 1"),
)
PYTHON_CHANGES = (
    ("            self.invalid += 1\n", ""),
    ("                self.verdict = VIOLATED\n", ""),
    ("        self._v.append(v)\n", ""),
    ("        if type(v) is not float:\n            v = number(v)\n", ""),
    ("                self.due = time + 3_000_000_000\n", ""),
    ("while time > self.due:", "if time > self.due:"),
    ("v > 2.0", "not v > 2.0"),
    ("d < 1.0 and v > 2.0", "d < 1.0 or v > 2.0"),
    ("not d <= INFINITY or not v <= INFINITY", "not d <= INFINITY and not v <= INFINITY"),
    ("not d <= INFINITY or not v <= INFINITY", "not (d <= INFINITY or not v <= INFINITY)"),
    ("time + 3_000_000_000", "time - 3_000_000_000"),
    ("v_2_ago = self._v[-3]", "v_2_ago = self._v[-2]"),
    ("value = abs(v - v_2_ago)", "value = abs(v) - v_2_ago"),
    ("len(self._v) < 3", "len(self._v) < 2"),
    ("self.answered.step(time, v, d)", "self.answered.step(time, d, v)"),
    ("self.state = 2", "self.state = 0"),
    ("self.invalid += 1", "self.invalid = 1"),
    ("deque(maxlen=3)", "deque(maxlen=2)"),
    ('"near": self.near.verdict', '"near": self.answered.verdict'),
    ("return math.inf if value > 0 else -math.inf", "return -math.inf if value > 0 else math.inf"),
)
NODE_CHANGES = (
    ("self.due = NEVER", "self.due = time"),
    ('Input("v", 2)', 'Input("v", 1)'),
    ('Reading("d", "/d", "number")', 'Reading("d", "/v", "number")'),
    ("monitor=Answered,", "monitor=Near,"),
    ("decisions=((0, 0, -2), (1, 0, 1)),", "decisions=((0, 0, -2), (1, 1, 0)),"),
    ('Age("j", "due_0", 2000000000)', 'Age("j", "due_0", 200000000)'),
    ("                timed=True,\n", ""),
    ('"std_msgs/msg/Float32", read_d', '"std_msgs/msg/Float32", read_v'),
    ("return guarded(monitor)", "return 0"),
    ("        import_ros,\n", "        lambda: None,\n"),
    ("sys.exit(main())", "main()"),
)
PACKAGE_CHANGES = (
    ("monitor=Past,", "monitor=Answered,"),
    ('Topic("/j",', 'Topic("/v",'),
    ("props_monitor = props_monitor.node:main", "props_monitor = props_monitor.node:monitor"),
    ('packages=find_packages(exclude=["test"])', "packages=[]"),
    ("script_dir=$base/lib/props_monitor", "script_dir=$base/bin"),
    ('<remap from="/d" to="$(var robot)/d"/>', '<remap from="/d" to="$(var robot)/v"/>'),
    ('<param from="$(var parameters)"/>', ""),
    ("<build_type>ament_python</build_type>", "<build_type>ament_cmake</build_type>"),
    ('jsonl: ""', 'jsonl: "x"'),
    ("near: never (d < 1 and v > 2)", "near: never (d < 1 and v > 3)"),
)


def test_none_of_seventy_changed_files_is_accepted(built: Path) -> None:
    """Compared as `certify --code` does: a statement, operator, operand, parenthesis or constant is another."""
    tables = {"code.c": C_CHANGES, "code.py": PYTHON_CHANGES, "node.py": NODE_CHANGES, "pkg": PACKAGE_CHANGES}
    changes = [(name, *change) for name, table in tables.items() for change in table]
    assert len(set(changes)) >= 70
    for name, right, wrong in random.Random(2).sample(changes, share_of(len(changes))):
        assert refusal(built, name, right, wrong) != "", (name, right, wrong)


@pytest.mark.parametrize(
    ("name", "right", "other"),
    [
        ("code.py", "import math", "# nothing\nimport math  # else"),
        ("code.py", "d < 1.0 and v > 2.0", "((d < 1.0)\n and (v > 2.0))"),
        ("code.py", '"""Judge one more step', '"""Something'),
        ("code.c", "    hold(monitors, time);", "/* x */ hold ( monitors,\n time ) ; // y"),
        ("code.c", "d < 1.0f && v > 2.0", "(d < 1.0f) && ((v > 2.0))"),
        ("pkg", "on_violation: continue", "on_violation: continue # x"),
        ("pkg", "<license>TODO: licence</license>", "<license>MIT</license>"),
    ],
)
def test_blanks_comments_redundant_parentheses_and_what_a_person_fills_in_make_no_difference(
    certify: Certify, name: str, right: str, other: str
) -> None:
    exit_code, shown = certify.changed(name, right, other)
    assert exit_code == 0, shown


@pytest.mark.parametrize("name", ["node.py", "pkg"])
def test_what_another_commit_has_made_is_accepted_if_it_is_the_same(certify: Certify, name: str) -> None:
    own = f'"commit": "{commit_text()}"' if commit_text() else '"commit": None'
    assert certify.changed(name, own, '"commit": "0123456789ab"')[0] == 0


def test_c_whose_parentheses_make_something_else_is_refused(certify: Certify) -> None:
    assert certify.changed("code.c", "time < monitors->time", "(time < monitors)->time")[0] == 1


def test_a_step_that_is_not_the_monitor_is_refused_even_if_ltlc_emits_it(
    certify: Certify, monkeypatch: pytest.MonkeyPatch
) -> None:
    from ltlc.assurance.afresh import files

    monkeypatch.setattr(files, "emit", lambda *given: emit(*given).replace("d < 1.0", "d <= 1.0"))
    exit_code, shown = certify.changed("code.py", "d < 1.0", "d <= 1.0")
    assert exit_code == 1
    assert "equal, as a tree" in shown
    assert "near: its steps do NOT match the monitor: " in shown


def test_a_file_of_another_version_is_said_to_be_one(certify: Certify) -> None:
    path = certify.folder / "code.py"
    text = path.read_text().replace("made by ltlc 1", "made by ltlc 9", 1)
    path.write_text(text.replace("d < 1.0", "1.0 > d"))
    exit_code, shown = certify("code.py")
    assert exit_code == 1
    assert "made by ltlc 9" in shown


def test_a_file_is_compared_wherever_its_specification_stands_and_whatever_it_is_called(certify: Certify) -> None:
    other = certify.folder / "moved" / "other.txt"
    other.parent.mkdir()
    other.write_text(PROPERTIES)
    certificate = str(certify.folder / "props.cert")
    for name in FILES.values():
        assert cli.main(["certify", str(other), certificate, "--code", str(certify.folder / name)]) == 0


def test_code_that_a_package_does_not_have_is_refused_and_other_files_are_named(certify: Certify) -> None:
    (certify.folder / "pkg/notes.dat").write_bytes(b"\xff")
    (certify.folder / "pkg/test/recordings/drive.mcap").write_bytes(b"\xff")
    exit_code, shown = certify("pkg")
    assert exit_code == 0
    assert "notes.dat" in shown
    (certify.folder / "pkg/math.py").write_text("")
    exit_code, shown = certify("pkg")
    assert exit_code == 1
    assert "math.py: ltlc emits no such file" in shown


def test_many_runs_to_be_replayed_are_no_reason_to_refuse_a_package(certify: Certify) -> None:
    runs = certify.folder / "pkg/test/runs.json"
    runs.write_text(runs.read_text() + " " * 10**6)
    assert certify("pkg")[0] == 0


HOSTILE: dict[str, tuple[str, str, Callable[[], str]]] = {
    "parentheses": ("code.c", "d < 1.0f", lambda: "(" * 30_000 + "d < 1.0f" + ")" * 30_000),
    "some parentheses": ("code.c", "d < 1.0f", lambda: "(" * 400 + "d < 1.0f" + ")" * 400),
    "minus signs": ("code.c", "> 2.0", lambda: "> " + "- " * 40_000 + "2.0"),
    "comments": ("code.c", "    hold(monitors", lambda: "/* " * 30_000 + "    hold(monitors"),
    "quotes": ("code.c", "    hold(monitors", lambda: '"\\' * 40_000 + "    hold(monitors"),
    "size": ("code.c", "    hold(monitors", lambda: " " * 10**7 + "    hold(monitors"),
    "minus signs in Python": ("code.py", "> 2.0", lambda: "> " + "-" * 100_000 + "2.0"),
    "parentheses in Python": ("code.py", "d < 1.0", lambda: "(" * 30_000 + "d < 1.0" + ")" * 30_000),
    "sums in Python": ("code.py", "v > 2.0", lambda: "v > " + "1+" * 40_000 + "2.0"),
    "branches in Python": ("code.py", "VIOLATED", lambda: "VIOLATED if 1 else " * 4_000 + "VIOLATED"),
    "a NUL in Python": ("code.py", "VIOLATED", lambda: "\0"),
}


@pytest.mark.parametrize(("name", "right", "wrong"), HOSTILE.values(), ids=HOSTILE)
def test_a_hostile_file_is_refused_at_once(built: Path, name: str, right: str, wrong: Callable[[], str]) -> None:
    begin = time.process_time()
    assert refusal(built, name, right, wrong()) != ""
    assert time.process_time() - begin < 10, "what is not bounded took minutes"


@pytest.mark.parametrize("content", [None, b"\xff", b"<package/>"])
def test_what_is_no_code_is_unusable(certify: Certify, content: bytes | None) -> None:
    folder = certify.folder / "none"
    folder.mkdir()
    if content is not None:
        (folder / "package.xml").write_bytes(content)
    assert certify("none")[0] == 2
    assert certify("nowhere.py")[0] == 2


def sample(mutants: Iterator[str], count: int) -> Sequence[str]:
    """Some of many, spread over all of them."""
    found = list(mutants)
    return random.Random(0).sample(found, min(count, len(found)))


@pytest.mark.parametrize("name", ["code.py", "node.py"])
def test_python_is_equal_exactly_if_its_tree_is(built: Path, name: str) -> None:
    text = (built / name).read_text()
    right = bare(text)
    for mutant in python_mutants(text, 0.05 if name == "code.py" else 0.0001):
        assert isinstance(python.compare(mutant, text), Equal) == (bare(mutant) == right), mutant


def test_every_change_of_a_token_of_c_is_refused(built: Path) -> None:
    header, source = ((built / f"code{suffix}").read_text() for suffix in (".h", ".c"))
    types = parsed(header).types
    for mutant in sample((m for m in c_mutants(source) if m.split() != source.split()), 60):
        is_regrouped = sorted(mutant.replace("(", "").replace(")", "").split()) == sorted(
            source.replace("(", "").replace(")", "").split()
        )
        assert isinstance(c.compare(mutant, source, types), Unequal) or is_regrouped, mutant


@pytest.mark.parametrize("group", ["(a - b) - c", "((a)) - b - c", "(a - b - c) != a", "(a - b - c != a && b != c) ||"])
def test_redundant_parentheses_of_c_make_no_difference(group: str) -> None:
    right = f"{GROUPED} {{ return a - b - c != a && b != c || !a; }}"
    changed = right.replace(group.replace("(", "").replace(")", ""), group)
    assert changed != right
    assert isinstance(c.compare(changed, right), Equal)


@pytest.mark.parametrize("group", ["a - (b - c)", "a != (a && b != c)", "(a && b != c || !a)", "b != (c || !a)"])
def test_parentheses_of_c_that_make_another_tree_are_refused(group: str) -> None:
    emitted = f"{GROUPED} {{ return a - b - c != a && b != c || !a && a != a && b != c; }}"
    changed = emitted.replace(group.replace("(", "").replace(")", ""), group)
    assert changed != emitted
    assert isinstance(c.compare(changed, emitted), Unequal)


def test_tokens_are_taken_apart_as_a_compiler_does() -> None:
    body = "void f(int a, int b) {{ {} }}"
    for found, emitted in (
        (body.format("- -a;"), body.format("--a;")),
        (body.format("a < = b;"), body.format("a <= b;")),
        (body.format('L "a";'), body.format('L"a";')),
        ("#if a\nb\n", "#if a b\n"),
        ("int a;\n#define b\n", "#define b\nint a;\n"),
    ):
        assert isinstance(c.compare(found, emitted), Unequal)


def test_literals_of_macros_have_no_further_parentheses() -> None:
    right = "long f(void) { return INT64_C(3); }\n"
    for other in ("INT64_C((3))", "(INT64_C)(3)"):
        assert isinstance(c.compare(right.replace("INT64_C(3)", other), right), Unequal)


def test_what_stands_in_xml_and_yaml_is_compared_and_comments_are_not() -> None:
    assert isinstance(packages.compare("a.xml", "<a>\n<!-- x\n y -->\n</a>", "<a>\n</a>"), Equal)
    assert isinstance(packages.compare("a.yaml", "a:\n  b: 1\n# c: 2\n", "a:\n  b: 1\n"), Equal)
    other: Any = packages.compare("a.yaml", "a:\nb: 1\n", "a:\n  b: 1\n")
    assert (other.line, other.reason) == (1, "`a:` where ltlc emits `b: 1`")
    for name, text in (("a.xml", "<a>"), ("a.xml", "<!DOCTYPE a><a/>"), ("a.yaml", "a: ["), ("a.cfg", "x")):
        assert "cannot be read" in str(packages.compare(name, text, "<a/>" if name == "a.xml" else ""))
    assert isinstance(packages.compare("a.cfg", "[a]\nb=1\n", "# x\n[a]\n\nb = 1\n"), Equal)
    assert isinstance(packages.compare("a.cfg", "[a]\nb=2\n", "[a]\nb=1\n"), Unequal)
