"""`ltlc certify --code`: whether a file is what ltlc emits for certified monitors, and its steps are these monitors."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from functools import partial

from ltlc import __version__
from ltlc.assurance.afresh import packages
from ltlc.assurance.afresh.files import Code, compared, emitted
from ltlc.assurance.afresh.outcomes import Equal, Unequal
from ltlc.assurance.lowered.equality import compare
from ltlc.assurance.lowered.letters import Judged
from ltlc.assurance.reading.c.files import written as written_in_c
from ltlc.assurance.reading.c.guards import Texts, difference
from ltlc.assurance.reading.files import written
from ltlc.assurance.reading.outcomes import Difference, ReadBack, Written
from ltlc.assurance.reading.rust import written as written_in_rust
from ltlc.backends import rust
from ltlc.backends.c.guards import endings
from ltlc.backends.spelling import NotInTargetError
from ltlc.base.limits import Budget, Exceeded, run_all
from ltlc.compiler import Compiled
from ltlc.interfaces.commands.progress import progress, saying
from ltlc.program.guards import GuardProgram
from ltlc.specification.specification import Specification

READING = Budget(seconds=60.0, megabytes=1024)
"""What reading back the code of one property may use."""

WIDTH = 120


def is_code_of(
    code: Code,
    compiled: Sequence[Compiled],
    specification: Specification,
    quiet: bool,
    guards: Sequence[GuardProgram] = (),
) -> bool:
    """Say of each file whether it is what ltlc emits, and of each property whether its steps are its monitor.

    Only what is equal to what ltlc emits is read back: that is as large as it has to be, and nested no deeper. Raises
    UnusableError.
    """
    try:
        with saying("comparing the code", quiet):
            found = list(compared(code, emitted(code, compiled, specification, guards)))
    except NotInTargetError as error:
        print(f"the code was NOT compared: ltlc does not write these properties for this target, as they have {error}")
        return False
    is_equal = True
    for name, outcome in found:
        is_equal &= isinstance(outcome, Equal)
        if not quiet or isinstance(outcome, Unequal):
            print("\n".join(_lines(name, outcome)))
    if not is_equal:
        print(f"NOT what ltlc {__version__} emits for these monitors{_of_another(code)}; nothing was read back")
        return False
    return _are_read_back(code, compiled, specification, guards, quiet) and _are_guards_read_back(
        code, compiled, guards
    )


def _of_another(code: Code) -> str:
    if code.version in (None, __version__):
        return ""
    return f": it was made by ltlc {code.version}, so compare it with that version or make it again"


def _lines(name: str, outcome: Equal | Unequal) -> list[str]:
    if isinstance(outcome, Unequal):
        return [outcome.at(name)]
    if not outcome.how:
        return [f"{name}: not compared: {outcome.not_compared}"]
    lines = [f"{name}: equal, {outcome.how}, to what ltlc {__version__} emits for these monitors"]
    if outcome.functions:
        lines += textwrap.wrap(
            f"functions: {', '.join(outcome.functions)}", WIDTH, initial_indent="  ", subsequent_indent="    "
        )
    return [*lines, *([f"  not compared: {outcome.not_compared}"] if outcome.not_compared else [])]


def _are_read_back(
    code: Code, compiled: Sequence[Compiled], specification: Specification, guards: Sequence[GuardProgram], quiet: bool
) -> bool:
    with progress("reading back the code", quiet) as watch:
        jobs = [
            partial(_read_back, *pair)
            for pair in zip(compiled, _written(code, compiled, specification, guards), strict=True)
        ]
        found = run_all(jobs, READING, watch=watch)
    for each, outcome in zip(compiled, found, strict=True):
        print(f"{each.specification.label}: {_answer(outcome)}")
    return all(isinstance(outcome, ReadBack) for outcome in found)


def _are_guards_read_back(code: Code, compiled: Sequence[Compiled], guards: Sequence[GuardProgram]) -> bool:
    """Say of each guard whether it rests where its region has it; in Python, what was read back has that."""
    is_right = True
    ends = endings(guards) if code.target == "c" else [""] * len(guards)
    for program, end in zip(guards, ends, strict=True):
        wrong = None
        if code.target == "c":
            names = [f"{code.stem}{of}" for of in (".h", ".c", f"{end}.h", f"{end}.c")]
            wrong = difference(Texts(*(code.texts[name] for name in names)), program, compiled)
        is_right &= wrong is None
        said = (
            f"it does NOT rest as its region has it: {wrong}"
            if wrong
            else "where it rests, read back, matches its region"
        )
        for guard in program.guards:
            print(f"guard {guard.out}: {said}")
    return is_right


def _read_back(compiled: Compiled, part: Written | Difference) -> ReadBack | Difference:
    """Whether the text is the machine, and the machine is the certified monitor."""
    if isinstance(part, Difference):
        return part
    lowered = compare(compiled.machine, _judged(compiled))
    return lowered if isinstance(lowered, Difference) else part.read_back()


def _judged(compiled: Compiled) -> Judged:
    return Judged(compiled.specification, compiled.formula, compiled.monitor)


def _written(
    code: Code, compiled: Sequence[Compiled], specification: Specification, guards: Sequence[GuardProgram]
) -> Sequence[Written | Difference]:
    match code.target:
        case "rust":
            (text,) = code.texts.values()
            files = rust.in_c(compiled, specification)
            own = (specification.rate, specification.timeout)
            return written_in_rust(text, files.header, files.source, compiled, *own)
        case "c":
            texts = code.texts[f"{code.stem}.h"], code.texts[f"{code.stem}.c"]
            return written_in_c(*texts, compiled, specification.rate, specification.timeout)
        case "ament":
            text = packages.as_one(code.texts)
        case _:
            (text,) = code.texts.values()
    return written(text, [each.machine for each in compiled], [each.specification for each in compiled], guards)


def _answer(outcome: ReadBack | Difference | Exceeded) -> str:
    match outcome:
        case ReadBack():
            return "its steps, read back, match the certified monitor"
        case Difference():
            return f"its steps do NOT match the monitor: {outcome}"
        case _:
            return f"its steps were NOT read back: that {outcome}"
