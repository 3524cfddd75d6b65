"""Scenarios of CommonRoad: obstacles where they stand, lanelets as what is free, and wrong files."""

from __future__ import annotations

from pathlib import Path

import pytest
import shapely

from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map
from irsim.bridges.maps.kinds.commonroad import read
from irsim.bridges.maps.source import ImportLimits, ImportOptions

PLACE = """<initialState><position><point><x>{x}</x><y>{y}</y></point></position>
<orientation><exact>{turn}</exact></orientation></initialState>"""
BOX = "<rectangle><length>4</length><width>2</width></rectangle>"


def obstacle(shape: str, x: float = 0, y: float = 0, turn: float = 0, tag: str = "staticObstacle") -> str:
    return f'<{tag} id="7"><shape>{shape}</shape>{PLACE.format(x=x, y=y, turn=turn)}</{tag}>'


def points(*rows: tuple[float, float]) -> str:
    return "".join(f"<point><x>{x}</x><y>{y}</y></point>" for x, y in rows)


def write(*inside: str) -> Path:
    file = Path("a.xml")
    file.write_text(f'<?xml version="1.0"?><commonRoad commonRoadVersion="2020a">{"".join(inside)}</commonRoad>')
    return file


def test_obstacles_stand_where_they_are() -> None:
    disc = "<circle><radius>0.5</radius></circle>"
    corner = f"<polygon>{points((0, 0), (2, 0), (0, 2))}</polygon>"
    moving = obstacle(BOX, tag="dynamicObstacle")
    file = write(obstacle(BOX, 10, 5, 1.5707963), obstacle(disc, -3, 1), obstacle(corner, 0, 0, 3.1415926), moving)
    matches = read(file, ImportOptions(), ImportLimits())
    box, disc_, triangle = (thing.region for thing in matches.things)
    assert box.bounds == pytest.approx((9, 3, 11, 7), abs=1e-5)
    assert disc_.area == pytest.approx(0.785, rel=0.01)
    assert triangle.bounds == pytest.approx((-2, -2, 0, 0), abs=1e-5)
    assert matches.notes == ["left out: 1 obstacle that can move"]
    result = import_map(file, "a.yaml")
    area = shapely.union_all([thing.region for thing in matches.things]).area
    assert result.occupied * result.resolution**2 == pytest.approx(area, rel=0.01)


def test_lanelets_are_free() -> None:
    lane = f'<lanelet id="1"><leftBound>{points((0, 4), (20, 4))}</leftBound>'
    lane += f"<rightBound>{points((0, 0), (20, 0))}</rightBound></lanelet>"
    result = import_map(write(lane, obstacle(BOX, 10, 1)), "a.yaml")
    assert result.free_area == pytest.approx(80 - 8, rel=0.01)


@pytest.mark.parametrize(
    ("inside", "message"),
    [
        ("<staticObstacle id='3'/>", "obstacle 3 has no exact initial position"),
        (obstacle("<star/>"), "a shape other than"),
        (obstacle(BOX, x=float("nan")), "must be 1 number"),
        ('<lanelet id="5"><leftBound/></lanelet>', "lanelet 5 has no two bounds"),
        ("", "nothing stands"),
    ],
)
def test_wrong_files_are_refused(inside, message) -> None:
    with pytest.raises(BridgeError, match=message):
        import_map(write(inside), "a.yaml")
