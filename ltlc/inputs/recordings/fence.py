"""The fence around all readers: whatever a damaged file makes them raise is a diagnostic about that file.

Readers report the errors that they expect. But files and the libraries that read them are written by others, and
nobody foresees all that a wrong byte does to them.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ltlc.base.libraries import missing_library
from ltlc.inputs.recordings.rows import RecordingError, failure

HELP = "if other programs can read it, please report this to the authors of ltlc, with the file"


@contextmanager
def fenced(path: Path, code: str) -> Iterator[None]:
    """What is raised while the recording at `path` is read becomes a RecordingError with this `code`."""
    try:
        yield
    except RecordingError:
        raise
    except ModuleNotFoundError as error:
        found = missing_library(error, str(path))
        if found is None:
            raise
        raise RecordingError(found) from None
    except MemoryError:
        raise failure(code, path, f"`{path}` needs more memory than is available") from None
    except OSError as error:
        raise failure("LTL902", path, f"`{path}` cannot be read: {error.strerror or error}") from None
    except Exception as error:
        what = f"{type(error).__name__}: {error}".partition("\n")[0]
        raise failure(code, path, f"`{path}` is damaged: reading it ends with {what}", HELP) from error
