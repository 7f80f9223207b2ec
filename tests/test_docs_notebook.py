"""The notebook in `docs/` runs, and shows what it showed when it was written."""

import ast
import json
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from types import UnionType
from typing import Any

import pytest

from ltlc.interfaces.api.tables import Display
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor

NOTEBOOK = Path(__file__).parent.parent / "docs" / "encodings.ipynb"
SHOWN_AS: dict[type | UnionType, str] = {Display: "text/html", Monitor: "image/svg+xml", Formula: "text/latex"}


def code_cells(notebook: Any) -> list[Any]:
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def printed(cell: Any) -> str:
    """What a cell prints; tables have times in them, which differ."""
    streams = (o for o in cell["outputs"] if o["output_type"] == "stream" and o["name"] == "stdout")
    return "".join("".join(o["text"]) for o in streams)


def shown(cell: Any) -> set[str]:
    """The forms in which the value of a cell is shown."""
    return {form for output in cell["outputs"] for form in output.get("data", {})}


def run(source: str, names: dict[str, Any]) -> tuple[str, Any]:
    """What a cell prints, and the value of its last line if that is an expression."""
    body = ast.parse(source).body
    last = body.pop() if body and isinstance(body[-1], ast.Expr) else None
    with redirect_stdout(StringIO()) as output:
        exec(compile(ast.Module(body, []), "cell", "exec"), names)
        value = eval(compile(ast.Expression(last.value), "cell", "eval"), names) if isinstance(last, ast.Expr) else None
    return output.getvalue(), value


def test_the_notebook_says_what_it_said_when_it_was_written() -> None:
    names: dict[str, Any] = {}
    forms = set()
    for cell in code_cells(json.loads(NOTEBOOK.read_text(encoding="utf-8"))):
        output, value = run("".join(cell["source"]), names)
        assert output == printed(cell)
        expected = {form for type_, form in SHOWN_AS.items() if isinstance(value, type_)}
        assert expected <= shown(cell)
        forms |= expected
    assert forms == set(SHOWN_AS.values())


@pytest.mark.filterwarnings("ignore")  # those of Jupyter
def test_the_notebook_runs_in_jupyter(tmp_path: Path) -> None:
    pytest.importorskip("ipykernel")
    nbclient, nbformat = pytest.importorskip("nbclient"), pytest.importorskip("nbformat")
    fresh = nbformat.read(NOTEBOOK, as_version=4)
    written = [(printed(cell), shown(cell)) for cell in code_cells(fresh)]
    nbclient.NotebookClient(fresh, timeout=120, resources={"metadata": {"path": tmp_path}}).execute()
    assert [(printed(cell), shown(cell)) for cell in code_cells(fresh)] == written
