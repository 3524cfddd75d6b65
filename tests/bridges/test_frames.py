"""Conversions of frames: round trips, handedness, headings, and cases worked by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from irsim.bridges import frames
from irsim.diagnostics.errors import ArgumentError

ANGLES = st.floats(-math.pi, math.pi)
PLACES = st.floats(-1e4, 1e4)
HANDED = {"irsim": 1, "ros": 1, "carla": -1, "usd": 1, "usd_yup": 1, "habitat_yup": 1, "gltf": 1, "colmap": 1}


@pytest.mark.parametrize("frame", frames.FRAMES)
@given(x=PLACES, y=PLACES, yaw=ANGLES, height=st.floats(-10, 10))
def test_round_trip(frame: str, x: float, y: float, yaw: float, height: float) -> None:
    pose = frames.pose_matrix(np.array([x, y, yaw]), height)
    shift = frames.pose_matrix(np.array([3.0, -2.0, 0.7]), 1.0)
    there = frames.to_frame(pose, frame, shift)
    back = frames.to_irsim(there, frame, shift)
    assert np.allclose(back, pose, atol=1e-8)
    assert np.allclose(frames.planar_pose(back)[:2], [x, y], atol=1e-8)
    assert math.isclose(math.remainder(float(frames.yaw_of(back)) - yaw, 2 * math.pi), 0, abs_tol=1e-9)


@pytest.mark.parametrize("frame", frames.FRAMES)
def test_handedness(frame: str) -> None:
    assert round(float(np.linalg.det(frames.axes_of(frame)))) == HANDED[frame]


@pytest.mark.parametrize("frame", frames.FRAMES)
@given(yaw=ANGLES)
def test_a_body_is_a_rotation_and_heads_where_it_goes(frame: str, yaw: float) -> None:
    """One meter forward in irsim is one meter along the forward axis of the body in the other frame."""
    pose = frames.to_frame(frames.pose_matrix(np.array([1.0, 2.0, yaw])), frame)
    ahead = frames.to_frame(frames.pose_matrix(np.array([1 + math.cos(yaw), 2 + math.sin(yaw), yaw])), frame)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1)
    forward = frames.axes_of(frame) @ [1, 0, 0]
    assert np.allclose(ahead[:3, 3] - pose[:3, 3], pose[:3, :3] @ forward, atol=1e-12)


def test_a_left_turn_worked_by_hand() -> None:
    """2 m ahead and 1 m to the left, turned left by 90 degrees."""
    pose = frames.pose_matrix(np.array([2.0, 1.0, math.pi / 2]))
    assert frames.to_frame(pose, "carla")[:3, 3].tolist() == [2, -1, 0]
    assert frames.to_frame(pose, "habitat_yup")[:3, 3].tolist() == [2, 0, -1]
    turned = frames.to_frame(pose, "habitat_yup")[:3, :3]
    assert turned @ [1, 0, 0] == pytest.approx([0, 0, -1]), "it heads along -z"


@given(yaw=ANGLES)
def test_cameras_look_forward_with_the_sky_above(yaw: float) -> None:
    pose, ahead = np.array([1.0, 2.0, yaw]), [math.cos(yaw), math.sin(yaw), 0]
    opengl = frames.camera_pose(pose, "opengl", 1.5)
    assert np.allclose(opengl[:3, :3] @ [0, 0, -1], ahead)
    assert np.allclose(opengl[:3, :3] @ [0, 1, 0], [0, 0, 1])
    assert np.allclose(opengl[:3, 3], [1, 2, 1.5])
    colmap = frames.camera_pose(pose, "colmap", 1.5)
    assert np.allclose(colmap[:3, :3] @ [0, 0, 1], ahead)
    assert np.allclose(colmap[:3, :3] @ [0, -1, 0], [0, 0, 1])
    assert np.linalg.det(opengl[:3, :3]) == pytest.approx(1)
    inside = frames.camera_pose(pose, "opengl", 1.5, "habitat_yup")
    assert np.allclose(inside[:3, :3] @ [0, 1, 0], [0, 1, 0])
    assert np.allclose(inside[:3, 3], [1, 1.5, -2])


@given(yaw=ANGLES, pitch=ANGLES, roll=ANGLES)
def test_quaternions_turn_as_their_matrices(yaw: float, pitch: float, roll: float) -> None:
    one = frames.rotation_of(yaw)
    two = np.roll(np.roll(frames.rotation_of(pitch), 1, axis=0), 1, axis=1)
    three = np.roll(np.roll(frames.rotation_of(roll), 2, axis=0), 2, axis=1)
    matrix = one @ two @ three
    x, y, z, w = frames.quaternion_of(matrix)
    again = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    assert np.allclose(again, matrix, atol=1e-12)
    assert w >= 0


def test_an_unknown_frame() -> None:
    with pytest.raises(ArgumentError, match="did you mean carla"):
        frames.axes_of("karla")
