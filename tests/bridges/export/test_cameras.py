"""`irsim export` of cameras: COLMAP, nerfstudio, lines of poses."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import irsim
from irsim.bridges.maps.sidecar import MapSidecar, scene_transform
from irsim.cli.app import app
from irsim.diagnostics.errors import ArgumentError
from irsim.runs import Run, open_run
from irsim.runs.files import RunError
from tests.bridges.scenes import recorded

HALL = """\
world: {width: 12, height: 8, collision_mode: unobstructed}
robot:
  - {name: left one, kinematics: {name: diff}, state: [1, 1, 0.5], goal: [5, 1, 0], behavior: {name: dash}}
  - {name: right, kinematics: {name: diff}, state: [1, 6, -0.5], goal: [9, 6, 0], behavior: {name: dash}}
obstacle:
  - {name: walker, kinematics: {name: omni}, state: [6, 6, 0], goal: [9, 2, 0], behavior: {name: dash}}
"""


@pytest.fixture
def run() -> Run:
    Path("hall.yaml").write_text(HALL, encoding="utf-8")
    return open_run(str(irsim.run("hall.yaml", seed=1, steps=20, record=True).run_id))


def beside(frame: str, height: float = 0.0, unit: float = 1.0) -> None:
    """Write a sidecar beside the scenario."""
    text = MapSidecar(scene_transform(frame, height, unit), frame, height).as_json()
    Path("hall.bridge.json").write_text(text, encoding="utf-8")


def lines(file: str) -> list[dict[str, object]]:
    return [json.loads(line) for line in Path(file).read_text(encoding="utf-8").splitlines()]


def test_poses_are_those_of_a_world_with_y_up(run: Run) -> None:
    result = irsim.export_run(run, "poses.jsonl", to="poses", objects=["right"], options={"height": 0.7})
    assert result.objects == ["right"]
    assert "the map of the run has no sidecar" in result.notes[0]
    trace = run.trace()
    for row in (0, 7, 20):
        line = lines("poses.jsonl")[row]
        x, y, theta = trace.pose[row, 1].tolist()
        assert (line["frame"], line["robot"]) == (row, "right")
        assert line["t"] == pytest.approx(trace.time[row])
        assert line["position"] == pytest.approx([x, 0.7, -y])
        # A camera that looks along -z is turned about y; forward is (cos, 0, -sin) of the heading.
        yaw = float(line["yaw"])  # type: ignore[arg-type]
        assert (-math.sin(yaw), -math.cos(yaw)) == pytest.approx((math.cos(theta), -math.sin(theta)))


@pytest.mark.parametrize("frame", ["habitat_yup", "usd", "colmap"])
def test_a_sidecar_puts_poses_into_its_scene(run: Run, frame: str) -> None:
    beside(frame, 0.4, 0.5)
    result = irsim.export_run(run, "poses.jsonl", to="poses", objects=["right"], options={"height": 1.0})
    assert result.notes == []
    x, y, _ = run.trace().pose[0, 1].tolist()
    assert lines("poses.jsonl")[0]["position"] == pytest.approx([2 * x, 2 * 1.4, -2 * y])
    irsim.export_run(run, "own.jsonl", to="poses", objects=["right"], options={"frame": "habitat_yup"})
    assert lines("own.jsonl")[0]["position"] == pytest.approx([x, 1.5, -y])


def test_colmap_has_a_line_for_each_step_and_robot(run: Run) -> None:
    irsim.export_run(run, "cameras", to="colmap", options={"every": 5, "width": 640, "rows": 480, "fov": 90.0})
    camera = Path("cameras/cameras.txt").read_text().splitlines()[1].split()
    assert camera[:4] == ["1", "PINHOLE", "640", "480"]
    assert [float(value) for value in camera[4:]] == pytest.approx([320, 320, 320, 240])
    text = Path("cameras/images.txt").read_text().splitlines()
    images = [line.split() for line in text[1::2]]
    assert [image[0] for image in images] == [str(number) for number in range(1, 11)]
    assert images[0][9] == "000_left_one/000000.png"
    assert images[9][9] == "001_right/000020.png"
    w, x, y, z, *shift = (float(value) for value in images[0][1:8])
    turn = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip
    assert -turn.T @ shift == pytest.approx([1, 1, 1.5])
    assert turn[2] == pytest.approx([math.cos(0.5), math.sin(0.5), 0])  # the view direction in the world


def test_nerfstudio_has_a_dataset_and_a_path_for_each_robot(run: Run) -> None:
    beside("irsim")
    irsim.export_run(run, "ns", to="nerfstudio", options={"every": 10, "height": 1.0})
    data = json.loads(Path("ns/transforms.json").read_text())
    assert [frame["file_path"] for frame in data["frames"]][::3] == ["images/000_left_one/000000.png",
                                                                     "images/001_right/000000.png"]  # fmt: skip
    matrix = np.array(data["frames"][3]["transform_matrix"])
    assert matrix[:3, 3] == pytest.approx([1, 6, 1])
    assert -matrix[:3, 2] == pytest.approx([math.cos(-0.5), math.sin(-0.5), 0])  # it looks along its -z
    assert matrix[:3, 1] == pytest.approx([0, 0, 1])  # y is up
    path = json.loads(Path("ns/camera_path_1.json").read_text())
    assert np.reshape(path["camera_path"][0]["camera_to_world"], (4, 4)) == pytest.approx(matrix)
    assert path["fps"] == pytest.approx(1.0)
    assert 2 * math.degrees(math.atan(data["h"] / 2 / data["fl_y"])) == pytest.approx(path["camera_path"][0]["fov"])


def test_wrong_options_are_refused_and_nothing_is_written(run: Run) -> None:
    for options, message in (
        ({"heigth": 1}, "did you mean height"),
        ({"every": 0}, "must be ≥ 1, got 0"),
        ({"fov": 180.0}, "must be > 0.*180"),
        ({"frame": "mars"}, "'mars' is not a valid value of 'frame'"),
    ):
        with pytest.raises(ArgumentError, match=message):
            irsim.export_run(run, "cameras", to="colmap", options=options)
    with pytest.raises(ArgumentError, match="the format csv has no option 'height'"):
        irsim.export_run(run, "a.csv", options={"height": 1.0})
    with pytest.raises(RunError, match="both frame and sidecar"):
        irsim.export_run(run, "cameras", to="colmap", options={"frame": "usd", "sidecar": "hall.yaml"})
    Path("hall.bridge.json").write_text("{}", encoding="utf-8")
    with pytest.raises(ValueError, match="not the sidecar of a map"):
        irsim.export_run(run, "cameras", to="colmap")
    assert sorted(path.name for path in Path().iterdir() if path.name[0] != ".") == ["hall.bridge.json", "hall.yaml"]


def test_cameras_are_left_out_while_their_object_is_not_in_the_world(run: Run) -> None:
    passer = "{name: replay, times: [1, 2], poses: [[5, 5], [4, 5]]}"
    record = recorded(HALL + f"  - {{name: passer, kinematics: {{name: omni}}, behavior: {passer}}}\n", 30)
    irsim.export_run(record, "passer.jsonl", to="poses", objects=["passer"])
    assert [line["frame"] for line in lines("passer.jsonl")] == list(range(10, 21))
    with pytest.raises(RunError, match="none of the chosen objects is in the world"):
        irsim.export_run(record, "never", to="colmap", objects=["passer"], options={"every": 30})
    assert not Path("never").exists()


def test_the_command_writes_a_folder_named_after_the_run(run: Run) -> None:
    done = CliRunner().invoke(app, ["export", "--to", "colmap", "--objects", "walker", "--set", "every=4"])
    assert done.exit_code == 0, done.output
    assert len(Path(f"{run.id}-colmap/images.txt").read_text().splitlines()) == 1 + 2 * 6
