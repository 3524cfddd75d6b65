"""Recorded runs as OpenSCENARIO, for its schema and an independent reader, and as CommonRoad, for its library."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.bridges.export.export import export_run
from irsim.bridges.recorded import recorded_scene, recorded_states
from irsim.runs import Run
from tests.bridges.scenes import record_stage, recorded

pytestmark = pytest.mark.interop
SCENE = """
world: {width: 20, height: 20, step_time: 0.1, collision_mode: unobstructed}
robot:
  - {name: car & <co> "1", kinematics: {name: acker}, shape: {name: rectangle, length: 3, width: 1.5, wheelbase: 2},
     state: [3, 3, 2.9], goal: [4, 15], vel_max: [3, 0.6], vel_min: [-3, -0.6], behavior: {name: dash}}
obstacle:
  - {name: walker, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, state: [10, 5, 0], goal: [16, 5],
     behavior: {name: dash}}
  - {name: crate, shape: {name: rectangle, length: 1, width: 2}, state: [14, 14, 0.3]}
"""


@pytest.fixture
def run() -> Run:
    return recorded(SCENE, 50)


def _schema(number: str) -> Any:
    spec = find_spec("schemas")
    if spec is None or not spec.submodule_search_locations:
        pytest.skip("scenariogeneration is not installed")
    from lxml import etree

    file = Path(next(iter(spec.submodule_search_locations))) / f"OpenSCENARIO_{number}.xsd"
    return etree.XMLSchema(etree.parse(file))


@pytest.mark.parametrize("objects", ["movers", "all", ["crate"]])
def test_files_fit_the_schema_of_asam(run: Run, objects: Any) -> None:
    from lxml import etree

    schema = _schema("1_0")
    irsim.export_run(run, "run.xosc", objects=objects, options={"roads": "Town03"} if objects == "all" else {})
    schema.assertValid(etree.parse("run.xosc"))


def test_the_schema_refuses_a_broken_file(run: Run) -> None:
    from lxml import etree

    irsim.export_run(run, "run.xosc")
    text = Path("run.xosc").read_text()
    assert 'followingMode="position"' in text
    assert not _schema("1_0").validate(etree.fromstring(text.replace('"position"', '"jump"').encode()))


def test_scenariogeneration_reads_the_trajectories(run: Run) -> None:
    xosc = pytest.importorskip("scenariogeneration.xosc")
    result = irsim.export_run(run, "run.xosc", objects="all")
    assert any("no roads are named" in note for note in result.notes)
    tree = ET.parse("run.xosc").getroot()
    read = xosc.Scenario.parse(tree)
    entities = {entity.name: entity.entityobject for entity in read.entities.scenario_objects}
    assert {name: type(one).__name__ for name, one in entities.items()} == {
        'car & <co> "1"': "Vehicle", "walker": "Pedestrian", "crate": "MiscObject",
    }  # fmt: skip
    car = entities['car & <co> "1"']
    assert (car.boundingbox.boundingbox.length, car.boundingbox.center.x) == pytest.approx((3, 1))  # from the rear axle
    trace = run.trace()
    (act,) = read.storyboard.stories[0].acts
    groups = {group.actors.actors[0].entity: group for group in act.maneuvergroup}
    assert set(groups) == {'car & <co> "1"', "walker"}
    for column, name in enumerate(['car & <co> "1"', "walker"]):
        (event,) = groups[name].maneuvers[0].events
        line = event.action[0].action.trajectory.shapes
        read_pose = np.array([[p.x, p.y, p.h] for p in line.positions])
        np.testing.assert_allclose(line.time, trace.time, atol=1e-6)
        np.testing.assert_allclose(read_pose[:, :2], trace.pose[:, column, :2], atol=1e-5)
        turn = np.remainder(read_pose[:, 2] - trace.pose[:, column, 2] + math.pi, 2 * math.pi) - math.pi
        np.testing.assert_allclose(turn, 0, atol=1e-5)
        assert np.abs(np.diff(read_pose[:, 2])).max() < 0.5  # no jump at half a turn
    assert len(trace.time) == 51


@pytest.fixture(scope="module")
def shapes(tmp_path_factory):
    pytest.importorskip("commonroad")
    return record_stage(tmp_path_factory.mktemp("commonroad"))


def test_commonroad_reads_what_was_simulated(shapes, tmp_path) -> None:
    from commonroad.common.file_reader import CommonRoadFileReader

    target = tmp_path / "run.xml"
    result = export_run(shapes, target, to="commonroad")
    assert "the map was left out" in " ".join(result.notes)
    scenario, problems = CommonRoadFileReader(str(target)).open()
    assert scenario.dt == 0.1
    scene, states = recorded_scene(shapes), list(recorded_states(shapes))
    kinds = {item.obstacle_type.value for item in scenario.dynamic_obstacles}
    assert kinds == {"unknown", "pedestrian"}
    [walker] = [item for item in scenario.dynamic_obstacles if item.obstacle_type.value == "pedestrian"]
    assert (walker.initial_state.time_step, walker.prediction.trajectory.final_state.time_step) == (4, 40)
    robots = [item for item in scenario.dynamic_obstacles if item.obstacle_type.value == "unknown"]
    for item, index in zip([walker, *robots], [5, 0, 1], strict=True):
        for state in states:
            x, y, yaw = state.pose[index]
            read = item.state_at_time(state.step)
            assert (read is None) == math.isnan(x)
            if read is not None:
                np.testing.assert_allclose(read.position, [x, y], atol=2e-9)
                assert math.remainder(read.orientation - yaw, math.tau) == pytest.approx(0, abs=2e-9)
    assert walker.prediction.trajectory.state_at_time_step(12).velocity == pytest.approx(2.5, abs=1e-6)
    assert {problem.initial_state.position[0] for problem in problems.planning_problem_dict.values()} == {1.0, 2.0}
    assert scene.agent("walker").moves


def test_static_bodies_are_where_they_were(shapes, tmp_path) -> None:
    from commonroad.common.file_reader import CommonRoadFileReader

    export_run(shapes, tmp_path / "run.xml", to="commonroad")
    scenario, _ = CommonRoadFileReader(str(tmp_path / "run.xml")).open()
    placed = [item.occupancy_at_time(0).shapely_object for item in scenario.static_obstacles]
    u_shape = 1.5 * 1.5 - 0.5
    assert len(placed) == 1 + 2 + 1 + 4, "a U, two legs of a wall, a disc, four walls around the world"
    [disc] = [item for item in scenario.static_obstacles if hasattr(item.obstacle_shape, "radius")]
    assert disc.obstacle_shape.radius == pytest.approx(0.3)
    np.testing.assert_allclose(disc.initial_state.position, [4.1, 7.0], atol=2e-9)
    [concave] = [shape for shape in placed if shape.area == pytest.approx(u_shape, abs=2e-3)]
    assert concave.bounds[:2] == pytest.approx((6 - 1.5 * math.sin(0.3), 6.0), abs=1e-6)
