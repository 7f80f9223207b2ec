"""Makes the parser's tables, `tables.json`, of `grammar.lark`: `python -m ltlc.frontend.syntax.generate`.

They are the LALR(1) automaton that lark makes; the compiler reads them instead of importing lark, of which an
environment with ROS's wheels may have another version.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ltlc.base.files import compact_json, write_text

HERE = Path(__file__).parent


def main() -> None:
    """Write the file beside this one."""
    write_text(HERE / "tables.json", compact_json(tables()))


def tables() -> dict[str, Any]:
    """The automaton: `rules` as [symbol, length, function], and for each of `states` what a symbol does there.

    A number from 0 is the next state, a negative one -n - 1 the reduction by rule n. State 0 is the initial one; states
    are numbered breadth first, so that the same grammar gives the same file.
    """
    from lark import Lark
    from lark.lexer import Lexer, LexerState
    from lark.lexer import Token as LarkToken

    class NoLexer(Lexer):
        def __init__(self, _: object) -> None:
            pass

        def lex(self, lexer_state: LexerState, parser_state: Any) -> Iterator[LarkToken]:
            raise NotImplementedError("only the tables are wanted")

    grammar = (HERE / "grammar.lark").read_text(encoding="utf-8")
    parser: Any = Lark(grammar, parser="lalr", lexer=NoLexer)
    literals = {t.name: t.pattern.value for t in parser.terminals if t.pattern is not None}
    table = parser.parser.parser._parse_table
    rules = {rule: number for number, rule in enumerate(parser.rules)}
    order = _breadth_first(table.states, table.start_states["start"])
    states = []
    for state in order:
        row: dict[str, int] = {}
        for symbol, (action, argument) in sorted(table.states[state].items()):
            row[literals.get(symbol, symbol)] = order[argument] if str(action) == "Shift" else -1 - rules[argument]
        states.append(row)
    return {
        "rules": [[rule.origin.name, len(rule.expansion), rule.alias] for rule in rules],
        "states": states,
    }


def _breadth_first(states: dict[int, dict[str, tuple[Any, Any]]], start: int) -> dict[int, int]:
    """New numbers for the states that can be reached from `start`."""
    numbers = {start: 0}
    queue = [start]
    for state in queue:
        for _, (action, argument) in sorted(states[state].items()):
            if str(action) == "Shift" and argument not in numbers:
                numbers[argument] = len(numbers)
                queue.append(argument)
    return numbers


if __name__ == "__main__":
    main()
