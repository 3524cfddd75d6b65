"""Conversions of frames, and the file beside a map, which has one: round trips, handedness, headings, cases by hand."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from irsim.bridges import frames
from irsim.bridges.base import BridgeError
from irsim.bridges.frames import FRAMES, axes_of, camera_pose, pose_matrix, to_frame
from irsim.bridges.maps.sidecar import MapSidecar, read_sidecar, scene_transform, sidecar_path
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


POSES = st.tuples(st.floats(-99, 99), st.floats(-99, 99), st.floats(-3.1, 3.1))


def sidecar(frame: str = "habitat_yup", height: float = 0.4, unit: float = 1.0) -> MapSidecar:
    return MapSidecar(scene_transform(frame, height, unit), frame, height, 0.05, (-1.0, 2.0), (30, 20))


def test_a_point_on_the_floor_by_hand() -> None:
    there = sidecar().to_scene([[3.0, 2.0, 0.0]])
    assert there.tolist() == [[3.0, 0.4, -2.0]]
    assert sidecar("usd", 0.4, unit=0.01).to_scene([[3.0, 2.0]], height=1.0) == pytest.approx(
        np.array([[300, 200, 140]])
    )
    assert sidecar("carla").to_scene([[3.0, 2.0]]).tolist() == [[3.0, -2.0, 0.4]]


def test_a_robot_that_looks_along_y_looks_along_minus_z_where_y_is_up() -> None:
    pose = sidecar().scene_poses([[0.0, 0.0, math.pi / 2]])[0]
    assert pose[:3, :3] @ [1, 0, 0] == pytest.approx(np.array([0, 0, -1]))
    assert pose[:3, :3] @ [0, 1, 0] == pytest.approx(np.array([0, 1, 0]))


@given(pose=POSES, frame=st.sampled_from(FRAMES), unit=st.sampled_from([1.0, 0.01, 2.54]))
def test_there_and_back(pose, frame, unit) -> None:
    one = sidecar(frame, 1.3, unit)
    assert one.to_irsim(one.to_scene([pose], height=0.7)) == pytest.approx(np.array([[*pose[:2], 0.7]]), abs=1e-6)
    assert one.scale == pytest.approx(1 / unit)
    turn = one.scene_poses([pose])[0, :3, :3]
    assert turn.T @ turn == pytest.approx(np.eye(3), abs=1e-9)
    assert np.linalg.det(turn) == pytest.approx(1)
    ahead = one.to_scene([[pose[0] + math.cos(pose[2]), pose[1] + math.sin(pose[2])]]) - one.to_scene([pose])
    assert turn @ axes_of(frame)[:, 0] / unit == pytest.approx(ahead[0], abs=1e-6)


@given(pose=POSES, frame=st.sampled_from(FRAMES))
def test_it_agrees_with_frames(pose, frame) -> None:
    one = sidecar(frame, 1.3)
    assert one.scene_poses([pose]) == pytest.approx(to_frame(pose_matrix(np.array([pose])), frame, one.transform))
    camera = camera_pose(np.array(pose), "opengl", 1.5, frame, one.transform)
    assert camera[:3, 3] == pytest.approx(one.to_scene([pose], height=1.5)[0])


def test_written_and_read(tmp_path) -> None:
    one = sidecar()
    file = sidecar_path(tmp_path / "flat.yaml")
    file.write_text(one.as_json())
    back = read_sidecar(tmp_path / "flat.yaml")
    assert file.name == "flat.bridge.json"
    assert (back.T_scene_from_irsim == one.T_scene_from_irsim).all()
    assert (back.frame, back.origin, back.size, back.floor_height) == ("habitat_yup", (-1.0, 2.0), (30, 20), 0.4)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"format": "x"}, "format"),
        ({"version": 2}, "version"),
        ({"frame": "moon"}, "frame"),
        ({"T_scene_from_irsim": [[1, 2], [3]]}, "4x4"),
        ({"T_scene_from_irsim": np.zeros((4, 4)).tolist()}, "4x4"),
        ({"T_scene_from_irsim": np.diag([1, 2, 1, 1]).tolist()}, "evenly"),
        ({"T_scene_from_irsim": np.diag([math.nan, 2, 1, 1]).tolist()}, "NaN is not a number"),
        ({"T_scene_from_irsim": np.diag([0, 0, 0, 1]).tolist()}, "evenly"),
        ({"origin": ["a", 1]}, "origin"),
        ({"origin": [math.inf, 1]}, "neither is Infinity"),
        ({"size": 3}, "size"),
        ({"resolution": True}, "resolution"),
        ({"source": []}, "source"),
    ],
)
def test_wrong_files_are_refused(tmp_path, change, said) -> None:
    file = tmp_path / "flat.bridge.json"
    file.write_text(json.dumps({**json.loads(sidecar().as_json()), **change}))
    with pytest.raises(BridgeError, match=said) as caught:
        read_sidecar(file)
    assert caught.value.code == "bridge-file"


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b"\xff\xfe", b"[" * 100_000, b" " * (1 << 21)])
def test_files_that_are_not_json(tmp_path, content) -> None:
    file = tmp_path / "flat.bridge.json"
    file.write_bytes(content)
    with pytest.raises(BridgeError):
        read_sidecar(file)
