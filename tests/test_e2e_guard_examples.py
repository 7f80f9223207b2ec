"""The worked examples of guards over ROS 2: the emitted node stands between the controller and the simulated robot.

These have no deadlines, so that no guard can be late, however busy the machine is.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from ros_support import own_domain

pytestmark = pytest.mark.ros
pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros,simulation]")
pytest.importorskip("mujoco", reason="needs MuJoCo: install ltlc[ros,simulation]")

LIVE = Path(__file__).parent.parent / "examples" / "guard" / "live.py"


@pytest.mark.parametrize(("name", "properties"), [("tools", 4), ("arm", 3)])
def test_a_robot_behind_an_emitted_guard_does_not_crash(name: str, properties: int, tmp_path: Path) -> None:
    with own_domain(tmp_path):
        command = [sys.executable, str(LIVE), name]
        run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    assert f"; 0 of {properties} properties violated.\n" in run.stdout
    assert "The robot hits" not in run.stdout
    assert (tmp_path / "build" / f"{name}_guard.py").exists()
