"""The phrases of other languages, tools and English, and how each is written here: a row for each."""

from __future__ import annotations

import re
from functools import cached_property

from ltlc.dataclass import dataclass
from ltlc.semantics.durations import UNITS


@dataclass(frozen=True)
class Phrase:
    """What a whole text is that matches `pattern`, as it is `written` here.

    `differs` says how that is not the same, if it is not. In `written`, groups of the pattern stand in braces: as they
    are with `!r`, else in parentheses where they are more than a comparison. The group `u` is a unit, or empty for
    seconds. A group of a topic has the `name` of a signal that is declared on it, and its `type`; one of a topic and a
    path the `signal` that is declared so.
    """

    pattern: str
    written: str
    differs: str = ""

    @cached_property
    def compiled(self) -> re.Pattern[str]:
        """The pattern, compiled when it is first tried: most files have no phrase."""
        return re.compile(self.pattern)


_P, _Q = r"(?P<p>[^,]+?)", r"(?P<q>[^,]+?)"
_NESTED = r"\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\)"
_ONE, _OTHER = (rf"(?P<{name}>(?:{_NESTED}|(?!\b(?:and|or|implies)\b)[^,()])+?)" for name in "pq")
_NUMBER, _UNIT = r"\d+(?:\.\d+)?", "|".join(UNITS)
_DURATION = rf"{_NUMBER}\s*(?:{_UNIT})\b"
_D, _WITHIN = rf"(?P<d>{_DURATION})", rf"(?P<w>\s+within\s+{_DURATION})?"
_U = rf"\s*(?P<u>(?:{_UNIT})\b|)\s*"
_TO = rf"_?\s*\[?\s*(?:<=?|0?\s*(?:{_UNIT})?\s*[,:])\s*(?P<n>{_NUMBER}){_U}[\])]?"
_FROM = rf"_?\s*\[\s*(?P<a>{_NUMBER})\s*(?:(?:{_UNIT})\b)?\s*[,:]\s*(?P<n>{_NUMBER}){_U}[\])]"
_UNBOUNDED = r"_?\s*\[\s*0\s*[,:]\s*(?:inf|infinity|oo|∞)\s*[\])]"
SECONDS = "the bound is taken to be in seconds"
_STILL = "in this P still has to hold at the instant at which the interval begins"
AT_FIRST = "a condition that stands alone is meant always; of the first step alone, it is `initially P`"
_SAMPLES = "`@{}` counts samples of the signal, `X` steps of the run"
_SCOPE = "an `after_until` has an episode each time, HPL's scope is the first"
_EVENT = r"(?P<{}>/[\w/~]+(?:\s*\{{[^{{}}]*\}})?)"
_E, _F = (_EVENT.format(name) for name in "ef")
_GLOBALLY = r"(?:globally\s*:\s*)?"
_SHALL = r"(?:the\s+)?\w+\s+shall\s+"
_ALWAYS, _EVENTUALLY, _PREFIX = "(?:always|globally|G)", "(?:eventually|finally|F)", r"(?:always\s+)?"
_THEN = r"(?:\s*[,:]\s*then\s+|\s*[,:]\s*|\s+then\s+)"
_BODY = r"(?:\s*[,:]\s*|\s+(?=(?:always|never|eventually)\b))"
_STATE = r"(?!(?:always|never|eventually|until|after|after_until|initially|within)\b)"
TEMPORAL = r"(?:always|never|eventually|until|after|after_until|initially)\b"
_EVERY = "this is about every moment at which P holds; where it begins to is `P and not previously P`"
_DIVISOR = "the result of `mod` has the sign of the divisor"
_IS = r"(?:(?:is|are|be|being|stays?|remains?)\s+)?"
_PER_SAMPLE = "this is the change from one sample to the next, not per second"
_FROM_SECOND = "this counts messages, `X` steps of the run"
_FIFTY = "this is of the last 50 samples, however long they took: windows of time are not averaged"
_EACH_MESSAGE = "this is judged from each message on; `each NAME of KEY: P` is judged for each value of KEY"
_ANY = "for at least one element, write `any` in place of `all`"
_LISTS = (
    "each element of one is combined with each of the other; of arrays whose elements belong together, write `(x, y)`"
)
_LAST_SECOND = "a rate is the number of messages in a time, here the last second, which must be at least so many"
_SUBJECT = r"(?P<v>[A-Za-z]\w*(?:\.\w+)*)"
_BOUNDED = r"(?:eventually|never|once|since)\b(?:(?!\b(?:and|or|implies)\b).)*"
_COMPARED = r"(?P<c>\s*(?:[<>]=?|[=!]=)\s*[-\w.]+)?"
_TOPIC = r"[/~][\w/~]+"
_GUARD = rf"guard\s+{_TOPIC}\s+to\s+{_TOPIC}"
_WINDOW = rf"\(\s*{_SUBJECT}\s*\)\s+(?:over|within)\s+{_D}"

PHRASES: tuple[Phrase, ...] = (
    # Punctuation and single words.
    Phrase(r"(?P<x>.*\S)\s*;+", "{x!r}"),
    Phrase(r"(?P<l>\w+)\s*:\s*(?P<x>\w+\s*:.*)", "{x!r}", "a property has one label"),
    Phrase(r"(?P<x>.*)\|(?P<v>[^|]+)\|(?P<y>.*)", "{x!r}abs({v!r}){y!r}"),
    Phrase(rf"(?P<x>(?:.*\s)?{_BOUNDED})\bin\s+{_D}(?P<y>.*)", "{x!r}within {d!r}{y!r}"),
    Phrase(rf"{_STATE}{_ONE}\s+in\s+{_D}", "eventually {p} within {d!r}"),
    Phrase(r"(?P<x>.*)\b(?P<f>age|rate)\(\s*(?P<t>/[\w/]+)\s*\)(?P<y>.*)", "{x!r}{f!r}({t.name}){y!r}"),
    Phrase(
        rf"(?P<x>.*)\b(?P<f>min|max|mean|median|sum)\(\s*{_SUBJECT}\s+(?:over|within|in|for)\s+{_D}\s*\)(?P<y>.*)",
        "{x!r}{f!r}({v!r}) over {d!r}{y!r}",
    ),
    Phrase(r"(?P<x>.*?)\bnew\s+(?P<t>/[\w/]+)(?P<y>.*)", "{x!r}new {t.name}{y!r}"),
    Phrase(r"(?P<x>(?!decl\b).*?(?:^|[\s(]))(?P<t>/\w+(?:[./]\w+)+)(?P<y>.*)", "{x!r}{t.signal}{y!r}"),
    *(
        Phrase(rf"(?P<x>.*)\b{word}\((?P<c>[^()]*{relation}[^()]*)\)(?P<y>.*)", f"{{x!r}}{written}({{c!r}}){{y!r}}")
        for word, relation, written in (
            ("min", "<", "any"),
            ("max", ">", "any"),
            ("min", ">", "all"),
            ("max", "<", "all"),
        )
    ),
    Phrase(r"(?P<x>.*?)(?<![\w.])\.(?P<n>\d+)(?P<y>.*)", "{x!r}0.{n!r}{y!r}"),
    Phrase(
        rf"(?P<x>.*?){_SUBJECT}\s+(?:is\s+)?between\s+(?P<n>[-\w.]+)\s+and\s+(?P<m>[-\w.]+)(?P<y>.*)",
        "{x!r}({n!r} <= {v!r} and {v!r} <= {m!r}){y!r}",
    ),
    Phrase(rf"(?P<x>.*?){_SUBJECT}'(?P<y>.*)", "{x!r}({v!r} - @{{{v!r}, -1}}){y!r}", _PER_SAMPLE),
    Phrase(
        rf"(?P<x>.*?){_SUBJECT}\s+in\s+(?:\[\s*(?P<n>[-\w.]+)\s*,\s*(?P<m>[-\w.]+)\s*\]|(?P<k>-?\d+)\.\.(?P<l>-?\d+))(?P<y>.*)",
        "{x!r}({n!r}{k!r} <= {v!r} and {v!r} <= {m!r}{l!r}){y!r}",
    ),
    Phrase(
        rf"{_STATE}{_ONE}\s+within\s+\[\s*(?P<a>{_NUMBER})\s*,\s*(?P<n>{_NUMBER})\s*\]\s*(?P<u>{_UNIT})\b",
        "eventually {p} within [{a!r} {u!r}, {n!r} {u!r}]",
    ),
    Phrase(
        rf"(?P<x>.*\b(?:within|for)\s+)\[\s*(?P<a>{_NUMBER})\s*,\s*(?P<n>{_NUMBER})\s*\]\s*(?P<u>{_UNIT})\b(?P<y>.*)",
        "{x!r}[{a!r} {u!r}, {n!r} {u!r}]{y!r}",
    ),
    Phrase(rf"(?P<x>.*?){_SUBJECT}\s*%\s*(?P<n>[-\w.]+)(?P<y>.*)", "{x!r}mod({v!r}, {n!r}){y!r}", _DIVISOR),
    Phrase(r"(?P<x>.*\b(?:for|within))\s+(?:at\s+(?:least|most)|up\s+to)\s+(?P<y>\d.*)", "{x!r} {y!r}"),
    Phrase(r"(?P<x>.*\d),(?P<y>\d.*)", "{x!r}.{y!r}"),
    Phrase(r"(?P<x>.*?\S)\s*//\s*(?P<y>.*)", "{x!r}  # {y!r}"),
    Phrase(r"(?P<x>.*)~\s*(?P<y>[\w(].*)", "{x!r}not {y!r}"),
    # Declarations.
    Phrase(r"(?P<n>\w+)\s*=\s*(?P<t>/[\w/]+)\.(?P<f>[\w.\[\]]+)", "decl {n!r} {t!r} {t.type}.{f!r}"),
    Phrase(r"(?P<n>\w+)\s*=\s*(?P<t>/[\w/]+)\s+(?P<f>[\w/]*[A-Z]\w*\.[\w.\[\]]+)", "decl {n!r} {t!r} {f!r}"),
    Phrase(r"decl\s+(?P<n>\w+)\s+(?P<t>/?\w+)/(?P<f>\w+(?:/\w+)*)", "decl {n!r} {t!r} {t.type}.{f.path}"),
    Phrase(
        r"decl\s+(?P<n>\w+)\s+(?P<t>\S+)\s+(?P<m>[\w/]*[A-Z]\w*)[\s/]+(?P<f>[a-z]\w*(?:/\w+)+)",
        "decl {n!r} {t!r} {m!r}.{f.path}",
    ),
    Phrase(
        r"(?P<x>decl\s+\w+)\s+(?P<m>(?:\w+/)*[A-Z]\w*(?:\.[\w.\[\]]+)?)\s+(?P<t>/[\w/]+)(?P<f>(?:\.[\w.\[\]]+)?)",
        "{x!r} {t!r} {m!r}{f!r}",
    ),
    Phrase(r"(?P<x>decl\s+\w+\s+\S+\s+\w+)(?:::msg)?::(?P<y>\S+)", "{x!r}/{y!r}"),
    Phrase(r"(?P<x>decl\s+\w+\s+\S+\s+[\w/]+)\s+(?P<y>[a-z][\w.\[\]]*)", "{x!r}.{y!r}"),
    # Guards.
    Phrase(
        rf"guard\s+(?P<t>{_TOPIC})\s*(?:,|implies|into|as)?\s*(?<!\w)(?P<o>{_TOPIC})(?P<y>.*)",
        "guard {t!r} to {o!r}{y!r}",
    ),
    Phrase(rf"guard\s+(?P<o>{_TOPIC})\s+(?:from|of)\s+(?P<t>{_TOPIC})(?P<y>.*)", "guard {t!r} to {o!r}{y!r}"),
    Phrase(
        rf"(?P<x>{_GUARD})(?:\s*,\s*|\s*,?\s+(?:or\s+else|or|otherwise|fallback|default|with)\s+)(?P<y>\w.*)",
        "{x!r} else {y!r}",
    ),
    Phrase(
        rf"(?P<x>{_GUARD}\s+else\s+\w+(?:\s*,\s*\w+)*)\s+(?:(?:or\s+else|or|else|then|and)\s+)?(?P<y>\w.*)",
        "{x!r}, {y!r}",
    ),
    Phrase(r"(?P<x>message\s+\w+)\s*[:=(]+\s*(?P<y>\{.*\})\)?", "{x!r} {y!r}"),
    Phrase(r"(?:assum(?:e|es|ing|ption))(?:\s+that|\s*:)?\s+(?P<x>.+)", "assume {x!r}"),
    Phrase(r"(?P<l>\w+)\s*:\s*assume\s+(?P<x>.+)", "assume {l!r}: {x!r}"),
    # FRET.
    Phrase(rf"(?:whenever)\s+{_P},?\s+(?P<s>{_SHALL}.+)", "always ({p} implies ({s!r}))"),
    Phrase(rf"(?:upon|when|if)\s+{_P},?\s+(?P<s>{_SHALL}.+)", "always ({p} and not previously {p} implies ({s!r}))"),
    Phrase(rf"in\s+(?P<m>\w+)\s+(?:mode,?\s+)?(?P<s>{_SHALL}.+)", "after_until {m}, not {m}, ({s!r})"),
    Phrase(rf"{_SHALL}always\s+satisfy\s+(?P<r>.+)", "always {r}"),
    Phrase(rf"{_SHALL}never\s+satisfy\s+(?P<r>.+)", "never {r}"),
    Phrase(rf"{_SHALL}immediately\s+satisfy\s+(?P<r>.+)", "initially {r}"),
    Phrase(rf"{_SHALL}within\s+{_D}(?:econds?)?\s+satisfy\s+(?P<r>.+)", "eventually {r} within {d!r}"),
    Phrase(rf"{_SHALL}for\s+{_D}(?:econds?)?\s+satisfy\s+(?P<r>.+)", "always {r} for {d!r}"),
    Phrase(rf"{_SHALL}until\s+{_P}\s+satisfy\s+(?P<r>.+)", "(always {r}) or (until {p}, always {r})"),
    Phrase(rf"{_SHALL}before\s+{_P}\s+satisfy\s+(?P<r>.+)", "(never {p}) or (until {p}, eventually {r})"),
    Phrase(rf"{_SHALL}(?:eventually\s+)?(?:satisfy\s+)?(?P<r>.+)", "eventually {r}"),
    # HPL: scopes, then patterns.
    Phrase(rf"after\s+{_E}\s+until\s+{_F}\s*:\s*(?P<x>.+)", "after_until {e}, {f}, {x!r}", _SCOPE),
    Phrase(rf"after\s+{_E}\s*:\s*(?P<x>.+)", "after {e}, {x!r}"),
    Phrase(rf"until\s+{_F}\s*:\s*no\s+{_E}", "(never {e}) or (until {f}, never {e})"),
    Phrase(rf"until\s+{_F}\s*:\s*some\s+{_E}", "until {e}, never {f}"),
    Phrase(rf"until\s+{_F}\s*:\s*(?P<x>.+)", "((never {f}) and ({x!r})) or (until {f}, ({x!r}))"),
    Phrase(rf"{_GLOBALLY}no\s+{_E}{_WITHIN}", "never {e}{w!r}"),
    Phrase(rf"{_GLOBALLY}some\s+{_E}{_WITHIN}", "eventually {e}{w!r}"),
    Phrase(rf"{_GLOBALLY}no\s*\{{\s*(?P<p>[^{{}}]+)\}}{_WITHIN}", "never {p}{w!r}"),
    Phrase(rf"{_GLOBALLY}some\s*\{{\s*(?P<p>[^{{}}]+)\}}{_WITHIN}", "eventually {p}{w!r}"),
    Phrase(rf"{_GLOBALLY}{_P}\s+(?:causes|leads\s+to)\s+{_Q}{_WITHIN}", "always ({p} implies eventually {q}{w!r})"),
    Phrase(rf"{_GLOBALLY}{_P}\s+requires\s+{_Q}{_WITHIN}", "always ({p} implies once {q}{w!r})"),
    Phrase(rf"{_GLOBALLY}{_P}\s+forbids\s+{_Q}{_WITHIN}", "always ({p} implies never {q}{w!r})"),
    # PSL and SVA, CTL and TLA.
    Phrase(r"assert\s+(?:property\s*)?\((?P<x>.+)\)", "{x!r}"),
    Phrase(
        rf"{_PREFIX}{_SUBJECT}{_COMPARED}\s*\|=>\s*(?P<q>.+)",
        "always (@{{{v!r}, -1}}{c!r} implies {q})",
        _SAMPLES,
    ),
    Phrase(rf"{_PREFIX}{_ONE}\s*\|->\s*(?P<q>.+)", "always ({p} implies {q!r})"),
    Phrase(rf"{_PREFIX}{_ONE}\s*(?:~>|-->)\s*{_OTHER}", "always ({p} implies eventually {q})"),
    Phrase(r"(?:AG|A\s*\[\])\s*(?P<p>.+)", "always {p}"),
    Phrase(r"AF\s*(?P<p>.+)", "eventually {p}"),
    Phrase(r"EF\s*(?P<p>.+)", "eventually {p}", "`E` is about some run, a monitor judges the one that it sees"),
    Phrase(rf"{_ALWAYS}{_UNBOUNDED}\s*(?P<p>.+)", "always {p}"),
    Phrase(rf"{_EVENTUALLY}{_UNBOUNDED}\s*(?P<p>.+)", "eventually {p}"),
    # English.
    Phrase(rf"{_PREFIX}every\s+{_D}{_THEN}?\s*{_STATE}(?P<p>.+)", "always eventually {p} within {d!r}"),
    Phrase(rf"{_PREFIX}{_STATE}{_ONE}\s+(?:at\s+least\s+)?every\s+{_D}", "always eventually {p} within {d!r}"),
    Phrase(
        rf"{_PREFIX}(?:if|whenever)\s+{_P}{_THEN}{_STATE}{_OTHER}\s+within\s+{_D}",
        "always ({p} implies eventually {q} within {d!r})",
    ),
    Phrase(
        rf"{_PREFIX}when\s+{_P}{_THEN}{_STATE}{_OTHER}\s+within\s+{_D}",
        "always ({p} implies eventually {q} within {d!r})",
        _EVERY,
    ),
    Phrase(rf"{_PREFIX}(?:if|whenever)\s+{_P}{_THEN}(?P<q>.+)", "always ({p} implies {q!r})"),
    Phrase(rf"{_PREFIX}when\s+{_P}{_THEN}(?P<q>.+)", "always ({p} implies {q!r})", _EVERY),
    Phrase(rf"while\s+{_P}{_THEN}(?P<q>{TEMPORAL}.+)", "after_until {p}, not {p}, {q!r}"),
    Phrase(rf"{_PREFIX}while\s+{_P}{_THEN}(?P<q>.+)", "always ({p} implies {q!r})"),
    Phrase(rf"never\s+{_ONE}\s+(?:while|when|whenever|if)\s+{_OTHER}", "never ({p} and {q})"),
    Phrase(
        rf"eventually\s+{_ONE}\s+within\s+{_D}\s+(?:when|whenever|if)\s+{_OTHER}",
        "always ({q} implies eventually {p} within {d!r})",
    ),
    Phrase(rf"{_PREFIX}{_STATE}{_ONE}\s+(?:while|when|whenever|if)\s+{_OTHER}", "always ({q} implies {p})"),
    Phrase(rf"{_STATE}{_ONE}\s+(?P<k>always|never)", "{k!r} {p}"),
    Phrase(r"at\s+all\s+times,?\s+(?P<x>.+)", "always {x!r}"),
    Phrase(rf"{_SUBJECT}\s+(?:must|should)\s+(?:never|not)\s+(?P<y>.+)", "never {v!r} {y!r}"),
    Phrase(rf"{_SUBJECT}\s+(?:must|should)\s+(?:always\s+)?(?:(?:be|stay|remain)\s+)?(?P<y>.+)", "always {v!r} {y!r}"),
    Phrase(rf"{_STATE}{_ONE}\s+precedes\s+{_OTHER}", "always ({q} implies once {p})"),
    Phrase(rf"never\s+{_ONE}\s+for\s+(?:more\s+than\s+|at\s+least\s+)?{_D}", "never historically {p} for {d!r}"),
    Phrase(
        rf"(?P<x>(?:(?:always|never|eventually)\s+)?){_STATE}{_ONE}\s+at\s+least\s+(?P<n>\d+)\s+times",
        "{x!r}once {p} {n!r} times",
    ),
    Phrase(rf"(?P<x>.*\bonce\s+.*\S)\s+(?P<n>\d+)(?P<y>\s+within\s+{_D})", "{x!r} {n!r} times{y!r}"),
    Phrase(
        rf"(?P<x>(?:(?:always|never|eventually)\s+)?)(?!once\b){_STATE}{_ONE}\s+(?P<n>\d+)\s+times(?P<y>\s+within\s+{_D})?",
        "{x!r}once {p} {n!r} times{y!r}",
    ),
    Phrase(r"G\s*(?P<x>\(.+\)|not .+)", "always {x!r}"),
    Phrase(r"F\s*(?P<x>\(.+\)|not .+)", "eventually {x!r}"),
    Phrase(rf"after\s+{_P}\s+until\s+{_Q}{_BODY}(?P<x>.+)", "after_until {p}, {q}, {x!r}"),
    Phrase(rf"between\s+{_P}\s+and\s+{_Q}{_BODY}(?P<x>.+)", "after_until {p}, {q}, {x!r}"),
    Phrase(
        rf"before\s+{_P}\s*[,:]\s*(?P<x>(?:always|never|eventually)\b.+)",
        "((never {p}) and ({x!r})) or (until {p}, ({x!r}))",
    ),
    *(
        Phrase(
            rf"(?P<x>.*?){_SUBJECT}\s+{words}\s+(?P<n>-?\d[\w.]*)(?P<y>.*)", f"{{x!r}}{{v!r}} {relation} {{n!r}}{{y!r}}"
        )
        for words, relation in (
            (rf"{_IS}(?:less|lower|smaller)\s+than", "<"),
            (rf"{_IS}(?:below|under)", "<"),
            (rf"{_IS}(?:more|greater|higher|larger)\s+than", ">"),
            (rf"{_IS}(?:above|over)", ">"),
            (r"exceeds?", ">"),
            (rf"{_IS}at\s+most", "<="),
            (rf"{_IS}at\s+least", ">="),
            (rf"{_IS}equal\s+to", "=="),
            (r"equals", "=="),
        )
    ),
    # One property for each id or message, of all elements, and rates; zones.
    Phrase(r"(?P<x>each\s+(?P<v>\w+)\s+of\s.*?\w)\[\s*(?P=v)\s*\](?P<y>.*)", "{x!r}{y!r}"),
    Phrase(
        r"(?P<x>zone\s+\w+)\s*(?:=\s*)?(?P<a>\([^()]*\))(?P<y>\s*,.*,\s*)(?P<b>\([^()]*\))", "{x!r} = [{a!r}{y!r}{b!r}]"
    ),
    Phrase(
        r"(?:for\s+)?(?:each|every|all)\s+(?P<v>\w+)\s+(?:of|in)\s+(?P<k>\w+)\s*[:,]\s*(?P<x>.+)",
        "each {v!r} of {k!r}: {x!r}",
    ),
    Phrase(r"(?:for\s+)?(?:each|every)\s+new\s+(?P<k>\w+)\s*[:,]\s*(?P<x>.+)", "each new {k!r}: {x!r}"),
    Phrase(r"(?:for\s+)?(?:each|every)\s+(?P<k>\w+)\s*[:,]\s*(?P<x>.+)", "each new {k!r}: {x!r}", _EACH_MESSAGE),
    Phrase(
        r"(?P<x>.*?)(?P<a>\w+)\[\s*[*:]?\s*\](?P<c>\s*(?:[<>]=?|[=!]=)\s*[-\w.]+)(?P<y>.*)",
        "{x!r}all({a!r}{c!r}){y!r}",
        _ANY,
    ),
    Phrase(r"(?P<x>.+)\s+over\s+(?P<a>[A-Za-z]\w*)", "{x!r} over ({a!r})"),
    Phrase(r"(?P<x>.+)\s+over\s+(?P<a>[A-Za-z]\w*)\s*,\s*(?P<b>[A-Za-z]\w*)", "{x!r} over ({a!r}), ({b!r})", _LISTS),
    Phrase(
        rf"(?P<x>.*)\brate\(\s*{_SUBJECT}\s*\)\s*>=?\s*(?P<n>\d+)\s*Hz(?!\s+over\b)(?P<y>.*)",
        "{x!r}rate({v!r}) >= {n!r} Hz over 1 s{y!r}",
        _LAST_SECOND,
    ),
    # Intervals.
    Phrase(
        rf"{_ONE}\s*\b(?:U|until){_TO}\s*{_OTHER}",
        "(until {q}, always {p}) and (eventually {q} within {n!r} {u!r})",
    ),
    Phrase(rf"{_EVENTUALLY}{_TO}\s*{_ONE}", "eventually {p} within {n!r} {u!r}"),
    Phrase(rf"{_ALWAYS}{_TO}\s*{_ONE}", "always {p} for {n!r} {u!r}"),
    Phrase(rf"(?:once|O|P){_TO}\s*{_ONE}", "once {p} within {n!r} {u!r}"),
    Phrase(rf"(?:historically|H){_TO}\s*{_ONE}", "historically {p} for {n!r} {u!r}"),
    Phrase(rf"{_EVENTUALLY}{_FROM}\s*{_ONE}", "eventually {p} within [{a!r} {u!r}, {n!r} {u!r}]"),
    Phrase(rf"{_ALWAYS}{_FROM}\s*{_ONE}", "always {p} for [{a!r} {u!r}, {n!r} {u!r}]"),
    Phrase(
        rf"{_ONE}\s*\b(?:U|until){_FROM}\s*{_OTHER}",
        "(always {p} for {a!r} {u!r}) and (within [{a!r} {u!r}, {n!r} {u!r}], until {q}, always {p})",
        _STILL,
    ),
    # Operators between two parts, and `X`.
    Phrase(rf"{_PREFIX}{_ONE}\s+until\s+{_D}", "always {p} for {d!r}"),
    Phrase(rf"never\s+{_ONE}\s+(?:U|until)\s+{_OTHER}", "until {q}, never {p}"),
    Phrase(rf"never\s+{_ONE}\s+(?:W|unless)\s+{_OTHER}", "(until {q}, never {p}) or never {p}"),
    Phrase(rf"{_PREFIX}{_ONE}\s+(?:U|until)\s+{_OTHER}", "until {q}, always {p}"),
    Phrase(r"(?:\[\]|□)\s*(?P<p>.+)", "always {p}"),
    Phrase(r"(?:<>|◇)\s*(?P<p>.+)", "eventually {p}"),
    Phrase(rf"{_PREFIX}{_ONE}\s+(?:W|unless|weak_until)\s+{_OTHER}", "(until {q}, always {p}) or always {p}"),
    Phrase(rf"{_ONE}\s+(?:R|V|releases|release)\s+{_OTHER}", "(until {p} and {q}, always {q}) or always {q}"),
    Phrase(rf"{_ONE}\s+S\s+{_OTHER}", "{p} since {q}"),
    Phrase(rf"{_ONE}\s+T\s+{_OTHER}", "not (not {p} since not {q})"),
    Phrase(
        rf"{_SUBJECT}{_COMPARED}\s+(?P<w>implies|and|or)\s+(?:X|next)\b\s*(?P<q>.+)",
        "@{{{v!r}, -1}}{c!r} {w!r} {q}",
        _SAMPLES,
    ),
    Phrase(
        rf"\A(?:always|G)\s+X\s+{_SUBJECT}{_COMPARED}",
        "after once new {v!r} 2 times, always {v!r}{c!r}",
        _FROM_SECOND,
    ),
    Phrase(rf"\AX\s+{_SUBJECT}{_COMPARED}", "after once new {v!r} 2 times, initially {v!r}{c!r}", _FROM_SECOND),
    # Windows of time.
    *(
        Phrase(rf"(?P<x>.*)\b{word}{_WINDOW}\s*{asked}\s*(?P<n>[-\w.]+)(?P<y>|\s.*)", f"{{x!r}}{written}{{y!r}}")
        for word, asked, written in (
            ("max", "(?P<o>>=?)", "once {v!r} {o!r} {n!r} within {d!r}"),
            ("max", "<", "not once {v!r} >= {n!r} within {d!r}"),
            ("max", "<=", "not once {v!r} > {n!r} within {d!r}"),
            ("min", "(?P<o><=?)", "once {v!r} {o!r} {n!r} within {d!r}"),
            ("min", ">", "not once {v!r} <= {n!r} within {d!r}"),
            ("min", ">=", "not once {v!r} < {n!r} within {d!r}"),
        )
    ),
    Phrase(rf"(?P<x>.*)\b(?P<f>mean|median|sum){_WINDOW}(?P<y>.*)", "{x!r}{f!r}(@{{{v!r}, -49:}}){y!r}", _FIFTY),
    Phrase(rf"(?P<x>.*?){_SUBJECT}\s+in\s+(?P<k>[A-Za-z]\w*)(?P<y>.*)", "{x!r}inside({v!r}, {k.zone}){y!r}"),
)
"""In the order in which they are tried, those of whole sentences before those of their parts."""
