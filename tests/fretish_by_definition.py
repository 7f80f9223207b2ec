"""The formulas of the future that FRET has for its sentences, composed as its semantics are published.

A formula of a timing is put into one of a trigger, and that into one of a scope: `r` is where an interval ends.
"""

from __future__ import annotations

SCOPES = {
    "": "",
    "in": "in m mode ",
    "notin": "unless in m mode ",
    "before": "before m mode, ",
    "after": "after m ",
    "onlyIn": "only during m ",
    "onlyBefore": "only before m mode ",
    "onlyAfter": "only after m ",
}
CONDITIONS = {"": "", "upon": "upon go ", "whenever": "whenever go, "}
TIMINGS = {
    **{word: word for word in ("always", "never", "immediately", "eventually")},
    "next": "at the next timepoint",
    "within": "within 2 seconds",
    "for": "for 2 seconds",
    "after": "after 2 seconds",
    "until": "until stop",
    "before": "before stop",
}

BEGINS, ENDS = "((! m) & (! LAST) & (X m))", "(m & (LAST | (X (! m))))"
"""The position before the mode begins, and its last one."""


def sentence(scope: str, condition: str, timing: str) -> str:
    return f"{SCOPES[scope]}{CONDITIONS[condition]}the robot shall {TIMINGS[timing]} satisfy lamp"


def formula(scope: str, condition: str, timing: str) -> str:
    ends = {"in": ENDS, "onlyAfter": ENDS, "notin": BEGINS, "onlyIn": BEGINS, "before": BEGINS}
    r = f"({ends[scope]} | LAST)" if scope in ends else "LAST"
    inner = triggered(condition, (opposite if scope.startswith("only") else required)(timing, "lamp", r), r)
    match scope:
        case "in":
            return f"(LAST V ((! ({BEGINS} & (! LAST))) | (X {inner}))) & (m -> {inner})"
        case "notin" | "onlyIn":
            return f"(LAST V ((! ({ENDS} & (! LAST))) | (X {inner}))) & ((! m) -> {inner})"
        case "before":
            return f"{inner} | m"
        case "after":
            return f"((! {ENDS}) U ({ENDS} & (X {inner}))) | (LAST V (! {ENDS}))"
        case "onlyBefore":
            later = f"((! {BEGINS}) U ({BEGINS} & (X {inner}))) | (LAST V (! {BEGINS}))"
            return f"((! m) -> ({later})) & (m -> {inner})"
        case _:
            return inner


def triggered(condition: str, inner: str, r: str) -> str:
    match condition:
        case "upon":
            becomes = f"((! go) & (! LAST) & (X go) & (! {r}))"
            return f"(({r} V ({becomes} -> ((X {inner}) & (! {r})))) & (go -> {inner}))"
        case "whenever":
            return f"({r} V (go -> {inner}))"
        case _:
            return inner


def required(timing: str, p: str, r: str) -> str:
    match timing:
        case "always":
            return f"({r} V {p})"
        case "never":
            return f"({r} V (! {p}))"
        case "immediately":
            return p
        case "eventually":
            return f"((! {r}) U {p})"
        case "next":
            return f"({r} | ((X {p}) & (! {r})))"
        case "within":
            return f"((F[<=2] {p}) | (F[<2] {r}))"
        case "for":
            return f"((G[<=2] {p}) | ({r} V {p}))"
        case "after":
            return f"(((G[<=2] (! {p})) | ({r} V (! {p}))) & ((F[<=3] {p}) | (F[<3] {r})))"
        case "until":
            return f"((! (((! stop) & (! {r})) U ((! {p}) & (! stop)))) | ({r} V {p}))"
        case _:
            return f"(! (((! ((! stop) & ({p} | {r}))) & (! {r})) U stop))"


def opposite(timing: str, p: str, r: str) -> str:
    """What an `only` scope requires of the intervals that are not in it."""
    same = {"always": "eventually", "eventually": "always", "within": "for", "for": "within", "until": "before"}
    match timing:
        case "never":
            return required("eventually", p, r)
        case "after":
            return f"((F[<=2] {p}) | (F[<2] {r}) | (G[<=3] (! {p})) | ({r} V (! {p})))"
        case "before":
            return f"((! (((! stop) & (! {r})) U ({p} & (! stop)))) | ({r} V (! {p})))"
        case _:
            return required(same.get(timing, timing), f"(! {p})", r)
