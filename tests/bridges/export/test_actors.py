"""Exports of what moves: ``openscenario``, well-formed without its tools, and ``isaac_people``, commands for people."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from PIL import Image

import irsim
from irsim.bridges.export.export import export_run
from irsim.bridges.export.formats import openscenario
from irsim.diagnostics.errors import ArgumentError
from irsim.runs import Run, RunError
from tests.bridges.scenes import recorded

SCENE = """
world: {width: 20, height: 20, step_time: 0.1}
robot:
  - {name: 'a "b" <c> & d', kinematics: {name: acker}, shape: {name: rectangle, length: 3, width: 1.5, wheelbase: 2},
     state: [3, 3, 0], goal: [14, 15], behavior: {name: dash}}
obstacle:
  - {name: walker, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, state: [10, 5, 0], goal: [16, 5],
     behavior: {name: dash}}
  - {name: crate, shape: {name: rectangle, length: 1, width: 2}, state: [4, 14, 0.3]}
"""


@pytest.fixture
def run() -> Run:
    return recorded(SCENE, 20)


def _vertices(root: Any, name: str) -> Any:
    (group,) = [one for one in root.iter("ManeuverGroup") if one.get("name") == name]
    places = [vertex.find("Position/WorldPosition") for vertex in group.iter("Vertex")]
    return np.array([[float(place.get(key)) for key in "xyh"] for place in places])


def test_entities_and_trajectories(run: Run) -> None:
    result = irsim.export_run(run, to="openscenario", objects="all")
    assert result.file.endswith(".xosc")
    root, trace = ET.parse(result.file).getroot(), run.trace()
    kinds = {one.get("name"): one[0].tag for one in root.iter("ScenarioObject")}
    assert kinds == {'a "b" <c> & d': "Vehicle", "walker": "Pedestrian", "crate": "MiscObject"}
    for column, name in enumerate(['a "b" <c> & d', "walker"]):
        np.testing.assert_allclose(_vertices(root, name), trace.pose[:, column], atol=1e-5)
    starts = {one.get("entityRef"): one.find(".//WorldPosition") for one in root.iter("Private")}
    assert (starts["crate"].get("x"), starts["crate"].get("y")) == ("4", "14")
    box = next(one for one in root.iter("ScenarioObject") if one.get("name") == "crate").find(".//Dimensions")
    assert (box.get("length"), box.get("width")) == ("1", "2")
    stop = root.find("Storyboard/StopTrigger").find(".//SimulationTimeCondition")
    assert float(stop.get("value")) == pytest.approx(2.0)


def test_in_the_world_of_roads(run: Run) -> None:
    given = {"x": 10.0, "y": -4.0, "yaw": 90.0, "roads": "Town03", "pedestrian": "walker.pedestrian.0042"}
    result = irsim.export_run(run, "run.xosc", options=given)
    assert result.notes == []
    root, pose = ET.parse("run.xosc").getroot(), run.trace().pose[:, 1]
    wanted = np.stack([10 - pose[:, 1], -4 + pose[:, 0], pose[:, 2] + np.pi / 2], axis=1)
    np.testing.assert_allclose(_vertices(root, "walker"), wanted, atol=1e-5)
    assert root.find("RoadNetwork/LogicFile").get("filepath") == "Town03"
    assert next(root.iter("Pedestrian")).get("model") == "walker.pedestrian.0042"


def test_a_run_that_is_too_long_writes_nothing(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(openscenario, "MAX_VERTICES", 30)
    with pytest.raises(RunError, match=r"holds up to 30 poses, and this run has 42"):
        irsim.export_run(run, "run.xosc")
    assert not Path("run.xosc").exists()


def test_characters_that_xml_has_none_for(run: Run) -> None:
    assert openscenario._text("a\x00b\ud800c\td") == "a\ufffdb\ufffdc\td"
    assert openscenario._text(1e-9) == "0"
    assert openscenario._text(-0.25) == "-0.25"


def test_a_map_is_no_entity() -> None:
    Image.fromarray(np.array([[0, 255], [255, 255]], dtype=np.uint8)).save("map.png")
    text = SCENE.replace("step_time: 0.1", "step_time: 0.1, obstacle_map: {name: image, path: map.png}")
    result = irsim.export_run(recorded(text, 2), to="openscenario", objects="all")
    assert len(list(ET.parse(result.file).getroot().iter("ScenarioObject"))) == 3
    assert "the map was left out: OpenSCENARIO has no grids" in result.notes


WALKS = """
world: {width: 20, height: 20, step_time: 0.1}
robot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [18, 1]}
obstacle:
  - {name: walker, kinematics: {name: omni_angular}, behavior: {name: replay, vanish: false, times: [0, 2, 4, 7, 9],
     poses: [[2, 3], [4, 3], [4, 5], [4, 5], [6, 6]]}}
  - {name: late one, kinematics: {name: omni_angular},
     behavior: {name: replay, times: [1.5, 9], poses: [[9, 9], [9, 2]]}}
  - {name: stands, kinematics: {name: omni_angular},
     behavior: {name: replay, times: [0, 10], poses: [[12, 5], [12, 5]]}}
  - {name: crate, state: [15, 15, 0]}
"""


@pytest.fixture
def walks() -> Run:
    return recorded(WALKS, 90)


def lines_of(run: Run, **options) -> list[str]:
    result = export_run(run, Path("people.txt"), to="isaac_people", overwrite=True, **options)
    assert result.format == "isaac_people"
    return Path("people.txt").read_text().splitlines()


def test_commands(walks: Run) -> None:
    assert lines_of(walks) == [
        "Spawn walker 2 3 0 0",
        "Spawn late_one 9 9 0 -90",
        "Spawn stands 12 5 0 0",
        "walker GoTo 4 3 0 4 5 0 _",
        "walker Idle 3.1",
        "walker GoTo 6 6 0 _",
        "late_one Idle 1.5",
        "late_one GoTo 9 2 0 _",
        "stands Idle 9",
    ]


def test_notes_and_options(walks: Run) -> None:
    result = export_run(walks, Path("some.txt"), to="isaac_people")
    assert result.objects == ["walker", "late one", "stands"]
    assert [note.split(":")[0] for note in result.notes[-2:]] == [
        "not in the world at the start, so standing where they appear before",
        "named with letters, digits and underscores only",
    ]
    lines = lines_of(walks, objects=["walker"], options={"z": 1.25, "pause": 5})
    assert lines == ["Spawn walker 2 3 1.25 0", "walker GoTo 4 3 1.25 4 5 1.25 6 6 1.25 _"]
    assert lines_of(walks, objects="robots")[0].startswith("Spawn robot_0 1 1 0 ")
    with pytest.raises(ArgumentError, match=r"isaac_people: 'pause' must be > 0 \[s\], got 0"):
        lines_of(walks, options={"pause": 0})


@pytest.mark.parametrize("tolerance", [0.02, 0.3])
def test_the_ways_are_those_of_the_run(tolerance: float) -> None:
    scene = """
    world: {width: 20, height: 20}
    robot: {kinematics: {name: omni}, state: [3, 10, 0], goal: [17, 10.5], behavior: {name: dash}}
    obstacle:
      - {number: 4, kinematics: {name: omni}, distribution: {name: circle_crossing, radius: 6}, behavior: {name: rvo}}
    """
    run = recorded(scene, 150, seed=3)
    lines = lines_of(run, options={"tolerance": tolerance})
    trace = run.trace()
    for name in ("obstacle_1", "obstacle_2", "obstacle_3", "obstacle_4"):
        start = next(line.split()[2:4] for line in lines if line.startswith(f"Spawn {name} "))
        ways = [line.split()[2:-1] for line in lines if line.startswith(f"{name} GoTo")]
        points = np.array([[float(value) for value in start]])
        for way in ways:
            points = np.concatenate([points, np.array(way, float).reshape(-1, 3)[:, :2]])
        driven = trace.pose[:, run.names.index(name), :2]
        path = shapely.LineString(points)
        assert max(path.distance(shapely.Point(place)) for place in driven) <= 2 * tolerance + 1e-3
        assert math.dist(points[-1], driven[-1]) <= tolerance + 1e-3
        assert len(points) < len(driven) / 3
