"""Draws docs/guard_people.png: where the robot is that drives at people, without its guard (left) and with it.

MUJOCO_GL=egl python examples/guard/picture.py
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import mujoco
import numpy as np
from crash import HERE, Guarded, Unguarded, drive
from scenes import People
from world import World

import ltlc

PICTURE = Path(HERE).parents[1] / "docs" / "guard_people.png"
HEIGHT, WIDTH = 240, 400


def frame(world: World) -> np.ndarray:
    """What a camera beside the robot sees."""
    camera = mujoco.MjvCamera()
    camera.lookat[:] = (5.1, 0.2, 0.7)
    camera.distance, camera.azimuth, camera.elevation = 4, 75, -22
    options = mujoco.MjvOption()
    options.flags[mujoco.mjtVisFlag.mjVIS_RANGEFINDER] = False
    with mujoco.Renderer(world.model, HEIGHT, WIDTH) as renderer:
        renderer.update_scene(world.data, camera, options)
        pixels: np.ndarray = renderer.render()
    return pixels


def png(pixels: np.ndarray) -> bytes:
    """Rows of RGB pixels as a PNG file."""
    height, width, _ = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    parts = (
        (b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)),
        (b"IDAT", zlib.compress(rows, 9)),
        (b"IEND", b""),
    )
    chunks = (
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in parts
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


def main() -> None:
    """Drive without and with the guard, and write the picture."""
    ways = (Unguarded(), Guarded(ltlc.guard(HERE / "people.txt")))
    PICTURE.write_bytes(png(np.hstack([frame(drive(People(), way)) for way in ways])))


if __name__ == "__main__":
    main()
