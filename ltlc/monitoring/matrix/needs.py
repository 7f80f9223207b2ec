"""The matrix as `needs.json`, from which sphinx-needs imports requirements and tests (`needimport`)."""

from __future__ import annotations

import json
import re
from itertools import count
from typing import Any

from ltlc.base.revision import version_text
from ltlc.monitoring.matrix.forms import results_text
from ltlc.monitoring.matrix.matrix import Matrix, Traced

VERSION = "1.0"
"""That of the needs in the file, which has one only."""


def needs_json(matrix: Matrix) -> str:
    """A `req` for each requirement, and a `test` for each property, which links to those that it verifies."""
    needs = [_need(each.id, "req", each.text or each.id, each.state.value, "", []) for each in matrix.requirements]
    needs += [_test(id, each) for id, each in zip(test_ids(matrix), matrix.properties, strict=True)]
    version = {
        "creator": {"program": "ltlc", "version": version_text()},
        "needs": {each["id"]: each for each in needs},
        "needs_amount": len(needs),
    }
    whole = {"project": "ltlc", "current_version": VERSION, "versions": {VERSION: version}}
    return json.dumps(whole, indent=2, ensure_ascii=False) + "\n"


def _test(id: str, of: Traced) -> dict[str, Any]:
    content = f".. code-block:: text\n\n   {of.text}\n\n{of.place}; SHA-256 {of.source.sha256}; {results_text(of)}"
    return _need(id, "test", of.label, of.state.value, content, list(of.ids))


def _need(id: str, kind: str, title: str, status: str, content: str, links: list[str]) -> dict[str, Any]:
    return {"id": id, "type": kind, "title": title, "status": status, "content": content, "links": links, "tags": []}


def test_ids(matrix: Matrix) -> list[str]:
    """An id of each property for other tools, the same as long as file and label are: capitals, digits and `_`."""
    found: list[str] = []
    for each in matrix.properties:
        name = re.sub(r"[^A-Z0-9]", "_", f"LTLC_{each.source.name}_{each.label}".upper())
        numbered = (name if n == 1 else f"{name}_{n}" for n in count(1))
        found.append(next(id for id in numbered if id not in found))
    return found
