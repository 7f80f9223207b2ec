"""Specifications drawn at random from the grammar, with any white space and comments between their tokens."""

from __future__ import annotations

import random
from functools import cache
from pathlib import Path

from lark import Lark

import ltlc.frontend.syntax

TERMINALS = {
    "NAME": ("x", "scan", "robot", "new", "initially", "s", "m", "min", "G", "opening", "error"),
    "TEMPLATE": ("{r}_battery", "front_{r}_door"),
    "SETTING": ("_rate_", "_simulator_"),
    "TOPIC": ("/odom", "~/x", "/model/{name}/odometry"),
    "TYPE": ("Odometry.pose.pose", "a_msgs/Array.list[].status", "LaserScan.ranges[0]"),
    "NUMBER": ("5", "0.50", "1e-3"),
    "DURATION": ("5 s", "200ms", "0.5\tmin"),
    "PARAMETER": ("?",),
    "STRING": ('"#1 # b"', '"\\" x"', '""'),
    "MESSAGE_TYPE": ("a_msgs/msg/Goal", "b/srv/C"),
    "FUNCTION": ("abs", "min", "age"),
    "QUANTIFIER": ("any", "count"),
    "WITHIN_FIRST": ("within",),
}
"""What is written for the terminals that have no text in the grammar."""

GAPS = ("  ", "\t", "\n", "\r\n", "\n\n\n", " # c\n", "#c \n", "\n\n# d\n\n\n\n# e\n")
SUPPRESSIONS = (
    "  # ltlc: ignore LTL520\n",
    "\n#ltlc:ignore unused, LTL512 for a reason\n",
    "# ltlc: ignore-file LTL104\n",
)


@cache
def _rules() -> tuple[dict[str, list[tuple[str, ...]]], dict[str, int]]:
    """The expansions of each symbol, its text for a word or sign; and how many tokens the shortest text of it has."""
    text = (Path(ltlc.frontend.syntax.__file__).parent / "grammar.lark").read_text(encoding="utf-8")
    terminals, compiled, _ = Lark(text, parser="earley", lexer="basic").grammar.compile(["start"], ())
    written = {terminal.name: terminal.pattern.value for terminal in terminals}
    rules: dict[str, list[tuple[str, ...]]] = {}
    for rule in compiled:
        expansion = tuple(written.get(symbol.name, symbol.name) for symbol in rule.expansion)
        rules.setdefault(rule.origin.name, []).append(expansion)
    shortest = dict.fromkeys(rules, 1000)
    while True:
        found = {name: min(sum(shortest.get(s, 1) for s in e) for e in rules[name]) for name in rules}
        if found == shortest:
            return rules, shortest
        shortest = found


def tokens(chance: random.Random, symbol: str, room: int) -> list[str]:
    """The tokens of a text of `symbol`, about `room` of them where that is enough."""
    rules, shortest = _rules()
    if symbol not in rules:
        return [chance.choice(TERMINALS.get(symbol, (symbol,)))]
    sizes = [sum(shortest.get(each, 1) for each in expansion) for expansion in rules[symbol]]
    fitting = [e for e, size in zip(rules[symbol], sizes, strict=True) if size <= max(room, min(sizes))]
    expansion = chance.choice(fitting)
    spare = max(0, room - sum(shortest.get(each, 1) for each in expansion))
    shares = [chance.random() for _ in expansion]
    return [
        token
        for part, share in zip(expansion, shares, strict=True)
        for token in tokens(chance, part, shortest.get(part, 1) + int(spare * share / sum(shares)))
    ]


def specification(chance: random.Random) -> str:
    """A text of some commands, most of which the parser takes."""
    commands = [tokens(chance, "command", chance.choice((5, 12, 40, 90))) for _ in range(chance.randint(1, 5))]
    return respaced(chance, [token for command in commands for token in [*command, "\n"]])


def respaced(chance: random.Random, parts: list[str]) -> str:
    """`parts` with something between them that parts them."""
    rarity, suppressed = chance.choice((0.0, 0.02, 0.3)), chance.random() / 10
    text = ""
    for part in parts:
        gap = chance.choice(SUPPRESSIONS if chance.random() < suppressed else GAPS)
        text += part + (gap if chance.random() < rarity else " ")
    return text
