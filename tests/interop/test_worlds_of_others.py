"""Worlds that libraries of other people write: what they occupy is what was built, as a map and as obstacles.

Three files for each of SDF (libsdformat), MJCF (MuJoCo and dm_control) and CommonRoad (commonroad-io).
"""

from __future__ import annotations

import math
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irsim.bridges.maps.kinds.commonroad import read
from irsim.bridges.maps.source import ImportLimits, ImportOptions
from tests.bridges.maps.occupied import assert_occupied
from tests.interop.conftest import with_libsdformat

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("worlds")]
ROOMS = 2 * 10 * 0.2 + 2 * 7.6 * 0.2 + 4 * 0.15


@pytest.fixture(scope="module")
def of_libsdformat(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with three worlds that libsdformat wrote."""
    folder = tmp_path_factory.mktemp("sdf")
    subprocess.run([with_libsdformat("write_sdf", folder), folder], check=True)
    return folder


@pytest.mark.parametrize(
    ("name", "area"),
    [
        ("rooms", ROOMS),
        ("round", math.pi * (0.25 + 0.36 + 0.5) + 3 * 0.8),
        ("nested", math.pi * 0.09 + 0.5 + 4),
    ],
)
def test_worlds_of_libsdformat(of_libsdformat: Path, name: str, area: float) -> None:
    assert_occupied(of_libsdformat / f"{name}.sdf", area)


def test_a_model_that_mujoco_specifies(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    spec = mujoco.MjSpec()
    box, cylinder, mesh = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CYLINDER, mujoco.mjtGeom.mjGEOM_MESH
    world = spec.worldbody
    world.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[20, 20, 0.1])
    for name, pos, size in (("s", (5, 0.1), (5, 0.1)), ("n", (5, 7.9), (5, 0.1)), ("e", (9.9, 4), (0.1, 3.8))):
        world.add_geom(name=name, type=box, pos=[*pos, 1], size=[*size, 1])
    table = world.add_body(name="table", pos=[3, 3, 0], quat=[math.cos(0.3), 0, 0, math.sin(0.3)])
    table.add_geom(type=box, pos=[0.5, 0, 0.7], size=[1, 0.5, 0.05])
    table.add_geom(type=cylinder, pos=[0.5, 0, 0.35], size=[0.1, 0.35, 0])
    world.add_geom(name="post", type=cylinder, pos=[7, 5, 0.5], size=[0.4, 0.5, 0])
    wedge = np.array([(0, 0, 0), (2, 0, 0), (0, 1, 0), (0, 0, 1), (2, 0, 1), (0, 1, 1)], dtype=np.float64)
    spec.add_mesh(name="wedge", uservert=wedge.ravel())
    world.add_geom(name="wedge", type=mesh, meshname="wedge", pos=[6, 2, 0.1])
    spec.compile()
    (tmp_path / "a.xml").write_text(spec.to_xml())
    assert_occupied(tmp_path / "a.xml", 2 * 2 + 7.6 * 0.2 + 2 + math.pi * 0.16 + 1)


def test_a_model_that_mujoco_saves(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    source = """<mujoco><default><geom type="box" size=".5 .3 .4"/><default class="pole">
      <geom type="capsule" size=".2"/></default></default><worldbody>
      <geom pos="1 1 .4" euler="0 0 30"/><geom class="pole" fromto="3 1 0 3 1 2"/>
      <body pos="5 1 0"><frame euler="0 0 45"><geom pos="0 1 .4"/></frame>
        <body pos="2 0 .5"><geom type="ellipsoid" size="1 .5 .4"/></body></body>
      <geom type="sphere" size=".6" pos="1 4 .6"/></worldbody></mujoco>"""
    mujoco.mj_saveLastXML(str(tmp_path / "a.xml"), mujoco.MjModel.from_xml_string(source))
    assert_occupied(tmp_path / "a.xml", 2 * 0.6 + math.pi * (0.04 + 0.5 + 0.36))


def test_a_model_of_dm_control(tmp_path: Path) -> None:
    mjcf = pytest.importorskip("dm_control.mjcf")
    room = mjcf.RootElement(model="room")
    room.default.geom.type = "box"
    for x, y, wide, high in ((5, 0.1, 5, 0.1), (5, 7.9, 5, 0.1), (0.1, 4, 0.1, 3.8), (9.9, 4, 0.1, 3.8)):
        room.worldbody.add("geom", pos=[x, y, 1], size=[wide, high, 1])
    for number, angle in enumerate((0.0, 0.5, 1.0)):
        chair = mjcf.RootElement(model=f"chair{number}")
        chair.worldbody.add("geom", type="box", pos=[0, 0, 0.5], size=[0.3, 0.25, 0.5])
        site = room.worldbody.add("site", pos=[2.5 * (number + 1), 3, 0], euler=[0, 0, math.degrees(angle)])
        site.attach(chair)
    (tmp_path / "a.xml").write_text(room.to_xml_string())
    assert_occupied(tmp_path / "a.xml", ROOMS - 0.6 + 3 * 0.3)


def scenario_of_commonroad(file: Path, shapes: list[tuple[Any, tuple[float, float], float]], *, road: bool) -> None:
    """Write static obstacles, and a road along x if asked for."""
    from commonroad.common.common_lanelet import LaneletType
    from commonroad.common.file_writer import CommonRoadFileWriter
    from commonroad.common.util import FileFormat
    from commonroad.common.writer.file_writer_interface import OverwriteExistingFile
    from commonroad.planning.planning_problem import PlanningProblemSet
    from commonroad.scenario.lanelet import Lanelet
    from commonroad.scenario.obstacle import ObstacleType, StaticObstacle
    from commonroad.scenario.scenario import Scenario, Tag
    from commonroad.scenario.state import InitialState

    scenario = Scenario(dt=0.1, tags={Tag.SIMULATED})
    for number, (shape, place, heading) in enumerate(shapes):
        state = InitialState(time_step=0, position=np.array(place, dtype=np.float64), orientation=heading, velocity=0.0,
                             acceleration=0.0, yaw_rate=0.0, slip_angle=0.0)  # fmt: skip
        scenario.add_objects(StaticObstacle(number + 1, ObstacleType.PILLAR, shape, state))
    if road:
        x = np.linspace(0.0, 40.0, 9)
        left, middle, right = (np.column_stack([x, np.full(9, y)]) for y in (6.0, 3.0, 0.0))
        scenario.add_objects(Lanelet(left, middle, right, 1000, lanelet_type={LaneletType.URBAN}))
    writer = CommonRoadFileWriter(scenario, PlanningProblemSet(), author="a", affiliation="b", source="c",
                                  tags={Tag.SIMULATED}, file_format=FileFormat.XML)  # fmt: skip
    writer.write_to_file(str(file), OverwriteExistingFile.ALWAYS)


def test_scenarios_of_commonroad_io(tmp_path: Path) -> None:
    pytest.importorskip("commonroad")
    from commonroad.geometry.obstacle_shapes.circle_obstacle_shape import CircleObstacleShape
    from commonroad.geometry.obstacle_shapes.polygon_obstacle_shape import PolygonObstacleShape
    from commonroad.geometry.obstacle_shapes.rect_obstacle_shape import RectObstacleShape
    from commonroad.geometry.obstacle_shapes.truck_shape import TruckShape

    car, disk = RectObstacleShape(width=1.8, length=4.5, origin_x_shift=-1.3), CircleObstacleShape(radius=1.5)
    corner = PolygonObstacleShape(np.array([(0, 0), (4, 0), (4, 1), (1, 1), (1, 3), (0, 3)], dtype=np.float64))
    cars = [(car, (6.0 * k, 2.0 * k), 0.4 * k) for k in range(4)]
    scenario_of_commonroad(tmp_path / "cars.xml", cars, road=False)
    assert_occupied(tmp_path / "cars.xml", 4 * 4.5 * 1.8)
    things = read(tmp_path / "cars.xml", ImportOptions(), ImportLimits()).things
    assert things[1].region.centroid.coords[0] == pytest.approx((6 + 1.3 * math.cos(0.4), 2 + 1.3 * math.sin(0.4)))
    scenario_of_commonroad(tmp_path / "shapes.xml", [(disk, (0, 0), 0.0), (corner, (5, 5), 0.7)], road=False)
    assert_occupied(tmp_path / "shapes.xml", math.pi * 2.25 + 6)
    truck = TruckShape.create_default()
    dims = truck.truck_dims
    scenario_of_commonroad(tmp_path / "road.xml", [(truck, (10, 2), 0.1), (disk, (30, 4), 0.0)], road=True)
    assert_occupied(tmp_path / "road.xml", dims.length * dims.width + math.pi * 2.25, unknown="free")
