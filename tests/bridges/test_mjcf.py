"""Scenes as models of MuJoCo, written without MuJoCo."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from irsim.bridges.base import BridgeError
from irsim.bridges.mujoco.mjcf import choose_agents, write_mjcf
from irsim.components.bridges.mujoco import Mujoco
from irsim.simulation.scene import Grid
from tests.bridges.scenes import gallery


@pytest.fixture(scope="module")
def model() -> ET.Element:
    scene = gallery()
    return ET.fromstring(write_mjcf(scene, choose_agents(scene, None), Mujoco()))


def body(model: ET.Element, name: str) -> ET.Element:
    found = model.find(f"worldbody/body[@name='{name}']")
    assert found is not None
    return found


def test_robots_and_what_can_be_pushed_are_moved_by_mujoco() -> None:
    scene = gallery()
    assert choose_agents(scene, None) == {"rover", "slider", "turner", "car", "box"}
    assert choose_agents(scene, []) == frozenset()
    with pytest.raises(BridgeError, match="no object 'rovr'") as caught:
        choose_agents(scene, ["rovr"])
    assert "rover" in str(caught.value)
    with pytest.raises(BridgeError, match="cannot move block, whose drive is none"):
        choose_agents(scene, ["block"])


def test_each_drive_has_its_joints_and_actuators(model: ET.Element) -> None:
    rover, slider, car = body(model, "rover"), body(model, "slider"), body(model, "car")
    assert rover.find("freejoint") is not None
    assert [wheel.get("name") for wheel in rover.findall("body")] == ["rover/left", "rover/right"]
    casters = [geom for geom in rover.findall("geom") if geom.get("class") == "caster"]
    assert len(casters) == 2
    assert [joint.get("type") for joint in slider.findall("joint")] == ["slide", "slide"]
    assert [joint.get("type") for joint in body(model, "turner").findall("joint")] == ["slide", "slide", "hinge"]
    steered = [part.get("name") for part in car.findall("body")]
    assert steered == ["car/left", "car/steer_left", "car/right", "car/steer_right"]
    driven = [actuator.get("joint") for actuator in model.findall("actuator/velocity")]
    assert [joint for joint in driven if joint and joint.startswith("car")] == ["car/left", "car/right"]
    assert not [joint for joint in driven if joint and joint.startswith("box")]


def test_casters_have_no_friction_and_wheels_that_of_the_option(model: ET.Element) -> None:
    caster = model.find("default/default[@class='caster']/geom")
    wheel = model.find("default/default[@class='wheel']/geom")
    assert caster is not None
    assert wheel is not None
    assert (caster.get("condim"), caster.get("priority")) == ("1", "1")
    assert wheel.get("priority") == "1"
    scene = gallery()
    icy = ET.fromstring(write_mjcf(scene, choose_agents(scene, None), Mujoco(friction=0.1)))
    grips = {geom.get("friction") for geom in icy.iter("geom") if geom.get("class") == "wheel"}
    assert grips == {"0.1 0.005 0.0001"}


def test_concave_polygons_become_prisms_and_lines_are_thin_for_lidars(model: ET.Element) -> None:
    assert [geom.get("type") for geom in body(model, "block").findall("geom")] == ["mesh"] * 3
    fence = body(model, "fence").findall("geom")
    assert [geom.get("group") for geom in fence] == ["1", "1", "4", "4"]
    assert float((fence[2].get("size") or "").split()[1]) < 1e-4


def test_what_irsim_moves_is_a_mocap_body_and_the_rest_is_fixed(model: ET.Element) -> None:
    mocap = {one.get("name") for one in model.iter("body") if one.get("mocap") == "true"}
    assert mocap == {"person"}
    scene = gallery()
    watched = ET.fromstring(write_mjcf(scene, frozenset(), Mujoco()))
    mocap = {one.get("name") for one in watched.iter("body") if one.get("mocap") == "true"}
    assert mocap == {"person", "rover", "slider", "turner", "car", "box"}


def test_what_is_only_drawn_touches_nothing_and_is_not_seen(model: ET.Element) -> None:
    [zone] = body(model, "zone").findall("geom")
    assert (zone.get("contype"), zone.get("conaffinity"), zone.get("group")) == ("0", "0", "1")


def test_map_and_walls_are_boxes(model: ET.Element) -> None:
    assert len(body(model, "irsim/map").findall("geom")) == 2
    assert len(body(model, "irsim/walls").findall("geom")) == 4


def test_names_are_written_as_they_are_and_numbers_as_numbers() -> None:
    scene = gallery()
    odd = tuple(
        replace(one, name=name)
        for one, name in zip(scene.agents, ("world", 'a<b"&', "ü", "rover/left", "a\nb\x00"), strict=False)
    )
    scene = replace(scene, agents=(*odd, *scene.agents[5:]))
    model = ET.fromstring(write_mjcf(scene, choose_agents(scene, None), Mujoco()))
    assert {"irsim/object_0", 'a<b"&', "ü", "irsim/object_3", "irsim/object_4"} <= {
        one.get("name") for one in model.iter("body")
    }
    for geom in model.iter("geom"):
        for key in ("pos", "size", "euler"):
            assert np.isfinite([float(word) for word in (geom.get(key) or "0").split()]).all()


def test_a_map_of_too_many_boxes_is_refused() -> None:
    occupied = np.indices((700, 700)).sum(axis=0) % 2 == 0
    scene = replace(gallery(), grid=Grid(occupied, (0.1, 0.1), (0.0, 0.0)))
    with pytest.raises(BridgeError, match="245,000 boxes"):
        write_mjcf(scene, frozenset(), Mujoco())
