"""Templates of emitted code: each package of a backend has its own beside its modules."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import jinja2
    import markupsafe


@cache
def template(package: str, name: str, *, escape: bool = False) -> jinja2.Template:
    """The template `name` of `package`; what goes into it is code already, unless it is to `escape` it for HTML.

    In HTML, the filter `coded` makes code of what is between backticks. A template is compiled once, which takes longer
    than to write with it.
    """
    import jinja2  # here, for what only judges needs none

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader(package, "."),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        undefined=jinja2.StrictUndefined,
        autoescape=escape,
    )
    environment.filters["coded"] = coded
    return environment.get_template(name)


def coded(text: str) -> markupsafe.Markup:
    """`text` as HTML, with what is between backticks as code."""
    from markupsafe import Markup, escape

    return Markup(re.sub("`([^`]*)`", r"<code>\1</code>", str(escape(text))))
