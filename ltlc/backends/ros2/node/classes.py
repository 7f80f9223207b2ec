"""The Python classes of ROS messages."""

from __future__ import annotations

import importlib
import sys
from typing import Any


def class_of(message: str) -> Any:
    """The class of messages with this full name; ImportError or AttributeError: none.

    Packages name services and actions only; what these are made of is defined beside
    them, `NavigateToPose_FeedbackMessage` where `NavigateToPose` is.
    """
    package, kind, name = message.split("/")
    found = getattr(importlib.import_module(f"{package}.{kind}"), name.split("_")[0])
    return getattr(sys.modules[found.__module__], name)
