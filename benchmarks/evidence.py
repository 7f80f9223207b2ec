"""Evidence as an oracle, and what it costs.

    python -m benchmarks.evidence [--runs N] [--seed N] [--journal FILE]
    python -m benchmarks.evidence --again SEED
    python -m benchmarks.evidence --cost [--repeat N]

Each seed is a random bag that is judged by all forms of properties that evidence covers (`tests/evidencing.py`), with a
rate or without; `recorded.py`, which shares nothing with ltlc, must find the letters that are written. It is also ten
random properties, drawn as for `benchmarks.differential`, and twelve recordings of them in any form: all three checks
must accept what is written, and refuse it after any single edit, though the digest at the end is set right. What was
tried is kept in a journal, a line for each seed, so that a campaign that was stopped goes on, up to N property-runs in
all.
With --cost, a bag of odometry is judged with and without `--evidence`, and read again. Exit code 1 if something
differs.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from random import Random
from resource import RUSAGE_CHILDREN, getrusage
from statistics import median
from subprocess import DEVNULL, run
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from evidencing import (
    BEGINNING,
    EVERY,
    TYPES,
    disagreements,
    entries_of,
    header,
    judge_of,
    make,
    refusals,
    write_bag,
)

from benchmarks.differential import files, reference, targets
from benchmarks.differential.draw import Draw
from ltlc.assurance.evidence import recorded
from ltlc.assurance.evidence.document import Claim, Document, digest, printed
from ltlc.assurance.evidence.parsing import UnreadableEvidence, parsed
from ltlc.semantics.verdicts import Verdict

JOURNAL = Path(__file__).parents[1] / "build" / "evidence.jsonl"
PROPERTIES, RECORDINGS, EDITS = 10, 12, 5
"""Random properties of a seed, recordings of them, and edits of the evidence of each."""

MESSAGES = 100_000
ODOMETRY = """
decl x /odom nav_msgs/Odometry.pose.pose.position.x
decl v /odom nav_msgs/Odometry.twist.twist.linear.x
decl w /odom nav_msgs/Odometry.twist.twist.angular.z
c0: never v > 2
c1: never abs(x - @{x, -1}) > 0.5
c2: always (v > 0.9 implies eventually v < 0.1 within 20 s)
c3: always age(v) <= 50 ms
c4: after_until v > 0.5, v < 0.1, never abs(w) > 2
c5: always hypot(x, v) < 1000
c6: never historically v > 0.5 for 20 s
c7: always (abs(w) > 0.9 implies once v > 0.5 within 30 s)
c8: always x >= -100
c9: eventually x > 1
d0: never (v > 0.5 and w > 0.99)
d1: always sqrt(abs(v)) < 1.2
"""


def main() -> int:
    """Look for differences, or measure."""
    parser = argparse.ArgumentParser(description="Compare evidence with what a plain reader computes.")
    parser.add_argument("--runs", type=int, default=10_000, help="how many property-runs in all")
    parser.add_argument("--seed", type=int, default=1000, help="the first seed")
    parser.add_argument("--journal", type=Path, default=JOURNAL)
    parser.add_argument("--again", type=int, metavar="SEED", help="only one seed")
    parser.add_argument("--cost", action="store_true", help="measure sizes and times")
    parser.add_argument("--repeat", type=int, default=5)
    options = parser.parse_args()
    if options.cost:
        cost(options.repeat)
        return 0
    if options.again is not None:
        found = tried(options.again).found
        print("\n".join(found) or "as it should be")
        return 1 if found else 0
    return campaign(options.journal, options.seed, options.runs)


class Tried(NamedTuple):
    """How many property-runs and edits were tried, and what was not as it should be."""

    runs: int
    edits: int
    found: list[str]


def tried(seed: int) -> Tried:
    """What comes of one seed."""
    with TemporaryDirectory() as folder:
        found = list(disagreements(seed, Path(folder)))
        other = drawn(Random(seed), Path(folder))
    judge_of.cache_clear()
    entries_of.cache_clear()
    return Tried(len(EVERY) + other.runs, other.edits, found + other.found)


def drawn(chance: Random, folder: Path) -> Tried:
    """What comes of random properties."""
    draw, runs, edits, found = Draw(chance), 0, 0, list[str]()
    text = draw.specification(PROPERTIES)
    try:
        of = targets.monitors(text)
    except targets.UnusableError:
        return Tried(0, 0, [])
    topics = sorted({topic for each in reference.properties(text).values() for topic in each.reads.all_topics})
    for number in range(RECORDINGS):
        recording = draw.recording([*topics, "/flag"], chance.random() < 0.6)
        form = chance.choice([each for each in (*files.TABLES, *files.bag_forms(recording.rows)) if each != UNREAD])
        (place := folder / str(number)).mkdir()
        path = files.write(form, place, of, recording)
        document = judge_of(text).judge(path).evidence
        if document is None:  # it cannot be read to its end, as some messages of ROS 2 in ROS 1
            continue
        runs += sum(isinstance(each, Claim) for each in document.properties)
        refused = refusals(document, text, path)
        found += [f"{form} {number}: {each}" for each in refused]
        for _ in range(EDITS if runs and not refused else 0):
            edits += 1
            what, changed = edited(printed(document), chance)
            if not isinstance(changed, UnreadableEvidence) and not refusals(changed, text, path):
                found.append(f"{form} {number}: accepted after {what}")
    return Tried(runs, edits, found)


UNREAD = "mcap with chunk index"
"""A form in which rosbags, and so `recorded.py`, finds no messages."""


def edited(text: str, chance: Random) -> tuple[str, Document | UnreadableEvidence]:
    """A document with one edit within its claims, and what it is."""
    lines = text.splitlines()[:-1]
    claimed = [n for n, line in enumerate(lines) if n > lines.index("") and line and not line.startswith("not-covered")]
    number = chance.choice(claimed)
    word, _, rest = lines[number].partition(" ")
    place = chance.randrange(len(lines[number]))
    was = lines[number][place]
    other = chance.choice([each for each in ("0123456789" if was.isdigit() else "abn_. ") if each != was])
    edits = [f"{lines[number][:place]}{other}{lines[number][place + 1 :]}", None]
    if word == "verdict":
        verdicts = [each.value for each in Verdict if each.value != rest.split()[0]]
        edits.append(f"verdict {chance.choice(verdicts)} {rest.split()[1]}")
    edit = chance.choice(edits)
    body = "".join(f"{line}\n" for line in [*lines[:number], *([] if edit is None else [edit]), *lines[number + 1 :]])
    return f"`{lines[number]}` became `{edit}`", parsed(f"{body}end sha256 {digest(body)}\n")


def campaign(journal: Path, first: int, runs: int) -> int:
    """Try seeds that the journal has not, until there were so many property-runs."""
    journal.parent.mkdir(parents=True, exist_ok=True)
    known = {each["seed"]: each for each in entries(journal)}
    with journal.open("a", encoding="utf-8") as file:
        for seed in count(first):
            if sum(each["runs"] for each in known.values()) >= runs:
                break
            if seed not in known:
                known[seed] = {"seed": seed, **tried(seed)._asdict()}
                file.write(json.dumps(known[seed]) + "\n")
                file.flush()
    wrong = [each for each in known.values() if each["found"]]
    for each in wrong:
        print(each["seed"], *each["found"], sep="\n  ")
    total, edits = (sum(each[what] for each in known.values()) for what in ("runs", "edits"))
    print(f"{len(known)} seeds, {total} property-runs, {edits} edits, {len(wrong)} seeds with differences")
    return 1 if wrong else 0


def entries(journal: Path) -> Iterator[dict[str, Any]]:
    if journal.exists():
        yield from map(json.loads, journal.read_text(encoding="utf-8").splitlines())


def cost(repeat: int) -> None:
    """Sizes, and medians of CPU times, side by side."""
    with TemporaryDirectory() as folder:
        at = Path(folder)
        bag = odometry(at / "bag")
        (at / "props.txt").write_text(ODOMETRY)
        ltlc = [str(Path(sys.executable).with_name("ltlc")), "run", str(at / "props.txt"), str(bag), "--quiet"]
        reader = [sys.executable, str(recorded.__file__), str(at / "evidence.txt"), str(bag)]
        commands: dict[str, list[str]] = {
            "run": ltlc,
            "run --evidence": [*ltlc, "--evidence", str(at / "evidence.txt")],
            "recorded.py": reader,
            "deserialising": [sys.executable, "-c", DESERIALISE, str(bag)],
        }
        times: dict[str, list[float]] = {name: [] for name in commands}
        for _ in range(repeat):
            for name, command in commands.items():
                times[name].append(timed(command))
        size = sum(file.stat().st_size for file in bag.iterdir())
        written = (at / "evidence.txt").stat().st_size
        print(f"{size:,} bytes of bag, {written:,} of evidence: {written / size:.4%}")
        for name, measured in times.items():
            print(f"{name}: {median(measured):.2f} s of CPU")


DESERIALISE = """
import sys
from pathlib import Path
from rosbags.highlevel import AnyReader
with AnyReader([Path(sys.argv[1])]) as reader:
    for connection, _, raw in reader.messages():
        reader.deserialize(raw, connection.msgtype)
"""


def timed(command: list[str]) -> float:
    """The CPU time of a command and of its children, in seconds."""
    before = getrusage(RUSAGE_CHILDREN)
    run(command, check=False, stdout=DEVNULL, stderr=DEVNULL)
    after = getrusage(RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def odometry(path: Path) -> Path:
    """A robot that drives to and fro, 50 messages a second."""
    chance, position, speed = Random(1), 0.0, 0.0
    TYPES["/odom"] = "nav_msgs/msg/Odometry"
    rows = []
    for number in range(MESSAGES):
        speed = max(0.0, min(1.0, speed + chance.gauss(0, 0.02)))
        position += speed / 50
        rows.append((BEGINNING + number * 20_000_000, "/odom", message(position, speed, chance.uniform(-1, 1))))
    return write_bag(path, rows)


def message(x: float, v: float, w: float) -> object:
    """What an odometry says."""
    none = np.zeros(36)
    turned = make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0)
    pose = make(
        "geometry_msgs/msg/Pose", position=make("geometry_msgs/msg/Point", x=x, y=0.0, z=0.0), orientation=turned
    )
    linear, angular = (
        make("geometry_msgs/msg/Vector3", x=v, y=0.0, z=0.0),
        make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=w),
    )
    return make(
        "nav_msgs/msg/Odometry",
        header=header(),
        child_frame_id="base",
        pose=make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=none),
        twist=make(
            "geometry_msgs/msg/TwistWithCovariance",
            twist=make("geometry_msgs/msg/Twist", linear=linear, angular=angular),
            covariance=none,
        ),
    )


if __name__ == "__main__":
    sys.exit(main())
