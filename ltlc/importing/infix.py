"""Formulas with infix operators, as NuSMV, FRET, C2PO, rtamt and reelay have them: one parser, and a table for each."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import NoReturn

from ltlc.importing import formulas as f
from ltlc.importing.lexing import Token, tokens_of
from ltlc.importing.names import Kind, Signals
from ltlc.importing.operators import (
    ALONE,
    ARITHMETIC,
    BEFORE,
    BETWEEN,
    COMPARED,
    DEFAULT,
    LOGICAL,
    SIGNS,
    Bounds,
    Form,
    Measure,
)
from ltlc.importing.values import (
    AGGREGATES,
    COMPARISON,
    POWER,
    PRODUCT,
    SUM,
    FormulaError,
    Part,
    Structure,
    Value,
    array,
    counted,
    power,
)
from ltlc.importing.writing import Reading, Writer


def parse(text: str, form: Form, signals: Signals, measure: Measure) -> f.Formula:
    """The condition that `text` is. Raises FormulaError."""
    parser = _Parser(tokens_of(text), form, signals, measure)
    found = parser.condition(parser.expression(0))
    parser.expect_end()
    return found


def parse_value(text: str, form: Form, signals: Signals, measure: Measure) -> Part:
    """The expression or condition that `text` is. Raises FormulaError."""
    parser = _Parser(tokens_of(text), form, signals, measure)
    found = parser.expression(0)
    parser.expect_end()
    return found


class _Parser:
    def __init__(self, tokens: list[Token], form: Form, signals: Signals, measure: Measure) -> None:
        self._tokens, self._at, self._depth = tokens, 0, 0
        self._bound: dict[str, Part] = {}
        self._slices: dict[str, str] = {}
        self._form, self._signals, self._measure = form, signals, measure

    @property
    def _token(self) -> Token:
        return self._tokens[self._at]

    def _fail(self, expected: str) -> NoReturn:
        raise self._failure(expected)

    def _failure(self, expected: str) -> FormulaError:
        """That something else comes next."""
        token = self._token
        found = "the formula ends" if token.kind == "end" else f"there is `{token.text}`"
        return FormulaError(f"{found} where {expected} is expected", token.offset)

    def _take(self, *texts: str) -> bool:
        if self._token.kind == "sign" and self._token.text in texts:
            self._at += 1
            return True
        return False

    def _need(self, text: str) -> None:
        if not self._take(text):
            self._fail(f"`{text}`")

    def expect_end(self) -> None:
        """Raises FormulaError if something is left."""
        if self._token.kind != "end":
            self._fail("an operator or the end")

    def _operator(self) -> str:
        """What the next token means between two parts, or in front of one; empty if nothing."""
        token = self._token
        if token.kind == "sign":
            return self._form.words.get(token.text, SIGNS.get(token.text, ""))
        following = self._tokens[min(self._at + 1, len(self._tokens) - 1)].text
        if token.kind != "word" or (following in SIGNS and SIGNS[following] in COMPARED):
            return ""  # a name that is also a word: `T > 3`
        return self._form.words.get(token.text, "")

    def condition(self, found: Part) -> f.Formula:
        """A condition, not a value. Raises FormulaError."""
        if isinstance(found, Structure):
            raise FormulaError("there are several values where a condition is expected", self._token.offset)
        if not isinstance(found, Value):
            return found
        if found.name:
            self._signals.use(found.name, Kind.BOOLEAN)
        elif found.kind is not Kind.BOOLEAN:
            raise FormulaError(f"`{found.text}` is a value where a condition is expected", self._token.offset)
        if found.name and self._signals.kind(found.name) is not Kind.BOOLEAN:
            raise FormulaError(f"`{found.name}` is a {self._signals.kind(found.name).name.lower()}, not a condition")
        return f.Atom(found.text)

    def expression(self, least: int) -> Part:
        """What comes next, with the operators that bind at least so tightly."""
        self._depth += 1
        if self._depth > 150:
            raise FormulaError("the formula is nested too deeply", self._token.offset)
        found = self._operand()
        while (operator := self._operator()) and (level := self._level(operator)) is not None and level >= least:
            self._at += 1
            if operator == "in":
                found = self._membership(found)
                continue
            bounds = self._bounds() if operator in BETWEEN else None
            right = self.expression(level if operator in self._form.right else level + 1)
            found = self._combined(found, operator, bounds, right)
        self._depth -= 1
        return found

    def _level(self, operator: str) -> int | None:
        if operator in COMPARED or operator == "in":
            return COMPARISON
        return self._form.levels.get(operator, ARITHMETIC.get(operator))

    def _combined(self, left: Part, operator: str, bounds: Bounds | None, right: Part) -> Part:
        if operator in COMPARED:
            return self._comparison(left, operator, right)
        if operator in ARITHMETIC:
            if not isinstance(left, Value) or not isinstance(right, Value):
                raise FormulaError(f"`{operator}` needs numbers on both sides", self._token.offset)
            return self._arithmetic(left, operator, right)
        p, q = self.condition(left), self.condition(right)
        if operator in BETWEEN:
            return self._between(p, operator, bounds or (0, None), q)
        return LOGICAL[operator](p, q)

    def _between(self, p: f.Formula, operator: str, bounds: Bounds, q: f.Formula) -> f.Formula:
        start, stop = bounds
        if start and self._form.leads and operator in ("until", "release"):
            return f.Next(BETWEEN[operator](p, q, 0, None if stop is None else stop - start), start)
        return BETWEEN[operator](p, q, start, stop)

    def _comparison(self, left: Part, operator: str, right: Part) -> f.Formula:
        if isinstance(left, Structure) and isinstance(right, Structure) and len(left.parts) == len(right.parts):
            found: f.Formula = f.TRUE
            for one, other in zip(left.parts.values(), right.parts.values(), strict=True):
                found = f.conjoined(found, self._comparison(one, "==", other))
            return found if operator == "==" else f.negated(found)
        kinds = {each.kind if isinstance(each, Value) else Kind.BOOLEAN for each in (left, right)}
        if Kind.BOOLEAN in kinds and operator in ("==", "!="):
            both = f.equivalent(self.condition(left), self.condition(right))
            return both if operator == "==" else f.Not(both)
        if not isinstance(left, Value) or not isinstance(right, Value):
            raise FormulaError(f"`{operator}` compares values, not conditions", self._token.offset)
        kind = Kind.STRING if Kind.STRING in kinds else Kind.NUMBER
        for each in (left, right):
            if each.name:
                self._signals.use(each.name, kind)
        return f.Atom(f"{left.within(SUM)} {operator} {right.within(SUM)}")

    def _arithmetic(self, left: Value, operator: str, right: Value) -> Value:
        for each in (left, right):
            if each.name:
                self._signals.use(each.name, Kind.NUMBER)
        if operator in ("%", "mod"):
            return Value(f"mod({left.text}, {right.text})", Kind.NUMBER)
        if operator == "^":
            return power(left.within(POWER), right.text, self._token.offset)
        level = ARITHMETIC[operator]
        return Value(f"{left.within(level)} {operator} {right.within(level + 1)}", Kind.NUMBER, level)

    def _operand(self) -> Part:
        token, operator = self._token, self._operator()
        if operator in ALONE:
            self._at += 1
            return ALONE[operator]
        if operator in ("not", "-") or operator in BEFORE:
            self._at += 1
            if operator == "-":
                inner = self.expression(PRODUCT)
                if not isinstance(inner, Value):
                    raise FormulaError("`-` needs a number", token.offset)
                return Value(f"-{inner.within(POWER)}", Kind.NUMBER, SUM)
            bounds = self._bounds()
            is_tight = operator == "not" and token.kind == "sign"
            operand = self.condition(self.expression(POWER if is_tight else COMPARISON))
            if operator == "not":
                return f.negated(operand)
            return BEFORE[operator](operand, *(bounds or DEFAULT.get(operator, (0, None))))
        self._at += 1
        match token.kind:
            case "number":
                return Value(re.sub(r"\A\.", "0.", token.text), Kind.NUMBER)
            case "string":
                return Value(f'"{token.text[1:-1]}"', Kind.STRING)
            case "word":
                return self._word(token)
            case "sign" if token.text == "(":
                found = self.expression(0)
                self._need(")")
                return self._selected(found)
            case "sign" if token.text == "{":
                return self._braces()
            case _:
                self._at -= 1
                raise self._failure("a condition or a value")

    def _word(self, token: Token) -> Part:
        word = token.text
        if word.lower() in ("true", "false"):
            return f.TRUE if word.lower() == "true" else f.FALSE
        if word in ("forall", "exists") and self._form.resolve:
            return self._quantified("all" if word == "forall" else "any")
        if word in self._signals.constants:
            constant = self._signals.constants[word]
            return Value(constant, Kind.STRING if constant.startswith('"') else Kind.NUMBER)
        if self._take("("):
            return self._call(token)
        if word.partition(".")[0] in self._bound or word.partition(".")[0] in self._form.parts:
            first, *fields = word.split(".")
            found = self._bound[first] if first in self._bound else self._form.parts[first]
            for field in fields:
                found = self._member(found, field, token.offset)
            return self._selected(found)
        if self._form.resolve:
            return self._bound.get(word) or self._field(word, token.offset)
        if self._take("["):
            index = self._token.text
            self._at += 1
            self._need("]")
            word = f"{word}[{index}]"
        return Value(self._signals.name(word), self._signals.kind(word), name=word)

    def _field(self, path: str, offset: int) -> Value:
        """A path with its indexes; an index that a quantifier binds stands for the elements that it names."""
        assert self._form.resolve is not None
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
            else:
                path += f"[{index}]"
            self._at += 1
            self._need("]")
        found = self._form.resolve(path, offset)
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

    def _need_word(self, word: str) -> None:
        if self._token.text != word:
            self._fail(f"`{word}`")
        self._at += 1

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
                if not (name + last).isdigit():
                    raise FormulaError("a slice has numbers", offset)
                found = array(found.part(str(n), offset) for n in range(int(name), int(last) + 1))
            else:
                found = found.part(name, offset)
            if not is_field:
                self._need("]")
        return found

    def _braces(self) -> Part:
        """`{a, b}` of C2PO is an array; `{x > 3}` and `{mode: "idle"}` of reelay are conditions."""
        if self._form.arrays:
            parts = [] if self._token.text == "}" else [self.expression(0)]
            while self._take(","):
                parts.append(self.expression(0))
            self._need("}")
            return self._selected(array(parts))
        found: f.Formula = f.TRUE
        while True:
            part = self.expression(0)
            if self._take(":"):
                part = self._comparison(part, "==", self.expression(0))
            found = f.conjoined(found, self.condition(part))
            if not self._take(","):
                self._need("}")
                return found

    def _aggregate(self, token: Token) -> f.Formula:
        """`foreach(x: a)(p)` and the like: p of each element; `foratleast(x: a, 2)(p)`: of so many."""
        variable = self._token.text
        self._at += 1
        self._need(":")
        over, least = self.expression(0), ""
        if self._take(","):
            least = self._token.text
            self._at += 1
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

    def _call(self, token: Token) -> Part:
        if token.text in AGGREGATES and self._form.arrays:
            return self._aggregate(token)
        arguments = [self.expression(0)]
        while self._take(","):
            arguments.append(self.expression(0))
        self._need(")")
        if token.text in self._form.structures:
            fields = self._form.structures[token.text]
            if len(fields) != len(arguments):
                raise FormulaError(f"`{token.text}` has {len(fields)} fields", token.offset)
            return self._selected(Structure(dict(zip(fields, arguments, strict=True))))
        values = [each for each in arguments if isinstance(each, Value)]
        if len(values) < len(arguments):
            raise FormulaError(f"`{token.text}` of a condition cannot be said", token.offset)
        for each in values:
            if each.name:
                self._signals.use(each.name, Kind.NUMBER)
        if token.text == "pow" and len(values) == 2:
            return power(values[0].within(POWER), values[1].text, token.offset)
        if token.text in ("prev", "preInt", "preReal") and len(values) == 2:
            return Value(f"@{{{values[1].text}, -1 else {values[0].text}}}", values[1].kind)
        if token.text == "rate" and len(values) == 1:
            return Value(f"{values[0].within(SUM)} - @{{{values[0].text}, -1 else 0}}", Kind.NUMBER, SUM)
        listed = ", ".join(each.text for each in values)
        if token.text not in self._form.functions:
            whole = f"{token.text}({listed})"
            return Value(self._signals.name(whole), self._signals.kind(whole), name=whole)
        return Value(f"{token.text}({listed})", Kind.NUMBER)

    def _bounds(self) -> Bounds | None:
        """An interval, if one comes next: `[0,5]`, `[0:5 s]`, `[5]`, `[<=5]`, `[=5]`."""
        if not self._take("["):
            return None
        offset = self._token.offset
        if self._take("<=", "<", "="):
            sign = self._tokens[self._at - 1].text
            stop = self._length() - (sign == "<")
            start = stop if sign == "=" else 0
        else:
            start, stop = 0, self._length()
            if self._take(",", ":"):
                start = stop
                if self._token.text in ("*", "inf", "oo"):
                    self._at += 1
                    self._need("]")
                    return start, None
                stop = self._length()
        self._need("]")
        if stop < start:
            raise FormulaError("the interval ends before it begins", offset)
        return start, stop

    def _length(self) -> int:
        token = self._token
        if token.kind != "number":
            self._fail("a number")
        self._at += 1
        unit = self._token.text if self._token.kind == "word" else ""
        self._at += bool(unit)
        return self._measure(token.text, unit)
