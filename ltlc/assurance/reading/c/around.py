"""What emitted C does around the steps of its properties, said a second time from the specification: as C.

It is compared as trees with what the text has. `_` begins the names of what it leaves open: values that are computed,
and what steps are given.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction

from ltlc.assurance.reading.c.definitions import parameters
from ltlc.assurance.reading.c.ids import Table
from ltlc.assurance.reading.c.instances import OpenTable
from ltlc.assurance.reading.c.members import Kept, Members, Pace, Struct
from ltlc.assurance.reading.trees import NotUnderstoodError
from ltlc.program.types import TEXT
from ltlc.runtime.times import NEVER, SECOND
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Field, New
from ltlc.specification.specification import Instances, Slicing, news_within, topics_of


def when(condition: str, *then: str, otherwise: Sequence[str] = ()) -> str:
    """An `if` statement."""
    rest = f" else {{ {' '.join(otherwise)} }}" if otherwise else ""
    return f"if ({condition}) {{ {' '.join(then)} }}{rest}"


def some(parts: Sequence[str]) -> str:
    """At least one of several parts holds; it may stand among those of a conjunction."""
    return f"({' || '.join(parts)})"


class Around:
    """The functions of a file; `steps` and `expires` are the names of the properties that have functions called so.

    `rate` is in Hz and `timeout` in ns, None if there is none.
    """

    def __init__(
        self, members: Members, steps: Iterable[str], expires: Iterable[str], rate: float | None, timeout: int | None
    ) -> None:
        self.given, self.prefix, self.definitions = members.given, members.prefix, members.definitions
        self.structs, self.paces = members.structs, members.paces
        self.steps, self.expires = frozenset(steps), frozenset(expires)
        self.rate, self.timeout = rate, timeout
        self.never = f"{self.prefix.upper()}_NEVER"
        self.holding = [pace for pace in self.paces if any(each.name in self.expires for each in pace.properties)]
        self.has_session = any(each.is_from_session or each.ages for each in self.structs)
        self.is_aging = any(each.ages for each in self.structs)
        self.table = self._table()

    def _table(self) -> Table | OpenTable | None:
        """The table of ids or instances, if the only property of a file is judged for each."""
        of, is_timed = [each.of.specification.slicing for each in self.structs], bool(self.expires)
        match of:
            case [Slicing() as slicing]:
                return Table(self.prefix, self.structs[0], slicing, self.given, is_timed)
            case [Instances() as instances]:
                mark = self.paces[0].heard[instances.mark.name]
                own = (self.prefix, self.structs[0], instances, self.given, mark)
                return OpenTable(*own, is_timed, self.has_session)
            case _ if any(of):
                raise NotUnderstoodError("a property that is judged for each id or message is in a file of its own")
            case _:
                return None

    def types(self) -> dict[str, str]:
        """The types of the header that are of this file only, but for the names of its properties."""
        prefix, is_rated = self.prefix, self.rate is not None
        verdicts = (Verdict.NOT_STARTED, *(each for each in Verdict if each is not Verdict.NOT_STARTED))
        found = {"verdict": f"enum {{ {', '.join(f'{prefix.upper()}_{each.name}' for each in verdicts)} }}"}
        found |= {struct.name: _struct(struct.declared(prefix)) for struct in self.structs}
        found["samples"] = _struct(self.given.declared(prefix))
        if is_rated:
            found["ticks"] = _struct(["int64_t next", "uint64_t fraction", "bool have_begun"])
        found |= {pace.name: _struct(pace.declared(prefix, is_rated)) for pace in self.paces}
        own = [f"{prefix}_{name} {name}" for name in (*(s.name for s in self.structs), *(p.name for p in self.paces))]
        own += [f"{prefix}_samples latest"] if is_rated else []
        own += ["bool has_session"] if self.has_session else []
        own += [] if self.timeout is None else ["bool is_over", "int64_t end"]
        found["monitors"] = _struct([*own, "int64_t time"])
        found |= self.table.types() if self.table else {}
        return {f"{prefix}_{name}": f"typedef {text} {prefix}_{name};" for name, text in found.items()}

    def functions(self) -> list[str]:
        """The functions that are of this file only, but for the steps of properties."""
        monitors, samples = f"{self.prefix}_monitors *monitors", f"const {self.prefix}_samples *samples"
        at, coming = f"{monitors}, int64_t time", f"{monitors}, int64_t time, {samples}"
        of = f"const {monitors}, {self.prefix}_property property"
        found: dict[str, Iterable[str]] = {}
        for pace in self.paces:
            found[f"static void judge{pace.suffix}({coming})"] = self.judge(pace)
            for each in pace.properties:
                if self.triggers(pace, each):
                    found[f"static bool {each.name}_is_due({coming})"] = self.is_due(pace, each)
                if each.ages:
                    found[f"static void {each.name}_hear({self.told(each)})"] = self.hear(each)
        for pace in self.holding:
            found[f"static void hold{pace.suffix}({at})"] = self.hold(pace)
        if self.rate is not None:
            found[f"static bool is_tick({self.prefix}_ticks *ticks, int64_t time)"] = self.is_tick(self.rate)
            found[f"static int64_t next_tick(const {monitors})"] = self.next_tick()
            found[f"static void tick({at})"] = self.tick()
        found[f"static bool pass({at})"] = self.pass_()
        if self.has_session:
            found[f"static bool begin_session({at})"] = self.begin_session()
            found[f"bool {self.prefix}_begin({at})"] = self.begin()
        if self.has_session and self.rate is None:
            found[f"static void first_steps({at})"] = self.first_steps()
        found[f"void {self.prefix}_init({monitors})"] = self.init()
        found[f"bool {self.prefix}_step({coming})"] = self.step()
        if self.expires or self.rate is not None or self.timeout is not None:
            found[f"bool {self.prefix}_advance({at})"] = self.advance()
            found[f"int64_t {self.prefix}_next_deadline(const {monitors})"] = self.next_deadline()
        for name, type_, shown in (
            ("verdict", f"{self.prefix}_verdict", "({0}_verdict)monitors->{1}.verdict"),
            ("steps", "uint32_t", "monitors->{2}.together + monitors->{1}.apart - monitors->{1}.invalid"),
            ("invalid", "uint32_t", "monitors->{1}.invalid"),
            ("since", "int64_t", "monitors->{1}.since"),
        ):
            found[f"{type_} {self.prefix}_{name}_of({of})"] = self.of_each(shown, is_verdict=name == "verdict")
        own = [f"{head} {{ {' '.join(body)} }}" for head, body in found.items()]
        return [*own, *(self.table.functions() if self.table else ())]

    def triggers(self, pace: Pace, struct: Struct) -> list[str]:
        """One of these holds where a step of a property may be due; with a rate, any tick is one of its news.

        What opens an instance is one of all.
        """
        if self.rate is not None and (struct.news or struct.is_from_session):
            return ["true"]
        slicing = struct.of.specification.slicing
        opening = self.given.news(topics_of(slicing.signal)) if isinstance(slicing, Instances) else ()
        news = (f"signals->{pace.heard[topic]}" for topic in struct.news)
        return list(dict.fromkeys([*self.given.fresh(struct.inputs), *news, *opening]))

    def is_due(self, pace: Pace, struct: Struct) -> list[str]:
        """Something that it reads is new, all of it has a value, and no number that is read is NaN."""
        triggers, ready = self.triggers(pace, struct), pace.ready(self.given, struct.waited)
        numbers = pace.numbers(struct)
        text = [when(f"!{some(triggers)}", "return false;")] if triggers != ["true"] else []
        text += [when(f"!({' && '.join(ready)})", "return false;")] if ready else []
        text.append("self->apart++;")
        for wanted, news in struct.excused:
            has, came = pace.ready(self.given, [wanted]), map(pace.place, news)
            missed = " && ".join([f"!({' && '.join(has)})" if len(has) > 1 else f"!{has[0]}", *came])
            text.append(when(missed, "self->invalid++;", "return false;"))
        if numbers:
            text.append(when(some([f"{each} != {each}" for each in numbers]), "self->invalid++;", "return false;"))
        text += [self.started(struct, "self->")] if struct.undefined == struct.values else []
        own = [f"{self.prefix}_{struct.name} *const self = &monitors->{struct.name};"]
        if any("signals->" in each for each in text):
            own.append(f"const {self.prefix}_{pace.name} *const signals = &monitors->{pace.name};")
        return [*own, *text, "return true;"]

    def started(self, struct: Struct, own: str, *further: str, also: str = "") -> str:
        """The first step sets the verdict, and presumes that something has occurred; `also` has to hold."""
        verdict = struct.of.machine.states[0].verdict
        constant = f"{self.prefix.upper()}_"
        presumed = ((name, count.duration) for name, count in struct.counts.items() if count.presumed)
        dues = (f"{own}{name} = time + INT64_C({duration});" for name, duration in presumed)
        body = (f"{own}verdict = {constant}{verdict.name};", f"{own}since = time;", *dues)
        return when(f"{own}verdict == {constant}{Verdict.NOT_STARTED.name}{also}", *body, *further)

    def hear(self, struct: Struct) -> Iterator[str]:
        """Messages renew ages: where one was late, a clock step is due, or a step."""
        for name, signal in zip(self.news_of(struct), self.aged(struct), strict=True):
            clocks = {due: age.duration for due, age in struct.ages.items() if age.signal == signal}
            late = some([f"time > self->{due}" for due in clocks])
            has_begun = f"self->verdict != {self.prefix.upper()}_NOT_STARTED"
            anew = (f"self->{due} = time + INT64_C({duration});" for due, duration in clocks.items())
            yield when(name, when(f"{late} && {has_begun}", "self->due = time - 1;"), *anew)

    def told(self, struct: Struct) -> str:
        """What the function that does so is given."""
        news = (f"bool {name}" for name in self.news_of(struct))
        return ", ".join([f"{self.prefix}_{struct.name} *self", "int64_t time", *news])

    def news_of(self, struct: Struct) -> list[str]:
        """What that function calls whether messages come."""
        return [each.name for each in parameters(self.definitions.function(f"{struct.name}_hear"))[2:]]

    def aged(self, struct: Struct) -> list[str]:
        """The signals of whose messages ages count, in the order in which a property hears of them."""
        return list(dict.fromkeys(age.signal for age in struct.ages.values()))

    def heard(self, struct: Struct) -> str:
        """How a property learns of messages from which its ages count."""
        signals = {i.signal.name: i.signal for i in struct.inputs if isinstance(i, New)}
        told = [some(self.given.news(topics_of(signals[name]))) for name in self.aged(struct)]
        return f"{struct.name}_hear({', '.join([f'&monitors->{struct.name}', 'time', *told])});"

    def judge(self, pace: Pace) -> Iterator[str]:
        """What has come is kept, what depends on it is computed, and properties are stepped."""
        yield f"{self.prefix}_{pace.name} *const signals = &monitors->{pace.name};"
        if pace.groups:
            seen = (f"signals->{g.flag} = signals->{g.flag} || samples->{g.flag};" for g in pace.groups)
            excuses = any(struct.of.machine.excused for struct in pace.properties)
            yield from seen if excuses else [when("!signals->has_started", *seen)]
        yield f"const bool all = {' && '.join(f'samples->{g.flag}' for g in pace.groups) or 'true'};"
        yield from self.kept(pace)
        for number, kept in enumerate((*pace.kept.values(), *pace.values.values())):
            if not isinstance(kept.of.definition, Field):
                pushed = kept.pushed(f"_value_{number}")
                holds = pushed if kept.of.when is None else when(f"_when_{number}", pushed)
                yield when(self.computed(pace, kept), holds)
        yield f"const bool together = {' && '.join(self.together(pace))};"
        yield "signals->together += together ? 1u : 0u;"
        for struct in pace.properties:
            if self.triggers(pace, struct):
                due = f"{struct.name}_is_due(monitors, time, samples)"
                is_stepped = struct.name in self.steps
                yield (
                    when(f"together || {due}", f"_step_{struct.name};")
                    if is_stepped
                    else when("!together", f"(void){due};")
                )
        yield when("!signals->has_started", f"signals->has_started = {' && '.join(self.have_started(pace))};")
        yield from self.timed_out(pace)

    def kept(self, pace: Pace) -> Iterator[str]:
        """The samples that have come; all at once where they come at once, and none is kept in a history."""
        pushed = {
            group.flag: [pace.kept[s].pushed(f"samples->{name}") for s, name in group.fields.items() if s in pace.kept]
            for group in pace.groups
        }
        plain = [g.flag for g in pace.groups if all(pace.kept[s].depth == 1 for s in g.fields if s in pace.kept)]
        each = {flag: when(f"samples->{flag}", *text) for flag, text in pushed.items()}
        if len(plain) > 1:
            yield when(
                "all", *(text for flag in plain for text in pushed[flag]), otherwise=[each[flag] for flag in plain]
            )
        yield from (text for flag, text in each.items() if len(plain) == 1 and flag in plain)
        yield from (text for flag, text in each.items() if flag not in plain)

    def computed(self, pace: Pace, kept: Kept) -> str:
        """When there is a new value of what is computed, of some only where something else holds, too."""
        parts = kept.of.inputs
        news = dict.fromkeys(topic for new in news_within(parts) for topic in topics_of(new.signal))
        fresh = [*self.given.fresh(parts), *(f"signals->{pace.heard[topic]}" for topic in news)]
        return " && ".join([some(fresh), *pace.ready(self.given, parts)]) if fresh else "false"

    def together(self, pace: Pace) -> list[str]:
        """All of these hold if all samples come at once, and no property needs to be asked whether it is due."""
        alone = (each for each in pace.properties if each.news and not self.given.fresh(each.inputs))
        numbers = [each for struct in pace.properties for each in pace.numbers(struct)]
        values = [each.ago() for each in pace.values.values()]
        numbers = [each for each in dict.fromkeys(numbers) if each not in values]
        asked = [some(self.triggers(pace, struct)) for struct in alone if self.rate is None]
        return ["signals->has_started", "all", *asked, *(f"{each} == {each}" for each in (*numbers, *values))]

    def have_started(self, pace: Pace) -> list[str]:
        """Whether each property has."""
        return [f"monitors->{each.name}.verdict != {self.prefix.upper()}_NOT_STARTED" for each in pace.properties]

    def timed_out(self, pace: Pace) -> list[str]:
        """Once a property has started, it is known when the run ends."""
        if self.timeout is None:
            return []
        is_first = f"monitors->end == {self.never} && {some(self.have_started(pace))}"
        return [when(is_first, f"monitors->end = time + INT64_C({self.timeout});")]

    def hold(self, pace: Pace) -> list[str]:
        """The clock steps up to a time are taken."""
        names = [each.name for each in pace.properties if each.name in self.expires]
        return [f"while (time > monitors->{name}.due) {{ {name}_expire(&monitors->{name}); }}" for name in names]

    def init(self) -> list[str]:
        """All is 0, but that nothing is due and there has been no time yet."""
        never = (
            f"monitors->{each.name}.{due} = {'-' if due in each.counts else ''}{self.never};"
            for each in self.structs
            for due in each.dues
        )
        end = [] if self.timeout is None else [f"monitors->end = {self.never};"]
        values = (text for pace in self.paces for text in self.values_at_first(pace))
        return [f"*monitors = ({self.prefix}_monitors){{0}};", "monitors->time = INT64_MIN;", *end, *never, *values]

    def values_at_first(self, pace: Pace) -> Iterator[str]:
        """What has a value before its first sample has that, and strings that may be read then are empty."""
        names = {e.input.signal for s in pace.properties for e in s.of.machine.excused}
        for number, (signal, kept) in enumerate(pace.kept.items()):
            place = f"monitors->{pace.name}.{kept.name}{'[0]' if kept.depth > 1 else ''}"
            if signal.otherwise is not None:
                yield f"{place} = _first{pace.suffix}_{number};"
            elif signal.name in names and kept.type == TEXT:
                yield f'{place} = "";'

    def begin_session(self) -> list[str]:
        """Ticks that begin with the session do, and ages count from there."""
        ticks = [
            f"monitors->{pace.name}.ticks.{begun};"
            for pace in self.paces
            if self.rate is not None and pace.begin is None
            for begun in ("have_begun = true", "next = time")
        ]
        ages = (
            f"monitors->{struct.name}.{name} = time + INT64_C({age.duration});"
            for struct in self.structs
            for name, age in struct.ages.items()
        )
        once = when("monitors->has_session", "return false;")
        return [once, "monitors->has_session = true;", *ticks, *ages, "return true;"]

    def first_steps(self) -> list[str]:
        """What begins with the session and has not is stepped, without news."""
        (pace,) = self.paces
        text = [f"monitors->{pace.name}.{name} = false;" for name in pace.heard.values()]
        for struct in self.structs:
            if struct.is_from_session:
                own = f"monitors->{struct.name}."
                step = [f"_first_{struct.name};"] if struct.name in self.steps else []
                silent = f" && {own}invalid == 0" if struct.of.machine.excused else ""
                text.append(self.started(struct, own, f"{own}apart++;", *step, also=silent))
        return [*text, *self.timed_out(pace)]

    def step(self) -> Iterator[str]:
        """What is due is done, news is noted, ages are renewed; then what has come is judged, or kept for ticks."""
        yield when("!pass(monitors, time)", "return false;")
        if self.has_session:
            yield (
                "(void)begin_session(monitors, time);"
                if self.rate is not None
                else "const bool is_first = begin_session(monitors, time);"
            )
        for pace in self.paces:
            yield from self.ticking(pace)
            for topic, name in pace.heard.items():
                if topic in self.given.marks:
                    continue
                target = f"monitors->{pace.name}.{name}"
                before = [target] if self.rate is not None else []
                yield f"{target} = {' || '.join([*before, *self.given.news([topic])])};"
        yield from (self.heard(struct) for struct in self.structs if struct.ages)
        if self.rate is None:
            yield "judge(monitors, time, samples);"
            yield from ("hold(monitors, time);" for _ in range(self.is_aging))
            yield from (when("is_first", "first_steps(monitors, time);") for _ in range(self.has_session))
        else:
            yield from self.merged()
        yield "return true;"

    def ticking(self, pace: Pace) -> list[str]:
        """Ticks begin with the first sample, or news, on a topic that is read."""
        if self.rate is None or not pace.begin:
            return []
        own = f"monitors->{pace.name}.ticks"
        begun = (f"{own}.have_begun = true;", f"{own}.next = time;")
        return [when(f"!{own}.have_begun && {some(self.given.news(pace.begin))}", *begun)]

    def merged(self) -> Iterator[str]:
        """Samples are kept for the next tick; unless that is now, what ages make due is done."""
        for group in self.given.groups:
            kept = (f"monitors->latest.{name} = samples->{name};" for name in group.fields.values())
            yield when(f"samples->{group.flag}", *kept, f"monitors->latest.{group.flag} = true;")
        for pace in self.paces:
            if any(each.ages for each in pace.properties):
                own = f"monitors->{pace.name}.ticks"
                yield when(f"!{own}.have_begun || {own}.next != time", f"hold{pace.suffix}(monitors, time);")

    def held(self, time: str) -> list[str]:
        """All clock steps up to `time`."""
        return [f"hold{pace.suffix}(monitors, {time});" for pace in self.holding]

    def is_tick(self, rate: float) -> list[str]:
        """Whether there is a tick; the next one is a period later, of which a fraction of a nanosecond is kept."""
        period = SECOND / Fraction(repr(rate))
        whole, rest = divmod(period.numerator, period.denominator)
        one = f"UINT64_C({period.denominator})"
        left = when(f"ticks->fraction >= {one}", f"ticks->fraction -= {one};", "ticks->next++;")
        return [
            when("!ticks->have_begun || ticks->next != time", "return false;"),
            f"ticks->next += INT64_C({min(whole, NEVER)});",
            *([f"ticks->fraction += UINT64_C({rest});", left] if rest else []),
            "return true;",
        ]

    def next_tick(self) -> Iterator[str]:
        """The first of those of all paces."""
        yield f"int64_t next = {self.never};"
        for pace in self.paces:
            own = f"monitors->{pace.name}.ticks"
            yield when(f"{own}.have_begun && {own}.next < next", f"next = {own}.next;")
        yield "return next;"

    def tick(self) -> Iterator[str]:
        """What is due before passes, and each pace that ticks is judged; then news is over, and ages may be due."""
        yield from [when("monitors->time < time", *self.held("time"))] if self.is_aging else self.held("time")
        for pace in self.paces:
            over = (f"monitors->{pace.name}.{name} = false;" for name in pace.heard.values())
            judged = f"judge{pace.suffix}(monitors, time, &monitors->latest);"
            yield when(f"is_tick(&monitors->{pace.name}.ticks, time)", judged, *over)
        aging = (pace for pace in self.paces if any(each.ages for each in pace.properties))
        yield from (f"hold{pace.suffix}(monitors, time);" for pace in aging)

    def pass_(self) -> Iterator[str]:
        """What is due before a time is done, unless that is no time or the run is over."""
        over = " || monitors->is_over" if self.timeout is not None else ""
        yield when(f"time <= -{self.never} || time >= {self.never} || time < monitors->time{over}", "return false;")
        if self.rate is not None:
            end = " && next <= monitors->end" if self.timeout is not None else ""
            yield "int64_t next = next_tick(monitors);"
            yield f"while (next < time{end}) {{ tick(monitors, next); next = next_tick(monitors); }}"
        if self.timeout is not None:
            ended = ("monitors->is_over = true;", *self.held("monitors->end"), "return false;")
            yield when("time > monitors->end", *ended)
        is_once = self.is_aging and self.rate is not None
        yield from [when("monitors->time < time", *self.held("time"))] if is_once else self.held("time")
        yield from ("monitors->time = time;", "return true;")

    def begin(self) -> list[str]:
        """The session begins, if it has not."""
        first = ["first_steps(monitors, time);"] if self.rate is None else []
        once = when("!pass(monitors, time) || !begin_session(monitors, time)", "return false;")
        return [once, *first, "return true;"]

    def advance(self) -> list[str]:
        """What is due up to a time is done."""
        tick = [when("next_tick(monitors) <= time", "tick(monitors, time);")] if self.rate is not None else []
        return [when("!pass(monitors, time)", "return false;"), *tick, "return true;"]

    def next_deadline(self) -> Iterator[str]:
        """The first clock step, or tick, before the end of the run."""
        yield f"int64_t next = {self.never};"
        for struct in self.structs:
            if struct.name in self.expires:
                due = f"monitors->{struct.name}.due"
                yield when(f"{due} < next", f"next = {due} + 1;")
        if self.rate is not None:
            yield when("next_tick(monitors) < next", "next = next_tick(monitors);")
        if self.timeout is not None:
            yield when("monitors->is_over || next > monitors->end", f"next = {self.never};")
        yield "return next;"

    def of_each(self, shown: str, is_verdict: bool) -> list[str]:
        """Something of the property with a number."""
        names = [each.name for each in self.definitions.type(f"{self.prefix}_property").values.enumerators]
        paces = {each.name: pace.name for pace in self.paces for each in pace.properties}
        cases = (
            f"case {constant}: return {shown.format(self.prefix, struct.name, paces[struct.name])};"
            for constant, struct in zip(names, self.structs, strict=True)
        )
        none = f"{self.prefix.upper()}_NOT_STARTED" if is_verdict else "0"
        return [f"switch (property) {{ {' '.join(cases)} default: return {none}; }}"]


def _struct(members: Iterable[str]) -> str:
    return f"struct {{ {' '.join(f'{each};' for each in members)} }}"
