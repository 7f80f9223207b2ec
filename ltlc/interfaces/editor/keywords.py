"""What the words of the language mean, in a line or two: the sentences of `docs/language.md`."""

from __future__ import annotations

from typing import NamedTuple

from ltlc.specification import requirements
from ltlc.specification.functions import WRITTEN


class Meaning(NamedTuple):
    """How a construction is written, and what it means."""

    form: str
    says: str


_EPISODES = (
    "Z holds on every episode of u. The first episode of `after_until X, Y, Z` opens at the first step with X and not "
    "Y. It lasts up to, not including, the first later step with Y, or to the end. The next opens at the first step "
    "from there on with X and not Y"
)

PROPERTIES = {
    "always": Meaning("always P", "P holds on every non-empty u[k..)"),
    "never": Meaning("never P", "P holds on no non-empty u[k..)"),
    "eventually": Meaning("eventually P", "P holds on some non-empty u[k..)"),
    "initially": Meaning("initially p", "u has a first step, and p holds there"),
    "after": Meaning("after X, Y", "if X holds at some step of u, first at k: Y holds on u[k..)"),
    "until": Meaning(
        "until X, Y", "X holds at some step of u, first at k, and Y holds on u[0..k), which is empty when k = 0"
    ),
    "after_until": Meaning("after_until X, Y, Z", _EPISODES),
    "within": Meaning(
        "within D, P`, `within [A, B], P",
        "P holds on the part of u that is at most D, or from A to B, later than its first step",
    ),
}
"""Those that are judged on a run, or a segment of one."""

SEGMENT = "u is the run, or the segment that the keyword is judged on; u[k..) is the rest of it from step k on."
"""What the meanings of `PROPERTIES` need."""

_PROPOSITIONAL = "as in propositional logic, each side judged on u"

OTHERS = {
    "not": Meaning("not P", _PROPOSITIONAL),
    "and": Meaning("P and Q", _PROPOSITIONAL),
    "or": Meaning("P or Q", _PROPOSITIONAL),
    "implies": Meaning("P implies Q", _PROPOSITIONAL),
    "previously": Meaning("previously p", "p held at the instant before; false at the first one"),
    "once": Meaning(
        "once p`, `once p within D", "p held at some instant so far; at some instant of the last D, this one included"
    ),
    "times": Meaning(
        "once p N times`, `once p N times within D",
        "p occurred N times or more so far; in the last D, this instant included",
    ),
    "rate": Meaning(
        "rate(s) >= f Hz over D",
        "at least f · D messages on the topic of s arrived in the last D, or no more than D has passed",
    ),
    "historically": Meaning(
        "historically p`, `historically p for D",
        "p held at every instant so far; p has held without a break since some instant at least D ago",
    ),
    "since": Meaning(
        "p since q`, `p since q within D",
        "q held at some instant so far, or of the last D, and p at every one after it, this one included",
    ),
    "age": Meaning("age(s) <= D", "the time since the last message on the topic of s is at most D"),
    "new": Meaning("new s", "a message on the topic of s arrives at this very instant"),
    "opening": Meaning(
        "@{s, opening}",
        "the value that s had at the step at which the innermost `after` or `after_until` around it opened",
    ),
    "when": Meaning("@{s, when p}", "the value that s had when p last held, at this message or before"),
    "else": Meaning(
        "@{s, -n else c}",
        "the value that s had n samples ago, or the constant c if there are not yet enough samples",
    ),
    "for": Meaning(
        "always P for D`, `always P for [A, B]", "`within D, always P`; likewise with `[A, B]` in place of D"
    ),
    "any": Meaning("any(C)", "at least one element satisfies C"),
    "all": Meaning("all(C)", "no element fails to satisfy C; so `all` of an empty array is true"),
    "count": Meaning("count(C)", "how many elements satisfy C, a number"),
    "norm": Meaning("norm(v)", "the length of a vector"),
    **{name: Meaning(function.form, function.says) for name, function in WRITTEN.items()},
    "in": Meaning("x in {1, 2, 5}", "`x == 1 or x == 2 or x == 5`"),
    "forall": Meaning(
        "forall r in {robot1, robot2}: P",
        "a property for each name in the set: P with that name in place of the variable r",
    ),
    "each": Meaning(
        "each v of s: P`, `each new s: P",
        "P for every value v that s ever has, on the *slice* of the run for v",
    ),
    "gone": Meaning("gone k", "from a message on its topic without v to the next one with v"),
    "over": Meaning("any(P over (a), (b))", "every element of one list is combined with every element of the others"),
    "limit": Meaning("each v of s limit N: P", "limits how many ids are kept"),
    "decl": Meaning("decl NAME TOPIC TYPE.FIELD.PATH", "a name for a value in the messages of a topic"),
    "model": Meaning("model NAME: ATTRIBUTE TOPIC TYPE.PATH ;", "what the robot believes about itself"),
    "object": Meaning(
        "object NAME TOPIC TYPE`, `object NAME at (x, y, z)",
        "the source of an object's ground truth in the simulation",
    ),
    "zone": Meaning(
        "zone NAME = [(x, y), …]", "a polygon in the plane, given by its corners; its border belongs to it"
    ),
    "guard": Meaning(
        "guard RAW to OUT else NAME, …",
        "commands come on RAW, and what the robot gets leaves on OUT. A guard keeps every property that reads OUT",
    ),
    "message": Meaning(
        "message NAME {PATH: VALUE, …}",
        "a message that a guard may send, a *fallback*: fields that are not named are zero, false or empty",
    ),
    "assume": Meaning("assume P", "a property that a guard relies on and does not keep"),
    "_rate_": Meaning("_rate_ = 30", "makes a step at regular times (Hz) instead of at every message"),
    "_timeout_": Meaning("_timeout_ = 60 s", "ends the run"),
    "_lead_": Meaning("_lead_ = 10 ms", "how long before a deadline a guard acts (10 ms)"),
    "_margin_": Meaning("_margin_ = 0.01", "the default margin of `==` and `!=` between numbers or vectors"),
    "_simulator_": Meaning("_simulator_ = tf", "the source of the ground truth of undeclared objects"),
}

KEYS = {key: Meaning(f"[{key} VALUE]", says) for key, says in requirements.KNOWN.items()}
"""The known attributes of a requirement."""

MEANINGS = PROPERTIES | OTHERS


def meaning(word: str) -> str | None:
    """What a keyword, a function or a setting means, in Markdown; None for any other word."""
    known = MEANINGS.get(word)
    if known is None:
        return None
    explained = f"\n\n{SEGMENT}" if word in PROPERTIES else ""
    return f"`{known.form}`: {known.says}.{explained}"
