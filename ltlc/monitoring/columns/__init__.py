"""Recordings judged by columns: the same verdicts, times and reports as row by row, without a step for each.

A row costs the session a microsecond or two, a value in a column half a nanosecond to look at. So recordings are read
as blocks, and a session is taken from the beginning of a block to its end without a step for each row: the state of
every track, of the samples and of the ticks is then what it would have been, so the next block may go either way.

  block ─series→ samples by signal ─values, thresholds→ atoms as bits ─follow→ where something happens ─tracks→ track
         └ticks┘                                                     ├─────leaps─────┤
                                                                     └──────walk─────┘

What is computed for all steps at once are the lowered expressions, of which emitted code is printed, each function by
its row in numpy (`functions`; what numpy would round otherwise, such as a norm, number by number). Numbers are doubles
there, and a block with integers that are not doubles is refused. The least and the greatest of a piece of a column
decide most comparisons.

Machine and open scopes make one table (`machine`, `tables`), which takes two to eight letters at a time, and none where
they repeat (`follow`; `groups` says what happened). Properties with equal tables are stepped together, their columns
one after the other as if they were one; of an atom that changes rarely, only the bytes in which it does are kept. The
step that decides a property is the track's own, from the state restored before it. With clocks, the same tables say
what happens as long as none comes due, and at which steps each is set; the times of these say how far that holds, and
around a clock that comes due the monitor takes the steps (`leaps`). Where letters change at every message, as those of
news do, or clocks come due often, that would be at all of them: there a letter has the pause after it, too, and a table
what comes in it (`pauses`). What is counted is one atom more, that it has occurred often enough (`counts`). Properties
with more atoms than a table has, with several bounds that share a clock, with scopes that an event of the past opens,
or with a trail for a picture, are stepped by their own monitor where a letter changes, and at the last step before a
clock comes due (`walk`). So are those that compare with values at openings: as long as no others are taken, these are
constants, so that the next change can be looked for ahead (`kept`). Arrays are held by number between their messages,
and each is looked at once (`arrays`). A property of each id is followed over the messages of one id after the other, as
if they were one run (`slices`). What columns cannot do exactly raises `UnsupportedError`: these properties go row by
row in this block, and `ltlc run --timing` says so.

By how much properties hold is computed beside all this, from the same samples (`measuring`): the margins of conditions
(`margins`), of these that of state predicates (`past`) and of the property (`robustness`), piece by piece (`timeline`,
`extremes`).
"""
