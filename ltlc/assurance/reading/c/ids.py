"""The table of ids that emitted C has where a property is judged for each, said a second time: as C."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ltlc.assurance.reading.c.members import Given, Struct
from ltlc.assurance.reading.c.tables import in_all
from ltlc.dataclass import dataclass
from ltlc.program.as_new import states_as_new
from ltlc.program.types import type_of
from ltlc.specification.specification import Slicing, topics


@dataclass(frozen=True)
class Table:
    """The table for one property, whose struct has clock steps if it `is_timed`; `given` is what comes in."""

    prefix: str
    struct: Struct
    slicing: Slicing
    given: Given
    is_timed: bool

    @property
    def key(self) -> str:
        """The type of ids: that of the keys, if they agree."""
        kinds = {type_of(key).scalar.value for key in self.slicing.keys}
        return f"{kinds.pop()}_t" if len(kinds) == 1 else "int64_t"

    @property
    def shared(self) -> list[str]:
        """One of these holds where something comes that all ids get."""
        return self.given.news([t for t in topics(self.struct.of.specification) if t not in self.slicing.topics])

    @property
    def as_new(self) -> list[int]:
        """The states of which a slice need not be kept."""
        return sorted(states_as_new(self.struct.of.machine, self.struct.of.specification, self.slicing))

    def types(self) -> dict[str, str]:
        """The types that there have to be, by their names without the prefix."""
        prefix, limit = self.prefix, self.slicing.limit or 0
        constant = prefix.upper()
        unborn = f"{prefix}_monitors unborn; " if self.shared else ""
        due = "int64_t due; " if self.is_timed else ""
        return {
            "size": f"enum {{ {constant}_LIMIT = {limit}, {constant}_PLACES = {2 * limit} }}",
            "slice": f"struct {{ {self.key} id; {prefix}_monitors monitors; bool is_taken; bool lacks_beginning; }}",
            "ids": f"struct {{ {prefix}_slice slices[{constant}_PLACES]; {unborn}int64_t time; {due}"
            "uint32_t count; uint32_t left_out; bool has_started; }",
        }

    def functions(self) -> Iterator[str]:
        """The functions that there have to be."""
        own = (*_PLACES, *(_AS_NEW if self.as_new else ()), _settle(self), *_over_all(self), *_calls(self))
        for text in (*in_all("ids", self.is_timed, bool(self.shared)), *own):
            yield text % self._words()

    def _words(self) -> Mapping[str, str]:
        """What stands for the names in the texts."""
        name = f"monitors->{self.struct.name}"
        is_still = f" && {name}.due == {self.prefix.upper()}_NEVER" if self.is_timed else ""
        return {
            "p": self.prefix,
            "P": self.prefix.upper(),
            "key": self.key,
            "name": self.struct.name,
            "is_still": is_still,
            "states": " || ".join(f"{name}.state == {state}" for state in self.as_new),
            "foreign": "".join(f"{flag} || " for flag in self.shared),
            "own": "".join(f"{flag} || " for flag in self.given.news(list(self.slicing.topics))),
        }


_PLACES = (
    """static uint32_t place_of(%(key)s id) {
        uint64_t mixed = (uint64_t)id; mixed ^= mixed >> 32; mixed *= UINT64_C(0x9e3779b97f4a7c15);
        return (uint32_t)(mixed >> 32) %% %(P)s_PLACES; }""",
    """static uint32_t find(const %(p)s_ids *all, %(key)s id) {
        uint32_t place = place_of(id);
        while (all->slices[place].is_taken && all->slices[place].id != id) { place = (place + 1u) %% %(P)s_PLACES; }
        return place; }""",
)
"""An id stands where it is looked for, or behind it with no free place between."""

_AS_NEW = (
    """static bool is_as_new(const %(p)s_monitors *monitors) {
        return monitors->%(name)s.verdict == %(P)s_PRESUMABLY_SATISFIED%(is_still)s && (%(states)s); }""",
    """static void release(%(p)s_ids *all, uint32_t place) {
        uint32_t hole = place; uint32_t next = (place + 1u) %% %(P)s_PLACES;
        all->count -= 1u; all->slices[hole].is_taken = false;
        while (all->slices[next].is_taken) {
            const uint32_t home = place_of(all->slices[next].id);
            const bool moves = hole <= next ? (home <= hole || home > next) : (home <= hole && home > next);
            if (moves) { all->slices[hole] = all->slices[next]; all->slices[next].is_taken = false; hole = next; }
            next = (next + 1u) %% %(P)s_PLACES; } }""",
)
"""A slice that is as new is dropped, and those behind it still stand so."""


def _settle(table: Table) -> str:
    """What is done after a slice may have changed."""
    dropped = "if (is_as_new(monitors)) { release(all, place); return true; }" if table.as_new else ""
    due = "all->due = sooner(all->due, %(p)s_next_deadline(monitors));"
    return f"""static bool settle(%(p)s_ids *all, uint32_t place) {{
        const %(p)s_monitors *const monitors = &all->slices[place].monitors;
        all->has_started = all->has_started || monitors->%(name)s.verdict != %(P)s_NOT_STARTED;
        {dropped} {due if table.is_timed else ""} return false; }}"""


def _over_all(table: Table) -> Iterator[str]:
    """Each slice gets what comes, or the time; one that takes the place of another has its turn, too."""
    if not table.is_timed and not table.shared:
        return
    step = "(void)%(p)s_step(&slice->monitors, time, samples);"
    advance = "(void)%(p)s_advance(&slice->monitors, time);"
    given = "take(&slice->monitors, time, samples);" if table.is_timed else step
    samples = ", const %(p)s_samples *samples" if table.shared else ""
    yield f"""static void go_on(%(p)s_ids *all, int64_t time{samples}) {{
        uint32_t place = 0; {"all->due = %(P)s_NEVER;" if table.is_timed else ""}
        while (place < %(P)s_PLACES) {{
            %(p)s_slice *const slice = &all->slices[place];
            if (slice->is_taken) {{ {given if table.shared else advance} }}
            if (!slice->is_taken || !settle(all, place)) {{ place++; }} }} }}"""


def _calls(table: Table) -> Iterator[str]:
    """What the header declares."""
    unborn = "%(p)s_init(&all->unborn);" if table.shared else ""
    never = "all->due = %(P)s_NEVER;" if table.is_timed else ""
    yield f"""void %(p)s_ids_init(%(p)s_ids *all) {{
        *all = (%(p)s_ids){{0}}; all->time = INT64_MIN; {never} {unborn} }}"""
    born = "slice->monitors = all->unborn;" if table.shared else "%(p)s_init(&slice->monitors);"
    yield f"""bool %(p)s_ids_step(%(p)s_ids *all, int64_t time, %(key)s id, const %(p)s_samples *samples) {{
        if (%(foreign)s!%(p)s_ids_advance(all, time)) {{ return false; }}
        const uint32_t place = find(all, id);
        %(p)s_slice *const slice = &all->slices[place];
        if (!slice->is_taken) {{
            if (all->count == %(P)s_LIMIT) {{ all->left_out = counted(all->left_out, 1u); return false; }}
            all->count++; slice->id = id; slice->is_taken = true; slice->lacks_beginning = all->left_out > 0u; {born} }}
        (void)%(p)s_step(&slice->monitors, time, samples); (void)settle(all, place); return true; }}"""
    if table.shared:
        yield """bool %(p)s_ids_share(%(p)s_ids *all, int64_t time, const %(p)s_samples *samples) {
            if (%(own)s!%(p)s_ids_advance(all, time)) { return false; }
            (void)%(p)s_step(&all->unborn, time, samples); go_on(all, time, samples); return true; }"""
    yield """%(p)s_verdict %(p)s_ids_verdict(const %(p)s_ids *all) {
        bool is_owed = false;
        for (uint32_t place = 0; place < %(P)s_PLACES; place++) {
            const %(p)s_slice *const slice = &all->slices[place];
            if (slice->is_taken && slice->monitors.%(name)s.verdict == %(P)s_VIOLATED) { return %(P)s_VIOLATED; }
            is_owed = is_owed
                || (slice->is_taken && slice->monitors.%(name)s.verdict == %(P)s_PRESUMABLY_VIOLATED); }
        if (is_owed) { return %(P)s_PRESUMABLY_VIOLATED; }
        return all->has_started ? %(P)s_PRESUMABLY_SATISFIED : %(P)s_NOT_STARTED; }"""
    yield """const %(p)s_slice *%(p)s_slice_of(const %(p)s_ids *all, %(key)s id) {
        const uint32_t place = find(all, id);
        return all->slices[place].is_taken ? &all->slices[place] : NULL; }"""
    yield "uint32_t %(p)s_left_out_of(const %(p)s_ids *all) { return all->left_out; }"
