"""Stepping monitors over samples: one mechanism for recorded and for live runs.

Standard library only; the text of `MODULES` is written, in that order and without its
imports of ltlc, into emitted ROS 2 nodes. In short:

    plan = Plan(signals, properties, rate, timeout)
        Made by the code that `ltlc.backends.python.plan.plan_code(compiled,
        specification)` writes: its function `plan` needs the names of the runtime and
        `INFINITY = math.inf`. A node may look at `signals` to see which fields of which
        topics it is to hand to `message`.
    session = Session(plan)
        What is known of one run. When the clock has jumped back, report, and begin a
        new one.
    rows = ByRows(session)
        Judges what comes in.
    changes = rows.begin(time)
        It begins at `time`, in ns; if nothing says so, the first message begins it.
    changes = rows.message(time, topic, values)
        A message came in; `values` in the order of `session.fields[topic]`, None where
        the message has no sample of a field.
    time = rows.due()
        When to call `advance`, if no message comes: no clock's answer changes before.
        None: never.
    changes = rows.advance(time)
        Called by a timer, and at the end of a recording: does the ticks of `_rate_`
        and the clock steps that are due, and notices that the timeout has come.
    session.is_over
        The timeout has come: nothing more is taken.
    session.tracks
        One for each property: `verdict`, `steps`, `episodes`, `decided_at` (step, time,
        whether by time, values, reasons, episodes), `open_since`, `deadline()`,
        `invalid`, `never_triggered`.
    session.messages, session.unseen
        How many messages came in on each topic, and how many of these no tick saw; a
        node looks here for silent topics, `silence.waiting_for(session, track)` says
        what a property waits for.
    session.lose(topic, count), session.lost
        Messages that were never judged; reported on the properties that read the topic.
    rows.judge(time, topic, None), session.malformed
        Messages that came but could not be read; reported in the same way.

Each `Change` has the property, its previous and current verdict, and the moment (step,
time, and whether time alone changed it). `reports` makes the text of a run, `documents`
its JSON lines and document, `junit` its XML. Times are integers of nanoseconds.
"""

MODULES = (
    "ltlc.semantics.verdicts",
    "ltlc.runtime.functions",
    "ltlc.runtime.times",
    "ltlc.runtime.sampling",
    "ltlc.runtime.guard_plans",
    "ltlc.runtime.properties",
    "ltlc.runtime.episodes",
    "ltlc.runtime.reasons",
    "ltlc.runtime.courses",
    "ltlc.runtime.tracking",
    "ltlc.runtime.readers",
    "ltlc.runtime.ticks",
    "ltlc.runtime.session",
    "ltlc.runtime.rows",
    "ltlc.runtime.guarding",
    "ltlc.runtime.watching",
    "ltlc.runtime.silence",
    "ltlc.runtime.reports",
    "ltlc.runtime.documents",
    "ltlc.runtime.guard_reports",
    "ltlc.runtime.junit",
    "ltlc.runtime.slice_keys",
    "ltlc.runtime.slice_ids",
    "ltlc.runtime.slice_openings",
    "ltlc.runtime.slice_reports",
    "ltlc.runtime.instance_reports",
    "ltlc.runtime.slice_steps",
    "ltlc.runtime.slice_ticks",
    "ltlc.runtime.slices",
)
"""What a stepping program needs, each after what it imports."""
