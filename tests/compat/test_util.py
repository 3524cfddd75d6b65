"""Helpers of scripts."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

import irsim
from irsim import util
from irsim.config import env_param, palette_param, path_param, world_param
from irsim.util import util as every

POSE = np.array([[1.0], [2.0], [0.5]])
ANGLES = st.floats(-1e3, 1e3)


def column(*values: float) -> Any:
    return np.array(values, dtype=float).reshape(-1, 1)


@given(ANGLES)
def test_angles_keep_their_direction(angle: float) -> None:
    for wrapped, low, high in (
        (util.WrapToPi(angle), -math.pi, math.pi),
        (every.WrapTo2Pi(angle), 0, 2 * math.pi),
        (util.WrapToRegion(angle, [1.0, 1.0 + 2 * math.pi]), 1.0, 1.0 + 2 * math.pi),
    ):
        assert low <= wrapped <= high
        assert math.cos(wrapped - angle) == pytest.approx(1)
    assert util.WrapToPi(angle, positive=True) == abs(util.WrapToPi(angle))


def test_angles_that_are_none() -> None:
    assert (util.WrapToPi(math.nan), every.WrapTo2Pi(math.inf), every.ClipTo2Pi(-4.0)) == (0, 0, 0)
    with pytest.raises(AssertionError):
        util.WrapToRegion(1.0, [0, 1])


def test_velocities_towards_a_direction_have_a_limited_yaw_rate() -> None:
    np.testing.assert_allclose(util.vel_world2diff(0.5, column(1, 0), w_max=0.5), [[math.cos(0.5)], [-0.5]])


def test_transformed_headings_are_wrapped() -> None:
    pose = util.transform_point_with_state(column(1, 1, 3), column(1, 2, 0.5))
    assert pose[2, 0] == pytest.approx(3.5 - 2 * math.pi)


SQUARE = np.array([[0, 1, 1, 0.0], [0, 0, 1, 1]])
CORNER_ON_A_LINE = np.array([[0, 1, 2, 2, 0.0], [0, 0, 0, 1, 1]])
DENT = np.array([[0, 2, 0.5, 0.0], [0, 0, 0.5, 2]])


@pytest.mark.parametrize("corners", [SQUARE, CORNER_ON_A_LINE])
def test_convex_polygons(corners: Any) -> None:
    for points, order in ((corners, "CCW"), (corners[:, ::-1], "CW")):
        assert util.is_convex_and_ordered(points) == (True, order)
        normals, offsets = util.gen_inequal_from_vertex(points)
        assert (normals @ np.array([[0.5], [0.5]]) < offsets).all()
        assert (normals @ np.array([[2.5], [0.5]]) > offsets).any()
    assert every.is_convex_polygon(shapely.Polygon(corners.T))


def test_polygons_with_a_dent() -> None:
    assert util.is_convex_and_ordered(DENT) == (False, None)
    assert util.gen_inequal_from_vertex(DENT) == (None, None)


def test_lists_and_checks() -> None:
    assert every.convert_list_length([1, 2], 3) == [[1, 2]] * 3
    assert every.convert_list_length([[1], [2]], 3) == [[1], [2], [2]]
    assert every.convert_list_length([1, 2], 3, per_object=True) == [1, 2, 2]
    assert util.find_duplicates([1, 2, 1, 3, 2]) == [1, 2]
    assert every.check_choice("A", "x", ["a"]) == "a"
    for wrong in ("a", math.inf, 1):
        with pytest.raises(ValueError, match="x must be"):
            every.check_number(wrong, "x", low=2)


@pytest.mark.parametrize("data", [[[1]], ((1, 2),)])
def test_lists_of_lists_are_2d_lists(data: Any) -> None:
    assert util.is_2d_list(data)


@pytest.mark.parametrize("data", [np.zeros((2, 2)), [np.zeros(2)], [], None, (1, 2), "ab"])
def test_arrays_are_no_2d_lists(data: Any) -> None:
    assert not util.is_2d_list(data)


def test_random_numbers_follow_the_environment_used_last(tmp_path: Any) -> None:
    path = tmp_path / "world.yaml"
    path.write_text("world: {width: 7}\nrobot: {kinematics: {name: omni}}")
    first, second = (irsim.make(path, headless=True, log_level="ERROR", seed=seed) for seed in (1, 2))
    mine = irsim.make(path, headless=True, log_level="ERROR", seed=1)
    first.step()
    assert util.rng.random() == mine.rng.random()
    second.step()
    assert util.rng.random() != mine.rng.random()
    util.set_seed(3)
    drawn = second.rng.random()
    assert drawn == np.random.default_rng(3).random()
    util.set_seed(3)
    assert util.random_point_range([0, 0, 0], [1, 1, 0]).shape == (3, 1)
    apart = util.random_uniform(low=[0, 0, 0], high=[9, 9, 1], size=(3, 5), min_distance=1.0)
    assert apart.shape == (3, 5)
    gaps = np.linalg.norm(apart[:2, :, None] - apart[:2, None], axis=0)[np.triu_indices(5, 1)]
    assert (gaps >= 1).all()


def test_parameter_modules_follow_the_environment_used_last(tmp_path: Any) -> None:
    path = tmp_path / "world.yaml"
    path.write_text("world: {step_time: 0.2}\nrobot: {kinematics: {name: omni}}")
    make: Callable[[], Any] = lambda: irsim.make(path, headless=True, log_level="ERROR")  # noqa: E731
    first, second = make(), make()
    second.step()
    second.step()
    first.step()
    assert (world_param.count, world_param.step_time) == (1, 0.2)
    assert env_param.objects == first.objects
    second.step()
    assert world_param.count == 3
    world_param.collision_mode = "unobstructed"
    assert second.world_param.collision_mode == "unobstructed"
    assert first.world_param.collision_mode == "stop"
    assert second.simulation.world.collision_mode == 1
    world_param.control_mode = "keyboard"
    assert second.status == "Running (keyboard)"
    assert path_param.fig_path.endswith("/figure")
    palette_param.robot = "red"
    assert second.palette_param.robot == "red"
    assert first.palette_param.robot != "red"
    with pytest.raises(AttributeError, match="nothing_like_it"):
        _ = world_param.nothing_like_it


def test_decorators(capsys: pytest.CaptureFixture[str]) -> None:
    @util.time_it("work")
    @every.ensure_column_vector("a")
    @every.validate_shape(a=2)
    def work(a: Any) -> Any:
        return a.shape

    assert work([1, 2]) == (2, 1)
    assert "work execute time" in capsys.readouterr().out
    with pytest.raises(ValueError, match="shape"):
        work([1])


def test_files(tmp_path: Path) -> None:
    file = tmp_path / "deep" / "a.txt"
    file.parent.mkdir()
    file.touch()
    assert util.find_file(str(tmp_path), "a.txt") == util.file_check("a.txt", str(tmp_path)) == str(file)
    assert util.file_check("b.txt", str(tmp_path)) is util.file_check(None) is None


def test_wrap_to_region_keeps_both_ends() -> None:
    around = [-math.pi, math.pi]
    wrapped = [util.WrapToRegion(angle, around) for angle in (math.pi, 3 * math.pi, -math.pi, -3 * math.pi)]
    assert wrapped == [math.pi, math.pi, -math.pi, -math.pi]
    assert util.WrapToRegion(2 * math.pi, [0, 2 * math.pi]) == 2 * math.pi
    with pytest.raises(ValueError, match="two numbers"):
        util.WrapToRegion(1, [0])


def test_transforms_of_nothing_are_none() -> None:
    nothing = [
        util.vertices_transform(None, POSE),
        util.vertices_transform(np.zeros((2, 3)), None),
        util.geometry_transform(None, POSE),
        util.to_numpy(None),
    ]
    assert nothing == [None] * 4
    assert every.to_numpy(None, np.zeros(2), (2, 1)).shape == (2, 1)
    assert every.points_to_xy_list(None) == ([], [])
    assert util.diff_to_omni(0.0, np.array(None)).tolist() == [[0], [0]]


@pytest.mark.parametrize(
    ("function", "arguments"),
    [
        (util.transform_point_with_state, (None, POSE)),
        (util.transform_point_with_state, (POSE, None)),
        (util.geometry_transform, (shapely.Point(1, 1), None)),
        (every.get_transform, (None,)),
        (every.get_affine_transform, (None,)),
        (util.relative_position, (None, POSE)),
        (util.distance, (POSE, None)),
        (util.omni_to_diff, (0.0, None)),
        (util.vel_world2omni, (0.0, None)),
    ],
)
def test_points_that_are_none_are_errors(function: Any, arguments: Any) -> None:
    with pytest.raises(TypeError, match="None"):
        function(*arguments)


def test_checks_of_arguments_pass_over_none() -> None:
    @every.validate_shape(state=3)
    def by_shape(state: Any = None) -> Any:
        return state

    @every.validate_length(state=3)
    def by_length(state: Any = None) -> Any:
        return state

    assert (by_shape(), by_length(None)) == (None, None)
    with pytest.raises(TypeError, match="sequence"):
        by_length(3)


def test_random_uniform_has_three_rows() -> None:
    points = util.random_uniform(size=(2, 4))
    assert points.shape == (3, 4)
    assert (points[2] == 0).all()
    assert (points[:2] >= 0.5).all()
    assert (points[:2] <= 9.5).all()
