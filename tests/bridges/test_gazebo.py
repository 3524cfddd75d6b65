"""Recorded runs as worlds of Gazebo and models of MuJoCo, without either, and how MuJoCo's robots are driven."""

from __future__ import annotations

import math
import re
import shlex
import time
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import shapely
from typer.testing import CliRunner

import irsim
from irsim.bridges.base import BridgeError
from irsim.bridges.mujoco.mjcf import choose_agents, write_mjcf
from irsim.bridges.mujoco.rays import LidarComparison
from irsim.bridges.mujoco.robots import Driver, rig_of, steering_of
from irsim.bridges.sdf import SdfWorld, prism
from irsim.cli.app import app
from irsim.components.bridges.mujoco import Mujoco
from irsim.runs import Run, RunError
from irsim.simulation.scene import Grid, SceneDescription
from tests.bridges.scenes import gallery, motion_of, recorded, state_of

TRAFFIC = """\
world: {width: 12, height: 8, collision_mode: unobstructed, boundary: walls}
robot:
  - {name: rover, kinematics: {name: diff}, state: [1, 1, 0], goal: [5, 1, 0], behavior: {name: dash},
     sensors: [{name: lidar2d, number: 5, range_max: 3}]}
obstacle:
  - {name: walker, kinematics: {name: omni}, state: [6, 6, 0], goal: [9, 2, 0], behavior: {name: dash}}
  - {name: waiting, kinematics: {name: omni}, state: [2, 6, 0]}
  - {name: crate, shape: {name: polygon, vertices: [[0, 0], [2, 0], [2, 2], [1, 0.5], [0, 2]]}, state: [4, 5, 0]}
"""


@pytest.fixture
def traffic() -> Run:
    return recorded(TRAFFIC, 25, seed=3)


def test_a_run_becomes_a_world_with_actors_on_the_recorded_paths(traffic: Run) -> None:
    done = CliRunner().invoke(app, ["export", "--to", "sdf", "-o", "town"])
    assert done.exit_code == 0, done.output
    assert "cmd_vel" in done.output
    world = ET.parse("town/world.sdf").getroot().find("world")
    assert world is not None
    assert [actor.get("name") for actor in world.findall("actor")] == ["walker"]
    waypoints = world.findall("actor/script/trajectory/waypoint")
    where = np.array([(point.findtext("pose") or "").split() for point in waypoints], dtype=float)
    trace = traffic.trace()
    np.testing.assert_allclose(where[:, [0, 1, 5]], trace.pose[:, traffic.index_of("walker")], atol=1e-9)
    np.testing.assert_allclose([float(point.findtext("time") or "nan") for point in waypoints], trace.time)
    names = [model.get("name") for model in world.findall("model")]
    assert sorted(str(name) for name in names) == ["boundary", "crate", "ground", "rover", "waiting"]
    rover = world.find("model[@name='rover']")
    assert rover is not None
    assert rover.findtext("static") == "false"
    assert rover.findtext("link/sensor/lidar/scan/horizontal/samples") == "5"


def test_noise_is_written_and_who_never_came_is_left_out() -> None:
    run = recorded(
        """\
world: {width: 12, height: 8}
robot:
  - {name: rover, kinematics: {name: diff}, state: [1, 1, 0], goal: [5, 1, 0], behavior: {name: dash},
     sensors: [{name: lidar2d, number: 5, noise: true, std: 0.05}, {name: lidar2d, number: 5}]}
obstacle:
  - {name: never, kinematics: {name: omni}, state: [8, 3, 0], goal: [8, 1, 0], behavior: {name: dash}, appear_time: 50}
""",
        5,
        seed=1,
    )
    exported = irsim.export_run(run, "world", to="sdf")
    assert any("never in the world: never" in note for note in exported.notes)
    world = ET.parse("world/world.sdf").getroot()
    assert not world.findall(".//*[@name='never']")
    noises = [lidar.find("noise") for lidar in world.iter("lidar")]
    assert noises[1] is None
    assert [noises[0].findtext(tag) for tag in ("type", "mean", "stddev")] == ["gaussian", "0", "0.05"]


def test_every_mesh_of_a_world_is_a_file_and_every_file_is_a_closed_prism(traffic: Run) -> None:
    irsim.export_run(traffic, "town", to="sdf")
    named = {uri.text for uri in ET.parse("town/world.sdf").getroot().iter("uri")}
    files = {f"meshes/{path.name}" for path in Path("town/meshes").iterdir()}
    assert named == files
    area = 0.0
    for file in files:
        lines = [line.split() for line in Path("town", file).read_text().splitlines()]
        points = np.array([line[1:] for line in lines if line[0] == "v"], dtype=float)
        faces = np.array([line[1:] for line in lines if line[0] == "f"], dtype=int) - 1
        edges = [(int(face[k]), int(face[(k + 1) % 3])) for face in faces for k in range(3)]
        assert len(set(edges)) == len(edges)
        assert {(b, a) for a, b in edges} == set(edges)  # each edge has one face on either side
        a, b, c = (points[faces[:, k]] for k in range(3))
        area += float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)  # the volume, as the height is 1 m
    assert area == pytest.approx(shapely.Polygon([[0, 0], [2, 0], [2, 2], [1, 0.5], [0, 2]]).area)


def test_a_run_becomes_a_model_of_mujoco(traffic: Run) -> None:
    result = irsim.export_run(traffic, "scene.xml", to="mjcf")
    assert result.format == "mjcf"
    model = ET.parse("scene.xml").getroot()
    assert {body.get("name") for body in model.findall("worldbody/body")} >= {"rover", "walker", "waiting", "crate"}
    assert any("mocap" in note for note in result.notes)
    again = irsim.export_run(traffic, "again.xml", to="mjcf")
    assert Path(again.file).read_bytes() == Path("scene.xml").read_bytes()


def test_names_of_a_world_are_unique_and_legal() -> None:
    scene = gallery()
    odd = ("a::b", "a b", "a/b", "__root__", "world", "ground", "???", "map", "ü")
    scene = replace(scene, agents=tuple(replace(one, name=n) for one, n in zip(scene.agents, odd, strict=True)))
    world = ET.fromstring(SdfWorld(scene, {}).write()).find("world")
    assert world is not None
    names = [str(model.get("name")) for model in world.findall("model")]
    assert len(set(names)) == len(names) == len(odd) + 3
    assert not [name for name in names if "::" in name or " " in name or name.startswith("__") or name == "world"]


def test_a_prism_stands_between_its_heights() -> None:
    text = prism(np.array([[0, 0], [1, 0], [0, 1]], dtype=float), 0.25, 1.5)
    heights = {line.split()[3] for line in text.splitlines() if line.startswith("v")}
    assert heights == {"0.25", "1.5"}
    assert text.count("\nf ") == 2 + 6


def test_what_the_page_says_works() -> None:
    page = Path(__file__).resolve().parents[2] / "skills/irsim-runner/bridges/gazebo.md"
    [block] = re.findall(r"```bash\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    Path("hall.yaml").write_text(TRAFFIC, encoding="utf-8")
    for command in block.splitlines():
        done = CliRunner().invoke(app, shlex.split(command)[1:])
        assert done.exit_code == 0, (command, done.output)
    assert Path("hall-gazebo/world.sdf").stat().st_size > 5000


@pytest.mark.parametrize("to", ["mjcf", "sdf"])
def test_a_world_without_anything_that_moves_is_a_scene_as_well(to: str) -> None:
    crate = "obstacle: [{name: crate, shape: {name: circle, radius: 0.5}, state: [4, 4]}]"
    for text, models in (("", 0), (crate, 1)):
        run = recorded(f"world: {{width: 9, height: 9}}\n{text}", 2)
        result = irsim.export_run(run, to=to, out=f"{to}{models}.{'xml' if to == 'mjcf' else 'd'}")
        file = Path(result.file)
        assert (file if file.is_file() else file / "world.sdf").read_text().count('name="crate"') == models
    with pytest.raises(RunError, match="has no objects"):
        irsim.export_run(recorded("world: {width: 9}", 1), to="csv", objects="all")


def test_maps_of_many_parts_become_a_world_in_seconds() -> None:
    board = np.indices((160, 160)).sum(axis=0) % 2 == 0
    scene = replace(gallery(), grid=Grid(board, (0.1, 0.1), (0.0, 0.0)))
    start = time.process_time()
    text = SdfWorld(scene, {}).write()
    assert time.process_time() - start < 6, "it is about 1 s; it grew with the square of the number of parts"
    names = re.findall(r'<collision name="(collision_\d+)"', text[text.index('<model name="map"') :])
    assert names[:12_800] == [f"collision_{number}" for number in range(12_800)]


def mujoco_model(scene: SceneDescription, agents: frozenset[str] | None = None, **options: Any) -> ET.Element:
    return ET.fromstring(write_mjcf(scene, choose_agents(scene, None) if agents is None else agents, Mujoco(**options)))


@pytest.fixture(scope="module")
def model() -> ET.Element:
    return mujoco_model(gallery())


def body(model: ET.Element, name: str) -> ET.Element:
    element = model.find(f"worldbody/body[@name='{name}']")
    assert element is not None
    return element


def test_robots_and_what_can_be_pushed_are_moved_by_mujoco() -> None:
    scene = gallery()
    assert choose_agents(scene, None) == {"rover", "slider", "turner", "car", "box"}
    assert choose_agents(scene, []) == frozenset()
    with pytest.raises(BridgeError, match="no object 'rovr'") as caught:
        choose_agents(scene, ["rovr"])
    assert "rover" in str(caught.value)
    with pytest.raises(BridgeError, match="cannot move block, whose drive is 'none'"):
        choose_agents(scene, ["block"])


def test_each_drive_has_its_joints_and_actuators(model: ET.Element) -> None:
    rover, slider, car = body(model, "rover"), body(model, "slider"), body(model, "car")
    assert rover.find("freejoint") is not None
    assert [wheel.get("name") for wheel in rover.findall("body")] == ["rover/left", "rover/right"]
    assert [geom.get("class") for geom in rover.findall("geom")].count("caster") == 2
    assert [joint.get("type") for joint in slider.findall("joint")] == ["slide", "slide"]
    assert [joint.get("type") for joint in body(model, "turner").findall("joint")] == ["slide", "slide", "hinge"]
    steered = [part.get("name") for part in car.findall("body")]
    assert steered == ["car/left", "car/steer_left", "car/right", "car/steer_right"]
    driven = [actuator.get("joint") for actuator in model.findall("actuator/velocity")]
    assert [joint for joint in driven if joint and joint.startswith("car")] == ["car/left", "car/right"]
    assert not [joint for joint in driven if joint and joint.startswith("box")]


def test_casters_have_no_friction_and_wheels_that_of_the_option(model: ET.Element) -> None:
    kinds = {one.get("class"): one.find("geom") for one in model.findall("default/default")}
    caster, wheel = kinds["caster"], kinds["wheel"]
    assert caster is not None
    assert wheel is not None
    assert (caster.get("condim"), caster.get("priority"), wheel.get("priority")) == ("1", "1", "1")
    icy = mujoco_model(gallery(), friction=0.1)
    grips = {geom.get("friction") for geom in icy.iter("geom") if geom.get("class") == "wheel"}
    assert grips == {"0.1 0.005 0.0001"}


def test_what_stands_in_the_world_has_its_geometry(model: ET.Element) -> None:
    assert len(body(model, "irsim/map").findall("geom")) == 2
    assert len(body(model, "irsim/walls").findall("geom")) == 4
    assert [geom.get("type") for geom in body(model, "block").findall("geom")] == ["mesh"] * 3, "convex parts"
    fence = body(model, "fence").findall("geom")
    assert [geom.get("group") for geom in fence] == ["1", "1", "4", "4"]
    assert float((fence[2].get("size") or "").split()[1]) < 1e-4, "thin for lidars"
    [zone] = body(model, "zone").findall("geom")
    contacts = (zone.get("contype"), zone.get("conaffinity"), zone.get("group"))
    assert contacts == ("0", "0", "1"), "what is only drawn touches nothing and is not seen"


def test_what_irsim_moves_is_a_mocap_body_and_the_rest_is_fixed(model: ET.Element) -> None:
    mocap = {one.get("name") for one in model.iter("body") if one.get("mocap") == "true"}
    assert mocap == {"person"}
    watched = mujoco_model(gallery(), frozenset())
    mocap = {one.get("name") for one in watched.iter("body") if one.get("mocap") == "true"}
    assert mocap == {"person", "rover", "slider", "turner", "car", "box"}


def test_names_are_written_as_they_are_and_numbers_as_numbers() -> None:
    scene, odd = gallery(), ("world", 'a<b"&', "ü", "rover/left", "a\nb\x00")
    named = [replace(one, name=name) for one, name in zip(scene.agents, odd, strict=False)]
    model = mujoco_model(replace(scene, agents=(*named, *scene.agents[5:])))
    names = {one.get("name") for one in model.iter("body")}
    assert {"irsim/object_0", 'a<b"&', "ü", "irsim/object_3", "irsim/object_4"} <= names
    for geom in model.iter("geom"):
        for key in ("pos", "size", "euler"):
            assert np.isfinite([float(word) for word in (geom.get(key) or "0").split()]).all()


def test_a_map_of_too_many_boxes_is_refused() -> None:
    occupied = np.indices((700, 700)).sum(axis=0) % 2 == 0
    scene = replace(gallery(), grid=Grid(occupied, (0.1, 0.1), (0.0, 0.0)))
    with pytest.raises(BridgeError, match="245,000 boxes"):
        write_mjcf(scene, frozenset(), Mujoco())


NAMES = ("rover", "slider", "turner", "car")


def driver(**options: float) -> Driver:
    scene = gallery()
    rigs = tuple(rig_of(scene.agent(name)) for name in NAMES)
    return Driver(NAMES, (0, 1, 2, 3), rigs, Mujoco(**options), np.random.default_rng(0))  # type: ignore[arg-type]


def test_targets_of_each_drive() -> None:
    drive, scene = driver(), gallery()
    wanted = {"rover": (0.8, 0.5), "slider": (0.3, -0.2), "turner": (0.1, 0.2, 0.3), "car": (1.0, 0.4)}
    drive.command(motion_of(scene, state_of(scene), **wanted))
    targets = drive.targets(0.0)
    rig, car = drive.rigs[0], drive.rigs[3]
    assert targets[0] == pytest.approx((0.8 - 0.5 * rig.half_track) / rig.wheel_radius)
    assert targets[1] == pytest.approx((0.8 + 0.5 * rig.half_track) / rig.wheel_radius)
    assert targets[2:7] == pytest.approx([0.3, -0.2, 0.1, 0.2, 0.3])
    rate = math.tan(0.4) / 3
    assert targets[7:9] * car.wheel_radius == pytest.approx([1 - rate * car.half_track, 1 + rate * car.half_track])
    assert targets[9:] == pytest.approx(steering_of(car, 0.4))


def test_the_inner_wheel_of_a_car_turns_more_and_both_point_at_one_center() -> None:
    rig = rig_of(gallery().agent("car"))
    for angle in (0.2, -0.7, 1.2):
        left, right = steering_of(rig, angle)
        assert (abs(left) > abs(right)) == (angle > 0)
        center = 3.0 / math.tan(angle)
        assert math.tan(left) * (center - rig.half_track) == pytest.approx(3.0)
        assert math.tan(right) * (center + rig.half_track) == pytest.approx(3.0)
    assert steering_of(rig, 0.0) == (0.0, 0.0)


def test_a_car_keeps_its_steering_while_it_stands() -> None:
    drive, scene = driver(), gallery()
    drive.command(motion_of(scene, state_of(scene), car=(1.0, 0.4)))
    turned = drive.targets(0.0)[-2:].copy()
    drive.command(motion_of(scene, state_of(scene, step=1), car=(0.0, 0.4)))
    assert drive.targets(0.1)[-2:] == pytest.approx(turned)


def test_commands_arrive_after_the_latency() -> None:
    drive, scene = driver(latency=0.25), gallery()
    for step in range(4):
        drive.command(motion_of(scene, state_of(scene, step=step), slider=(0.1 * (step + 1), 0.0)))
    speeds = [float(drive.targets(time)[2]) for time in (0.0, 0.24, 0.25, 0.34, 0.35, 0.55)]
    assert speeds == pytest.approx([0.0, 0.0, 0.1, 0.1, 0.2, 0.4])
    drive.forget()
    assert not drive.targets(9.0).any()


def test_slip_takes_a_share_of_the_speed_of_each_wheel() -> None:
    drive, scene = driver(slip=0.4), gallery()
    shares = []
    for step in range(200):
        drive.command(motion_of(scene, state_of(scene, step=step), rover=(1.0, 0.0)))
        shares.append(drive.targets(step * 0.1)[:2] * drive.rigs[0].wheel_radius)
    ratios = np.array(shares)
    assert ((ratios >= 0.6) & (ratios <= 1)).all()
    assert ratios.mean() == pytest.approx(0.8, abs=0.02)
    assert abs(np.corrcoef(ratios.T)[0, 1]) < 0.2


def test_comparison_of_lidars_counts_what_only_one_has_hit() -> None:
    comparison = LidarComparison()
    ours = {"a/0": np.array([1.0, 2.0, np.inf, np.inf], dtype=np.float32), "b/0": np.ones(3, dtype=np.float32)}
    theirs = {"a/0": np.array([1.004, 2.0, 3.0, np.inf], dtype=np.float32)}
    comparison.add(ours, theirs)
    assert (comparison.beams, comparison.one_sided) == (2, 1)
    assert comparison.largest == pytest.approx(0.004, rel=1e-3)
    assert comparison.quantile(0.5) == 0.0
    assert comparison.quantile(1.0) == pytest.approx(0.004, rel=1e-3)


def test_without_mujoco_the_error_names_the_command(monkeypatch: pytest.MonkeyPatch) -> None:
    from irsim.bridges.mujoco.bridge import make
    from irsim.common import extras

    monkeypatch.setattr(extras, "find_spec", lambda name: None)
    with pytest.raises(extras.ExtraError, match=r"pip install 'irsim-mcp\[mujoco\]'"):
        make(Mujoco())
