"""Conditions of HPL on the fields of a message: sets, ranges and quantifiers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ltlc.importing import formulas as f
from ltlc.importing.infix import Parser
from ltlc.importing.lexing import Token
from ltlc.importing.names import Kind, Signals
from ltlc.importing.operators import Form, Measure
from ltlc.importing.values import COMPARISON, SUM, FormulaError, Part, Value
from ltlc.importing.writing import Reading, Writer

FORM = Form(
    words={"and": "and", "or": "or", "not": "not", "implies": "implies", "iff": "iff", "in": "in"},
    levels={"implies": 1, "iff": 1, "or": 3, "and": 4},
    functions=frozenset(("abs", "sqrt", "len", "sum", "max", "min", "log", "sin", "cos", "tan", "asin", "acos")),
)

Resolve = Callable[[str, int], Value]
"""Gives the path of a field, at a place, a value. Raises FormulaError."""


class Conditions(Parser):
    """Reads the condition on a message, whose fields `resolve` gives values."""

    def __init__(self, text: str, signals: Signals, measure: Measure, resolve: Resolve) -> None:
        super().__init__(text, FORM, signals, measure)
        self._resolve = resolve
        self._bound: dict[str, Part] = {}
        self._slices: dict[str, str] = {}

    def _word(self, token: Token) -> Part:
        if token.text in ("forall", "exists"):
            return self._quantified("all" if token.text == "forall" else "any")
        if token.text in ("True", "False") or self._token.text == "(":
            return super()._word(token)
        return self._bound.get(token.text) or self._field(token.text, token.offset)

    def _field(self, path: str, offset: int) -> Value:
        """A path with its indexes; an index that a quantifier binds stands for the elements that it names."""
        part = ""
        while self._token.text in ("[", "."):
            if self._take("."):
                path += f".{self._token.text}"
                self._at += 1
                continue
            self._need("[")
            index = self._token.text
            if index in self._slices:
                part = self._slices[index]
                is_of_messages = self._tokens[self._at + 2].text == "."
                path += "[]" if is_of_messages and not part else ""
            else:
                path += f"[{index}]"
            self._at += 1
            self._need("]")
        found = self._resolve(path, offset)
        return replace(found, text=found.text + part) if part else found

    def _quantified(self, word: str) -> f.Formula:
        """`forall x in ARRAY: p`, `exists i in [0 to 4]: p`: of the elements of an array, or by their numbers."""
        variable = f"@{self._token.text}"
        self._at += 1
        self._need_word("in")
        before = set(self._signals.kinds)
        if self._token.text in ("[", "!"):
            self._slices[variable] = self._range()
        else:
            self._bound[variable], self._slices[variable] = self.expression(SUM), ""
        self._need(":")
        body = self.condition(self.expression(COMPARISON))
        domain = self._bound.pop(variable, None)
        del self._slices[variable]
        arrays = [domain.name] if isinstance(domain, Value) else set(self._signals.kinds) - before
        for name in arrays:
            self._signals.kinds[name] = Kind.NUMBERS
        return f.Atom(f"{word}({Writer(Reading(None), '').condition(body)})")

    def _range(self) -> str:
        """`[0 to 4]`, as a slice; with `!`, the end does not belong to it."""
        offset = self._token.offset
        first = int(self._take("!"))
        self._need("[")
        least = self.expression(SUM)
        self._need_word("to")
        most = self.expression(SUM)
        self._need("]")
        is_open = self._take("!")
        if not isinstance(least, Value) or not isinstance(most, Value) or not least.text.isdigit():
            raise FormulaError("a range has numbers", offset)
        first += int(least.text)
        if most.text.startswith("len(") and is_open:
            return f"[{first}:]" if first else ""
        if not most.text.isdigit():
            raise FormulaError("a range ends at a number, or before a length", offset)
        return f"[{first}:{int(most.text) + (not is_open)}]"

    def _membership(self, left: Part) -> f.Formula:
        """`x in {1, 2}`, `x in ![0 to 10]!`; with `!`, the end does not belong to it."""
        if not isinstance(left, Value):
            raise FormulaError("`in` needs a value", self._token.offset)
        if self._take("{"):
            items = [self.expression(SUM)]
            while self._take(","):
                items.append(self.expression(SUM))
            self._need("}")
            found: f.Formula = f.FALSE
            for item in items:
                found = f.disjoined(found, self._comparison(left, "==", item))
            return found
        is_open = self._take("!")
        self._need("[")
        least = self.expression(SUM)
        self._need_word("to")
        most = self.expression(SUM)
        self._need("]")
        below, above = "<" if is_open else "<=", "<" if self._take("!") else "<="
        return f.And(self._comparison(least, below, left), self._comparison(left, above, most))
