"""The topics and fallbacks of guards in an emitted node are read back."""

from __future__ import annotations

import pytest
from stepping import from_text

from ltlc.assurance.reading.files import written
from ltlc.assurance.reading.outcomes import Difference
from ltlc.backends import ros2
from ltlc.interfaces.building.guards import guard_entries, guard_programs

TEXT = """guard /raw to /out else crawl, stop
message crawl {linear.x: 0.1}
message stop {linear.x: 0, linear.y: -1}
decl speed /out geometry_msgs/Twist.linear.x
decl near /near std_msgs/Bool.data
slow: always (new speed and near implies speed <= 0.2)
"""


def difference(old: str, new: str) -> bool:
    """Whether a node in which `new` stands in place of `old` is refused."""
    compiled, specification = from_text(TEXT, "watch.txt")
    guards = guard_programs(specification, compiled, guard_entries(specification, compiled))
    code = ros2.emit(compiled, specification, guards)
    assert code.count(old) == 1, old
    machines, properties = [each.machine for each in compiled], [each.specification for each in compiled]
    found = written(code.replace(old, new), machines, properties, guards)
    return all(isinstance(each, Difference) for each in found)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"/raw",', '"/out",'),
        ('            "/out",', '            "/raw",'),
        ('"crawl"', '"stop"'),
        ("0.1)", "0.2)"),
        ('(("linear", "y"), -1.0)', '(("linear", "z"), -1.0)'),
        (', (("linear", "y"), -1.0)', ""),
        ("def topics_to_guard()", "def topics_to_leave()"),
    ],
)
def test_a_guard_whose_topics_or_fallbacks_are_changed_is_refused(old: str, new: str) -> None:
    assert difference(old, new)


def test_a_guard_as_it_was_emitted_is_not_refused() -> None:
    assert not difference('"crawl"', '"crawl"')
