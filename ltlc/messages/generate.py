"""Makes `jazzy.json`, the message definitions of ROS 2 Jazzy that rosbags ships: `python -m ltlc.messages.generate`.

Importing rosbags would take longer than compiling a specification.
"""

from __future__ import annotations

from pathlib import Path

from ltlc.files import compact_json, write_text
from ltlc.messages.definitions import jazzy_definitions


def main() -> None:
    """Write the file beside this one."""
    write_text(Path(__file__).parent / "jazzy.json", compact_json(jazzy_definitions()))


if __name__ == "__main__":
    main()
