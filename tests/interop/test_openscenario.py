"""Recorded runs as OpenSCENARIO, against its schema and an independent reader."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.runs import Run
from tests.bridges.scenes import recorded

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
