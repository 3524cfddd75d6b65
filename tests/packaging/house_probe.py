"""Counts the calls of one recorded run and the public names of its robot, in a process of its own; prints JSON."""

from __future__ import annotations

import json
import os
import sys
import tempfile
from types import FrameType
from typing import Any

import irsim
from irsim.api import run

_SCENE = """
world: {width: 10, height: 10}
robot: {kinematics: {name: diff}, state: [1, 5, 0], goal: [9, 5, 0], behavior: {name: dash}, sensors: [{name: lidar2d}]}
obstacle: {shape: {name: circle, radius: 0.5}, state: [5, 8, 0]}
"""


def main() -> None:
    """Run the scene twice and count in the second run, in which everything is imported."""
    package = os.path.dirname(irsim.__file__)
    files: list[str] = []

    def seen(frame: FrameType, event: str, _: Any) -> None:
        if event == "call" and frame.f_code.co_filename.startswith(package):
            files.append(os.path.relpath(frame.f_code.co_filename, package))

    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        with open("scene.yaml", "w", encoding="utf-8") as file:
            file.write(_SCENE)
        run("scene.yaml", record=True)
        sys.setprofile(seen)
        run("scene.yaml", record=True)
        sys.setprofile(None)
        env = irsim.make("scene.yaml", headless=True, log_level="ERROR")
        names = {"names of a robot": public(env.robot), "names of an environment": public(env)}
        env.end()
        os.chdir("/")
    rooms = [name.partition(os.sep)[0] for name in files]
    print(json.dumps({"calls": len(files), "files": len(set(files)), "rooms": rooms, **names}))


def public(thing: object) -> int:
    """Number of public names that completion offers."""
    return sum(not name.startswith("_") for name in dir(thing))


if __name__ == "__main__":
    main()
