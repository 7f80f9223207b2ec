"""What happens when a wheel or an sdist is built: it keeps the commit that it was built from, for `ltlc --version`."""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class CommitHook(BuildHookInterface[Any]):
    """Adds the file `commit.txt` to the package where git knows the commit; an sdist has it already."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Write the file beside the tree, and have it taken in; nothing for an editable install, which asks git."""
        sys.path.insert(0, self.root)
        from ltlc.base.revision import FILE, commit_of

        commit = commit_of(Path(self.root))
        if version == "editable" or not commit:
            return
        self._folder = TemporaryDirectory()
        file = Path(self._folder.name) / FILE
        file.write_text(commit, encoding="utf-8")
        build_data["force_include"][str(file)] = f"ltlc/{FILE}"
