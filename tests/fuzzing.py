"""Input of all kinds for the command line, and what a run of it shows: `benchmarks/fuzz.py` looks for what breaks."""

from __future__ import annotations

import contextlib
import importlib
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from io import BytesIO, StringIO, TextIOWrapper
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import seed as seeded
from hypothesis import strategies as st
from quick_gate import quick_gate

from ltlc.base.limits import Budget, Exceeded, run_all
from ltlc.cli import TRACEBACK, main
from ltlc.interfaces.commands.parser import COMMANDS, module_of

FIXTURES = Path(__file__).parent / "fixtures"
BROKEN = FIXTURES / "fuzz"
"""A folder for each input that broke something once: its files, and `arguments`, one a line."""

BUDGET = Budget(60, 2048)
LIMIT = "--budget=2,512"


@dataclass(frozen=True)
class Case:
    """A command line and the files that it names."""

    arguments: tuple[str, ...]
    files: tuple[tuple[str, bytes], ...] = ()

    def save(self, folder: Path) -> None:
        """Write the case into `folder`."""
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "arguments").write_text("\n".join(self.arguments), encoding="utf-8", errors="surrogateescape")
        _write(folder, self.files)


def _write(folder: Path, files: Sequence[tuple[str, bytes]]) -> None:
    for name, content in files:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(content)


def saved(folder: Path) -> Case:
    """The case that `save` wrote into `folder`."""
    arguments = (folder / "arguments").read_text(encoding="utf-8", errors="surrogateescape").split("\n")
    paths = [path for path in sorted(folder.rglob("*")) if path.is_file() and path.name != "arguments"]
    files = [(path.relative_to(folder).as_posix(), path.read_bytes()) for path in paths]
    return Case(tuple(arguments), tuple(files))


_NEEDED = (
    "ltlc.analysis.analyse",
    "ltlc.assurance.gate",
    "ltlc.automata.spot_translation",
    "ltlc.interfaces.api.compare",
    "ltlc.monitoring.judging.run",
)


@cache
def _prepare() -> None:
    """Import what commands import when they are called, so that not every child does."""
    for command in COMMANDS:
        module_of(command)
    for module in _NEEDED:
        importlib.import_module(module)


def broken_by(
    case: Case, look: Callable[[Sequence[str]], str | None] | None = None, budget: Budget = BUDGET
) -> str | None:
    """What `case` breaks: what `look` says of its arguments, or a limit; None if it is handled as it should.

    It is run in a folder and a process of its own, with `budget`.
    """
    _prepare()
    folder = Path(tempfile.mkdtemp(prefix="fuzz"))
    try:
        _write(folder, case.files)
        [outcome] = run_all([partial(_looked, look or _meaningless, case.arguments, folder)], budget)
    finally:
        shutil.rmtree(folder)
    return str(outcome) if isinstance(outcome, Exceeded) else outcome


def _looked(look: Callable[[Sequence[str]], str | None], arguments: Sequence[str], folder: Path) -> str | None:
    """With the recursion limit that users have, nothing on standard input, and tracebacks of bugs."""
    sys.setrecursionlimit(1000)
    sys.stdin = TextIOWrapper(BytesIO())
    os.environ[TRACEBACK] = "1"
    with contextlib.chdir(folder):
        return look(arguments)


def _meaningless(arguments: Sequence[str]) -> str | None:
    """A traceback, an exit code that means nothing, or one without a word."""
    code, output, errors = printed(arguments)
    if "Traceback" in errors:
        return errors
    if code not in (0, 1, 2, 3):
        return f"exit code {code}"
    return None if code == 0 or output or errors else f"exit code {code} without a word"


def printed(arguments: Sequence[str]) -> tuple[object, str, str]:
    """The exit code of a command, and what it prints."""
    output, errors = StringIO(), StringIO()
    code: object
    try:
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            code = main(arguments)
    except SystemExit as exit_:
        code = exit_.code
    return code, output.getvalue(), errors.getvalue()


SPECIFICATIONS = sorted([*FIXTURES.glob("*/*.txt"), *(FIXTURES.parents[1] / "examples").glob("**/*.txt")])

PROPERTIES = """decl x /x Float64.data
decl b /b Bool.data
decl m /m String.data
decl s /scan LaserScan.ranges
_rate_ = 10
low: never x > 5
stop: after_until x < 1, x > 2, eventually x == 0
never b and m == "go"
min(s) > 0.3 and x - @{x, -1} < 2
limit = 0.5 s
always (b implies eventually x < 1 within limit) and age(s) <= 200 ms
after historically b for 2 s, within 1 min, eventually (x > 1 since new m)
"""
CSV = 'time,x,b,m,s\n0,1,true,go,"[1, 2]"\n0.5,,false,"a, b",\n1.25,-3e2,1,,"[NaN, 1e400]"\n2,inf,0,stop,[]\n'
JSONL = (
    '{"time": 0, "x": 1, "b": true, "m": "go", "s": [1, 2]}\n'
    '{"time": 0.5, "x": null, "b": 0}\n\n'
    '{"time": 1.25, "x": "inf", "m": "stop", "s": ["nan", 3]}\n'
)
ENCODINGS = """# mine
encoding patient
after X, Z          = G(X -> G Z)
until X, Z          = Z U X
after_until X, Y, Z = G((X & !Y & F Y) -> rel(Y, next(Z) | weak_next(Z)))
bare
"""
FORMULAS = "name\tone\ttwo\n# a comment\nresponse\tG(p -> F q)\tG(!p | X[!] F q)\nabsence\t-\tG !p W q M r R s\n"

_WORDS = (
    "forall in {x}_b r {r}_x within for once historically previously since initially new age( 5 0.5ns 2 ms us min h "
    "always never eventually after until after_until and or not implies decl model object robot position velocity "
    "orientation distance _rate_ _timeout_ _margin_ _simulator_ true false min max abs sqrt slope encoding bare rel "
    "next weak_next property assumption dead witness loop remains subject formula nan inf -inf 1e308 1e-320 -0.0 0 1 "
    "1e400 99999999999999999999 time x b m s { } [ ] ( ) @{ , ; : = == != < <= > >= =={0.1} + - * / # \" ' \\ \t \n \r "
    "\0 \ufeff \u202e ö 𝒳 & | ! -> <-> X U W R M F G X[!] q0 p1 f2 a3 d4"
)
WORDS = tuple(_WORDS.split(" "))


@cache
def _seeds(kind: str) -> tuple[str, ...]:
    """Texts to begin with."""
    match kind:
        case "specification":
            return (PROPERTIES, *(path.read_text(encoding="utf-8") for path in SPECIFICATIONS))
        case "certificate":
            return tuple(_certificates())
        case _:
            return ({"csv": CSV, "jsonl": JSONL, "encodings": ENCODINGS, "formulas": FORMULAS}[kind],)


def _certificates() -> Iterator[str]:
    """The certificates that a build of `PROPERTIES` writes."""
    with tempfile.TemporaryDirectory(prefix="fuzz") as folder, contextlib.chdir(folder):
        Path("props.txt").write_text(PROPERTIES, encoding="utf-8")
        with quick_gate(), contextlib.redirect_stdout(StringIO()), contextlib.redirect_stderr(StringIO()):
            code = main(
                ["build", "props.txt", "--target", "json", "-o", "monitor", "--certificate", "proof", "--budget=1,512"]
            )
        assert code == 0
        yield Path("proof").read_text(encoding="utf-8")


@st.composite
def texts(draw: st.DrawFn, kind: str) -> bytes:
    """A text of this kind with some things changed, or any bytes."""
    if draw(st.integers(0, 30)) == 0:
        return draw(st.binary(max_size=200))
    text = draw(st.sampled_from(_seeds(kind)))
    for _ in range(draw(st.integers(0, 4))):
        text = draw(_changed(text))
    return text.encode("utf-8", "replace")


@st.composite
def _changed(draw: st.DrawFn, text: str) -> str:
    """`text` with a part of it left out, written many times, moved, or replaced by words."""
    start = draw(st.integers(0, len(text)))
    end = min(len(text), start + draw(st.one_of(st.integers(0, 8), st.integers(0, len(text)))))
    part = text[start:end]
    match draw(st.integers(0, 4)):
        case 0:
            part = ""
        case 1:
            part *= draw(st.sampled_from([2, 3, 20, 300, 20_000])) if len(part) < 40 else 2
        case 2:
            part = draw(st.sampled_from(WORDS)) * draw(st.sampled_from([1, 1, 1, 2, 200, 20_000]))
        case 3:
            part = " ".join(draw(st.lists(st.sampled_from(WORDS), max_size=12)))
        case _:
            part = draw(st.text(max_size=5))
            start = end
    return text[:start] + part + text[end:]


@st.composite
def about_specifications(draw: st.DrawFn) -> Case:
    """A specification, with every command that takes one."""
    files = (("props.txt", draw(texts("specification"))), ("run.csv", CSV.encode()))
    target = draw(st.sampled_from(["ros2", "python", "hoa", "dot", "json"]))
    command = draw(
        st.sampled_from(
            [
                ("check", "props.txt", LIMIT, "--format", draw(st.sampled_from(["full", "concise", "json", "sarif"]))),
                ("check", "props.txt", LIMIT, draw(st.sampled_from(["--fix", "--diff"]))),
                ("build", "props.txt", LIMIT, "--target", target, "--certificate", "proof", "-o", "out"),
                ("run", "props.txt", "run.csv", LIMIT),
                ("mine", "props.txt", "run.csv", LIMIT),
                ("explain", "props.txt", LIMIT),
                ("format", "props.txt", "--diff"),
                ("compare", "props.txt", LIMIT, "--recording", "run.csv"),
            ]
        )
    )
    encoding = (
        ()
        if command[0] in ("compare", "mine", "format")
        else draw(st.sampled_from([(), ("--encoding", "pointwise-strong")]))
    )
    return Case((*command, *encoding), files)


def _recordings(kind: str) -> st.SearchStrategy[Case]:
    forms = st.sampled_from([("--format", "text"), ("--format", "json", "--verdicts"), ("--format", "junit")])
    rates = st.sampled_from(["_rate_ = 10\n", "", "_timeout_ = 1.5\n", "_rate_ = 10000\n", "_rate_ = 1e-300\n"])

    def case(content: bytes, form: tuple[str, ...], rate: str) -> Case:
        properties = PROPERTIES.replace("_rate_ = 10\n", rate).encode()
        return Case(("run", "props.txt", f"run.{kind}", *form), (("props.txt", properties), (f"run.{kind}", content)))

    return st.builds(case, texts(kind), forms, rates)


def _certified(content: bytes) -> Case:
    return Case(("certify", "props.txt", "proof"), (("props.txt", PROPERTIES.encode()), ("proof", content)))


def _encoded(content: bytes, form: str) -> Case:
    properties = b"decl x /x Float64.data\nafter_until x < 1, x > 2, (after x > 3, eventually x == 0)\n"
    arguments = ("compare", "props.txt", LIMIT, "--encoding-file", "mine.txt", "--format", form)
    return Case(arguments, (("props.txt", properties), ("mine.txt", content)))


def _of_formulas(content: bytes, option: str, form: str) -> Case:
    """Of a few formulas: every pair of them is a question with a budget of its own."""
    content = b"\n".join(b"\t".join(line.split(b"\t")[:5]) for line in content.split(b"\n")[:6])
    return Case(("compare", option, "formulas.txt", LIMIT, "--format", form), (("formulas.txt", content),))


_FORMS = st.sampled_from(["text", "json", "csv", "md", "html"])
_OPTIONS = (
    "props.txt run.csv - . / /dev/null none.txt --format json junit sarif --target hoa dot -o out --certificate proof "
    "--budget 1 1,64 0 nan 1e999 -1 --encoding dwyer --encodings episode,,dwyer --ltl Gp (( --corpus random --count 3 "
    "--seed 1 --msg-path --strict --verdicts --reading finite --recording LTL101 101 --version --help --"
)
_ARGUMENTS = st.one_of(
    st.sampled_from(_OPTIONS.split()),
    st.text(st.characters(exclude_characters="\0\n"), max_size=6),
)


def _of_arguments(command: str, arguments: Sequence[str]) -> Case:
    return Case((command, *arguments), (("props.txt", PROPERTIES.encode()), ("run.csv", CSV.encode())))


def drawn(strategy: st.SearchStrategy[Case], count: int, seed: int | None = None) -> list[Case]:
    """Some cases, to be run outside of hypothesis, since the gate uses it too, as do the first certificates."""
    _seeds("certificate")
    cases = []

    @settings(max_examples=count, database=None, phases=[Phase.generate], suppress_health_check=list(HealthCheck))
    @given(strategy)
    def note(case: Case) -> None:
        cases.append(case)

    (note if seed is None else seeded(seed)(note))()
    return cases


TARGETS: dict[str, st.SearchStrategy[Case]] = {
    "specification": about_specifications(),
    "csv": _recordings("csv"),
    "jsonl": _recordings("jsonl"),
    "certificate": st.builds(_certified, texts("certificate")),
    "encodings": st.builds(_encoded, texts("encodings"), _FORMS),
    "formulas": st.builds(_of_formulas, texts("formulas"), st.sampled_from(["--ltl-file", "--corpus"]), _FORMS),
    "arguments": st.builds(
        _of_arguments, st.sampled_from(sorted(COMMANDS.keys() - {"serve"})), st.lists(_ARGUMENTS, max_size=5)
    ),
}
"""What is made up, and how; `serve` ends when it is told to."""
