"""Formulas with infix operators, as NuSMV, FRET, C2PO, rtamt and reelay have them: one parser, and a table for each."""

from __future__ import annotations

import re
from typing import NoReturn

from ltlc.importing import formulas as f
from ltlc.importing.lexing import Token, tokens_of
from ltlc.importing.names import PREDICATES, Kind, Signals
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
    COMPARISON,
    POWER,
    PRODUCT,
    SUM,
    Choice,
    FormulaError,
    Part,
    Structure,
    Value,
    power,
)


def parse(text: str, form: Form, signals: Signals, measure: Measure) -> f.Formula:
    """The condition that `text` is. Raises FormulaError."""
    return Parser(text, form, signals, measure).condition_alone()


def parse_value(text: str, form: Form, signals: Signals, measure: Measure) -> Part:
    """The expression or condition that `text` is. Raises FormulaError."""
    return Parser(text, form, signals, measure).alone()


class Parser:
    """Reads a formula of a form; what is the same in all forms."""

    def __init__(self, text: str, form: Form, signals: Signals, measure: Measure) -> None:
        self._tokens, self._at, self._depth = tokens_of(text), 0, 0
        self._form, self._signals, self._measure = form, signals, measure

    def alone(self) -> Part:
        """The expression or condition that the whole text is. Raises FormulaError."""
        found = self.expression(0)
        if self._token.kind != "end":
            self._fail("an operator or the end")
        return found

    def condition_alone(self) -> f.Formula:
        """The condition that the whole text is. Raises FormulaError."""
        return self.condition(self.alone())

    @property
    def _token(self) -> Token:
        return self._tokens[min(self._at, len(self._tokens) - 1)]

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
        if isinstance(found, Structure | Choice):
            raise FormulaError("there are several values where a condition is expected", self._token.offset)
        if not isinstance(found, Value):
            return found
        if found.name:
            self._signals.use(found.name, Kind.BOOLEAN)
        elif found.kind is not Kind.BOOLEAN:
            raise FormulaError(f"`{found.text}` is a value where a condition is expected", self._token.offset)
        if found.name and self._signals.kind(found.name) is not Kind.BOOLEAN:
            kind = self._signals.kind(found.name).name.lower()
            raise FormulaError(f"`{found.name}` has values of the kind {kind}, not true and false")
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
        if not least and self._take("?"):
            found = self._choice(self.condition(found))
        self._depth -= 1
        return found

    def _choice(self, given: f.Formula) -> Part:
        """What follows `given ?`: two conditions, or two values."""
        then = self.expression(0)
        self._need(":")
        otherwise = self.expression(0)
        if isinstance(then, Value) and isinstance(otherwise, Value) and not {then.kind, otherwise.kind} & PREDICATES:
            return Choice(given, then, otherwise)
        return f.And(f.implies(given, self.condition(then)), f.disjoined(given, self.condition(otherwise)))

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
        if isinstance(left, Choice):
            then = f.implies(left.given, self._comparison(left.then, operator, right))
            return f.And(then, f.disjoined(left.given, self._comparison(left.otherwise, operator, right)))
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
                return found
            case "sign" if token.text == "{":
                return self._braces()
            case _:
                self._at -= 1
                raise self._failure("a condition or a value")

    def _word(self, token: Token) -> Part:
        word = token.text
        if word.lower() in ("true", "false"):
            return f.TRUE if word.lower() == "true" else f.FALSE
        if word in self._signals.constants:
            constant = self._signals.constants[word]
            return Value(constant, Kind.STRING if constant.startswith('"') else Kind.NUMBER)
        if self._take("("):
            return self._call(token)
        if word in self._form.parts:
            return self._form.parts[word]
        if self._take("["):
            index = self._token.text
            self._at += 1
            self._need("]")
            word = f"{word}[{index}]"
        return Value(self._signals.name(word), self._signals.kind(word), name=word)

    def _membership(self, left: Part) -> f.Formula:
        """What follows `in`. Raises FormulaError."""
        self._fail("another operator")

    def _need_word(self, word: str) -> None:
        if self._token.text != word:
            self._fail(f"`{word}`")
        self._at += 1

    def _braces(self) -> Part:
        """`{x > 3}` and `{mode: "idle"}`, conditions as reelay has them."""
        found: f.Formula = f.TRUE
        while True:
            part = self.expression(0)
            if self._take(":"):
                part = self._comparison(part, "==", self.expression(0))
            found = f.conjoined(found, self.condition(part))
            if not self._take(","):
                self._need("}")
                return found

    def _call(self, token: Token) -> Part:
        arguments = self._arguments()
        if token.text in ("prev", "preBool") and len(arguments) == 2 and arguments[0] in (f.TRUE, f.FALSE):
            before = self.condition(arguments[1])
            return f.Previous(before) if arguments[0] == f.FALSE else f.Not(f.Previous(f.negated(before)))
        values = [each for each in arguments if isinstance(each, Value)]
        if len(values) < len(arguments):
            raise FormulaError(f"`{token.text}` of a condition cannot be said", token.offset)
        for each in values:
            if each.name:
                self._signals.use(each.name, Kind.NUMBERS if token.text in ("len", "sum") else Kind.NUMBER)
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

    def _arguments(self) -> list[Part]:
        """What is between the parentheses of a call."""
        found = [self.expression(0)]
        while self._take(","):
            found.append(self.expression(0))
        self._need(")")
        return found

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
