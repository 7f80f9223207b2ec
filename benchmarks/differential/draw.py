"""Draws specifications by the grammar and the types."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from random import Random

from benchmarks.differential.draw_recordings import Recordings
from ltlc.base.source import Source
from ltlc.frontend.language import load_text

DECLARATIONS = """\
decl v /v Float64.data
decl w /w Float64.data
decl f /f Float32.data
decl g /g Float32.data
decl small /small Int8.data
decl byte /byte UInt8.data
decl i /i Int64.data
decl u /u UInt64.data
decl flag /flag Bool.data
decl mode /mode String.data
decl scan /scan LaserScan.ranges
decl many /many Float64MultiArray.data
decl ints /ints Int64MultiArray.data
decl uints /uints UInt64MultiArray.data
decl ids /marks MarkerArray.markers[].id
decl kinds /marks MarkerArray.markers[].ns
decl locked /marks MarkerArray.markers[].frame_locked
decl marks /marks MarkerArray
decl bump /bump std_msgs/Empty
decl pair_x /pair Vector3.x
decl pair_y /pair Vector3.y
object robot /robot Odometry
object cart /cart Odometry
object sign at (1, 2, 0.5)
zone hall = [(0, 0), (2, 0), (2, 0.3), (1.1, 0.1), (-0.3, 3)]
"""

NUMBERS = ("v", "w", "f", "g", "small", "byte", "i", "u", "pair_x", "pair_y")
OF_ONE = ("sqrt", "floor", "ceil", "sign", "exp", "log", "sin", "cos", "tan", "asin", "acos")
OF_TWO = ("mod", "atan2", "hypot", "angle_between")
ARRAYS = ("scan", "many", "ints", "uints", "ids")
MESSAGES = ("bump", "marks")
DURATIONS = ("1 s", "500 ms", "2 s", "100 ms", "0.3 s", "3 ns", "1 ns")
RATES = ("1 Hz over 1 s", "2 Hz over 2 s", "6 Hz over 500 ms", "10 Hz over 0.3 s", "1000000000 Hz over 3 ns")
INTERVALS = ("[1 s, 2 s]", "[100 ms, 500 ms]", "[0.3 s, 2 s]", "[1 ns, 3 ns]", "[1 ns, 1 s]", "[0 s, 1 s]")


class Draw(Recordings):
    """Draws from one source of chance properties whose text has `having` in it."""

    def __init__(self, chance: Random, having: str = "") -> None:
        super().__init__(chance)
        self._having = having

    def specification(self, count: int) -> str:
        """A specification of so many properties."""
        pick, settings = self.chance.random, ""
        if pick() < 0.15:
            settings += f"_rate_ = {self.chance.choice(['10', '3', '7.5', '1'])}\n"
        if pick() < 0.1:
            settings += f"_timeout_ = {self.chance.choice(['3 s', '1.5 s', '10'])}\n"
        if pick() < 0.15:
            settings += f"_margin_ = {self.chance.choice(['0.1', '0.5', '0'])}\n"
        text = DECLARATIONS + settings + "soon = 500 ms\n" + f"fast = {self._atom(['v', 'f', 'small'])}\n"
        return text + "".join(f"p{number}: {self._accepted(text)}\n" for number in range(count))

    def _accepted(self, text: str) -> str:
        """A property that the language has."""
        while True:
            line = self._property()
            if self._having in line and load_text(Source("props.txt", f"{text}p: {line}\n"))[0] is not None:
                return line

    def _property(self) -> str:
        pick = self.chance.random
        self.is_timed = pick() < 0.5
        names = [*NUMBERS, *ARRAYS, *MESSAGES, "flag", "mode", "kinds", "locked", "robot", "robot", "cart"]
        names = self.chance.sample(names, self.chance.choice([1, 1, 2, 2, 3]))
        if pick() < 0.05:
            other = self.chance.choice(["w", "f", "small"])
            return f"forall r in {{v, {other}}}: " + self._over(["v"]).replace("v ", "r ").replace("{v,", "{r,")
        return self._over(names)

    def _over(self, names: Sequence[str]) -> str:
        self.names = list(names)
        self.pool = [self._atom(names) for _ in range(self.chance.randint(1, 3))]
        if self.is_timed and self.chance.random() < 0.3:
            self.pool = [f"(new {name} and {self._atom([name])})" for name in self.chance.choices(names, k=3)]
        if self.is_timed:
            self.pool += [self._timed_atom() for _ in range(self.chance.randint(0, 2))]
        if self.chance.random() < 0.2 and self._kept():
            return self._keeping()
        return self._temporal(self.chance.randint(1, 3), True)

    def _event(self, depth: int = 1) -> str:
        one = self.chance.choice(self.pool)
        kind = self.chance.random()
        if kind < 0.5 or depth == 0:
            return one
        if kind < 0.62:
            return f"not ({one})"
        if self.is_timed and kind < 0.8:
            return self._past(depth)
        if kind < 0.84:
            return f"({one} implies {self._event(depth - 1)})"
        return f"({one} {self.chance.choice(['and', 'or'])} {self._event(depth - 1)})"

    def _past(self, depth: int) -> str:
        one, other, d = self._event(depth - 1), self._event(0), self._duration()
        forms = [
            f"previously ({one})",
            f"once ({one})",
            f"(once ({one}) within {d})",
            f"historically ({one})",
            f"(historically ({one}) for {d})",
            f"({other} since {one})",
            f"({other} since ({one}) within {d})",
            f"(({other}) and not previously ({other}))",
            self._count(),
            self._count(),
        ]
        return self.chance.choice(forms)

    def _count(self) -> str:
        """How often something has occurred, or messages come."""
        pick, atom, name = self.chance.choice, self._atom(self.names), self.chance.choice(self.names)
        p = pick(
            [atom, f"not ({atom})", f"new {name}", f"new {name} and ({atom})", f"new {name} or new {self.names[0]}"]
        )
        times = f"once ({p}) {pick('11223359')} times"
        rate = f"rate({name}) {pick(['>=', '<'])} {pick(RATES)}"
        return pick(
            [f"({times})", f"({times} within {self._duration()})", f"({times} within {self._duration()})", rate]
        )

    def _timed_atom(self) -> str:
        name = self.chance.choice(self.names)
        relation = self.chance.choice(["<=", "<", ">", ">="])
        return self.chance.choice([f"new {name}", f"age({name}) {relation} {self._duration()}"])

    def _duration(self) -> str:
        return self.chance.choice([*DURATIONS, "soon"])

    def _temporal(self, depth: int, is_anchor: bool) -> str:
        pick, event = self.chance.choice, self._event
        d = self._duration()
        if depth == 0:
            leaf = f"{pick(['always', 'eventually', 'never', 'initially'])} {event()}"
            return f"({leaf})"
        inner, same = partial(self._temporal, depth - 1, False), partial(self._temporal, depth - 1, is_anchor)
        forms: list[Callable[[], str]] = [
            lambda: f"(always {pick([inner(), event()])})",
            lambda: f"(never {pick([inner(), event()])})",
            lambda: f"(eventually {pick([inner(), event()])})",
            lambda: f"({same()} and {pick([same(), event()])})",
            lambda: f"({same()} or {same()})",
            lambda: f"({same()} implies {same()})",
            lambda: f"(not {same()})",
            lambda: f"(after {event()}, {pick([same(), event()])})",
            lambda: f"(until {event()}, {pick([same(), event()])})",
            lambda: f"(after_until {event()}, {event()}, {pick([same(), event()])})",
            lambda: f"(after_until {event()}, {event()}, {same()})",
            lambda: f"(always (after_until {event()}, {event()}, {inner()}))",
            lambda: f"(always ({event()} implies eventually {event()}))",
            lambda: f"(always ({event()} implies {inner()}))",
        ]
        if self.is_timed and is_anchor:
            time = pick([d, d, pick(INTERVALS)])
            forms += [
                lambda: f"(within {time}, {same()})",
                lambda: f"(eventually {pick([event(), same()])} within {time})",
                lambda: f"(never {pick([event(), same()])} within {time})",
                lambda: f"(always {pick([event(), same()])} for {time})",
                lambda: f"(always ({event()} implies eventually {event()} within {d}))",
                lambda: f"(always ({event()} implies eventually {event()} within {d}))",
                lambda: f"(always eventually {event()} within {d})",
                lambda: f"(always ({event()} implies always {event()} for {d}))",
                lambda: f"(always ({event()} implies never {event()} within {d}))",
                lambda: f"(always (({event()} implies always {event()} for {d}) and {event()}))",
            ]
        return pick(forms)()

    def _keeping(self) -> str:
        """A property that reads values at openings."""
        event, kept, pick = self._event, self._kept, self.chance.choice
        body = [
            lambda: f"always {kept()}",
            lambda: f"never {kept()}",
            lambda: f"eventually {kept()}" + (f" within {self._duration()}" if self.is_timed else ""),
            lambda: f"(always {kept()}) or (eventually {event()})",
        ]
        forms = [
            f"after_until {event()}, {event()}, {pick(body)()}",
            f"after_until {event()}, {kept()}, {self._temporal(1, True)}",
            f"after_until {event()}, {event()} and {kept()}, {pick(body)()}",
            f"after {event()}, {pick(body)()}",
            f"after {event()}, after_until {event()}, {pick([event(), kept()])}, {pick(body)()}",
            f"({pick(body)()}) and (eventually {event()})",
        ]
        return pick(forms)

    def _kept(self) -> str:
        """A comparison with what was at the opening, which has a value whatever was."""
        forms = []
        for name in self.names:
            at, relation = f"@{{{name}, opening}}", self.chance.choice(["==", "!=", "<", "<=", ">", ">="])
            if name in NUMBERS:
                forms.append(f"{name} {relation} {at}")
            if name in ("small", "byte"):
                forms.append(f"abs({name} - {at}) {relation} {self.chance.choice('0123')}")
                forms.append(f"{name} {relation} {at} + 1")
            if name in ("mode", "flag"):
                forms.append(f"{name} {self.chance.choice(['==', '!='])} {at}" if name == "mode" else at)
            if name in ("scan", "many", "ints"):
                forms.append(f"any({name} {relation} {at})")
                forms.append(f"len({name}) {relation} len({at})")
        return self.chance.choice(forms) if forms else ""

    def _atom(self, names: Sequence[str]) -> str:
        name, pick = self.chance.choice(names), self.chance.choice
        if name in MESSAGES:
            return f"new {name}"
        if name == "flag":
            return pick(["flag", "not flag", "@{flag, -1}", "flag and not @{flag, -2}"])
        if name == "mode":
            return pick(['mode == "a"', 'mode != "b"', "mode == @{mode, -1}", 'mode in {"a", "c"}'])
        if name == "kinds":
            return pick(
                ['any(kinds == "a")', 'all(kinds != "b")', 'count(kinds == "c") >= 1', "any(ids == 1 and locked)"]
            )
        if name == "locked":
            return pick(["any(locked)", "all(not locked)", "count(locked) > 1", 'any(kinds == "a" or locked)'])
        if name in ("robot", "cart"):
            return self._geometric(name, [n for n in names if n in NUMBERS])
        if name in ARRAYS:
            others = [n for n in names if n in ARRAYS and n != name]
            if others and pick(range(3)) == 0:
                return self._of_two_arrays(name, pick(others))
            return self._of_array(name, [n for n in names if n in NUMBERS])
        if pick(range(12)) == 0:
            other = pick([n for n in names if n in NUMBERS] or [name])
            joined = pick([f"and {other} > 0", f"or not {other} > 1", "", ""])
            return f"@{{{name} < {self._literal(name)} {joined}, -{pick([1, 1, 2])}}}"
        if pick(range(12)) == 0:
            return f"{name} in {{{self._literal(name)}, {self._literal(name)}}}"
        if pick(range(12)) == 0:
            return f"{pick(['inside', '0.7 > distance'])}({name}, {self._number(name, names)}, hall)"
        if pick(range(8)) == 0:
            return self._of_samples(name, names)
        relation = pick(["<", "<=", ">", ">=", "==", "!="])
        margin = pick(["", "", "", "", "{0.1}", "{0.5}", "{1}", "{0}"])
        left = self._number(name, names)
        right = pick([self._literal(name), self._literal(name), self._literal(name), self._number(name, names)])
        left, right = (left, right) if pick(range(5)) else (right, left)
        return f"{left} {relation}{margin} {right}"

    def _of_samples(self, name: str, names: Sequence[str]) -> str:
        """What is said of the last samples of a number."""
        pick = self.chance.choice
        other = pick([n for n in names if n in NUMBERS] or [name])
        last = f"@{{{pick([name, name, f'{name} - {other}'])}, -{pick([1, 2, 2, 3, 5])}:}}"
        x = pick([self._literal(name), other])
        return pick(
            [
                f"all({last} >= {x})",
                f"any({last} == {x})",
                f"count({last} < {x}) > {pick([0, 1, 2])}",
                f"max({last}) - min({last}) < {x}",
                f"{pick(['mean', 'median', 'sum', 'min', 'max'])}({last}) > {x}",
                f"any(@{{{name} > {x}, -{pick([1, 2])}:}})",
                f"all({last}[1:] < {x})",
                f"any({last} > {name} or {last} < 0)",
            ]
        )

    def _literal(self, name: str) -> str:
        pick = self.chance.choice
        large = ["9007199254740993", "9007199254740992", "9223372036854775807"] if name in ("i", "u") else []
        return pick([*large, "0", "1", "2", "0.5", "0.3", "0.1", "1.1", "-1", "3", "2.5", "-0.3"])

    def _number(self, name: str, names: Sequence[str]) -> str:
        pick = self.chance.choice
        other = pick([n for n in names if n in NUMBERS] or [name])
        relation = pick(["<", ">=", "=="])
        event = pick([f"new {other}", f"{other} {relation} {self._literal(other)}", "flag", 'mode == "a" and new mode'])
        rich = [
            f"@{{{name}, -{pick([1, 1, 2, 3])}}}",
            f"@{{{name}, when {event}}}",
            f"{name} - @{{{name}, when {event}}}",
            f"@{{{name} - {other}, -{pick([1, 1, 2])}}}",
            f"@{{abs({other}), -1}}",
            f"abs({name})",
            f"-{name}",
            f"{name} + {other}",
            f"({name} - {other})",
            f"{name} / {other}",
            f"1 / {name}",
            f"{pick(OF_ONE)}({name})",
            f"{pick(OF_TWO)}({name}, {pick([other, '2', '-0.3'])})",
            f"{name} * 2 - 1",
            f"{name} - @{{{name}, -1}}",
            f"abs({name} - @{{{other}, -1}})",
        ]
        if name not in ("i", "u"):
            rich += [f"min({name}, {self._literal(name)})", f"max({name}, {pick([name, other])})"]
        return pick([name, name, name, pick(rich)])

    def _of_array(self, a: str, numbers: Sequence[str]) -> str:
        pick = self.chance.choice
        part = pick([a, a, f"{a}[0:2]", f"{a}[-2:]", f"{a}[1:]", f"{a}[:-1]", f"@{{{a}, -1}}", f"@{{{a}, -2}}[:2]"])
        x, relation = pick([self._literal(a), self._literal(a), *numbers]), pick(["<", "<=", ">", ">=", "==", "!="])
        element = pick(
            [
                part,
                part,
                f"abs({part})",
                f"-{part}",
                f"{pick(OF_ONE)}({part})",
                f"mod({part}, 2)",
                f"{part} * 2",
                f"min({part}, 1)",
            ]
        )
        element = pick([element, f"{part} - @{{{a}, -1}}"]) if part == a else element
        inside = pick(
            [f"{element} {relation} {x}", f"{x} {relation} {element}", f"{part} > 0 and {element} {relation} {x}"]
        )
        if a == "ids":
            inside = pick([inside, 'ids == 1 and kinds == "a"', f"ids {relation} {x} or locked", "ids in {1, 2}"])
        forms = [
            f"{pick(['any', 'all'])}(inside({element}, {pick([part, '0.5'])}, hall))",
            f"any({inside})",
            f"all({inside})",
            f"count({inside}) {relation} {pick(['1', '2', '0', x])}",
            f"min({part}) {relation} {x}",
            f"max({part}) {relation} {x}",
            f"sum({part}) {relation} {x}",
            f"median({part}) {relation} {x}",
            f"mean({part}) {relation} {x}",
            f"nearest({x}, {part}) {relation} {pick([x, '1'])}",
            f"len({part}) {relation} {pick('0123')}",
            f"any({part} {pick(['<', '>'])}{{0.1}} {x})",
            f"any({part} > min({a}) + 1)",
        ]
        return pick(forms)

    def _of_two_arrays(self, a: str, b: str) -> str:
        pick = self.chance.choice
        relation = pick(["<", "<=", ">", ">=", "==", "!="])
        b = pick([b, b, f"{b}[1:]"])
        said = pick(
            [f"{a} {relation} {b}", f"abs({a} - {b}) {relation} 1", f"{a} > 0 and {b} {relation} 1", f"{a} * {b} > 1"]
        )
        of = f"{said} over ({a}), ({b})"
        return pick([f"any({of})", f"all({of})", f"count({of}) {relation} {pick('0123')}"])

    def _geometric(self, name: str, numbers: Sequence[str]) -> str:
        pick = self.chance.choice
        other = "cart" if name == "robot" and self.chance.random() < 0.3 else "sign"
        forms = [
            f"{name}.distance.{other}",
            f"{name}.distanceZ.{other}",
            f"{name}.position.{pick('xyz')}",
            f"{name}.velocity",
            f"{name}.velocity.{pick('xyz')}",
            f"{name}.velocity.linear.{pick('xy')}",
            f"{name}.velocity_angular",
            f"{name}.velocity.angular.z",
        ]
        if self.chance.random() < 0.15:
            return f"inside({name}.position, hall)"
        if self.chance.random() < 0.15:
            return f"{name}.position {pick(['==', '!='])}{{{pick(['0.5', '1', '5'])}}} {other}.position"
        if self.chance.random() < 0.15:
            turn = pick(["orientation", "orientation.yaw", "orientation.roll", "orientation.pitch"])
            return f"{name}.{turn} {pick(['<', '>'])} {pick(['0.4', '-0.4', '1.3'])}"
        x = pick(["0", "1", "5", "2", "0.5", *numbers])
        return f"{pick(forms)} {pick(['<', '<=', '>', '>='])} {x}"
