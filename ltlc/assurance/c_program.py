"""The emitted C of a property, or the equivalent Rust, as something that can be replayed."""

from __future__ import annotations

import re

from ltlc.assurance.compiled_program import CompiledProgram
from ltlc.backends.c import Files
from ltlc.dataclass import dataclass
from ltlc.specification.shapes import Shape

_TOKENS = re.compile(r'"(?:[^"\\]|\\.)*"|/\*.*?\*/|\w+|[^\s\w]', re.DOTALL)


@dataclass(frozen=True)
class CProgram(CompiledProgram):
    """The property with a number in emitted C, or in what is printed from it."""

    files: Files

    def describe(self, shape: Shape) -> None:
        """The text of the property and of its signals, with the names in it numbered as they come."""
        files = self.files
        writer = files.properties[self.number]
        known = set(re.findall(r"\w+", " ".join(files.names_of(self.number))))
        numbers: dict[str, int] = {}
        code = "\n".join(files.text_of(self.number))
        found = (token for token in _TOKENS.findall(code) if not token.startswith("/*"))
        tokens = [numbers.setdefault(token, len(numbers)) if token in known else f"C {token}" for token in found]
        signals = [(signal, numbers.get(files.samples.fields[signal])) for signal in files.signals_of(self.number)]
        shape.add((tuple(tokens), tuple(signals), writer.timed, self.libraries.own.rate, self.libraries.own.timeout))
