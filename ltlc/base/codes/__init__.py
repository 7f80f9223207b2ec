"""The registry of diagnostic codes: every diagnostic is made here, so that there is none without a name and a page.

The first digit tells the subject: 0 syntax, 1 names, 2 types and messages, 3 properties, 4 settings, 5 and 6 what
analyses find, 7 monitors and the gate, 8 recordings, 9 files. `CODE.md` beside this file explains a code.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ltlc.base.diagnostics import Diagnostic, Help, Label, Severity
from ltlc.base.source import Source, Span

ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE


@dataclass(frozen=True, slots=True)
class Code:
    """What a code stands for: its mnemonic, its page's title, how much it weighs, and whether it is told on demand."""

    name: str
    title: str
    severity: Severity = ERROR
    pedantic: bool = False


CODES: dict[str, Code] = {
    "LTL001": Code("syntax", "Something else has to stand here"),
    "LTL002": Code("missing-comma", "A comma is missing between the arguments of a keyword"),
    "LTL003": Code("single-equals", "`=` names things, `==` compares them"),
    "LTL004": Code("foreign-operator", "An operator of another language"),
    "LTL005": Code("unclosed", "A parenthesis, brace or bracket is not closed"),
    "LTL006": Code("unfinished", "The text ends, or something new begins, too early"),
    "LTL007": Code("missing-semicolon", "A model has to end with a semicolon"),
    "LTL008": Code("keyword-as-name", "A keyword stands where a name is needed"),
    "LTL009": Code("reserved-word", "The word is reserved for a later version of the language"),
    "LTL010": Code("split-word", "A word of the language is written in two"),
    "LTL011": Code("strange-character", "A character that is not a part of the language"),
    "LTL012": Code("malformed-string", "A string does not end, or has an unknown escape"),
    "LTL013": Code("chained-comparison", "Comparisons do not chain"),
    "LTL014": Code("malformed-number", "A number is not written as numbers are"),
    "LTL015": Code("too-deep", "The property is nested too deeply"),
    "LTL016": Code("stray-bound", "A bound on time belongs to no keyword"),
    "LTL018": Code("malformed-forall", "A `forall` is not written as one"),
    "LTL019": Code("second-on-line", "A property begins on the line on which another one ends"),
    "LTL020": Code("unit", "Numbers have no units but those of angles"),
    "LTL021": Code("foreign-phrase", "A sentence is in the words of another language"),
    "LTL101": Code("unknown-name", "A name that nothing defines"),
    "LTL102": Code("redefined-name", "A name is defined twice"),
    "LTL103": Code("used-before-definition", "A name is used before its definition"),
    "LTL104": Code("unused", "A name is defined and not used", WARNING),
    "LTL105": Code("unknown-attribute", "An object, a model or a vector has no such attribute"),
    "LTL106": Code("duplicate-label", "Two properties have the same label"),
    "LTL107": Code("unknown-function", "There is no such function"),
    "LTL108": Code("bad-topic", "Not the name of a topic of ROS 2"),
    "LTL109": Code("bad-forall", "The variables and names of a `forall` do not fit"),
    "LTL110": Code("similar-object", "An object that nothing declares is called almost as another", WARNING),
    "LTL111": Code("duplicate-id", "Two requirements have the same id"),
    "LTL112": Code("bad-attribute", "An attribute of a requirement is given twice, or has too many values"),
    "LTL113": Code("bad-each", "The variable and the keys of an `each` do not fit"),
    "LTL201": Code("unknown-message-type", "No known package defines the message type"),
    "LTL202": Code("ambiguous-message-type", "Several packages define the message type"),
    "LTL203": Code("unknown-field", "The message has no such field"),
    "LTL204": Code("path-without-value", "The path does not end in a value"),
    "LTL205": Code("type-mismatch", "The operands do not fit the operator"),
    "LTL206": Code("not-a-predicate", "A value stands where a property is needed, or a property where a value is"),
    "LTL207": Code("wrong-arguments", "A function is applied to arguments that it does not take"),
    "LTL208": Code("no-ground-truth", "The object's source cannot give this primitive"),
    "LTL209": Code("missing-model", "The primitive needs a model's attribute"),
    "LTL210": Code("history-of-expression", "History needs something that has samples"),
    "LTL211": Code("history-offset", "History counts samples back, with an integer"),
    "LTL212": Code("index-out-of-range", "The array has no such element"),
    "LTL213": Code("no-number", "The constant expression has no value"),
    "LTL214": Code("unknown-constant", "The message has no such constant"),
    "LTL215": Code("not-constant", "A constant is needed here"),
    "LTL216": Code("no-duration", "A bound is a duration, with its unit"),
    "LTL217": Code("bad-duration", "A duration cannot be counted in nanoseconds, or there is no time in a bound"),
    "LTL218": Code("age-comparison", "An age has an ordering with durations only"),
    "LTL219": Code("no-messages", "`new` and `age` speak of the messages of one topic"),
    "LTL220": Code("no-field", "A message without a field stands where a value is needed"),
    "LTL230": Code("elements", "What is said of elements has to speak of arrays that belong together"),
    "LTL231": Code("latch-looks-back", "What holds at one step is asked of that step"),
    "LTL232": Code("bad-count", "A count is a whole number of times that something occurs at steps"),
    "LTL240": Code("bad-zone", "The corners of a zone make no simple polygon"),
    "LTL301": Code("temporal-event", "An event, or what is looked back at, has to be a state predicate"),
    "LTL302": Code("ambiguous-mixture", "A state predicate beside a temporal property can be read in two ways"),
    "LTL303": Code("bad-margin", "A margin has to be a finite number, not negative"),
    "LTL304": Code("margin-without-side", "The margin of an ordering has no favourable side here"),
    "LTL305": Code("margin-on-other-type", "Only numbers and vectors are compared with a margin"),
    "LTL306": Code("no-property", "The file states no property"),
    "LTL307": Code("too-large", "A property grows too large when its associations are written out"),
    "LTL308": Code("wrong-bound", "The keyword takes no such bound"),
    "LTL309": Code("ambiguous-bound", "A bound, or what stands under it, can be read in two ways"),
    "LTL310": Code("many-clocks", "The bound would need any number of clocks"),
    "LTL311": Code("nested-reading", "A temporal keyword takes in what a connective joins to it", NOTE),
    "LTL312": Code("many-openings", "A value at an opening where there is no one opening"),
    "LTL321": Code("formula-syntax", "A formula, or an equation of an encoding, cannot be read"),
    "LTL322": Code("unknown-letter", "An equation uses a letter or keyword that it does not have"),
    "LTL323": Code("incomplete-encoding", "An encoding needs a name of its own and one equation for each keyword"),
    "LTL324": Code("misused-letter", "The letters of an equation stand where they make no sense"),
    "LTL325": Code("idle-equation", "An equation makes no difference between runs, or ignores a letter", WARNING),
    "LTL326": Code("unbounded-encoding", "A bound stands where the encoding has no clock for it"),
    "LTL401": Code("unknown-setting", "There is no such setting"),
    "LTL402": Code("setting-out-of-range", "The value of a setting is out of range"),
    "LTL403": Code("doubled-setting", "A setting is given twice"),
    "LTL501": Code("unsatisfiable", "No run satisfies the property"),
    "LTL502": Code("no-finite-run", "Only runs that never end satisfy the property", WARNING),
    "LTL503": Code("valid", "The property cannot fail", WARNING),
    "LTL504": Code("vacuous-part", "A part of the property makes no difference", WARNING),
    "LTL505": Code("never-triggered", "An event cannot occur while the properties hold", WARNING),
    "LTL506": Code("never-decided", "No run decides the property while it goes on", WARNING, pedantic=True),
    "LTL507": Code("idle-bound", "A bound on time makes no difference", WARNING),
    "LTL508": Code("own-trigger", "An interval excludes what begins it", WARNING),
    "LTL510": Code("events-overlap", "An event and its closing event can hold together", WARNING),
    "LTL511": Code("events-gap", "Between an event and its closing event is a gap", NOTE, pedantic=True),
    "LTL512": Code("encodings-differ", "The published readings of a scope part here", NOTE, pedantic=True),
    "LTL513": Code("held-trigger", "An interval is counted from the last instant of its trigger", NOTE, pedantic=True),
    "LTL520": Code("exact-equality", "Measured numbers are compared exactly", WARNING),
    "LTL521": Code("rate-dependent", "The verdict depends on how messages arrive", WARNING),
    "LTL522": Code("short-bound", "A bound on time is over before the next tick", WARNING),
    "LTL523": Code("waits-for-topic", "A deadline begins when a topic speaks, which may stay silent", NOTE),
    "LTL524": Code("waits-for-others", "A part of the property waits for a signal that it does not read", NOTE),
    "LTL525": Code("never-forgotten", "Ids or messages are kept for ever, until others find no place", NOTE),
    "LTL526": Code("unreachable-count", "A count cannot be reached within its time", WARNING),
    "LTL601": Code("inconsistent", "Properties cannot hold together"),
    "LTL602": Code("redundant", "The property follows from others", WARNING),
    "LTL603": Code("equivalent", "The property says the same as another", WARNING),
    "LTL604": Code("same-signal", "Two names for one signal", WARNING),
    "LTL605": Code("goal-on-the-way", "Whatever satisfies another property reaches this goal", NOTE, pedantic=True),
    "LTL606": Code("excluded-deadline", "After a trigger, the time that two properties give does not fit", WARNING),
    "LTL690": Code("not-decided", "A question about the specification stays open", NOTE),
    "LTL691": Code("idle-suppression", "A comment suppresses nothing", NOTE),
    "LTL701": Code("translation-exceeded", "The budget does not suffice to make the monitor"),
    "LTL702": Code("wrong-monitor", "The monitor and the meaning of the property disagree"),
    "LTL703": Code("wrong-code", "The emitted code does not do what it should"),
    "LTL704": Code("not-judged", "The budget does not suffice to judge the monitor"),
    "LTL801": Code("recording-head", "The recording does not have the columns that it needs"),
    "LTL802": Code("recording-line", "A line of the recording cannot be read"),
    "LTL803": Code("recording-value", "A recorded value does not fit its signal"),
    "LTL804": Code("recording-time", "The times of a recording have to be numbers that do not decrease"),
    "LTL805": Code("unknown-column", "The recording has a column that no property reads", NOTE),
    "LTL806": Code("missing-column", "The recording has no values of a signal", WARNING),
    "LTL807": Code("recording-format", "Not a recording in a form that can be read"),
    "LTL820": Code("damaged-table", "The recording is damaged"),
    "LTL830": Code("no-recordings", "A folder or a pattern has no recording"),
    "LTL831": Code("storage", "A storage, or a recording on it, cannot be read"),
    "LTL832": Code("lost-recording", "No process judges the recording to its end"),
    "LTL833": Code("results-table", "The table of results cannot be read or written"),
    "LTL834": Code("engine", "There are no workers that could judge recordings"),
    "LTL840": Code("parameter", "A `?` has no value yet"),
    "LTL841": Code("misplaced-parameter", "A `?` stands where no value can be found"),
    "LTL842": Code("not-monotone", "A property has no tightest value"),
    "LTL843": Code("no-parameter", "The file has no `?`"),
    "LTL850": Code("no-place", "Messages were left out: more ids came than an `each` keeps", WARNING),
    "LTL810": Code("bag-metadata", "The metadata of a bag cannot be used"),
    "LTL811": Code("damaged-bag", "A bag is damaged, or is no bag"),
    "LTL812": Code("missing-messages", "Not all messages that a bag says it has were read"),
    "LTL813": Code("bag-files", "The files of a bag are not those that its metadata names", WARNING),
    "LTL814": Code("message-times", "Messages were recorded out of order, or at one time", NOTE),
    "LTL815": Code("header-stamps", "Messages have no time in a header", WARNING),
    "LTL818": Code("definitions", "By whose definition messages are read", NOTE),
    "LTL705": Code("not-certified", "There is no proof that the monitor is right"),
    "LTL706": Code("unforeseen-letter", "Values lead to a letter that the alphabet excludes"),
    "LTL707": Code("wrong-text", "The text of the emitted code is not the monitor"),
    "LTL708": Code("not-in-target", "The property cannot be written in C or Rust yet"),
    "LTL711": Code("judged-by-rows-only", "A property of each id or message cannot be mined or compared yet"),
    "LTL710": Code("wrong-machine", "What the monitor was lowered to is not the monitor"),
    "LTL709": Code("late-verdict", "A verdict may come later than it could", WARNING),
    "LTL901": Code("file-not-found", "The file does not exist"),
    "LTL902": Code("unreadable-file", "The file cannot be read"),
    "LTL903": Code("not-utf-8", "The file is not UTF-8 text"),
    "LTL904": Code("empty-file", "The file is empty"),
    "LTL905": Code("too-long-file", "The file is too long for a specification"),
    "LTL906": Code("bad-message-path", "A message path, or a message definition in it, cannot be read"),
}


def diagnostic(
    code: str,
    source: Source,
    place: Span | None,
    message: str,
    *,
    label: str = "",
    secondary: tuple[Label, ...] = (),
    help: str | Help = "",
    example: dict[str, Any] | None = None,
) -> Diagnostic:
    """The diagnostic `code` at `place`, with the name and severity that the registry gives it.

    Raises KeyError for a code that is not registered.
    """
    known = CODES[code]
    primary = None if place is None else Label(place, label)
    advice = Help(help) if isinstance(help, str) else help
    return Diagnostic(
        code, known.name, known.severity, message, source, primary, secondary, advice.text, example, advice.fixes
    )


def find(text: str) -> str | None:
    """The code that `text` is, or the name of: `LTL101`, `ltl101`, `101` and `unknown-name`; None if there is none."""
    code = text.upper() if text.upper().startswith("LTL") else f"LTL{text}"
    if code in CODES:
        return code
    return next((code for code, known in CODES.items() if known.name == text.lower()), None)


def page(code: str) -> str:
    """The page that explains `code`, in Markdown. Raises KeyError if there is no such code."""
    CODES[code]
    return page_path(code).read_text(encoding="utf-8")


def page_path(code: str) -> Path:
    """The file with the page of a registered code."""
    return Path(__file__).parent / f"{code}.md"
