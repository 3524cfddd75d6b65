"""Bags become scenarios that drive as recorded; any other file is an error, and nothing is written."""

from __future__ import annotations

import json
import math
import shlex
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import irsim
from irsim.bridges.base import BridgeError
from irsim.bridges.ros.backends.bag import BagFolder
from irsim.bridges.ros.bags import importing
from irsim.bridges.ros.bags.importing import BagOptions, import_bag
from irsim.bridges.ros.messages import Messages
from irsim.cli.app import app
from irsim.diagnostics.errors import ArgumentError
from irsim.runs import open_run
from irsim.scenario.read import read
from tests.bridges.scenes import recorded

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("ros_others")]
ROOM = """\
world: {width: 12, height: 8, step_time: 0.1}
robot:
  - {name: rover, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0.5], goal: [10, 6, 0],
     behavior: {name: dash},
     sensors: [{name: lidar2d, number: 180, range_max: 6, angle_range: 4, offset: [0.1, 0, 0.2]}]}
obstacle:
  - {name: box, shape: {name: rectangle, length: 1, width: 2}, state: [7, 2, 0.3]}
  - {name: post, shape: {name: circle, radius: 0.4}, state: [3, 5, 0.3]}
"""


@pytest.fixture
def bag() -> Path:
    irsim.export_run(recorded(ROOM), "lab-rosbag2", to="rosbag2")
    return Path("lab-rosbag2")


def write_odometry(poses: Iterable[tuple[float, float, float]], speed: float, start: int, period: int) -> None:
    """The bag ``b`` with the odometry of a robot; times in nanoseconds."""
    messages = Messages()
    with BagFolder(Path("b"), messages, "mcap", "b") as bag:
        topic = bag.topic("/odom", "nav_msgs/msg/Odometry")
        for number, pose in enumerate(poses):
            stamp = start + period * number
            bag.add(topic, stamp, messages.odometry(stamp, "odom", "base_link", pose, (speed, 0.0, 0.0)))


def test_the_robot_drives_as_recorded_in_what_its_scans_saw(bag: Path) -> None:
    done = CliRunner().invoke(app, ["bridge", "import-bag", str(bag), "-o", "again.yaml", "--json"])
    assert done.exit_code == 0, done.output
    answer = json.loads(done.stdout)
    assert answer["notes"] == []  # the mount of the lidar came from /tf_static
    [before] = [open_run(str(one)).trace() for one in Path(".irsim/runs").iterdir() if one.is_dir()]
    again = open_run(str(irsim.run("again.yaml", seed=1, record=True).run_id)).trace()
    count = min(len(again.pose), len(before.pose))
    assert np.hypot(*(again.pose[:count, 0, :2] - before.pose[:count, 0, :2]).T).max() < 0.01
    # the scans of the map equal the recorded ones, as far as a grid of 5 cm can say
    now, then = again.ranges["robot/0"][:count], before.ranges["rover/0"][:count]
    both = np.isfinite(now) & np.isfinite(then)
    assert both.sum() > 2000
    assert np.median(np.abs(now[both] - then[both])) < 0.05
    grey = np.asarray(Image.open("again.png"))
    assert set(np.unique(grey)) == {0, 205, 254}  # solid, unknown, free
    cells = read("again.yaml").scenario.grid.cells
    assert ((grey == 205) == cells.unknown[:, ::-1].T).all()


def test_scans_of_another_robot_make_no_map() -> None:
    second = "  - {name: blind, kinematics: {name: diff}, state: [1, 7, 0], goal: [9, 7, 0], behavior: {name: dash}}\n"
    text = ROOM.replace("obstacle:", second + "obstacle:")
    irsim.run(text=text, seed=1, steps=20, bridges=["{name: rosbag, folder: two}"])
    alone = import_bag("two", "blind.yaml", BagOptions(odom="/blind/odom"))
    assert (alone.map, alone.scans) == (None, 0)
    assert "no scans of this robot" in alone.notes[0]
    assert import_bag("two", "rover.yaml", BagOptions(odom="/rover/odom")).scans == 21
    assert import_bag("two", "both.yaml", BagOptions(odom="/blind/odom", scan="/rover/scan")).scans == 21


def test_cells_that_fit_are_chosen_and_said(bag: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importing, "MAX_CELLS", 20_000)
    imported = import_bag(bag, "coarse.yaml")
    assert [note for note in imported.notes if "cells are 0.1 m" in note]
    with pytest.raises(BridgeError, match=r"--resolution 0\.1\b"):
        import_bag(bag, "none.yaml", BagOptions(resolution=0.05))


def test_windows_and_options(bag: Path) -> None:
    imported = import_bag(bag, "part.yaml", BagOptions(start=2.0, end=4.0, resolution=0.1, mount=(0.0, 0.0, 0.0)))
    assert (imported.duration, imported.poses) == (pytest.approx(2.0), 21)
    assert irsim.validate("part.yaml").valid
    with pytest.raises(BridgeError, match="the window of time has 0 poses"):
        import_bag(bag, "none.yaml", BagOptions(start=100.0))
    with pytest.raises(BridgeError, match=r"cells.*--resolution"):
        import_bag(bag, "none.yaml", BagOptions(resolution=0.0005))
    with pytest.raises(BridgeError, match=r"no topic '/odom'.*there are: /rover/odom"):
        import_bag(bag, "none.yaml", BagOptions(odom="/odom"))
    assert not Path("none.yaml").exists()


@pytest.mark.parametrize("damage", ["truncated", "garbage", "empty", "no metadata"])
def test_what_is_no_bag_is_an_error_with_nothing_written(bag: Path, damage: str) -> None:
    [file] = bag.glob("*.db3")
    if damage == "no metadata":
        (bag / "metadata.yaml").unlink()
    elif damage == "truncated":
        file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    else:
        file.write_bytes(b"" if damage == "empty" else b"x" * 5000)
    with pytest.raises(BridgeError, match="bag"):
        import_bag(bag, "none.yaml")
    assert not Path("none.yaml").exists()
    assert not Path("none.png").exists()


def test_metadata_beyond_all_bags_are_refused_at_once(bag: Path) -> None:
    metadata = bag / "metadata.yaml"
    for more in ("x: [" + "1, " * 400_000 + "]\n", "x: " + "[" * 900 + "]" * 900 + "\n"):
        text = metadata.read_text()
        metadata.write_text(text + more)
        start = time.process_time()
        with pytest.raises(BridgeError, match="not a bag that can be read"):
            import_bag(bag, "none.yaml")
        assert time.process_time() - start < 5
        metadata.write_text(text)


def test_poses_that_span_years_are_refused_at_once() -> None:
    write_odometry([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)], 1.0, 0, 10**17)
    with pytest.raises(BridgeError, match=r"its poses span 1e\+08 s, which is more than 10,000,000 steps"):
        import_bag("b", "s.yaml")


def test_odometry_that_is_not_finite_is_left_out() -> None:
    poses = [(math.nan if step == 7 else 0.1 * step, 0.0, 0.0) for step in range(30)]
    write_odometry(poses, 1.0, 100_000_000, 100_000_000)
    imported = import_bag("b", "s.yaml")
    assert imported.poses == 29
    assert imported.notes == ["1 messages were not usable and left out", "the bag has no scans, so there is no map"]
    assert irsim.run("s.yaml").outcome == "success"


def test_the_commands_of_the_page() -> None:
    Path("hall.yaml").write_text(ROOM)
    page = Path(__file__).parents[3] / "skills" / "irsim-runner" / "bridges" / "ros2.md"
    block = page.read_text().split("## Bags")[1].split("```bash\n")[1].split("```")[0]
    for line in block.strip().splitlines():
        done = CliRunner().invoke(app, shlex.split(line, comments=True)[1:])
        assert done.exit_code == 0, (line, done.output)
    assert Path("again.png").exists()


def test_the_doctor_is_content() -> None:
    done = CliRunner().invoke(app, ["bridge", "doctor", "ros2", "ros1", "rosbridge", "rosbag", "--json"])
    states = {one["part"]: one["state"] for one in json.loads(done.stdout)}
    assert states == {
        "rclpy": "missing", "cyclonedds": "ready", "zenoh": "ready", "rospy": "there", "roslibpy": "there",
        "rosbags": "ready",
    }, done.stdout  # fmt: skip


def test_a_robot_that_comes_back_drives_its_whole_way() -> None:
    turns = [math.tau * step / 120 for step in range(121)]
    write_odometry([(math.cos(turn), math.sin(turn), 0.0) for turn in turns], 0.0, 7_000_000, 50_000_000)
    import_bag("b", "s.yaml")
    result = irsim.run("s.yaml")
    assert result.outcome == "success"
    assert result.robots[0].path_length == pytest.approx(2 * math.pi, rel=0.01)


def write_transforms(folder: str, corrected: bool) -> None:
    """A robot that drives along x for 2 s in a room of 6 m x 4 m, which says where it is only in ``/tf``.

    Every second beam has no return, which its driver writes as the greatest range, or as more.
    """
    messages = Messages()

    def moved(stamp: int, parent: str, child: str, pose: tuple[float, float, float]) -> Any:
        return messages("tf2_msgs", "TFMessage")([messages.transform(stamp, parent, child, pose)])

    with BagFolder(Path(folder), messages, "mcap", folder) as bag:
        tf = bag.topic("/tf", "tf2_msgs/msg/TFMessage")
        fixed = bag.topic("/tf_static", "tf2_msgs/msg/TFMessage", latched=True)
        scan = bag.topic("/scan", "sensor_msgs/msg/LaserScan")
        bag.add(fixed, 0, moved(0, "base_link", "laser", (0.2, 0.0, math.pi / 2)))
        for step in range(21):
            stamp, x = 100_000_000 * step, 1.0 + 0.1 * step
            shift = 0.5 if corrected else 0.0
            bag.add(tf, stamp, moved(stamp, "odom", "base_link", (x - shift, 2.0, 0.0)))
            if corrected and step == 0:
                bag.add(tf, stamp, moved(stamp, "map", "odom", (shift, 0.0, 0.0)))
            angles = math.pi / 2 + np.linspace(-math.pi, math.pi, 181)
            cosine, sine = np.cos(angles), np.sin(angles)
            with np.errstate(divide="ignore"):
                across = np.where(cosine > 0, (6.0 - x - 0.2) / cosine, -(x + 0.2) / cosine)
                along = np.where(sine > 0, 2.0 / sine, -2.0 / sine)
            ranges = np.minimum(across, along)
            ranges[::2] = 30.0
            ranges[::4] = 40.0
            beams = (-math.pi, math.pi, math.tau / 180)
            message = messages.scan(stamp, "laser", beams, (0.05, 30.0), 0.1, ranges.astype(np.float32))
            bag.add(scan, stamp, message)


@pytest.mark.parametrize("corrected", [False, True])
def test_poses_come_from_transforms_where_there_is_no_odometry(corrected: bool) -> None:
    write_transforms("b", corrected)
    imported = import_bag("b", "s.yaml", BagOptions(step_time=0.1))
    assert (imported.poses, imported.scans, imported.notes) == (21, 21, [])
    result = irsim.run("s.yaml", seed=1, record=True)
    trace = open_run(str(result.run_id)).trace()
    np.testing.assert_allclose(trace.pose[0, 0, :2], [1.0, 2.0], atol=1e-3)
    np.testing.assert_allclose(trace.pose[20, 0, :2], [3.0, 2.0], atol=0.02)
    world = read("s.yaml").scenario.world
    size = [world.width, world.height]
    np.testing.assert_allclose(size, [8.0, 6.0], atol=0.15)  # the walls and 1 m around them: nothing at 30 m


def test_beams_without_a_return_clear_as_far_as_asked() -> None:
    write_transforms("b", False)
    free = []
    for reach in (1.0, 3.0):
        import_bag("b", "s.yaml", BagOptions(range_max=reach), overwrite=True)
        free.append(int((np.asarray(Image.open("s.png")) == 254).sum()))
    assert free[0] < 0.6 * free[1]
    with pytest.raises(ArgumentError, match="range_max must be a positive number"):
        import_bag("b", "none.yaml", BagOptions(range_max=-1.0))


@pytest.mark.foreign
def test_a_log_of_others_becomes_a_map_with_its_walls(foreign: Path) -> None:
    imported = import_bag(foreign / "bags" / "csail.bag", "csail.yaml")
    assert (imported.poses, imported.scans) == (406, 406)
    grey = np.asarray(Image.open("csail.png"))
    height, width = np.array(grey.shape) * 0.05
    assert 56 <= width <= 62
    assert 80 <= height <= 90
    assert (grey == 0).sum() > 5000  # its walls


def write_first_bag(file: Path) -> None:
    """A bag of ROS 1: a robot drives straight on for a second."""
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    types = {name.split("/")[-1]: made for name, made in store.types.items() if name.startswith(("geometry_", "std_"))}
    kind = "nav_msgs/msg/Odometry"
    with Writer(file) as bag:
        topic = bag.add_connection("/odom", kind, typestore=store)
        for step in range(20):
            stamp = store.types["builtin_interfaces/msg/Time"](1, 50_000_000 * step)
            pose = types["Pose"](types["Point"](0.05 * step, 1.0, 0.0), types["Quaternion"](0.0, 0.0, 0.0, 1.0))
            zero = types["Vector3"](0.0, 0.0, 0.0)
            message = store.types[kind](
                types["Header"](step, stamp, "odom"), "base_link",
                types["PoseWithCovariance"](pose, np.zeros(36)),
                types["TwistWithCovariance"](types["Twist"](zero, zero), np.zeros(36)),
            )  # fmt: skip
            bag.write(topic, 10**9 + 50_000_000 * step, store.serialize_ros1(message, kind))


def test_a_bag_of_ros_1() -> None:
    write_first_bag(Path("drive.bag"))
    imported = import_bag("drive.bag", "s.yaml", BagOptions(step_time=0.05))
    assert (imported.poses, imported.duration) == (20, pytest.approx(0.95))
    assert irsim.run("s.yaml").robots[0].path_length == pytest.approx(0.95, abs=0.06)
