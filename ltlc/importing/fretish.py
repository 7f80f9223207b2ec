"""FRETish, the sentences of FRET: a scope, a condition, a component, a timing and a response; and what they mean.

A sentence is about intervals of positions, its scope; in each, positions trigger it: where its condition becomes true
or is true at the beginning of the interval; with `whenever`, where it is true; without a condition, the beginning. What
is open where an interval ends is excused. Giannakopoulou, Pressburger, Mavridou and Schumann, Automated formalization
of structured natural language requirements, Information and Software Technology 137 (2021).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from ltlc.dataclass import dataclass
from ltlc.importing import formulas as f
from ltlc.importing.infix import Parser
from ltlc.importing.lexing import Token
from ltlc.importing.names import Signals
from ltlc.importing.operators import Form, Measure
from ltlc.importing.values import FormulaError, Part, Value

_QUALIFIERS = ("upon", "whenever", "when", "unless", "where", "if")
_TIMINGS = {
    **{word: word for word in ("always", "never", "eventually", "immediately", "finally")},
    **{word: word for word in ("within", "for", "after", "until", "before")},
    "initially": "immediately",
}
_AT_THE = {"first": "immediately", "same": "immediately", "next": "next", "last": "finally"}
_OPPOSITE = {"always": "eventually", "within": "for", "until": "before"}
_OPPOSITES = {
    **_OPPOSITE,
    **{there: here for here, there in _OPPOSITE.items()},
}
"""What is asked outside of an `only` scope, of the opposite response."""


@dataclass(frozen=True)
class Sentence:
    """The parts of a sentence.

    `scope` is `in`, `notin`, `before`, `after`, `onlyBefore` or `onlyAfter` the mode, or empty. Each position with the
    `condition` triggers it if that `repeats`. `timing` is one of FRET's, `always` for `never`, or `not after`; `bound`
    is of `within`, `for` and `after`, in positions, and `stop` of `until` and `before`.
    """

    scope: str
    mode: f.Formula
    condition: f.Formula | None
    repeats: bool
    timing: str
    response: f.Formula
    bound: int
    stop: f.Formula


def meaning(sentence: Sentence) -> f.Formula:
    """What holds of an infinite run that satisfies `sentence`. Raises FormulaError if it is only about finite ones."""
    if sentence.condition is None and sentence.scope in _OPENINGS:
        then = _from_the_beginning(sentence)
        if not sentence.scope:
            return then
        opened = _OPENINGS[sentence.scope](sentence.mode)
        return f.Or(f.Until(f.negated(opened), f.And(opened, then)), f.Not(f.eventually(opened)))
    return f.always(_everywhere(sentence))


def _ended(mode: f.Formula) -> f.Formula:
    return f.And(f.negated(mode), f.Previous(mode))


_OPENINGS: Mapping[str, Callable[[f.Formula], f.Formula]] = {
    "": lambda mode: f.TRUE,
    "after": _ended,
    "onlyBefore": lambda mode: mode,
}
"""Where intervals begin that do not end."""


def _from_the_beginning(sentence: Sentence) -> f.Formula:
    """What is required where an interval begins that does not end."""
    p, stop, n = sentence.response, sentence.stop, sentence.bound
    match sentence.timing:
        case "immediately":
            return p
        case "next":
            return f.Next(p)
        case "always":
            return f.always(p)
        case "eventually":
            return f.eventually(p)
        case "within":
            return f.eventually(p, 0, n)
        case "for":
            return f.always(p, 0, n)
        case "after":
            return f.And(f.always(f.negated(p), 0, n), f.eventually(p, 0, n + 1))
        case "not after":
            return f.implies(f.always(f.negated(p), 0, n), f.always(f.negated(p), 0, n + 1))
        case "until":
            return f.weak_until(p, stop)
        case "before":
            return f.Not(f.Until(f.negated(p), stop))
        case _:
            raise FormulaError("it is about the last position only, which a run that goes on does not have")


def _everywhere(sentence: Sentence) -> f.Formula:
    """What holds at every position, of triggers there and before it in the same interval."""
    p, stop, n = sentence.response, sentence.stop, sentence.bound
    inside = _inside(sentence)
    held = f.conjoined(inside, sentence.condition or f.TRUE)
    trigger = held if sentence.repeats else f.And(held, f.negated(f.Previous(held)))

    def since(kept: f.Formula, begun: f.Formula, start: int = 0, end: int | None = None) -> f.Formula:
        """That `begun` held in this interval, and `kept` since then, with it."""
        begun = f.conjoined(begun, kept)
        if sentence.scope in ("in", "notin"):  # intervals that another one may follow
            return f.Since(f.conjoined(inside, kept), begun, start, end)
        found = f.Since(kept, begun, start, end)
        return found if sentence.scope in _OPENINGS else f.conjoined(inside, found)

    match sentence.timing:
        case "immediately":
            return f.implies(trigger, p)
        case "next":
            return f.implies(trigger, f.Next(p if sentence.scope in _OPENINGS else f.implies(inside, p)))
        case "always":
            return f.implies(inside if sentence.condition is None else since(f.TRUE, held), p)
        case "eventually":
            return f.implies(trigger, f.Until(inside, f.conjoined(inside, p)))
        case "within":
            return f.implies(trigger, f.eventually(f.disjoined(p, f.negated(inside)), 0, n))
        case "for" if sentence.scope in _OPENINGS:
            return f.implies(trigger, f.always(p, 0, n))
        case "for":
            return f.implies(since(f.TRUE, trigger, 0, n), p)
        case "after":
            kept, then = (replace(sentence, timing=timing) for timing in ("for", "within"))
            return f.And(_everywhere(replace(kept, response=f.negated(p))), _everywhere(replace(then, bound=n + 1)))
        case "not after":
            return f.Not(f.conjoined(inside, f.And(p, f.Previous(since(f.negated(p), trigger, n, n)))))
        case "until":
            return f.implies(since(f.negated(stop), trigger), p)
        case "before":
            waiting = f.Or(trigger, f.conjoined(inside, f.Previous(since(f.negated(p), trigger))))
            return f.Not(f.And(stop, waiting))
        case _:
            if inside == f.TRUE or sentence.scope in _OPENINGS:
                raise FormulaError("it is about the last position only, which a run that goes on does not have")
            begun = inside if sentence.condition is None else since(f.TRUE, held)
            return f.implies(f.conjoined(f.negated(inside), f.Previous(begun)), f.Previous(p))


def _inside(sentence: Sentence) -> f.Formula:
    """Whether a position is in an interval of the scope."""
    mode = sentence.mode
    match sentence.scope:
        case "in":
            return mode
        case "notin":
            return f.negated(mode)
        case "before":
            return f.Not(f.Since(f.TRUE, mode))
        case "onlyAfter":
            return f.Not(f.Since(f.TRUE, _ended(mode)))
        case "after" | "onlyBefore":
            return f.Since(f.TRUE, _OPENINGS[sentence.scope](mode))
        case _:
            return f.TRUE


FORM = Form(
    words={"FTP": "first", "LAST": "last", **{word: word.lower() for word in ("xor", "XOR", "mod", "MOD")}},
    levels={"implies": 1, "iff": 1, "or": 3, "xor": 3, "and": 4},
)


def parse(text: str, signals: Signals, measure: Measure) -> tuple[Sentence, tuple[str, ...]]:
    """The sentence that `text` is, and remarks on how it is read. Raises FormulaError."""
    reader = _Sentences(text.replace("%", "_PERCENT_"), FORM, signals, measure)
    return reader.sentence(), tuple(reader.notes)


class Conditions(Parser):
    """Reads conditions of FRET: with `if p then q`, and predicates of the last and the next positions."""

    looks_back = False

    def _words(self, *words: str) -> str:
        """The next word, in small letters, if it is one of these; otherwise empty."""
        word = self._token.text.lower() if self._token.kind == "word" else ""
        self._at += word in words
        return word if word in words else ""

    def _need_any(self, *words: str) -> str:
        return self._words(*words) or self._fail(" or ".join(f"`{word}`" for word in words))

    def _operand(self) -> Part:
        if self._token.kind == "string":
            self._at += 1
            name = self._tokens[self._at - 1].text[1:-1]
            return Value(self._signals.name(name), self._signals.kind(name), name=name)
        if not self._words("if"):
            return super()._operand()
        given = self.condition(self.expression(0))
        self._need_any("then")
        return f.implies(given, self.condition(self.expression(0)))

    def _call(self, token: Token) -> Part:
        if token.text not in _LATELY:
            return super()._call(token)
        arguments = self._arguments()
        count = arguments[0]
        if len(arguments) != 2 or not isinstance(count, Value) or not count.text.isdigit():
            raise FormulaError(f"`{token.text}` needs a number of positions and a condition", token.offset)
        self.looks_back = self.looks_back or token.text in ("occurred", "persisted")
        return _LATELY[token.text](self.condition(arguments[1]), int(count.text))


_LATELY: Mapping[str, Callable[[f.Formula, int], f.Formula]] = {
    "occurred": lambda p, n: f.Since(f.TRUE, p, 0, n),
    "persisted": lambda p, n: f.And(f.Previous(f.TRUE, n), f.Not(f.Since(f.TRUE, f.negated(p), 0, n))),
    "occurs": lambda p, n: f.eventually(p, 0, n),
    "persists": lambda p, n: f.always(p, 0, n),
}


class _Sentences(Conditions):
    """Reads a sentence; its words are those of the grammar that FRET publishes, in any case."""

    notes: list[str]

    def sentence(self) -> Sentence:
        """The sentence that the whole text is. Raises FormulaError."""
        self.notes = []
        is_only, scope, mode = self._scope()
        condition, repeats = self._condition()
        if self._words("shall"):
            self._component()
        else:
            self._component()
            self._need_any("shall")
        timing, bound, stop = self._timing()
        self._need_any("satisfy")
        response = self.condition(self.expression(0))
        self._take(".")
        if self._token.kind != "end":
            self._fail("the end")
        if scope and self.looks_back:
            raise FormulaError(
                "`occurred` and `persisted` in a scope, where they count from its beginning, are not read"
            )
        if timing == "never":
            timing, response = "always", f.negated(response)
        if is_only and timing == "after":
            timing = "not after"
        elif is_only:
            timing, response = _OPPOSITES.get(timing, timing), f.negated(response)
        return Sentence(scope, mode, condition, repeats, timing, response, bound, stop)

    def _scope(self) -> tuple[bool, str, f.Formula]:
        """Whether the scope is one of `only`, which it is, and its mode."""
        begin = self._at
        prefix, given = self._words("only", "except"), self._words("when", "if", "unless")
        is_not = bool(given and self._words("not"))
        word = self._words("in") if given else self._words("in", "during", "while", "after", "before")
        if not word:
            self._at = begin
            return False, "", f.TRUE
        is_inverted = (prefix != "") ^ is_not ^ (given == "unless")
        is_only = prefix == "only"
        if (is_only and (is_not or given == "unless")) or (prefix == "except" and word in ("after", "before")):
            self._fail("another scope")
        if word in ("after", "before"):
            opposite = {"before": "onlyBefore", "after": "onlyAfter"}
            scope = opposite[word] if prefix else word
        else:
            scope = "notin" if is_inverted else "in"
        if self._token.kind == "word" and self._tokens[self._at + 1].kind == "word":
            self._words("mode")
        mode = self.condition(self.expression(0))
        self._words("mode")
        self._take(",")
        return is_only, scope, mode

    def _condition(self) -> tuple[f.Formula | None, bool]:
        """The condition, if there is one, and whether every position at which it holds triggers."""
        found, repeats = None, False
        while True:
            begin = self._at
            self._take(",")
            joint, word = self._words("and", "or"), self._words(*_QUALIFIERS)
            if not word:
                self._at = begin if joint else self._at
                return found, repeats
            condition = self.condition(self.expression(0))
            is_false = self._words("is") and self._need_any("true", "false") == "false"
            condition = f.negated(condition) if bool(is_false) != (word == "unless") else condition
            repeats = word == "whenever" and (found is None or repeats)
            if found is not None:
                condition = (f.disjoined if joint == "or" else f.conjoined)(found, condition)
            found = condition

    def _component(self) -> None:
        """The name of what the sentence is about, of one or several words."""
        begin = self._at
        ends = {"shall", "satisfy", "at", "probability", *_TIMINGS}
        while self._token.kind in ("word", "string", "number") and self._token.text.lower() not in ends:
            self._at += 1
        if self._at == begin:
            self._fail("a component")

    def _timing(self) -> tuple[str, int, f.Formula]:
        """The timing, its bound and its stop condition."""
        self._take(",")
        if self._words("with", "probability", "what"):
            raise FormulaError("a probability is not decided by one run", self._token.offset)
        timing, bound, stop = "eventually", 0, f.TRUE
        if self._words("at"):
            self._need_any("the")
            timing = _AT_THE[self._need_any(*_AT_THE)]
            self._need_any("timepoint")
        elif word := self._words(*_TIMINGS):
            timing = _TIMINGS[word]
        if timing in ("within", "for", "after"):
            bound = self._bound()
        elif timing in ("until", "before"):
            stop = self.condition(self.expression(0))
        self._take(",")
        return timing, bound, stop

    def _bound(self) -> int:
        """A number of positions, with a unit that FRET does not count."""
        number = self._token.text
        if self._token.kind != "number":
            self._fail("a number")
        self._at += 1
        bound, word = self._measure(number, ""), self._words(*_UNITS)
        unit = _UNITS.get(word, "")
        try:
            is_alike = not unit or self._measure(number, unit) == bound
        except FormulaError:
            is_alike = False
        if not is_alike:
            self.notes.append(f"FRET counts `{number} {word}` as {number} positions")
        return bound


_UNITS = {
    word: unit
    for unit, stem, ends in (
        ("", "tick", ("", "s")),
        ("us", "microsec", ("", "s", "ond", "onds")),
        ("ms", "millisec", ("", "s", "ond", "onds")),
        ("s", "sec", ("", "s", "ond", "onds")),
        ("min", "minute", ("", "s")),
        ("h", "hour", ("", "s")),
    )
    for word in (stem + end for end in ends)
}
