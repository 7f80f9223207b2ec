"""In a Jupyter notebook, monitors and formulas show themselves as pictures."""

from __future__ import annotations

import sys

from ltlc.interfaces.api.pictures import formula_latex, monitor_svg
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor


def show_pictures() -> None:
    """Have the notebook in which this runs, if any, show monitors as SVG and formulas as LaTeX."""
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    if shell is None:
        return
    formatters = shell.display_formatter.formatters
    formatters["image/svg+xml"].for_type(Monitor, monitor_svg)
    formatters["text/latex"].for_type(Formula, formula_latex)
