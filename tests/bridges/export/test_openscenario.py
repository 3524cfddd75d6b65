"""``openscenario``: well-formed files of any run, without the tools that read them."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import irsim
from irsim.bridges.export.formats import openscenario
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


def test_only_some_objects(run: Run) -> None:
    irsim.export_run(run, "some.xosc", objects=["walker"])
    root = ET.parse("some.xosc").getroot()
    assert [one.get("name") for one in root.iter("ScenarioObject")] == ["walker"]


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
