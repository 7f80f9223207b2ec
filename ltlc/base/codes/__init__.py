"""The registry of diagnostic codes: every diagnostic is made here, so that each has a name and a page.

The first digit is the subject: 0 syntax, 1 names, 2 types and messages, 3 properties, 4 settings, 5 and 6 what
analyses find, 7 monitors and the gate, 8 recordings, 9 files. `CODE.md` beside this file explains a code.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ltlc.base.diagnostics import Diagnostic, Help, Label, Severity
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass

ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE


@dataclass(frozen=True, slots=True)
class Code:
    """What a code stands for: its mnemonic, its page's title, its weight, and whether it is reported on demand only."""

    name: str
    title: str
    severity: Severity = ERROR
    pedantic: bool = False


CODES: dict[str, Code] = {
    "LTL001": Code("syntax", "Unexpected text"),
    "LTL002": Code("missing-comma", "A comma is missing between arguments"),
    "LTL003": Code("single-equals", "`=` defines a name; `==` compares values"),
    "LTL004": Code("foreign-operator", "An operator of another language"),
    "LTL005": Code("unclosed", "A parenthesis, brace or bracket is not closed"),
    "LTL006": Code("unfinished", "The text ends too early, or something new begins too early"),
    "LTL007": Code("missing-semicolon", "A model must end with a semicolon"),
    "LTL008": Code("keyword-as-name", "A keyword cannot be used as a name"),
    "LTL009": Code("reserved-word", "A reserved word cannot be used as a name"),
    "LTL010": Code("split-word", "A word of the language is split in two"),
    "LTL011": Code("strange-character", "An invalid character"),
    "LTL012": Code("malformed-string", "An unterminated string, or an unknown escape"),
    "LTL013": Code("chained-comparison", "Comparisons cannot be chained"),
    "LTL014": Code("malformed-number", "A malformed number"),
    "LTL015": Code("too-deep", "The property is nested too deeply"),
    "LTL016": Code("stray-bound", "A time bound belongs to no keyword"),
    "LTL018": Code("malformed-forall", "A malformed `forall`"),
    "LTL019": Code("second-on-line", "Two properties on one line"),
    "LTL020": Code("unit", "Only durations and angles have units"),
    "LTL021": Code("foreign-phrase", "A phrase of another language"),
    "LTL101": Code("unknown-name", "An undefined name"),
    "LTL102": Code("redefined-name", "A name is defined twice"),
    "LTL103": Code("used-before-definition", "A name is used before its definition"),
    "LTL104": Code("unused", "A name is defined but not used", WARNING),
    "LTL105": Code("unknown-attribute", "No such attribute of an object, a model or a vector"),
    "LTL106": Code("duplicate-label", "Two properties have the same label"),
    "LTL107": Code("unknown-function", "No such function"),
    "LTL108": Code("bad-topic", "An invalid topic name"),
    "LTL109": Code("bad-forall", "Invalid variables or names in a `forall`"),
    "LTL110": Code("similar-object", "The name of an undeclared object resembles another one", WARNING),
    "LTL111": Code("duplicate-id", "Two requirements have the same id"),
    "LTL112": Code("bad-attribute", "An attribute of a requirement is given twice, or has too many values"),
    "LTL113": Code("bad-each", "Invalid variable or keys in an `each`"),
    "LTL114": Code("bad-guard", "The topics, types or fallbacks of a guard do not fit, or what is beside it"),
    "LTL115": Code("idle-guard", "A guard keeps no property"),
    "LTL201": Code("unknown-message-type", "Unknown message type"),
    "LTL202": Code("ambiguous-message-type", "Several packages define the message type"),
    "LTL203": Code("unknown-field", "The message has no such field"),
    "LTL204": Code("path-without-value", "The path does not lead to a value"),
    "LTL205": Code("type-mismatch", "The operands do not fit the operator"),
    "LTL206": Code("not-a-predicate", "A value is used as a property, or a property as a value"),
    "LTL207": Code("wrong-arguments", "A function is given arguments that it does not accept"),
    "LTL208": Code("no-ground-truth", "The object's source does not provide this primitive"),
    "LTL209": Code("missing-model", "The primitive needs an attribute of a model"),
    "LTL210": Code("history-of-expression", "History needs something that has samples"),
    "LTL211": Code("history-offset", "A history offset must be an integer that looks back"),
    "LTL212": Code("index-out-of-range", "The array has no such element"),
    "LTL213": Code("no-number", "The constant expression has no value"),
    "LTL214": Code("unknown-constant", "The message has no such constant"),
    "LTL215": Code("not-constant", "A constant is required here"),
    "LTL216": Code("no-duration", "A bound is a duration with a unit"),
    "LTL217": Code("bad-duration", "A duration is not a whole number of nanoseconds, or a bound is empty"),
    "LTL218": Code("age-comparison", "An age is compared only by order, and only with a duration"),
    "LTL219": Code("no-messages", "`new` and `age` need the messages of one topic"),
    "LTL220": Code("no-field", "A message without a field is used as a value"),
    "LTL230": Code("elements", "Arrays whose elements do not belong together"),
    "LTL231": Code("latch-looks-back", "A condition inside `@{…}` must be about one step"),
    "LTL232": Code("bad-count", "A count must be a whole number of occurrences at single steps"),
    "LTL240": Code("bad-zone", "The corners of a zone do not form a simple polygon"),
    "LTL241": Code("bad-constant", "A value does not fit the field of a message"),
    "LTL301": Code("temporal-event", "An event, or an operand of a past operator, must be a state predicate"),
    "LTL302": Code("ambiguous-mixture", "A state predicate beside a temporal property is ambiguous"),
    "LTL303": Code("bad-margin", "A margin must be a finite number and not negative"),
    "LTL304": Code("margin-without-side", "This margin has no favourable side"),
    "LTL305": Code("margin-on-other-type", "Only numbers and vectors can be compared with a margin"),
    "LTL306": Code("no-property", "The file has no property"),
    "LTL307": Code("too-large", "The property is too large once its associations are expanded"),
    "LTL308": Code("wrong-bound", "The keyword does not take this bound"),
    "LTL309": Code("ambiguous-bound", "A bound, or its operand, is ambiguous"),
    "LTL310": Code("many-clocks", "The bound would need an unlimited number of clocks"),
    "LTL311": Code("nested-reading", "A temporal keyword extends over a connective", NOTE),
    "LTL312": Code("many-openings", "A value at an opening is used where there is no single opening"),
    "LTL321": Code("formula-syntax", "A malformed formula, or a malformed equation of an encoding"),
    "LTL322": Code("unknown-letter", "An equation uses an unknown letter or keyword"),
    "LTL323": Code("incomplete-encoding", "An encoding needs a unique name and one equation for each keyword"),
    "LTL324": Code("misused-letter", "A letter is used in the wrong place in an equation"),
    "LTL325": Code("idle-equation", "An equation is trivial or ignores a letter", WARNING),
    "LTL330": Code("import-form", "The file is not of the form that is to be imported"),
    "LTL331": Code("not-imported", "A requirement of another tool cannot be imported"),
    "LTL332": Code("import-differs", "An imported property means something else than its formula", WARNING),
    "LTL333": Code("import-not-compared", "An imported property could not be compared with its formula", WARNING),
    "LTL334": Code("import-readings", "A formula means something else at points than over signals", NOTE),
    "LTL326": Code("unbounded-encoding", "The encoding has no clock for this bound"),
    "LTL401": Code("unknown-setting", "No such setting"),
    "LTL402": Code("setting-out-of-range", "The value of a setting is out of range"),
    "LTL403": Code("doubled-setting", "A setting is given twice"),
    "LTL501": Code("unsatisfiable", "No run satisfies the property"),
    "LTL502": Code("no-finite-run", "Only infinite runs satisfy the property", WARNING),
    "LTL503": Code("valid", "The property cannot fail", WARNING),
    "LTL504": Code("vacuous-part", "A part of the property makes no difference", WARNING),
    "LTL505": Code("never-triggered", "An event cannot occur while the properties hold", WARNING),
    "LTL506": Code("never-decided", "No run decides the property before it ends", WARNING, pedantic=True),
    "LTL507": Code("idle-bound", "A time bound makes no difference", WARNING),
    "LTL508": Code("own-trigger", "An interval forbids its own trigger", WARNING),
    "LTL510": Code("events-overlap", "An event and its closing event can hold at the same step", WARNING),
    "LTL511": Code("events-gap", "There is a gap between an event and its closing event", NOTE, pedantic=True),
    "LTL512": Code("encodings-differ", "The published readings of a scope differ here", NOTE, pedantic=True),
    "LTL513": Code("held-trigger", "An interval is counted from the last instant of its trigger", NOTE, pedantic=True),
    "LTL520": Code("exact-equality", "Measured numbers are compared exactly", WARNING),
    "LTL521": Code("rate-dependent", "The verdict depends on how often messages arrive", WARNING),
    "LTL522": Code("short-bound", "A time bound ends before the next tick", WARNING),
    "LTL523": Code("waits-for-topic", "A deadline starts with a topic that may stay silent", NOTE),
    "LTL524": Code("waits-for-others", "A part of the property waits for a signal that it does not read", NOTE),
    "LTL525": Code("never-forgotten", "Ids or messages may be kept forever, until no others can be accepted", NOTE),
    "LTL526": Code("unreachable-count", "A count cannot be reached within its time", WARNING),
    "LTL527": Code("presumed-rate", "A rate that holds at first decides the property", WARNING),
    "LTL601": Code("inconsistent", "The properties contradict one another"),
    "LTL602": Code("redundant", "The property follows from others", WARNING),
    "LTL603": Code("equivalent", "The property is equivalent to another one", WARNING),
    "LTL604": Code("same-signal", "Two names for one signal", WARNING),
    "LTL605": Code(
        "goal-on-the-way", "The goal is reached by whatever satisfies another property", NOTE, pedantic=True
    ),
    "LTL606": Code("excluded-deadline", "After a trigger, the times of two properties are incompatible", WARNING),
    "LTL610": Code("guard-passes-nothing", "A guard lets nothing through"),
    "LTL611": Code("guard-begins-never", "A guard has nothing to begin with"),
    "LTL612": Code("guard-holds-back", "A guard never lets some commands through that violate nothing", WARNING),
    "LTL613": Code("guard-takes-back", "A guard lets commands through and takes them back", NOTE),
    "LTL614": Code("short-for-guard", "A time bound is shorter than the lead of a guard", WARNING),
    "LTL615": Code("watched-only", "No guard keeps the property", NOTE),
    "LTL616": Code("uncontrollable", "No controller can keep the properties"),
    "LTL617": Code("controllable", "Nothing is found that keeps a controller from keeping the properties", NOTE),
    "LTL690": Code("not-decided", "A question about the specification was not decided", NOTE),
    "LTL691": Code("idle-suppression", "A comment suppresses nothing", NOTE),
    "LTL701": Code("translation-exceeded", "The budget is too small to build the monitor"),
    "LTL702": Code("wrong-monitor", "The monitor does not match the meaning of the property"),
    "LTL703": Code("wrong-code", "The emitted code behaves differently from its monitor"),
    "LTL704": Code("not-judged", "The budget is too small to judge the monitor"),
    "LTL801": Code("recording-head", "The recording lacks required columns"),
    "LTL802": Code("recording-line", "A malformed line in the recording"),
    "LTL803": Code("recording-value", "A recorded value does not fit its signal"),
    "LTL804": Code("recording-time", "The times of a recording must be numbers that do not decrease"),
    "LTL805": Code("unknown-column", "No property reads this column of the recording", NOTE),
    "LTL806": Code("missing-column", "The recording has no values of a signal", WARNING),
    "LTL807": Code("recording-format", "An unsupported recording format"),
    "LTL808": Code("missing-library", "A library is not installed"),
    "LTL820": Code("damaged-table", "The recording is damaged"),
    "LTL830": Code("no-recordings", "A folder or a pattern contains no recording"),
    "LTL831": Code("storage", "A storage, or a recording on it, cannot be read"),
    "LTL832": Code("lost-recording", "The recording could not be judged to its end"),
    "LTL833": Code("results-table", "The table of results cannot be read or written"),
    "LTL834": Code("engine", "No workers to judge recordings"),
    "LTL840": Code("parameter", "A `?` has no value yet"),
    "LTL841": Code("misplaced-parameter", "No value can be found for a `?` in this place"),
    "LTL842": Code("not-monotone", "The property has no tightest value"),
    "LTL843": Code("no-parameter", "The file has no `?`"),
    "LTL850": Code("no-place", "Messages were ignored: there were more ids than an `each` keeps", WARNING),
    "LTL851": Code("no-evidence", "Evidence does not cover a property", NOTE),
    "LTL852": Code("rules-not-checked", "Rules of a pack were not checked", NOTE),
    "LTL810": Code("bag-metadata", "The metadata of a bag cannot be used"),
    "LTL811": Code("damaged-bag", "A bag is damaged, or is not a bag"),
    "LTL812": Code("missing-messages", "Some of a bag's messages were not read"),
    "LTL813": Code("bag-files", "The files of a bag differ from its metadata", WARNING),
    "LTL814": Code("message-times", "Messages were recorded out of order, or at the same time", NOTE),
    "LTL815": Code("header-stamps", "Messages have no time in a header", WARNING),
    "LTL816": Code("from-before", "The time of `--from` is before the recording", WARNING),
    "LTL817": Code("other-pace", "A simulation was recorded by another clock than its own", NOTE),
    "LTL818": Code("definitions", "Which definitions are used to read messages", NOTE),
    "LTL819": Code("dropouts", "A flight log lacks messages", WARNING),
    "LTL705": Code("not-certified", "The monitor could not be certified"),
    "LTL706": Code("unforeseen-letter", "Some values lead to a letter that the alphabet excludes"),
    "LTL707": Code("wrong-text", "The text of the emitted code does not match the monitor"),
    "LTL708": Code("not-in-target", "The property, or the guard, cannot be written for this target yet"),
    "LTL711": Code("judged-by-rows-only", "A property for each id or message cannot be mined or compared yet"),
    "LTL710": Code("wrong-machine", "The lowered machine does not match the monitor"),
    "LTL709": Code("late-verdict", "A verdict may come later than it could", WARNING),
    "LTL901": Code("file-not-found", "The file does not exist"),
    "LTL902": Code("unreadable-file", "The file cannot be read"),
    "LTL903": Code("not-utf-8", "The file is not UTF-8 text"),
    "LTL904": Code("empty-file", "The file is empty"),
    "LTL905": Code("too-long-file", "The file is too long to be a specification"),
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
    """The code that `text` means: `LTL101`, `ltl101`, `101` or `unknown-name`; None if it is not one."""
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
