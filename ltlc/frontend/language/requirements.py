"""The requirement that a property states: the attributes in front of it, and the `##` comments that touch it."""

from __future__ import annotations

from ltlc.base.diagnostics import Label
from ltlc.base.source import Source, Span
from ltlc.frontend.language.names import Checker
from ltlc.frontend.syntax import tree as syntax
from ltlc.specification.requirements import Requirement


class Requirements:
    """Takes the requirements of the properties of a file, one after the other."""

    def __init__(self, checker: Checker) -> None:
        self.checker = checker
        self.ids: dict[str, Span] = {}

    def of(self, command: syntax.PropertyCommand) -> Requirement | None:
        """The requirement that `command` states, if it states one; its errors are reported."""
        text = " ".join(_comments(self.checker.source, command))
        given: dict[str, syntax.Entry] = {}
        for entry in (entry for line in command.attributes for entry in line.entries):
            if first := given.get(entry.key.text):
                message = f"`{entry.key.text}` is given twice: write all values of an attribute together"
                self.checker.report("LTL112", entry.key.span, message, Label(first.span, "first here"))
            given.setdefault(entry.key.text, entry)
        if "id" in given:
            self._check_id(given["id"])
        if not text and not given:
            return None
        attributes = {key: tuple(value.text for value in entry.values) for key, entry in given.items()}
        return Requirement(text, attributes, command.whole())

    def _check_id(self, entry: syntax.Entry) -> None:
        """An id is one string, and that of one property; those that a `forall` stands for share it."""
        value, *others = entry.values
        if others:
            self.checker.report("LTL112", others[0].span, "a requirement has one `id`, not several")
            return
        first = self.ids.setdefault(value.text, value.span)
        if first != value.span:
            message = f"two requirements have the id `{value.text}`"
            self.checker.report("LTL111", value.span, message, Label(first, "first here"))


def _comments(source: Source, command: syntax.PropertyCommand) -> list[str]:
    """The lines of the `##` comments above `command`, and between its attributes and itself."""
    first, last = (source.position(span.start).line for span in (command.whole(), command.span))
    above = first
    while above > 1 and source.line(above - 1).lstrip().startswith("##"):
        above -= 1
    lines = (source.line(number).strip() for number in range(above, last))
    return [text for line in lines if line.startswith("##") and (text := line.lstrip("#").strip())]
