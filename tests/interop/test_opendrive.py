"""Roads written by scenariogeneration, and by hand, as CARLA's own parser and we see them."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from irsim.bridges.maps import import_map
from irsim.scenario.read import read

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("opendrive")]
carla = pytest.importorskip("carla")
CELL = 0.25
BY_HAND = """<?xml version="1.0"?><OpenDRIVE><header revMajor="1" revMinor="4" name="" version="1" north="0" south="0"
east="0" west="0"/><road name="" length="90" id="1" junction="-1"><link/><planView>
<geometry s="0" x="-20" y="7" hdg="0.4" length="20"><line/></geometry>
<geometry s="20" x="-1.5787801" y="14.7883668" hdg="0.4" length="30"><arc curvature="-0.03"/></geometry>
<geometry s="50" x="{x}" y="{y}" hdg="-0.5" length="40"><paramPoly3 aU="0" bU="1" cU="0" dU="-0.00002" aV="0" bV="0"
cV="0.004" dV="0.00005" pRange="arcLength"/></geometry></planView>
<elevationProfile><elevation s="0" a="0" b="0" c="0" d="0"/></elevationProfile><lateralProfile/>
<lanes><laneOffset s="0" a="0.8" b="0.01" c="0" d="0"/>
<laneSection s="0"><left><lane id="1" type="driving" level="false"><link/>
<width sOffset="0" a="3" b="0.02" c="0" d="0"/></lane>
<lane id="2" type="sidewalk" level="false"><link/><width sOffset="0" a="2" b="0" c="0" d="0"/></lane></left>
<center><lane id="0" type="none" level="false"/></center>
<right><lane id="-1" type="driving" level="false"><link/><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane>
<lane id="-2" type="shoulder" level="false"><link/><width sOffset="0" a="1" b="0" c="0" d="0"/></lane></right>
</laneSection></lanes></road></OpenDRIVE>"""


def by_hand(folder: Path) -> Path:
    turn = 0.4 - 0.03 * 30
    x = -1.5787801 + (math.sin(turn) - math.sin(0.4)) / -0.03
    y = 14.7883668 - (math.cos(turn) - math.cos(0.4)) / -0.03
    file = folder / "hand.xodr"
    file.write_text(BY_HAND.format(x=x, y=y))
    return file


def generated(folder: Path) -> Path:
    xodr = pytest.importorskip("scenariogeneration").xodr
    curve = [xodr.Spiral(1e-9, 0.05, 20), xodr.Arc(0.05, length=30), xodr.Spiral(0.05, 1e-9, 20)]
    shapes = [[xodr.Line(40)], curve, [xodr.Line(30)]]
    roads = [
        xodr.create_road(shape, id=k, left_lanes=2, right_lanes=1, lane_width=3.5) for k, shape in enumerate(shapes, 1)
    ]
    network = xodr.OpenDrive("town")
    for one, other in pairwise(roads):
        one.add_successor(xodr.ElementType.road, other.id, xodr.ContactPoint.start)
        other.add_predecessor(xodr.ElementType.road, one.id, xodr.ContactPoint.end)
    for road in roads:
        network.add_road(road)
    network.adjust_roads_and_lanes()
    file = folder / "town.xodr"
    network.write_xml(str(file))
    return file


def theirs(file: Path, grid, kind) -> np.ndarray:
    """(nx, ny) whether the center of each cell is in a lane, as the client library of CARLA says, whose y is -y."""
    town = carla.Map("town", file.read_text())
    in_lane = np.zeros(grid.cells.occupied.shape, bool)
    for i, j in np.ndindex(in_lane.shape):
        x, y = grid.origin[0] + (i + 0.5) * CELL, grid.origin[1] + (j + 0.5) * CELL
        place = carla.Location(x=x, y=-y, z=0.0)
        in_lane[i, j] = town.get_waypoint(place, project_to_road=False, lane_type=kind) is not None
    return in_lane


@pytest.mark.parametrize(("write", "lanes", "kind"), [
    (generated, "drive", "Driving"), (by_hand, "drive", "Driving"), (by_hand, "walk", "Sidewalk"),
])  # fmt: skip
def test_lanes_as_carla_sees_them(tmp_path, write, lanes, kind, record_property) -> None:
    file = write(tmp_path)
    result = import_map(file, tmp_path / "town.yaml", resolution=CELL, lanes=lanes)
    grid = read(tmp_path / "town.yaml").scenario.grid
    ours, other = grid.cells.occupied == 0, theirs(file, grid, getattr(carla.LaneType, kind))
    iou = float((ours & other).sum() / (ours | other).sum())
    record_property("iou", iou)
    assert iou > 0.95, iou
    assert result.components[0] == pytest.approx(result.free_area)
