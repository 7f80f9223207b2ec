"""What a tool gets right: its answers beside the verdicts of the cases.

An answer is the changes of verdict that a tool has seen of a case, each with its time; or why the case is `outside` of
what the tool can say.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.conformance.cases import Case, Change, Verdicts
from benchmarks.differential.compare import last_of_each_time

WORDS = frozenset({"violated", "satisfied", "presumably_violated", "presumably_satisfied"})


class UnusableAnswersError(Exception):
    """What a tool has written are no answers; the message says where, and what is expected."""


@dataclass(frozen=True)
class Outside:
    """A case that a tool cannot say, and why."""

    because: str


Answer = Verdicts | Outside


@dataclass
class Score:
    """How many cases a tool has answered, and how: by the numbers of the cases.

    At the `end` is the last verdict, `at_steps` are those after each step and at the end, and `in_time` all changes, to
    the nanosecond; `wrong` are the answers in which one is not.
    """

    tool: str
    outside: dict[int, str] = field(default_factory=dict)
    missing: list[int] = field(default_factory=list)
    end: list[int] = field(default_factory=list)
    at_steps: list[int] = field(default_factory=list)
    in_time: list[int] = field(default_factory=list)
    wrong: dict[int, Verdicts] = field(default_factory=dict)

    @property
    def answered(self) -> int:
        """How many cases have an answer."""
        return len(self.in_time) + len(self.wrong)

    @property
    def is_full(self) -> bool:
        """Whether every answer is right, and none is missing."""
        return not self.wrong and not self.missing


def scored(tool: str, cases: Sequence[Case], answers: Mapping[int, Answer]) -> Score:
    """The score of a tool on some cases."""
    score = Score(tool)
    for case in cases:
        match answers.get(case.number):
            case None:
                score.missing.append(case.number)
            case Outside(because):
                score.outside[case.number] = because
            case Verdicts() as found:
                _take(score, case, found)
    return score


def _take(score: Score, case: Case, found: Verdicts) -> None:
    end, expected = case.recording.end, case.expected
    moments = [*(step for step in expected.steps if step <= end), end]
    if found.at(end) == expected.at(end):
        score.end.append(case.number)
    if all(found.at(moment) == expected.at(moment) for moment in moments):
        score.at_steps.append(case.number)
    if last_of_each_time(found.changes) == list(expected.changes):
        score.in_time.append(case.number)
    else:
        score.wrong[case.number] = found


def asked(command: Sequence[str], cases: Iterable[Case], timeout: float) -> dict[int, Answer]:
    """The answers of a command, which gets the cases as lines and writes a line for each.

    Raises UnusableAnswersError, also if it ends with an error or takes longer than the seconds it is given.
    """
    questions = "".join(json.dumps(case.question(), allow_nan=False) + "\n" for case in cases)
    try:
        done = subprocess.run(command, input=questions, stdout=subprocess.PIPE, text=True, timeout=timeout, check=False)
    except subprocess.TimeoutExpired:
        raise UnusableAnswersError(f"`{command[0]}` took more than {timeout:g} s; --timeout gives it more") from None
    except OSError as error:
        raise UnusableAnswersError(f"`{command[0]}` cannot be run: {error.strerror}") from None
    if done.returncode != 0:
        raise UnusableAnswersError(f"`{command[0]}` ended with exit code {done.returncode}")
    return answers_in(done.stdout, command[0])


def read(path: Path) -> dict[int, Answer]:
    """The answers in a file. Raises UnusableAnswersError."""
    try:
        return answers_in(path.read_text(), str(path))
    except (OSError, UnicodeDecodeError) as error:
        raise UnusableAnswersError(f"{path} cannot be read: {error}") from None


def answers_in(text: str, source: str) -> dict[int, Answer]:
    """The answers in some lines, of which empty ones are skipped. Raises UnusableAnswersError."""
    found: dict[int, Answer] = {}
    for number, line in enumerate(text.splitlines(), 1):
        if line.strip():
            try:
                document = json.loads(line)
                one, answer = _answer(document)
            except (ValueError, KeyError, TypeError) as error:
                message = f"{source}, line {number}: {error}: `{line[:80]}`; an answer is {EXAMPLE} or {OTHER}"
                raise UnusableAnswersError(message) from None
            if one in found:
                raise UnusableAnswersError(f"{source}, line {number}: case {one} has two answers")
            found[one] = answer
    return found


EXAMPLE = '{"id": 7, "verdicts": [[0, "presumably_satisfied"], [2000000001, "violated"]]}'
OTHER = '{"id": 7, "outside": "no arrays"}'


def _answer(document: Any) -> tuple[int, Answer]:
    if not isinstance(document, dict) or type(document.get("id")) is not int:
        raise ValueError("there is no `id`")
    if "outside" in document:
        return document["id"], Outside(str(document["outside"]))
    changes: list[Change] = []
    for time, verdict in document["verdicts"]:
        if type(time) is not int or verdict not in WORDS:
            raise ValueError("a verdict is a time in whole nanoseconds and one of " + ", ".join(sorted(WORDS)))
        changes.append((time, verdict))
    if changes != sorted(changes, key=lambda change: change[0]):
        raise ValueError("the times go back")
    return document["id"], Verdicts(changes, ())


def table(scores: Iterable[Score], cases: int) -> str:
    """The scores as a table, a line for each tool."""
    lines = [
        "| tool | can say | at the end | at each step | with times | without an answer |",
        "|---|---|---|---|---|---|",
    ]
    for score in scores:
        can = cases - len(score.outside)
        right = (len(each) for each in (score.end, score.at_steps, score.in_time))
        shares = " | ".join(f"{number:,} ({number / can:.1%})" if can else "–" for number in right)
        lines.append(f"| {score.tool} | {can:,} ({can / cases:.0%}) | {shares} | {len(score.missing):,} |")
    return "\n".join(lines)
