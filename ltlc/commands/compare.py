"""`ltlc compare`: encodings of the same sentence, or formulas, side by side; or ways to make a monitor, on a corpus."""

from __future__ import annotations

import argparse
import csv
import io
import json
import sys
from collections.abc import Sequence
from typing import Any

from ltlc.automata import Budget, Exceeded, SpotMissing
from ltlc.commands.common import FINDING, OK, UNDECIDED, failure, report, unusable
from ltlc.comparison.api import Table, UnusableInput, compare
from ltlc.comparison.reference import Contradiction


def run(options: argparse.Namespace) -> int:
    """Print the comparison; 0 if all of it was decided, 3 if a limit was met, 1 if the interpreters contradict Spot."""
    if options.recording and options.specification is None:
        return unusable("a recording has signals, and formulas have none: --recording needs PROPS")
    try:
        return _compare(options)
    except UnusableInput as error:
        report(error.diagnostics)
        return failure(error.diagnostics) if error.diagnostics else unusable(str(error))
    except SpotMissing as error:
        return unusable(str(error))
    except Contradiction as error:
        print(f"ltlc: {error}; this is a fault of ltlc or of Spot, please report it", file=sys.stderr)
        return FINDING


def _compare(options: argparse.Namespace) -> int:
    table = compare(
        options.specification,
        ltl=options.ltl if options.ltl is not None else options.ltl_file,
        encodings=options.encodings.split(",") if options.encodings else None,
        encoding_files=options.encoding_file,
        recordings=options.recording,
        reading=options.reading,
        message_paths=options.msg_path,
        budget=Budget(*options.budget),
    )
    report(table.diagnostics)
    print(_formatted(table, options.format), end="")
    return OK if _is_decided(table) else UNDECIDED


def _formatted(table: Table, form: str) -> str:
    match form:
        case "json":
            return json.dumps(table.document(), indent=2, ensure_ascii=False) + "\n"
        case "csv":
            return as_csv(table.rows())
        case "md":
            return table.markdown()
        case "html":
            return table.html()
    return str(table)


def as_csv(rows: Sequence[dict[str, Any]]) -> str:
    """`rows`, which have the same keys, as comma-separated values."""
    text = io.StringIO()
    if rows:
        writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    return text.getvalue()


def _is_decided(table: Table) -> bool:
    """Whether no question ran into a limit."""
    related = (part for each in table for comparison in each.comparisons for part in comparison.related.values())
    return not any(isinstance(part, Exceeded) for part in related)
