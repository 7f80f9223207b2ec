"""Formulas of C2PO with arrays, structures and aggregates: `{a, b}`, `t.field`, `foreach(x: a)(x > 3)`."""

from __future__ import annotations

from ltlc.importing import formulas as f
from ltlc.importing.infix import Parser
from ltlc.importing.lexing import Token
from ltlc.importing.names import Signals
from ltlc.importing.operators import Form, Measure
from ltlc.importing.values import AGGREGATES, FormulaError, Part, Structure, Value, array, counted


class Formulas(Parser):
    """Reads a formula in which names may stand for several values."""

    def __init__(self, text: str, form: Form, signals: Signals, measure: Measure) -> None:
        super().__init__(text, form, signals, measure)
        self._bound: dict[str, Part] = {}

    def _operand(self) -> Part:
        return self._selected(super()._operand())

    def _word(self, token: Token) -> Part:
        first, *fields = token.text.split(".")
        if first not in self._bound and first not in self._form.parts:
            return super()._word(token)
        found = self._bound[first] if first in self._bound else self._form.parts[first]
        for field in fields:
            found = self._member(found, field, token.offset)
        return found

    def _member(self, of: Part, name: str, offset: int) -> Part:
        if not isinstance(of, Structure):
            raise FormulaError(f"there is no `{name}` in a single value", offset)
        return of.part(name, offset)

    def _selected(self, found: Part) -> Part:
        """What follows a structure: `[2]`, `[1..3]`, `.field`."""
        while isinstance(found, Structure) and self._token.text in ("[", "."):
            offset, is_field = self._token.offset, self._take(".")
            if not is_field:
                self._need("[")
            name = self._token.text
            self._at += 1
            if not is_field and self._take("."):
                self._need(".")
                last = self._token.text
                self._at += 1
                if not (name.isdigit() and last.isdigit()):
                    raise FormulaError("a slice has numbers", offset)
                found = array(found.part(str(n), offset) for n in range(int(name), int(last) + 1))
            else:
                found = found.part(name, offset)
            if not is_field:
                self._need("]")
        return found

    def _braces(self) -> Part:
        """The elements of an array."""
        parts = [] if self._token.text == "}" else [self.expression(0)]
        while self._take(","):
            parts.append(self.expression(0))
        self._need("}")
        return array(parts)

    def _call(self, token: Token) -> Part:
        if token.text in AGGREGATES:
            return self._aggregate(token)
        if token.text not in self._form.structures:
            return super()._call(token)
        fields, arguments = self._form.structures[token.text], self._arguments()
        if len(fields) != len(arguments):
            raise FormulaError(f"`{token.text}` has {len(fields)} fields", token.offset)
        return Structure(dict(zip(fields, arguments, strict=True)))

    def _aggregate(self, token: Token) -> f.Formula:
        """`foreach(x: a)(p)` and the like: p of each element; `foratleast(x: a, 2)(p)`: of so many."""
        variable = self._token.text
        self._at += 1
        self._need(":")
        over, least = self.expression(0), ""
        if self._take(","):
            number = self.expression(0)
            least = number.text if isinstance(number, Value) else ""
        self._need(")")
        self._need("(")
        if not isinstance(over, Structure):
            raise FormulaError(f"`{token.text}` needs an array", token.offset)
        begin, found, outer = self._at, [], self._bound.get(variable)
        for part in over.parts.values():
            self._at, self._bound[variable] = begin, part
            found.append(self.condition(self.expression(0)))
        self._bound.pop(variable)
        if outer is not None:
            self._bound[variable] = outer
        self._need(")")
        return counted(found, token.text, least, token.offset)
