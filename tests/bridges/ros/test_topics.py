"""The table of topics, and the names in it."""

from __future__ import annotations

import pytest

from irsim.bridges.base import BridgeError
from irsim.bridges.options import read_bridge
from irsim.bridges.ros.bridge import RosBridge
from irsim.bridges.ros.topics import TABLE, Qos, ros_names, scene_topics
from irsim.simulation.scene import Lidar, SceneDescription, SceneObject


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
    found = names()
    assert found["/robot_0/scan"] == found["/robot_0/scan_1"] == found["/object_7/scan"] == "out LaserScan"
    assert found["/robot_0/cmd_vel"] == "in Twist"
    assert found["/clock"] == "out Clock"
    assert "/ann/odom" not in found


def test_a_name_that_fits_stays_as_it_is() -> None:
    given = ["robot 1", "robot_1", "rob__ot", "机器人", "object", "3po", "a_", "tb3_0"]
    assert ros_names(given) == ["robot_1_2", "robot_1", "rob_ot", "object_2", "object", "object_3po", "a", "tb3_0"]


def test_real_robots_turn_odometry_scans_and_commands_around() -> None:
    found = names("real", stamped=True)
    assert found["/robot_0/odom"] == "in Odometry"
    assert found["/robot_0/scan"] == "in LaserScan"
    assert found["/robot_0/cmd_vel"] == "out TwistStamped"
    assert not {"/clock", "/tf_static"} & found.keys()  # the robots' own


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
