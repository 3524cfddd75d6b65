"""Input from outside: right values, and wrong ones that are named and ignored."""

from __future__ import annotations

import math
import time
from types import SimpleNamespace as N
from typing import Any

import numpy as np
import pytest

from irsim.bridges.ros.incoming import (
    MAX_BYTES,
    Inbox,
    MessageError,
    Scan,
    decode,
    fitted_ranges,
    read_goal,
    read_odometry,
    read_scan,
    read_twist,
)
from irsim.bridges.ros.receiver import Receiver, Reports
from irsim.bridges.ros.topics import STATE, Topic
from irsim.components.bridges.ros2 import Ros2
from irsim.simulation.scene import Lidar
from tests.bridges.ros.test_topics import SCENE

COMMANDS = Topic("cmd_vel", "/robot_0/cmd_vel", "geometry_msgs/msg/Twist", False, STATE, "robot 0")
GOALS = Topic("goal_pose", "/goal_pose", "geometry_msgs/msg/PoseStamped", False, STATE)


def twist(x: Any, turn: Any = 0.0) -> N:
    return N(linear=N(x=x, y=0.0, z=0.0), angular=N(x=0.0, y=0.0, z=turn))


def pose(x: Any, yaw: float = 0.0, frame: str = "map", scale: float = 1.0) -> N:
    turn = N(x=0.0, y=0.0, z=scale * math.sin(yaw / 2), w=scale * math.cos(yaw / 2))
    return N(header=N(frame_id=frame), pose=N(position=N(x=x, y=2.0, z=0.0), orientation=turn))


def test_values_are_read() -> None:
    assert read_twist(twist(0.5, -1)) == (0.5, 0, -1)
    assert read_twist(N(header=None, twist=twist(0.5))) == (0.5, 0, 0)
    assert read_goal(pose(1.0, 2.5), "map") == pytest.approx((1, 2, 2.5))
    odometry = read_odometry(N(pose=N(pose=pose(1.0, -3).pose), twist=N(twist=twist(0.1))))
    assert odometry.pose == pytest.approx((1, 2, -3))
    assert odometry.velocity == (0.1, 0, 0)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: read_twist(twist(math.nan)), "the velocity is nan"),
        (lambda: read_twist(twist(math.inf)), "the velocity is inf"),
        (lambda: read_twist(twist(None)), "not a number"),
        (lambda: read_twist(twist("fast")), "not a number"),
        (lambda: read_twist(twist(True)), "not a number"),
        (lambda: read_twist(twist(1e30)), "greater than"),
        (lambda: read_twist(N(linear=3)), "angular is missing"),
        (lambda: read_twist(N(linear=N(x=0, y=0), angular="fast")), "field angular.z is missing"),
        (lambda: read_goal(pose(1.0, frame="odom"), "map"), "frame 'odom', not in the fixed frame 'map'"),
        (lambda: read_goal(pose(math.nan), "map"), "the position is nan"),
        (lambda: read_goal(pose(1.0, scale=0.5), "map"), "not a unit quaternion"),
        (lambda: read_scan(N(ranges="x" * 9)), "not a list"),
        (lambda: read_scan(N(ranges=[])), "1 to 100000 beams, got 0"),
        (lambda: read_scan(N(ranges=[[1], [2]], angle_min=0, angle_increment=1, range_min=0, range_max=1)), "a list"),
    ],
)  # fmt: skip
def test_wrong_values_are_named(call: Any, words: str) -> None:
    with pytest.raises(MessageError, match=words):
        call()


def test_bytes_that_are_no_message_are_named() -> None:
    def fail(content: bytes, kind: str) -> None:
        raise IndexError

    with pytest.raises(MessageError, match="3 bytes are not a geometry_msgs/msg/Twist"):
        decode(N(from_cdr=fail), COMMANDS, b"abc")  # type: ignore[arg-type]


def test_scans_of_other_lidars_fit_by_direction() -> None:
    lidar = Lidar("a/0", 0, (0, 0, 0), -math.pi / 2, math.pi / 2, 3, 0.1, 5.0, 0.1)
    # a full turn that begins at the back: 0 is behind, 4 ahead
    ranges = np.arange(1, 9, dtype=np.float32)
    scan = Scan(-math.pi, math.pi / 4, ranges, 0.0, 10.0)
    assert fitted_ranges(scan, lidar).tolist() == [3, 5, math.inf]  # right, ahead; 7 m is beyond the lidar's range
    upside_down = Scan(math.pi, -math.pi / 4, ranges, 0.0, 10.0)
    assert fitted_ranges(upside_down, lidar).tolist() == [math.inf, 5, 3]
    narrow = Scan(-0.1, 0.1, np.float32([1, math.nan, 1]), 0.0, 10.0)
    assert fitted_ranges(narrow, lidar).tolist() == [math.inf] * 3


def test_a_flood_keeps_the_newest_message_only() -> None:
    inbox = Inbox()
    for number in range(100_000):
        inbox.put(COMMANDS, number)
    inbox.put(GOALS, b"x" * (MAX_BYTES + 1))
    assert [arrival.content for arrival in inbox.take().values()] == [99_999]
    assert (inbox.received, inbox.overwritten, inbox.refused) == (100_001, 99_999, 1)
    assert inbox.take() == {}


def received(options: Ros2, *contents: tuple[Topic, Any], wait: float = 0.0) -> tuple[Any, Receiver, list[str]]:
    inbox, said = Inbox(), list[str]()
    receiver = Receiver(options, N(), SCENE.robots, Reports("ros2", said.append), None)  # type: ignore[arg-type]
    for topic, content in contents:
        inbox.put(topic, content)
    receiver.receive(N(poll=lambda: None), inbox)  # type: ignore[arg-type]
    time.sleep(wait)
    return receiver.feedback(), receiver, said


def test_commands_and_goals_become_feedback() -> None:
    feedback, receiver, said = received(Ros2(), (COMMANDS, twist(0.5)), (GOALS, pose(4.0, 1.0)))
    assert feedback.commands == {"robot 0": (0.5, 0, 0)}
    assert feedback.goals == {"robot 0": pytest.approx((4, 2, 1))}  # the first robot
    assert receiver.feedback().goals == {}
    assert said == []


def test_an_old_command_is_a_stop_or_gives_way_to_the_behavior() -> None:
    feedback, _, _ = received(Ros2(command_timeout=0.01), (COMMANDS, twist(0.5)), wait=0.03)
    assert feedback.commands == {"robot 0": (0, 0, 0)}
    options = Ros2(command_timeout=0.01, after_command="behavior")
    feedback, _, _ = received(options, (COMMANDS, twist(0.5)), wait=0.03)
    assert feedback.commands == {}


def test_wrong_messages_are_reported_once_and_counted() -> None:
    inbox, said = Inbox(), list[str]()
    reports = Reports("ros2", said.append)
    receiver = Receiver(Ros2(), N(), SCENE.robots, reports, None)  # type: ignore[arg-type]
    for _ in range(5):
        inbox.put(COMMANDS, twist(math.nan))
        receiver.receive(N(poll=lambda: None), inbox)  # type: ignore[arg-type]
    assert receiver.feedback().commands == {}
    reports.finish()
    assert said == [
        "ros2: /robot_0/cmd_vel: the velocity is nan; the message is ignored",
        "ros2: /robot_0/cmd_vel: 5 times: the velocity is nan",
    ]
