"""Splats in other frames, and colors that depend on the direction of view."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from irsim.bridges.frames import FRAMES, axes_of
from irsim.bridges.splats.render import colors_seen
from irsim.bridges.splats.splats import Splats, covariance_of, join_splats, moved, rotation_matrices, scale_of

NUMBERS = st.floats(-1, 1)


def some(count: int = 5, seed: int = 0, terms: int = 0) -> Splats:
    rng = np.random.default_rng(seed)
    quaternion = rng.normal(size=(count, 4))
    quaternion /= np.linalg.norm(quaternion, axis=1, keepdims=True)
    arrays = [rng.normal(size=(count, 3)), rng.uniform(0.1, 2, (count, 3)), quaternion, rng.uniform(0, 1, count)]
    arrays.append(rng.uniform(0, 1, (count, 3)))
    harmonics = rng.normal(size=(count, terms, 3)).astype(np.float32) if terms else None
    return Splats(*(values.astype(np.float32) for values in arrays), harmonics)


@given(frame=st.sampled_from(FRAMES), factor=st.sampled_from([0.1, 1.0, 30.0]), yaw=st.floats(-3, 3))
def test_moved_splats_have_the_moved_covariance(frame: str, factor: float, yaw: float) -> None:
    splats, transform = some(), np.eye(4)
    turn = np.array([[math.cos(yaw), -math.sin(yaw), 0], [math.sin(yaw), math.cos(yaw), 0], [0, 0, 1]])
    transform[:3, :3] = factor * axes_of(frame) @ turn
    transform[:3, 3] = [1, -2, 3]
    found = moved(splats, transform)
    assert scale_of(transform) == pytest.approx(factor)
    expected = covariance_of(splats.scale, splats.rotation, transform[:3, :3])
    size = float(np.abs(expected).max())
    np.testing.assert_allclose(covariance_of(found.scale, found.rotation), expected, atol=2e-5 * size)
    np.testing.assert_allclose(np.linalg.det(rotation_matrices(found.rotation)), 1, atol=1e-5)
    shifted = splats.center @ transform[:3, :3].T + transform[:3, 3]
    np.testing.assert_allclose(found.center, shifted, atol=1e-5 * factor + 1e-5)


def test_joined_splats_get_harmonics_of_zero() -> None:
    joined = join_splats([some(2), some(3, terms=3)])
    assert len(joined) == 5
    assert joined.harmonics is not None
    assert joined.harmonics.shape == (5, 3, 3)
    assert not joined.harmonics[:2].any()
    assert join_splats([some(2), some(1)]).harmonics is None


def test_harmonics_are_an_orthonormal_basis() -> None:
    rng = np.random.default_rng(0)
    steps = 400
    z = (np.arange(steps) + 0.5) / steps * 2 - 1  # equal areas of the sphere
    angle = np.arange(steps) * math.pi * (3 - math.sqrt(5)) + rng.uniform()
    direction = np.column_stack([np.sqrt(1 - z * z) * np.cos(angle), np.sqrt(1 - z * z) * np.sin(angle), z])
    direction = direction.astype(np.float32)
    values = np.stack([
        colors_seen(np.full((steps, 3), 9.0, np.float32), np.tile(one, (steps, 1, 1)), direction)[:, 0] - 9.0
        for one in np.eye(15, dtype=np.float32)[:, :, None].repeat(3, axis=2)
    ])  # fmt: skip
    np.testing.assert_allclose(4 * math.pi * values @ values.T / steps, np.eye(15), atol=0.02)


@pytest.mark.parametrize(("axis", "coefficient", "sign"), [(1, 0, -1), (2, 1, 1), (0, 2, -1)])
def test_the_first_degree_is_y_z_x_with_their_signs(axis: int, coefficient: int, sign: int) -> None:
    harmonics = np.zeros((1, 3, 3), np.float32)
    harmonics[0, coefficient] = 0.5
    direction = np.zeros((1, 3), np.float32)
    direction[0, axis] = 1
    seen = colors_seen(np.full((1, 3), 0.5, np.float32), harmonics, direction)
    assert seen[0] == pytest.approx(0.5 + sign * 0.5 * math.sqrt(3 / (4 * math.pi)))
