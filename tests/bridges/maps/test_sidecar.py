"""The file beside a map: poses go back to the scene, and wrong files are refused."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from irsim.bridges.base import BridgeError
from irsim.bridges.frames import FRAMES, axes_of, camera_pose, pose_matrix, to_frame
from irsim.bridges.maps.sidecar import MapSidecar, read_sidecar, scene_transform, sidecar_path

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
        ({"T_scene_from_irsim": np.diag([math.nan, 2, 1, 1]).tolist()}, "4x4"),
        ({"T_scene_from_irsim": np.diag([0, 0, 0, 1]).tolist()}, "evenly"),
        ({"origin": ["a", 1]}, "origin"),
        ({"origin": [math.inf, 1]}, "origin"),
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
