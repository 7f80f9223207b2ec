"""Changes of emitted C that reading it back has to refuse, and whether one alters a verdict of some run."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

from support import signal

from ltlc.assurance.c_library import Library, compiler
from ltlc.assurance.library import CompilerError
from ltlc.assurance.reading.c.files import written
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.backends.c import Files
from ltlc.base.limits import Budget, Exceeded, run_all
from ltlc.compiler import Compiled
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Signal
from ltlc.specification.specification import Specification

VERDICTS = ("VIOLATED", "PRESUMABLY_VIOLATED", "PRESUMABLY_SATISFIED", "SATISFIED", "NOT_STARTED")
_RELATIONS = ("<", "<=", ">", ">=", "==", "!=")

Run = Sequence[tuple[int, dict[Signal, Value], Sequence[str]]]
"""Times with the samples that come at them, and the topics on which a message has come; without either, time passes."""


Change = Callable[[re.Match[str], random.Random], str]
"""What is written instead of a match."""


def read_back(
    files: Files, compiled: Sequence[Compiled], whole: Specification | None = None
) -> list[ReadBack | Difference]:
    """What reading `files` back says of each property; `whole` has a rate or a timeout."""
    settings = (None, None) if whole is None else (whole.rate, whole.timeout)
    parts = written(files.header, files.source, compiled, *settings)
    return [part if isinstance(part, Difference) else part.read_back() for part in parts]


def with_source(files: Files, source: str) -> Files:
    return replace(files, source=source)


def verdicts_of(files: Files, runs: Sequence[Run]) -> list[list[tuple[int, int]]] | Exceeded | None:
    """The verdicts and invalid steps of all properties after each entry of each run; None if it does not compile.

    A change can make an endless loop of clock steps, so they are run in a child, whose limit is what it then gives.
    """
    [found] = run_all([partial(_verdicts, files, runs)], Budget(10, 1024))
    return found


def _verdicts(files: Files, runs: Sequence[Run]) -> list[list[tuple[int, int]]] | None:
    path = compiler()
    assert path is not None
    try:
        library = Library(files, path)
    except CompilerError:
        return None
    found = []
    for run in runs:
        monitors, shown = library.monitors(), []
        for time, sample, topics in run:
            _ = monitors.step(time, sample, topics) if sample or topics else monitors.advance(time)
            for number in range(len(files.properties)):
                verdict, _, invalid, _ = monitors.show(number)
                shown.append((verdict, invalid))
        found.append(shown)
    return found


def runs_of(drawn: Sequence[dict[Signal, Value]], count: int, chance: random.Random) -> list[Run]:
    """Runs in which some of the samples come, now and then all of one of those that were `drawn`."""

    def sample() -> dict[Signal, Value]:
        whole, share = chance.choice(drawn), chance.choice([0.5, 1.0])
        return {signal: value for signal, value in whole.items() if chance.random() <= share}

    return [[(time, sample(), ()) for time in range(10)] for _ in range(count)]


def runs_in_time(count: int, chance: random.Random) -> list[Run]:
    """Runs of boolean signals, a few nanoseconds from one entry to the next."""
    found: list[Run] = []
    for _ in range(count):
        time = 10
        run: list[tuple[int, dict[Signal, Value], Sequence[str]]] = []
        for _ in range(8):
            time += chance.choice([0, 1, 1, 2, 3, 5])
            names = [name for name in "xyzn" if chance.random() < 1 / 2]
            values: dict[Signal, Value] = {signal(name): chance.random() < 1 / 2 for name in names if name != "n"}
            run.append((time, values, [f"/{name}" for name in names]))
        found.append([*run, *((time + gap, {}, ()) for gap in range(1, 10))])
    return found


def text_mutants(files: Files, chance: random.Random) -> Iterator[Files]:
    """The files with one thing changed in what is the property's own, of any kind at random, some hundred times."""
    source = files.source
    begin = min(
        found.start() for p in files.properties for found in re.finditer(rf"^static \w+ {p.name}_", source, re.M)
    )
    end = source.index("/* Judge what has come at `time`. */")
    before, own, after = source[:begin], source[begin:end], source[end:]
    code = re.sub(r"/\*.*?\*/", lambda found: " " * len(found[0]), own, flags=re.S)
    for _ in range(1000):
        pattern, change = chance.choice(_CHANGES)
        places = list(re.finditer(pattern, code, re.M))
        if not places:
            continue
        place = chance.choice(places)
        changed = change(place, chance)
        if changed != place[0]:
            yield with_source(files, before + own[: place.start()] + changed + own[place.end() :] + after)


def _relation(found: re.Match[str], chance: random.Random) -> str:
    return f" {chance.choice(_RELATIONS)} "


def _double(found: re.Match[str], chance: random.Random) -> str:
    value, suffix = float(found[1]), found[2]
    other = chance.choice([-value, value + 1.0, value / 2.0, value * 2.0, 0.0, 2.5])
    return f"{other!r}{suffix}"


def _integer(found: re.Match[str], chance: random.Random) -> str:
    return f"{found[1]}{max(0, int(found[2]) + chance.choice([-1, 1, 2]))}{found[3]}"


def _verdict(found: re.Match[str], chance: random.Random) -> str:
    return f"{found[1]}_{chance.choice(VERDICTS)}"


def _other(word: str) -> Change:
    return lambda found, chance: found[0].replace(found[1], word)


def _nothing(found: re.Match[str], chance: random.Random) -> str:
    return ""


def _twice(found: re.Match[str], chance: random.Random) -> str:
    return f"{found[0]}\n{found[0]}"


_CHANGES: list[tuple[str, Change]] = [
    (r" (?:<=|>=|<|>|==|!=) ", _relation),
    (r"(\b\d+\.\d+(?:e[-+]?\d+)?)(f?)\b", _double),
    (r"((?:state (?:=|==|<|<=|>|>=) |INT64_C\(|past\(\S+, ))(\d+)(u?)", _integer),
    (r"\b([A-Z][A-Z0-9]*)_(?:PRESUMABLY_VIOLATED|PRESUMABLY_SATISFIED|VIOLATED|SATISFIED)\b", _verdict),
    (r" (&&) ", _other("||")),
    (r" (\|\|) ", _other("&&")),
    (r"(!)(?=[\w(])", _other("")),
    (r"^ +self->(?!since|apart)[^;\n]+;$", _nothing),
    (r"^ +self->(?!since|apart)[^;\n]+;$", _twice),
    (r"self->due = (time);", _other("self->due")),
    (r"(?<== )(\w+_NEVER)\b", _other("time")),
    (r"\} (else) if ", _other("")),
    (r"\b(return false);", _other("")),
    (r"(\(double\))", _other("")),
    (r"\b(true|false)\b", lambda found, chance: "false" if found[0] == "true" else "true"),
]
