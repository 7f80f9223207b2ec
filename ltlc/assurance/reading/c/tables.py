"""What the table of ids and that of instances have in common in emitted C, said a second time: as C."""

from __future__ import annotations

from collections.abc import Iterator


def in_all(stem: str, is_timed: bool, is_shared: bool) -> Iterator[str]:
    """The functions of the table called `stem`, in which `p` is the prefix of names and `P` that of constants.

    Something may come that all of it gets if it `is_shared`.
    """
    yield """static uint32_t counted(uint32_t count, uint32_t more) {
        return more > UINT32_MAX - count ? UINT32_MAX : count + more; }"""
    if is_timed and is_shared:
        yield """static void take(%(p)s_monitors *monitors, int64_t time, const %(p)s_samples *samples) {
            if (samples != NULL) { (void)%(p)s_step(monitors, time, samples); }
            else { (void)%(p)s_advance(monitors, time); } }"""
    due = f"if (time >= all->due) {{ go_on(all, time{', NULL' if is_shared else ''}); }}" if is_timed else ""
    yield f"""bool %(p)s_{stem}_advance(%(p)s_{stem} *all, int64_t time) {{
        if (time <= -%(P)s_NEVER || time >= %(P)s_NEVER || time < all->time) {{ return false; }}
        all->time = time; {due} return true; }}"""
    if is_timed:
        yield f"int64_t %(p)s_{stem}_next_deadline(const %(p)s_{stem} *all) {{ return all->due; }}"
