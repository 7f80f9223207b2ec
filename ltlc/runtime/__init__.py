"""Stepping monitors over samples: one mechanism for recorded and for live runs.

Standard library only; the text of `MODULES` is written, in that order and without its
imports of ltlc, into emitted ROS 2 nodes. In short:

    plan = Plan(signals, properties, rate, timeout)
        Made by the code that `ltlc.backends.python.plan.plan_code(compiled,
        specification)` writes: it defines SIGNALS, PROPERTIES and PLAN, and needs the
        names of the runtime and `INFINITY = math.inf`. A node may use SIGNALS to see
        which fields of which topics it is to hand to `message`.
    session = Session(plan)
        One run. When the clock has jumped back, report, and begin a new one.
    changes = session.message(time, topic, values)
        A message came in, at `time` in s; `values` in the order of
        `session.fields(topic)`, None where the message has no sample of a field.
    changes = session.advance(time)
        Called by a timer, and at the end of a recording: does the ticks of `_rate_`
        that are due, and notices that the timeout has come.
    session.is_over
        The timeout has come: nothing more is taken.
    session.tracks
        One for each property: `verdict`, `steps`, `episodes`, `decided_at` (step, time,
        values, reasons, episodes), `open_since`, `invalid`, `never_triggered`.
    session.messages
        How many messages came in on each topic; a node looks here for silent topics,
        `silence.waiting_for(session, track)` says what a property waits for.
    session.lose(topic, count), session.lost
        Messages that were never judged; reported on the properties that read the topic.

Each `Change` has the property, its previous and current verdict, and the moment (step
and time). `reports` makes the text, JSON lines, JSON document and JUnit XML of a run.
"""

MODULES = (
    "ltlc.semantics.verdicts",
    "ltlc.runtime.functions",
    "ltlc.runtime.sampling",
    "ltlc.runtime.tracking",
    "ltlc.runtime.session",
    "ltlc.runtime.silence",
    "ltlc.runtime.reports",
)
"""What a stepping program needs, each after what it imports."""
