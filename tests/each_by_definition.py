"""What `each` means: rows are left out, and what is left is judged as a run by itself, by a session without slices.

Nothing here knows of births, shared samples or what can be dropped.
"""

from __future__ import annotations

import math
import random
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from ltlc.automata import Budget
from ltlc.backends.python.load import load_plan
from ltlc.base.source import Source
from ltlc.compiler import compile_specification
from ltlc.frontend.language import load_text
from ltlc.runtime.properties import Change
from ltlc.runtime.rows import ByRows
from ltlc.runtime.sampling import Input, New, Slope
from ltlc.runtime.session import Plan, Session
from ltlc.runtime.slice_keys import Id
from ltlc.runtime.tracking import Track
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.verdicts import Verdict

Row = tuple[int, str, Mapping[str, object]]
"""A message: its time in ns, its topic, and its values by name."""

HEAD = """
decl id   /track sensor_msgs/JoyFeedback.id
decl kind /track sensor_msgs/JoyFeedback.type
decl dist /track sensor_msgs/JoyFeedback.intensity
decl fid  /fb sensor_msgs/JoyFeedback.id
decl prog /fb sensor_msgs/JoyFeedback.intensity
decl v    /odom std_msgs/Float64.data
decl stop /estop std_msgs/Bool.data
"""

ONE_TOPIC = (
    "always (kind == 1 implies eventually kind == 2)",
    "always (kind == 1 implies eventually kind == 2 within 20 ns)",
    "eventually kind == 2 within 40 ns",
    "always (dist < 1 implies eventually v < 0.2 within 15 ns)",
    "never (dist < 1 and v > 2)",
    "always age(dist) <= 30 ns",
    "always (v > 2 implies age(dist) <= 30 ns)",
    "always (new dist implies eventually stop within 25 ns)",
    "after kind == 1, never kind == 2",
    "after_until kind == 1, kind == 2, always dist < 2",
    "after_until kind == 1, kind == 2, eventually v < 1 within 30 ns",
    "never abs(dist - @{dist, -1}) > 2",
    "always dist <= @{dist, opening} + 2",
    "after_until kind == 1, kind == 2, always dist <= @{dist, opening} + 1",
    "always (kind == 2 implies once kind == 1)",
    "always (kind == 2 implies once stop within 30 ns)",
    "never historically dist < 1 for 25 ns",
    "never once kind == 2 2 times within 60 ns",
    "always (kind == 1 implies once kind == 2 2 times)",
    "always (kind == 1 implies eventually once dist < 1 2 times within 30 ns)",
    "always (previously kind == 1 implies kind in {1, 2})",
    "initially kind == 1",
    "eventually kind == 2",
    "until kind == 2, always dist < 3",
    "always (new stop implies dist < 3)",
    "always (dist < 1 implies age(stop) <= 40 ns)",
    "after_until new dist, age(dist) > 25 ns, always (kind == 1 implies eventually kind == 2 within 20 ns)",
    "never v - dist > 2",
    "never @{v, when new dist} > 2",
    "never @{v, when new stop and v > 1} > dist",
    "always (id == g implies v > @{v, -1} - 3)",
    "never (g == 3 and v > 2)",
    "(eventually kind == 2) or always stop",
    "never @{dist, when new dist} > 3",
    "never @{dist, when kind == 1} > 3",
    "always (kind == 1 implies @{v, when new stop} < 3)",
)
"""Properties of `each g of id`: one topic is sliced."""

TWO_TOPICS = (
    "always (kind == 1 implies eventually prog > 2 within 30 ns)",
    "always (kind == 2 implies prog > 1)",
    "never (dist < 1 and prog < 1 and stop)",
    "always age(prog) <= 50 ns",
    "after kind == 1, eventually prog > 2",
    "always (new prog implies kind == 1)",
)
"""Properties of `each g of id, fid`."""


@dataclass(frozen=True)
class Quantified:
    """A property of each id: as a plan that slices the run, and the property itself of whole runs.

    `keys` has the signal with the id, by topic.
    """

    sliced: Plan
    plain: Plan
    keys: Mapping[str, str]


@cache
def quantified(text: str, keys: str, more: str = "") -> Quantified:
    """`each g of KEYS: text`; `more` are settings."""
    first = keys.split(",")[0]
    topics = dict(re.findall(r"^decl +(\w+) +(\S+)", HEAD, re.MULTILINE))
    plain = re.sub(r"\bg\b", first, text)
    return Quantified(
        plan_of(f"{HEAD}{more}p: each g of {keys}: {text}"),
        plan_of(f"{HEAD}{more}p: {plain}"),
        {topics[key.strip()]: key.strip() for key in keys.split(",")},
    )


def plan_of(text: str) -> Plan:
    """The plan of a specification without errors."""
    specification, found = load_text(Source("props.txt", text))
    assert specification is not None, [(d.code, d.message) for d in found]
    compiled, problems = compile_specification(specification, EPISODE, Budget())
    assert not problems
    return load_plan(compiled, specification)


def random_rows(chance: random.Random, count: int, ids: Sequence[int]) -> list[Row]:
    """Messages with ties, gaps and NaN."""
    time, rows = chance.choice([0, 5, 10**15]), []
    for _ in range(count):
        time += chance.choice([0, 0, 1, 3, 7, 12, 20])
        topic = chance.choices(["/track", "/fb", "/odom", "/estop"], [5, 2, 2, 1])[0]
        value = math.nan if chance.random() < 0.04 else chance.choice([0.0, 0.5, 1.5, 2.5, 3.5])
        id_ = chance.choice(ids)
        values: Mapping[str, Mapping[str, object]] = {
            "/track": {"id": id_, "kind": chance.choice([0, 0, 1, 2]), "dist": value},
            "/fb": {"fid": id_, "prog": value},
            "/odom": {"v": value},
            "/estop": {"stop": chance.random() < 0.4},
        }
        rows.append((time, topic, values[topic]))
    return rows


def give(rows: ByRows, row: Row) -> list[Change]:
    """A message comes."""
    time, topic, values = row
    fields = rows.session.fields
    return rows.message(time, topic, [values.get(name) for name in fields[topic]]) if topic in fields else []


def run(plan: Plan, rows: Sequence[Row], until: int, keep_verdicts: bool = False) -> Session:
    """The rows, judged by a session of `plan`, seen up to `until`."""
    judge = ByRows(Session(plan, keep_verdicts))
    judge.begin(rows[0][0])
    for row in rows:
        give(judge, row)
    judge.advance(until)
    return judge.session


def ids_of(of: Quantified, rows: Sequence[Row]) -> list[Id]:
    """The ids that come, in their order."""
    found = (values[of.keys[topic]] for _, topic, values in rows if topic in of.keys)
    return list(dict.fromkeys(id_ for id_ in found if isinstance(id_, int)))


def slice_of(of: Quantified, rows: Sequence[Row], id_: object) -> list[Row]:
    """The rows of a slice: of sliced topics those with this id, of other topics all."""
    return [row for row in rows if row[1] not in of.keys or row[2][of.keys[row[1]]] == id_]


def judged(of: Quantified, rows: Sequence[Row], id_: object, until: int) -> Track:
    """The property on the slice of an id, seen up to `until`."""
    part = slice_of(of, rows, id_)
    (property_,) = of.plain.properties
    birth = next(n for n, row in enumerate(part) if row[1] in of.keys)
    judge = ByRows(Session(of.plain))
    own = {name for name, topics in judge.session.sampler.topics.items() if topics & of.keys.keys()}
    if any(not isinstance(i, New) and i.signal in own for i in property_.inputs):
        # It waits for a value of the slice, so that its run cannot begin earlier, and all rows may be given.
        if len(of.keys) > 1 and any(age.signal in own for age in property_.ages):
            judge.begin(part[birth][0])  # ages of the slice count from its birth
            part = part[birth:]
        else:
            judge.begin(rows[0][0])
        for row in part:
            give(judge, row)
    else:
        # It reads nothing of the slice but when it comes: what was known at its birth comes with its first message.
        assert not any(isinstance(i, Slope) or (isinstance(i, Input) and i.ago) for i in property_.inputs)
        _give_at_once(judge, part[: birth + 1])
        for row in part[birth + 1 :]:
            give(judge, row)
    judge.advance(until)
    return judge.session.tracks[0]


def _give_at_once(judge: ByRows, rows: Sequence[Row]) -> None:
    """The last of `rows` comes, with what was known before."""
    fields, known = judge.session.fields, dict[str, object]()
    for _, topic, values in rows:
        known |= {name: values[name] for name in fields.get(topic, ())}
    time, topic, _ = rows[-1]
    judge.samples(time, tuple(known), list(known.values()), [topic] if topic in fields else [])


def conjunction(verdicts: Sequence[Verdict]) -> Verdict:
    """The verdict of the whole: of an id that has not come, nothing is known."""
    for found in (Verdict.VIOLATED, Verdict.PRESUMABLY_VIOLATED):
        if found in verdicts:
            return found
    is_started = any(verdict is not Verdict.NOT_STARTED for verdict in verdicts)
    return Verdict.PRESUMABLY_SATISFIED if is_started else Verdict.NOT_STARTED
