"""Maps of a flat and of a house: levels, what is free, what is unknown, and how they turn with the scene."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.occupancy import eroded, occupancy_of, within
from irsim.bridges.maps.regions import connected, masked_regions
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Occupancy, SceneTriangles
from irsim.bridges.maps.writing import suggest_trip
from irsim.components.maps._site import FREE, OCCUPIED, UNKNOWN
from tests.bridges.maps.scenes import box, flat, house


def occupancy(triangles: np.ndarray, **options) -> Occupancy:
    return occupancy_of(SceneTriangles("irsim", triangles), ImportOptions(**options), ImportLimits())


def at(result: Occupancy, x: float, y: float) -> float:
    grid = result.grid
    return float(result.values[int((x - grid.x) / grid.resolution), int((y - grid.y) / grid.resolution)])


def area(result: Occupancy) -> float:
    return float((result.values == FREE).sum()) * result.grid.resolution**2


def test_a_furnished_flat() -> None:
    result = occupancy(flat())
    for x, y, value in [
        (3.0, 5.0, FREE),
        (7.0, 1.0, FREE),  # below the shelf
        (3.0, 3.4, FREE),  # on the rug
        (5.06, 2.0, FREE),  # in the door
        (2.0, 1.5, OCCUPIED),  # the table
        (7.0, 5.0, OCCUPIED),  # the bed
        (5.01, 4.0, OCCUPIED),  # a wall
        (5.7, 5.5, UNKNOWN),  # in the cabinet, which has no bottom
    ]:
        assert at(result, x, y) == value, (x, y)
    inside = 8 * 6 - (0.12 * 5.1 + 1.6 * 0.9 + 1.6 * 2.0 + 1.2 * 0.5 + 0.6 * 0.7)
    assert area(result) == pytest.approx(inside, rel=0.04)
    assert result.height == pytest.approx(0.0, abs=0.01)
    assert [(round(height, 1), roof) for height, _, roof in result.levels] == [(0.0, False), (2.8, True)]


def test_headroom_and_climb_decide() -> None:
    assert at(occupancy(flat(), headroom=1.8), 7.7, 1.0) != FREE  # the shelf hangs at 1.7 m
    assert at(occupancy(flat(), headroom=0.6), 2.0, 1.5) == FREE  # below the table
    assert at(occupancy(flat(), climb=0.5), 7.0, 5.0) == FREE  # a robot that climbs onto beds
    assert at(occupancy(flat(), climb=0.01), 3.0, 3.4) != FREE  # and one that the rug stops


def test_a_scene_without_a_floor_gets_a_ground() -> None:
    """Posts without anything below them, as in files of furniture; the ground is 1 m wider than they are."""
    posts = np.concatenate([box([3.0 * k, 0, 0.5], [3.0 * k + 0.4, 0.4, 1.5]) for k in range(4)])
    with pytest.raises(BridgeError, match=r"--ground 0\.5 puts a floor"):
        occupancy(posts)
    result = occupancy(posts, ground=0.5, resolution=0.05)
    assert result.height == pytest.approx(0.5, abs=0.01)
    assert area(result) == pytest.approx(11.4 * 2.4 - 4 * 0.4**2, rel=0.02)
    assert [at(result, x, 0.2) for x in (0.2, 1.5, 3.2, 9.2)] == [OCCUPIED, FREE, OCCUPIED, OCCUPIED]
    part = occupancy(posts, ground=0.0, bounds=(2.0, -2.0, 5.0, 2.0), resolution=0.05)
    assert (part.height, area(part)) == (pytest.approx(0, abs=0.01), pytest.approx(3 * 4 - 0.4**2, rel=0.03))


def test_levels_of_a_house() -> None:
    ground = occupancy(house())
    assert [round(height, 1) for height, _, _ in ground.levels] == [0.0, 2.8, 5.6]
    assert (ground.level, ground.height) == (0, pytest.approx(0.0, abs=0.01))
    assert ground.levels[2][2]
    assert "level 0 of 3" in ground.notes[0]
    upper = occupancy(house(), level=1)
    assert upper.height == pytest.approx(2.8, abs=0.01)
    assert occupancy(house(), height=2.5).level == 1
    assert at(upper, 1.5, 5.5) != FREE  # the hole for the stairs
    assert at(upper, 2.0, 3.4) == FREE
    with pytest.raises(BridgeError, match=r"0 at 0\.00 m, 1 at 2\.80 m"):
        occupancy(house(), level=3)
    with pytest.raises(BridgeError, match="one of --level and --height"):
        occupancy(house(), level=0, height=1.0)


@pytest.mark.parametrize("resolution", [0.05, 0.4, 0.5, 0.7, 1.0, 2.0])
def test_large_cells_do_not_make_a_floor_of_the_roof(resolution: float) -> None:
    result = occupancy(flat(), resolution=resolution)
    assert result.height == pytest.approx(0.0, abs=0.03)
    assert [roof for _, _, roof in result.levels] == [False, True]
    assert not any("may be a roof" in note for note in result.notes)
    assert occupancy(house(), resolution=resolution).height < 3


def test_cells_in_which_no_floor_is_left_are_told_of() -> None:
    result = occupancy(flat(), resolution=3.0)
    assert result.height == pytest.approx(2.8, abs=0.01)
    assert "this may be a roof; try --resolution 0.1" in result.notes[-1]
    assert occupancy(flat(), resolution=3.0, level=0).notes == []
    assert occupancy(box([0, 0, -0.2], [9, 9, 0.0]), resolution=3.0).notes == [], "a ground without rooms"


@pytest.mark.parametrize("resolution", [0.1, 0.5, 2.0])
def test_a_yard_above_a_cellar_is_no_roof(resolution: float) -> None:
    yard, cellar = box([0, 0, -0.2], [30, 30, 0]), box([3, 3, -3.1], [12, 11, -3])
    result = occupancy(np.concatenate([yard, cellar]), resolution=resolution)
    assert (result.height, result.levels[-1][2]) == (pytest.approx(0.0, abs=0.01), False)


def test_a_seed_point_picks_a_part() -> None:
    rooms = np.concatenate([box([0, 0, -0.1], [3, 2, 0]), box([5, 0, -0.1], [6, 2, 0])])
    assert at(occupancy(rooms), 1, 1) == FREE
    other = occupancy(rooms, seed_point=(5.5, 1.0))
    assert at(other, 5.5, 1.0) == FREE
    assert other.kept == 1
    assert other.regions == pytest.approx([6, 2], rel=0.1)
    with pytest.raises(BridgeError, match=r"--seed-point 2\.\d+,") as caught:
        occupancy(rooms, seed_point=(4.0, 1.0))
    x, y = (float(part) for part in str(caught.value.fix).split()[-1].split(","))
    assert at(occupancy(rooms, seed_point=(x, y)), x, y) == FREE
    with pytest.raises(BridgeError, match="seed point"):
        occupancy(rooms, seed_point=(1e9, 0.0))
    stacked = np.concatenate([box([0, 0, -0.1], [3, 2, 0]), box([2, 0, 2.9], [4, 2, 3.0])])
    assert occupancy(stacked, seed_point=(3.5, 1.0)).height == pytest.approx(3.0, abs=0.01)


def test_slopes_and_hills() -> None:
    def ramp(rise: float) -> np.ndarray:
        corners = np.array([[0, 0, 0], [10, 0, rise], [10, 4, rise], [0, 4, 0]], float)
        return np.array([corners[[0, 1, 2]], corners[[0, 2, 3]]])

    hill = occupancy(ramp(8.0))  # one level although it is higher than a storey
    assert len(hill.levels) == 1
    assert area(hill) == pytest.approx(40, rel=0.03)
    with pytest.raises(BridgeError, match="no connected floor"):
        occupancy(ramp(12.0))
    assert area(occupancy(ramp(12.0), slope=60.0, climb=0.2)) == pytest.approx(40, rel=0.03)
    obstacle = occupancy(np.concatenate([ramp(8.0), box([4.5, 1.5, 3.0], [5.5, 2.5, 6.0])]))
    assert at(obstacle, 5.0, 2.0) == OCCUPIED


@given(turn=st.sampled_from([0, 1, 2, 3]), shift=st.tuples(*[st.integers(-400, 400)] * 2), rise=st.integers(-30, 30))
@settings(max_examples=6, deadline=None)
def test_a_turned_scene_has_a_turned_map(turn, shift, rise) -> None:
    """Turns by right angles and shifts by whole cells; the scene lies off the lines of the grid."""
    scene = flat() + np.array([0.013, 0.021, 0.0])
    c, s = round(math.cos(turn * math.pi / 2)), round(math.sin(turn * math.pi / 2))
    matrix = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    moved = scene @ matrix.T + [shift[0] * 0.05, shift[1] * 0.05, rise * 0.1]
    here, there = occupancy(scene), occupancy(moved)
    turned = np.rot90(here.values, turn)
    assert turned.shape == there.values.shape
    assert (turned != there.values).mean() < 0.002
    assert there.height == pytest.approx(here.height + rise * 0.1, abs=0.01)


def test_scenes_that_have_no_floor() -> None:
    for scene, said in [
        (np.zeros((0, 3, 3)), "no triangles"),
        (np.zeros((4, 3, 3)), "no connected floor"),
        (box([0, 0, 0], [0.3, 0.3, 1]), "no connected floor"),
        (box([0, 0, 0], [3, 3, 1])[:, ::-1], "no connected floor"),
    ]:
        with pytest.raises(BridgeError, match=said):
            occupancy(scene)
    with pytest.raises(BridgeError, match="--resolution"):
        occupancy(box([0, 0, 0], [90_000, 90_000, 1]), resolution=0.05)


@given(cells=st.floats(0, 6), seed=st.integers(0, 99))
@settings(max_examples=40)
def test_distances_between_cells(cells, seed) -> None:
    marked = np.random.default_rng(seed).random((14, 9)) < 0.05
    i, j = np.nonzero(np.pad(marked, 20, constant_values=True))
    x, y = np.meshgrid(np.arange(14) + 20, np.arange(9) + 20, indexing="ij")
    squares = ((x[..., None] - i) ** 2 + (y[..., None] - j) ** 2).min(axis=-1)
    assert (within(marked, cells) == (squares <= cells * cells)).all()


def test_erosion_makes_cells_occupied() -> None:
    values = np.full((9, 9), FREE)
    values[4, 4] = UNKNOWN
    assert (eroded(values, 0.0) == values).all()
    result = eroded(values, 1.0)
    assert result[4, 4] == UNKNOWN
    assert result[3, 4] == OCCUPIED
    assert result[3, 3] == FREE


@given(seed=st.integers(0, 99), share=st.floats(0, 1))
def test_connected_parts_of_a_grid(seed, share) -> None:
    free = np.random.default_rng(seed).random((12, 9)) < share
    number, sizes = masked_regions(free)
    assert ((number >= 0) == free).all()
    assert sizes.tolist() == sorted(sizes.tolist(), reverse=True)
    assert sizes.sum() == free.sum()
    seen = set()
    for start in zip(*np.nonzero(free), strict=True):
        waiting, part = [start], set()
        while waiting:
            i, j = waiting.pop()
            if (i, j) not in part and 0 <= i < 12 and 0 <= j < 9 and free[i, j]:
                part.add((i, j))
                waiting += [(i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)]
        assert len({int(number[cell]) for cell in part}) == 1
        assert len(part) == sizes[number[start]]
        seen.add(int(number[start]))
    assert len(seen) == len(sizes)


def test_a_long_chain_is_one_part() -> None:
    n = 100_000
    order = np.random.default_rng(0).permutation(n)
    root = connected(n, order[:-1], order[1:])
    assert (root == 0).all()


def test_start_and_goal_are_free_and_far_apart() -> None:
    result = occupancy(flat())
    trip = suggest_trip(result, np.where(result.values < 0, 100.0, result.values))
    assert math.dist(trip.start[:2], trip.goal[:2]) > 7
    assert trip.clearance >= 0.4
    for x, y, _ in (trip.start, trip.goal):
        assert at(result, x, y) == FREE
    nowhere = occupancy(box([0, 0, -0.1], [0.1, 20, 0]))
    narrow = suggest_trip(nowhere, np.where(nowhere.values < 0, 100.0, nowhere.values))
    assert narrow is None or narrow.clearance <= 0.05
