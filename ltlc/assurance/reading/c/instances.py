"""The instances that emitted C has where a property is judged from each message on, said a second time: as C."""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.assurance.reading.c.members import Given, Struct, declared
from ltlc.assurance.reading.c.tables import in_all
from ltlc.dataclass import dataclass
from ltlc.program.types import TEXT
from ltlc.specification.specification import Instances, topics_of


@dataclass(frozen=True)
class OpenTable:
    """The instances of one property, whose struct has clock steps if it `is_timed`; `given` is what comes in.

    An instance opens with the news called `mark`. There is a session to begin if it `has_session`.
    """

    prefix: str
    struct: Struct
    instances: Instances
    given: Given
    mark: str
    is_timed: bool
    has_session: bool

    def types(self) -> dict[str, str]:
        """The types that there have to be, by their names without the prefix."""
        prefix, constant = self.prefix, self.prefix.upper()
        due = "int64_t due; " if self.is_timed else ""
        counts = " ".join(f"uint32_t {each};" for each in ("count", "satisfied", "violated", "left_out", "no_step"))
        return {
            "size": f"enum {{ {constant}_LIMIT = {self.instances.limit or 0} }}",
            "instance": f"struct {{ int64_t opened_at; {prefix}_monitors monitors; uint32_t more; }}",
            "violation": "struct { int64_t opened_at; int64_t since; }",
            "instances": f"struct {{ {prefix}_instance open[{constant}_LIMIT]; {prefix}_monitors before; "
            f"{prefix}_violation first; {prefix}_violation last; int64_t time; {due}{counts} }}",
        }

    def functions(self) -> Iterator[str]:
        """The functions that there have to be."""
        words = {
            "p": self.prefix,
            "P": self.prefix.upper(),
            "name": self.struct.name,
            "mark": f"one->monitors.signals.{self.mark}",
            "opens": " || ".join(self.given.news(topics_of(self.instances.signal))),
        }
        own = (self._alike(), _DECIDED, _MERGED, self._go_on(), *self._calls())
        for text in (*in_all("instances", self.is_timed, is_shared=True), *own):
            yield text % words

    def _apart(self) -> Iterator[tuple[str, str, list[str]]]:
        """What distinguishes instances: the declarations and names of members, and what of them is compared."""
        yield from (("int64_t ", due, [""]) for due in self.struct.dues)
        yield f"uint{self.struct.width}_t ", "state", [""]
        registers = self.struct.of.machine.registers
        for name, register in zip(self.struct.kept, registers, strict=True):
            type_ = register.kept.type
            parts = [".elements", ".length"] if type_.is_array else [""]
            yield declared(self.prefix, type_), name, parts

    def _alike(self) -> str:
        registers = zip(self.struct.kept, self.struct.of.machine.registers, strict=True)
        texts = {name for name, register in registers if register.kept.type == TEXT}
        same = [
            f"same_text(one->{name}, other->{name})" if name in texts else f"one->{name}{part} == other->{name}{part}"
            for _, name, parts in self._apart()
            for part in parts
        ]
        return f"""static bool is_alike(const %(p)s_%(name)s *one, const %(p)s_%(name)s *other) {{
            return {" && ".join(same)}; }}"""

    def _given(self, run: str) -> str:
        """One of the runs gets what comes, or the time."""
        if not self.is_timed:
            return f"(void)%(p)s_step(&{run}, time, samples);"
        return f"take(&{run}, time, samples); all->due = sooner(all->due, %(p)s_next_deadline(&{run}));"

    def _go_on(self) -> str:
        """All go on as far as they are open and unlike others; one that has just opened has taken its step."""
        old = " ".join(f"const {type_}old_{name} = own->{name};" for type_, name, _ in self._apart())
        changed = " || ".join(
            f"old_{name}{part} != own->{name}{part}" for _, name, parts in self._apart() for part in parts
        )
        return f"""static void go_on(%(p)s_instances *all, int64_t time, const %(p)s_samples *samples) {{
            const uint32_t count = all->count; bool has_changed = false; all->count = 0;
            {"all->due = %(P)s_NEVER;" if self.is_timed else ""}
            for (uint32_t place = 0; place < count; place++) {{
                %(p)s_instance *const one = &all->open[place];
                const %(p)s_%(name)s *const own = &one->monitors.%(name)s;
                const uint32_t invalid = own->invalid; const bool opens = %(mark)s;
                {old}
                {self._given("one->monitors")} %(mark)s = false;
                has_changed = has_changed || {changed};
                if (opens && (own->verdict == %(P)s_NOT_STARTED || own->invalid != invalid)) {{
                    all->no_step = counted(all->no_step, 1u);
                }} else if (!is_decided(all, place) && !(has_changed && is_merged(all, place))) {{
                    if (all->count != place) {{ all->open[all->count] = *one; }}
                    all->count++; }} }}
            {self._given("all->before")} }}"""

    def _calls(self) -> Iterator[str]:
        """What the header declares."""
        never = "all->due = %(P)s_NEVER;" if self.is_timed else ""
        yield f"""void %(p)s_instances_init(%(p)s_instances *all) {{
            *all = (%(p)s_instances){{0}}; all->time = INT64_MIN; {never} %(p)s_init(&all->before); }}"""
        if self.has_session:
            due = "all->due = %(p)s_next_deadline(&all->before);" if self.is_timed else ""
            yield f"""bool %(p)s_instances_begin(%(p)s_instances *all, int64_t time) {{
                if (!%(p)s_instances_advance(all, time) || !%(p)s_begin(&all->before, time)) {{ return false; }}
                {due} return true; }}"""
        yield """bool %(p)s_instances_step(%(p)s_instances *all, int64_t time, const %(p)s_samples *samples) {
            if (!%(p)s_instances_advance(all, time)) { return false; }
            const bool opens = %(opens)s; const bool has_place = all->count < %(P)s_LIMIT;
            if (opens && has_place) {
                %(p)s_instance *const one = &all->open[all->count];
                one->opened_at = time; one->monitors = all->before; %(mark)s = true; one->more = 0; all->count++;
            } else if (opens) { all->left_out = counted(all->left_out, 1u); }
            go_on(all, time, samples); return has_place || !opens; }"""
        yield """%(p)s_verdict %(p)s_instances_verdict(const %(p)s_instances *all) {
            if (all->violated > 0u) { return %(P)s_VIOLATED; }
            for (uint32_t place = 0; place < all->count; place++) {
                if (all->open[place].monitors.%(name)s.verdict == %(P)s_PRESUMABLY_VIOLATED) {
                    return %(P)s_PRESUMABLY_VIOLATED; } }
            const bool has_started = all->before.%(name)s.verdict != %(P)s_NOT_STARTED;
            return has_started ? %(P)s_PRESUMABLY_SATISFIED : %(P)s_NOT_STARTED; }"""


_DECIDED = """static bool is_decided(%(p)s_instances *all, uint32_t place) {
    const %(p)s_instance *const one = &all->open[place];
    const %(p)s_%(name)s *const own = &one->monitors.%(name)s; const uint32_t many = counted(one->more, 1u);
    if (own->verdict == %(P)s_SATISFIED) { all->satisfied = counted(all->satisfied, many); return true; }
    if (own->verdict != %(P)s_VIOLATED) { return false; }
    if (all->violated == 0u || own->since < all->first.since) {
        all->first.opened_at = one->opened_at; all->first.since = own->since; }
    if (all->violated == 0u || own->since >= all->last.since) {
        all->last.opened_at = one->opened_at; all->last.since = own->since; }
    all->violated = counted(all->violated, many); return true; }"""
"""One that is decided is counted, with those that it stands for; of the violated, the first and the last are known."""

_MERGED = """static bool is_merged(%(p)s_instances *all, uint32_t place) {
    const %(p)s_instance *const one = &all->open[place];
    for (uint32_t other = 0; other < all->count; other++) {
        %(p)s_instance *const earlier = &all->open[other];
        if (is_alike(&earlier->monitors.%(name)s, &one->monitors.%(name)s)) {
            earlier->more = counted(earlier->more, counted(one->more, 1u)); return true; } }
    return false; }"""
"""One that goes on like an earlier one is counted there."""
