"""Rule packs: what others have learned that robots must not do, a file for each rule (docs/rules.md).

A rule is a specification of its own: definitions, an empty line, and properties that begin with the `##` comments of
their requirements. A pack is all the rules in a folder; definitions that several of them need stand in each, the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from ltlc.base.nearest import did_you_mean
from ltlc.dataclass import dataclass

FOLDER = Path(__file__).parent
SUFFIX = ".ltlc"


class UnknownRuleError(Exception):
    """There is no pack or rule of this name; the text says which there are."""


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule, by its name in its pack: `battery_cell`."""

    name: str
    text: str

    @property
    def definitions(self) -> str:
        """What comes before the properties."""
        return self.text[: self._begin].strip()

    @property
    def properties(self) -> str:
        """The properties, with the text of their requirements."""
        return self.text[self._begin :].strip()

    @property
    def _begin(self) -> int:
        return self.text.index("\n##") + 1


@dataclass(frozen=True, slots=True)
class Pack:
    """Rules for one kind of robot; `about` says in a sentence which."""

    name: str
    version: str
    about: str
    rules: tuple[Rule, ...]

    def text(self, rules: Iterable[Rule] | None = None) -> str:
        """A specification of some of its rules, by default all; what they define stands at the beginning, once."""
        chosen = self.rules if rules is None else tuple(rules)
        lines = (line for rule in chosen for line in rule.definitions.splitlines())
        defined = dict.fromkeys(" ".join(line.split()) for line in lines)
        head = f"# The rules `@{self.name}` {self.version} of ltlc: {self.about}"
        return "\n\n".join([head, "\n".join(defined), *(rule.properties for rule in chosen)]) + "\n"


def packs() -> list[str]:
    """The names of all packs."""
    return sorted(path.parent.name for path in FOLDER.glob("*/pack.toml"))


def pack(name: str) -> Pack:
    """The pack called `name`; of `px4/battery_cell`, with this rule only. Raises UnknownRuleError."""
    of, _, rule = name.partition("/")
    if of not in packs():
        raise UnknownRuleError(did_you_mean(of, packs()) or f"the packs are {_listed(packs())}")
    import tomllib

    head = tomllib.loads((FOLDER / of / "pack.toml").read_text(encoding="utf-8"))
    files = sorted((FOLDER / of).glob(f"*{SUFFIX}"))
    rules = [Rule(path.stem, path.read_text(encoding="utf-8")) for path in files]
    chosen = [each for each in rules if rule in ("", each.name)]
    if not chosen:
        names = [each.name for each in rules]
        raise UnknownRuleError(did_you_mean(rule, names) or f"the rules of `{of}` are {_listed(names)}")
    return Pack(of, head["version"], head["about"], tuple(chosen))


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)
