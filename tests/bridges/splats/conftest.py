"""A room of splats in the frame of COLMAP, its map, and a run in it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

import irsim
from irsim.bridges.frames import axes_of
from irsim.bridges.maps.importing import import_map
from irsim.runs import Run, open_run
from tests.bridges.splats.scenes import Room, room, write_ply

ROBOT = """\
robot:
  name: rover
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.2}
  state: [1.5, 1, 0]
  goal: [5, 1.5, 0]
  behavior: {name: dash}
  color: "#0000ff"
obstacle:
  - name: walker
    kinematics: {name: omni}
    shape: {name: circle, radius: 0.25}
    state: [5.5, 4.2, 0]
    goal: [3.5, 4.4, 0]
    behavior: {name: dash}
    color: "#ff0000"
"""


@dataclass(frozen=True)
class Site:
    """A room of splats, its file, the scenario with its map and a robot, and a recorded run."""

    folder: Path
    room: Room
    scene: Path
    scenario: Path
    run: Run


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Site:
    """A room in the frame of COLMAP, whose floor is 1.2 m below its origin."""
    folder = tmp_path_factory.mktemp("site")
    made = room(spacing=0.1, axes=axes_of("colmap"), shift=(0.0, 1.2, 0.0))
    scene = write_ply(folder / "room.ply", made.columns)
    scenario = folder / "room.yaml"
    import_map(scene, scenario, up="-y", resolution=0.1)
    scenario.write_text(scenario.read_text(encoding="utf-8") + ROBOT, encoding="utf-8")
    irsim.run(scenario, seed=1, record=folder / "run")
    return Site(folder, made, scene, scenario, open_run(folder / "run"))
