"""The table of topics, options of the bridges, and bodies and maps as messages, without the libraries of ROS."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

import irsim
from irsim.bridges.base import BridgeError
from irsim.bridges.export.formats import _ros_run
from irsim.bridges.options import read_bridge
from irsim.bridges.ros.backends.base import Node
from irsim.bridges.ros.backends.opening import open_backend
from irsim.bridges.ros.bridge import RosBridge
from irsim.bridges.ros.incoming import Inbox
from irsim.bridges.ros.outgoing import body_markers
from irsim.bridges.ros.topics import TABLE, Qos, ros_names, scene_topics
from irsim.common.extras import ExtraError
from irsim.components.bridges._ros import TOPIC_KEYS, TOPIC_NAME
from irsim.components.bridges.ros2 import Ros2
from irsim.diagnostics.errors import ScenarioError
from irsim.objects.describe import describe_scene
from irsim.simulation.scene import Lidar, SceneDescription, SceneObject
from tests.bridges.scenes import environment


def agent(index: int, name: str, role: str = "robot", lidars: int = 0) -> SceneObject:
    mounted = tuple(Lidar(f"{name}/{k}", k, (0.1, 0, 0), -1, 1, 5, 0, 3, 0.1) for k in range(lidars))
    return SceneObject(index, name, role, "diff", True, (1.0, 2.0, 0.0), (), (), 0.2, (-1, -1), (1, 1), (9, 9), None,
                       1.0, (0, 0, 0), mounted)  # type: ignore[arg-type]  # fmt: skip


SCENE = SceneDescription(
    "lab", 0.1, (0, 0), (9, 9), (agent(0, "robot 0", lidars=2), agent(1, "7", lidars=1), agent(2, "ann", "obstacle"))
)


def names(mode: str = "sim", **more: object) -> dict[str, str]:
    topics = scene_topics(SCENE, SCENE.robots, mode, **{"names": {}, "qos": {}, **more})  # type: ignore[arg-type]
    return {topic.name: f"{'out' if topic.outgoing else 'in'} {topic.kind.split('/')[-1]}" for topic in topics}


def test_each_robot_and_each_lidar_has_its_topics() -> None:
    topics = names()
    assert topics["/robot_0/scan"] == topics["/robot_0/scan_1"] == topics["/object_7/scan"] == "out LaserScan"
    assert topics["/robot_0/cmd_vel"] == "in Twist"
    assert topics["/clock"] == "out Clock"
    assert "/ann/odom" not in topics


def test_a_name_that_fits_stays_as_it_is() -> None:
    given = ["robot 1", "robot_1", "rob__ot", "机器人", "object", "3po", "a_", "tb3_0"]
    assert ros_names(given) == ["robot_1_2", "robot_1", "rob_ot", "object_2", "object", "object_3po", "a", "tb3_0"]


def test_real_robots_turn_odometry_scans_and_commands_around() -> None:
    topics = names("real", stamped=True)
    assert topics["/robot_0/odom"] == "in Odometry"
    assert topics["/robot_0/scan"] == "in LaserScan"
    assert topics["/robot_0/cmd_vel"] == "out TwistStamped"
    assert not {"/clock", "/tf_static"} & topics.keys()  # the robots' own


def test_names_and_qualities_can_be_others() -> None:
    topics = scene_topics(
        SCENE, SCENE.robots[:1], "sim", names={"cmd_vel": "/cmd_vel", "tf": None, "scan": "/{robot}/front{n}"},
        qos={"scan": Qos(reliable=True)},
    )  # fmt: skip
    by_name = {topic.name: topic for topic in topics}
    assert "/cmd_vel" in by_name
    assert "/tf" not in by_name
    assert by_name["/robot_0/front_1"].qos.reliable
    assert not TABLE["scan"].qos.reliable


@pytest.mark.parametrize(("name", "words"), [("cmd vel", "cannot be the name"), ("/cmd_vel", "two topics are called")])
def test_names_that_cannot_be_are_refused(name: str, words: str) -> None:
    with pytest.raises(BridgeError, match=words):
        names(names={"cmd_vel": name})


def test_what_has_no_effect_on_simulated_robots_is_said() -> None:
    given = read_bridge("{name: ros2, dry_run: false, max_speed: 1}")
    assert RosBridge(given).notes() == ["ros2: dry_run, max_speed had no effect: no robot is real without mode: real"]
    assert RosBridge(read_bridge("ros2")).notes() == []
    assert RosBridge(read_bridge("{name: ros2, mode: real}")).notes() == []


PAGE = Path(__file__).parents[3] / "skills" / "irsim-runner" / "bridges" / "ros2.md"
WORLD = "world: {width: 5, height: 5}\nrobot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}}\n"


def test_the_scenario_of_the_page_is_valid_and_all_topics_are_in_its_table() -> None:
    text = PAGE.read_text()
    [scenario] = re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)
    report = irsim.validate(text=scenario)
    assert report.valid, report
    assert report.summary.startswith("valid: 1 robot")
    assert [key for key in TABLE if f"`{key}`" not in text] == []


@pytest.mark.parametrize(
    ("bridge", "words"),
    [
        ("{name: ros2, mode: real, clock: irsim}", "real robots move in real time"),
        ("{name: ros2, clock: external}", "ROS does not decide"),
        ("{name: ros2, mode: real, odom_timeout: 2, lost_timeout: 1}", "lost_timeout is below"),
        ("{name: ros2, domain: 500}", "101"),
        ("{name: ros2, max_speed: -1}", "0"),
        ("{name: rosbag, folder: ../../etc/bag}", "folder"),
        ("{name: rosbridge, host: 'a b'}", "host"),
        ("{name: ros2, backend: rospy}", "rclpy"),
        ("{name: ros2, topics: {cmd_val: /cmd_vel}}", "did you mean cmd_vel"),
        ("{name: ros2, topics: {xyz: null}}", "they are clock, tf, "),
        ("{name: rosbag, qos: {skan: {depth: 2}}}", "did you mean scan"),
        ("{name: ros2, topics: {odom: odom}}", "cannot be the name of a topic"),
        ("{name: ros2, robots: [robto_0]}", "write robot_0"),
        ("{name: json_lines, agents: [me], answers: true}", "no object is called 'me'"),
        ("{name: mujoco, report: hall.yaml}", "report: report.json"),  # it would be overwritten
        ("{name: mujoco, agents: [me]}", "no object is called 'me'"),
        ("{name: carla, follow: {me: 3}}", "no object is called 'me'"),
        ("{name: carla, lidar: {low: 3}}", "low must be below high"),
        ("{name: carla, lidar: {lower: 5}}", "lower must not be above upper"),
        ("{name: carla, command: fly}", "'fly'"),
        ("{name: carla, port: 65535}", "65534"),
        ("{name: carla, wheelbase: 0}", "wheelbase"),
        ("{name: carla, ground: roof}", "roof"),
    ],
)
def test_wrong_options_are_named_with_their_line(bridge: str, words: str) -> None:
    Path("a.yaml").write_text(f"{WORLD}bridges: [{bridge}]\n")
    with pytest.raises(ScenarioError, match=words) as error:
        irsim.make("a.yaml", display=False)
    paths = [item.path[:2] for item in error.value.diagnostics if item.severity == "error"]
    assert paths == [("bridges", 0)] * (2 if "ground" in bridge else 1)  # it is a word or a number
    assert "3:" in str(error.value)


def test_the_keys_of_topics_are_those_of_the_table() -> None:
    assert tuple(TABLE) == TOPIC_KEYS
    told = str(Ros2.__doc__)
    assert [key for key in TABLE if not re.search(rf"\b{key}\b", told)] == []
    assert all(TOPIC_NAME.fullmatch(row.name) for row in TABLE.values())


@pytest.mark.parametrize(
    ("bridge", "extra"),
    [("ros2, backend: dds", "ros2"), ("ros2, backend: zenoh", "zenoh"), ("rosbridge", "rosbridge"), ("rosbag", "bag")],
)
def test_a_missing_library_is_named(bridge: str, extra: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim.common.extras.find_spec", lambda name: None)
    env = environment(f"{WORLD}bridges: [{{name: {bridge}}}]\n")
    with pytest.raises(ExtraError, match=re.escape(f"pip install 'irsim-mcp[{extra}]'")):
        irsim.connect(env)


@pytest.mark.parametrize(
    ("name", "value", "stays"),
    [
        ("ROS_LOCALHOST_ONLY", "1", True), ("ROS_LOCALHOST_ONLY", "0", False),
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST", True), ("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET", False),
    ],
)  # fmt: skip
def test_variables_of_ros_keep_a_node_here(name: str, value: str, stays: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    loopbacks = []
    backend = SimpleNamespace(DdsBackend=lambda node, domain, loopback: loopbacks.append(loopback))
    monkeypatch.setitem(sys.modules, "irsim.bridges.ros.backends.dds", backend)
    for variable in ("ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv(name, value)
    open_backend(Ros2(backend="dds", domain=3), Node("node", [], Inbox(), None))  # type: ignore[arg-type]
    assert loopbacks == [stays]


BODIES = """
world: {width: 4, height: 2, obstacle_map: {name: ros, path: map.yaml}}
robot: {name: rover, kinematics: {name: omni}, shape: {name: circle, radius: 0.2, center: [0.1, 0]},
  state: [1, 0.5, 1.5707963], goal: [3, 0.5], color: red}
obstacle:
  - {shape: {name: circle, radius: 0.3, center: [0.5, 0]}, state: [3, 0.5, 1.5707963], color: blue}
  - {shape: {name: linestring, vertices: [[0, 0], [1, 0], [1, 0.5]]}, state: [0, 1, 0]}
  - {shape: {name: polygon, vertices: [[0, 0], [1, 0], [1, 0.5]]}, state: [2, 1, 0]}
"""


class Plain:
    """Makes messages that only hold what they were made of."""

    def __call__(self, package: str, name: str) -> Any:
        return lambda *given, **fields: SimpleNamespace(given=given, **fields)

    def header(self, stamp: int, frame: str) -> str:
        return frame

    def pose(self, x: float, y: float, heading: float) -> Any:
        return SimpleNamespace(at=[x, y, heading], position=SimpleNamespace(z=0.0))

    def vector(self, x: float, y: float, z: float) -> Any:
        return SimpleNamespace(x=x, y=y, z=z)

    def points(self, rows: Any) -> list[list[float]]:
        return np.asarray(rows).tolist()

    def grid(self, stamp: int, frame: str, side: float, origin: Any, levels: Any) -> Any:
        return SimpleNamespace(frame=frame, side=side, origin=origin, levels=levels)


@pytest.fixture
def bodies() -> SceneDescription:
    levels = np.array([[0, 0, 100, 0], [0, 30, 0, 70]], np.uint8)
    Image.fromarray(levels).save("map.pgm")
    Path("map.yaml").write_text("{image: map.pgm, resolution: 1.0, origin: [0, 0, 0], mode: raw}")
    Path("scene.yaml").write_text(BODIES)
    return describe_scene(irsim.make("scene.yaml", headless=True, log_level="ERROR").simulation)


@pytest.mark.parametrize("kind", ["live", "recorded"])
def test_each_body_is_a_marker_where_it_is(bodies: SceneDescription, kind: str) -> None:
    frames: Any = {"rover": "rover/base"}
    made = body_markers(Plain(), bodies, frames, "map", united=kind == "recorded")  # type: ignore[arg-type]
    markers = [marker for marker in made.given[0] if marker.ns == "bodies"]
    rover, disk, line, area = markers
    assert [marker.type for marker in markers] == [3, 3, 4, 11]
    assert [marker.header for marker in markers] == ["rover/base", "map", "map", "map"]
    assert (rover.scale.x, disk.scale.y) == pytest.approx((0.4, 0.6)), "scales are diameters"
    assert rover.pose.at == pytest.approx([0.1, 0, 0]), "in its own frame"
    assert disk.pose.at == pytest.approx([3, 1, 1.5707963], abs=1e-4), "in the world"
    assert rover.color.given == (1, 0, 0, 1)
    assert disk.color.given == (0, 0, 1, 1)
    assert line.points == [[0, 0], [1, 0], [1, 0.5]]
    assert sorted(area.points) == [[0, 0], [1, 0], [1, 0.5]]
    assert [marker.text for marker in made.given[0] if marker.ns == "names"] == ["rover"]


def test_a_grid_keeps_the_levels_of_its_map(bodies: SceneDescription) -> None:
    grid = _ros_run.occupancy_grid(Plain(), bodies, "map")  # type: ignore[arg-type]
    assert (grid.side, grid.origin) == (1, (0, 0))
    assert grid.levels.tolist() == [[0, 0], [30, 0], [0, 100], [70, 0]], "(nx, ny), from below"
