"""A property explained: in English, by its class and its monitor, and by a run for each verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice
from typing import assert_never

from ltlc.analysis.english import English
from ltlc.analysis.examples import Example, example_of
from ltlc.analysis.search import all_shortest
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import listed
from ltlc.base.limits import Budget, Exceeded, Watch, run_all
from ltlc.dataclass import dataclass
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Word
from ltlc.specification.arrivals import waited_for
from ltlc.specification.expressions import Current, Input, New, Past, Recent, Slope
from ltlc.specification.specification import PropertySpecification, Slicing, topics, topics_of

MOST_WORDS = 50
"""Of so many short runs with a verdict, the most instructive one is shown."""

MOST_TRIED = 8
"""For so many of them numbers are looked for."""

CAPTIONS = {
    Verdict.SATISFIED: "satisfied, whatever follows",
    Verdict.VIOLATED: "violated at the earliest",
    Verdict.PRESUMABLY_SATISFIED: "presumably satisfied",
    Verdict.PRESUMABLY_VIOLATED: "presumably violated",
}
"""The verdicts a run is shown for, in this order."""

CLASSES = {
    "safety and guarantee": "decided by the first few steps, either way",
    "safety": "every violation shows up after finitely many steps",
    "guarantee": "every run that satisfies it does so after finitely many steps",
    "obligation": "a Boolean combination of safety and guarantee",
    "recurrence": "an obligation can open again and again, and may be fulfilled at any later time",
    "persistence": "something must eventually hold forever",
    "reactivity": "if something happens again and again, so must something else",
}
"""What the classes of Manna and Pnueli mean for a monitor."""


@dataclass(frozen=True, slots=True)
class Explanation:
    """The explanation of one property; if a limit was exceeded, `limit` says so, and `temporal_class` is empty.

    `begins` says when its run does. `verdicts` are those that the monitor can give after some step, `examples` a run
    for each, where values were found; `not_shown` are the others.
    """

    label: str
    text: str
    english: str
    conditions: tuple[tuple[str, str], ...]
    topics: tuple[str, ...]
    begins: str
    temporal_class: str
    states: int | None
    verdicts: tuple[Verdict, ...]
    examples: tuple[Example, ...]
    not_shown: tuple[Verdict, ...] = ()
    limit: str = ""


def explain(study: Study, budget: Budget, watch: Watch | None = None) -> list[Explanation]:
    """Each property of `study` explained, all of them within `budget`; `watch` gets how many are."""
    jobs = [partial(_explain, study, subject) for subject in study.subjects]
    outcomes = run_all(jobs, budget, budget.seconds, watch)
    return [
        replace(_in_words(study, subject), limit=str(outcome)) if isinstance(outcome, Exceeded) else outcome
        for subject, outcome in zip(study.subjects, outcomes, strict=True)
    ]


def _in_words(
    study: Study, subject: Subject, class_: str = "", runs: Mapping[Verdict, Example | None] | None = None
) -> Explanation:
    specification, monitor = subject.specification, subject.monitor
    words, found = English(specification), runs or {}
    return Explanation(
        specification.label,
        _stated(specification),
        words.sentence(),
        tuple(words.atoms()),
        topics(specification),
        _beginning(specification, has_ticks=study.specification.rate is not None),
        class_,
        len(monitor.verdicts) if monitor else None,
        tuple(v for v in CAPTIONS if v in monitor.verdicts) if monitor else (),
        tuple(example for example in found.values() if example is not None),
        tuple(verdict for verdict, example in found.items() if example is None),
    )


def _stated(specification: PropertySpecification) -> str:
    """The property as its author wrote it, with the head of an `each`, or as an assumption."""
    if specification.is_assumed:
        return f"assume {specification.text}"
    match specification.slicing:
        case Slicing(keys, variable, limit):
            most = "" if limit is None else f" limit {limit}"
            return f"each {variable} of {', '.join(key.name for key in keys)}{most}: {specification.text}"
        case _:
            return specification.text


def _beginning(specification: PropertySpecification, *, has_ticks: bool) -> str:
    """When a run of the property begins, and what it does not wait for; samples are messages, unless it `has_ticks`."""
    every, spoken = topics(specification), dict[str, int]()
    for wanted in waited_for(specification):
        of = topics_of(wanted.signal)
        count = 1 if has_ticks or len(of) > 1 else _samples(wanted)
        spoken |= {topic: max(count, spoken.get(topic, 1)) for topic in of}
    if not spoken:
        return "with the session, whether or not any message arrives"
    silent = [topic for topic in every if topic not in spoken]
    rest = f"; it does not wait for {listed(silent)}" if silent else ""
    if len(spoken) > 1 and set(spoken.values()) == {1}:
        return f"when {listed(list(spoken))} have each delivered a value that it reads{rest}"
    told = [f"{topic} has delivered {'a value' if n == 1 else f'{n} values'}" for topic, n in spoken.items()]
    return f"when {listed(told)} that it reads{rest}"


def _samples(wanted: Input) -> int:
    """How many samples of its signal there have to be."""
    match wanted:
        case Past(_, samples) | Recent(_, samples):
            return samples + 1
        case Slope():
            return 2
        case Current() | New():
            return 1
        case _:
            assert_never(wanted)


def _explain(study: Study, subject: Subject) -> Explanation:
    from ltlc.automata.queries import temporal_class

    class_ = temporal_class(subject.formula, subject.alphabet).value
    shows = subject.monitor if not subject.counts else None
    return _in_words(study, subject, class_, _examples(study, subject, shows) if shows else {})


def _examples(study: Study, subject: Subject, monitor: Monitor) -> dict[Verdict, Example | None]:
    """A run for each verdict that the monitor gives after some step, None where no values are found for one."""
    shown: dict[Verdict, Example | None] = {}
    for verdict, caption in CAPTIONS.items():
        for word in _telling_first(monitor, _words(study, subject, monitor, verdict))[:MOST_TRIED]:
            shown[verdict] = example_of(study.setting(subject), word, caption, study.verdicts(subject, word))
            if shown[verdict] is not None:
                break
    return shown


def _words(study: Study, subject: Subject, monitor: Monitor, verdict: Verdict) -> list[Word]:
    """Short runs after which the monitor gives `verdict`; that `new s` is a message on s matters to their values."""
    monitored = [(subject.formula, monitor)]
    alphabet = study.letters.alphabet(atom.name for atom in subject.specification.atoms)
    found = all_shortest(monitored, alphabet, lambda verdicts: verdicts[0] is verdict, subject.shut)
    return list(islice(found, MOST_WORDS))


def _telling_first(monitor: Monitor, words: Sequence[Word]) -> list[Word]:
    """Short runs first; but a presumable verdict is more instructive after a change of the verdict."""

    def key(word: Word) -> tuple[bool, int]:
        verdicts = monitor.run(word)
        return not verdicts[-1].is_permanent and len(set(verdicts)) == 1, len(word)

    return sorted(words, key=key)
