"""Helpers of scripts."""

from __future__ import annotations

import math
from collections.abc import Callable
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


def test_velocities() -> None:
    np.testing.assert_allclose(util.omni_to_diff(0.0, column(1, 1)), [[1], [1.5]])
    np.testing.assert_allclose(util.vel_world2diff(0.5, column(1, 0), w_max=0.5), [[math.cos(0.5)], [-0.5]])
    assert util.omni_to_diff(0.0, [0.01, 0]).tolist() == [[0], [0]]
    np.testing.assert_allclose(util.diff_to_omni(0.5, column(2, 0.3)), [[2 * math.cos(0.5)], [2 * math.sin(0.5)]])
    np.testing.assert_allclose(util.vel_omni2world(0.7, util.vel_world2omni(0.7, column(1, 2))), column(1, 2))


def test_frames() -> None:
    state = column(1, 2, 0.5)
    vertices = np.array([[0, 1, 1.0], [0, 0, 1]])
    moved = util.vertices_transform(vertices, state)
    np.testing.assert_allclose(
        np.array(util.geometry_transform(shapely.Polygon(vertices.T), state).exterior.coords)[:3], moved.T
    )
    pose = util.transform_point_with_state(column(1, 1, 3), state)
    np.testing.assert_allclose(pose[:2, 0], moved[:, 2])
    assert pose[2, 0] == pytest.approx(3.5 - 2 * math.pi)
    assert util.relative_position(column(1, 1), column(1, 3)) == (2, pytest.approx(math.pi / 2))
    assert (util.distance([0, 0], [3, 4]), util.dist_hypot(0, 0, 3, 4)) == (5, 5)


def test_polygons() -> None:
    square = np.array([[0, 1, 1, 0.0], [0, 0, 1, 1]])
    assert util.is_convex_and_ordered(square) == (True, "CCW")
    assert util.is_convex_and_ordered(square[:, ::-1]) == (True, "CW")
    dent = np.array([[0, 2, 0.5, 0.0], [0, 0, 0.5, 2]])
    assert util.is_convex_and_ordered(dent) == (False, None)
    assert util.gen_inequal_from_vertex(dent) == (None, None)
    for corners in (square, square[:, ::-1]):
        normals, offsets = util.gen_inequal_from_vertex(corners)
        assert normals is not None
        assert (normals @ np.array([[0.5], [0.5]]) < offsets).all()
        assert (normals @ np.array([[1.5], [0.5]]) > offsets).any()
    assert every.is_convex_polygon(shapely.box(0, 0, 1, 1))


def test_lists_and_checks() -> None:
    assert every.convert_list_length([1, 2], 3) == [[1, 2]] * 3
    assert every.convert_list_length([[1], [2]], 3) == [[1], [2], [2]]
    assert every.convert_list_length([1, 2], 3, per_object=True) == [1, 2, 2]
    assert util.find_duplicates([1, 2, 1, 3, 2]) == [1, 2]
    assert every.check_choice("A", "x", ["a"]) == "a"
    for wrong in ("a", math.inf, 1):
        with pytest.raises(ValueError, match="x must be"):
            every.check_number(wrong, "x", low=2)
    assert util.to_numpy([1, 2]).shape == (2, 1)  # type: ignore[union-attr]
    assert every.points_to_xy_list([[1, 2], [3, 4]]) == ([1, 3], [2, 4])
    assert every.traj_to_xy_list([column(1, 2, 3), column(4, 5, 6)]) == ([1, 4], [2, 5])


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


def test_files(tmp_path: Any) -> None:
    (tmp_path / "deep").mkdir()
    file = tmp_path / "deep" / "a.txt"
    file.write_text("")
    assert util.find_file(str(tmp_path), "a.txt") == str(file)
    assert util.file_check("a.txt", str(tmp_path)) == str(file)
    assert util.file_check("b.txt", str(tmp_path)) is None
    assert util.file_check(None) is None
