"""Input from outside, right or wrong, and commands to real robots."""

from __future__ import annotations

import json
import math
import queue
import sys
import threading
import time
from collections.abc import Callable, Iterator
from types import SimpleNamespace as N
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from irsim.bridges.base import BridgeLostError
from irsim.bridges.ros import guard
from irsim.bridges.ros.guard import ZERO, Limits, limited
from irsim.bridges.ros.incoming import (
    MAX_BYTES,
    Inbox,
    MessageError,
    Odometry,
    Scan,
    decode,
    fitted_ranges,
    read_goal,
    read_odometry,
    read_scan,
    read_twist,
)
from irsim.bridges.ros.real import RealRobots, composed, inverted
from irsim.bridges.ros.receiver import Receiver, Reports
from irsim.bridges.ros.topics import STATE, Topic
from irsim.bridges.state import Motion
from irsim.components.bridges.ros2 import Ros2
from irsim.options.base import Options
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


def received(options: Ros2, *contents: tuple[Topic, Any]) -> tuple[Receiver, Reports, list[str]]:
    """A receiver that has received contents one after the other, its reports, and what they said."""
    inbox, said = Inbox(), list[str]()
    reports = Reports("ros2", said.append)
    receiver = Receiver(options, N(), SCENE.robots, reports, None)  # type: ignore[arg-type]
    for topic, content in contents:
        inbox.put(topic, content)
        receiver.receive(N(poll=lambda: None), inbox)  # type: ignore[arg-type]
    return receiver, reports, said


def test_commands_and_goals_become_feedback() -> None:
    receiver, _, said = received(Ros2(), (COMMANDS, twist(0.5)), (GOALS, pose(4.0, 1.0)))
    feedback = receiver.feedback()
    assert feedback.commands == {"robot 0": (0.5, 0, 0)}
    assert feedback.goals == {"robot 0": pytest.approx((4, 2, 1))}  # the first robot
    assert receiver.feedback().goals == {}
    assert said == []


def test_an_old_command_is_a_stop_or_gives_way_to_the_behavior() -> None:
    for after, commands in (("stop", {"robot 0": (0, 0, 0)}), ("behavior", {})):
        receiver, _, _ = received(Ros2(command_timeout=0.01, after_command=after), (COMMANDS, twist(0.5)))
        time.sleep(0.03)
        assert receiver.feedback().commands == commands


def test_wrong_messages_are_reported_once_and_counted() -> None:
    receiver, reports, said = received(Ros2(), *[(COMMANDS, twist(math.nan))] * 5)
    assert receiver.feedback().commands == {}
    reports.finish()
    assert said == [
        "ros2: /robot_0/cmd_vel: the velocity is nan; the message is ignored",
        "ros2: /robot_0/cmd_vel: 5 times: the velocity is nan",
    ]


LIMITS = Limits(0.5, 1.0, 1.0, 3.0)
NUMBERS = st.floats(-10, 10)
POSES = st.tuples(NUMBERS, NUMBERS, st.floats(-3, 3))


@given(st.tuples(NUMBERS, NUMBERS, NUMBERS))
def test_commands_never_exceed_the_limits(target: tuple[float, float, float]) -> None:
    command = ZERO
    for _ in range(60):
        before, command = command, limited(target, command, LIMITS, 0.05)
        assert math.hypot(*command[:2]) <= 0.5 + 1e-9
        assert abs(command[2]) <= 1 + 1e-9
        assert math.hypot(command[0] - before[0], command[1] - before[1]) <= 0.05 + 1e-9
    if math.hypot(*target[:2]) > 0.5 and 1e-3 < abs(target[2]) < math.hypot(*target[:2]):
        # slower as a whole: the arc stays
        assert command[2] / math.hypot(*command[:2]) == pytest.approx(target[2] / math.hypot(*target[:2]), rel=1e-6)


@pytest.mark.parametrize("target", [(0, 0, 0), (math.nan, 0, 0), (0.1, math.inf, 0), (1,), ()])
def test_a_stop_is_immediate_and_what_is_not_finite_is_one(target: tuple[float, ...]) -> None:
    assert limited(target, (0.5, 0, 1), LIMITS, 0.05) == ZERO


@given(POSES, POSES)
def test_poses_compose_and_invert(first: tuple[float, ...], second: tuple[float, ...]) -> None:
    again = composed(inverted(first), composed(first, second))
    assert again[:2] == pytest.approx(second[:2], abs=1e-9)
    assert math.cos(again[2] - second[2]) == pytest.approx(1)


def robots(**options: Any) -> RealRobots:
    made = RealRobots(Ros2(mode="real", **options), 0.1)
    made.add(SCENE.robots[:1])  # it starts at (1, 2, 0)
    return made


def motion(turn: float = 0.0) -> Motion:
    twist = np.tile([0.3, 0.0, turn], (3, 1))
    return Motion(5, 0.5, np.zeros((3, 3)), np.array([[1.0, 2.0, 0.1 * turn]] * 3), twist)


def test_odometry_begins_at_the_start_in_the_scenario() -> None:
    fleet = robots()
    fleet.take("robot 0", Odometry((50.0, 0.0, math.pi / 2), (0.2, 0, 0)), 10.0)
    assert fleet.poses()["robot 0"] == pytest.approx((1, 2, 0))
    fleet.take("robot 0", Odometry((50.0, 1.0, math.pi / 2), (0.2, 0, 0)), 10.0)  # one metre ahead
    assert fleet.poses()["robot 0"] == pytest.approx((2, 2, 0))
    fleet.relocate("robot 0", (5.0, 5.0, 1.0))
    assert fleet.poses()["robot 0"] == pytest.approx((5, 5, 1))
    in_world = robots(odom_origin="world")
    in_world.take("robot 0", Odometry((3.0, 4.0, 0.5), (0, 0, 0)), 10.0)
    assert in_world.poses()["robot 0"] == pytest.approx((3, 4, 0.5))


def test_old_odometry_is_a_zero_command_and_then_the_end() -> None:
    fleet = robots(odom_timeout=0.5, lost_timeout=3)
    fleet.take("robot 0", Odometry((0.0, 0.0, 0.0), (0.2, 0, 0)), 10.0)
    assert fleet.commands(motion(), 10.4)["robot 0"] == pytest.approx((0.3, 0, 0))
    assert fleet.commands(motion(2.0), 10.4)["robot 0"] == pytest.approx((0.3, 0, 2))  # at the heading of the start
    assert fleet.commands(motion(), 10.6) == {"robot 0": ZERO}
    assert fleet.twists(10.6)["robot 0"] == ZERO
    assert "zero commands in 1 steps" in fleet.notes()[0]
    fleet.take("robot 0", Odometry((0.0, 0.0, 0.0), (0.2, 0, 0)), 11.0)
    fleet.take_scan("robot 0", "robot 0/0", 10.4)
    assert fleet.commands(motion(), 11.0) == {"robot 0": ZERO}  # a lidar that measured once has to go on
    fleet.take_scan("robot 0", "robot 0/0", 10.9)
    assert fleet.commands(motion(), 11.0)["robot 0"] == pytest.approx((0.3, 0, 0))
    with pytest.raises(BridgeLostError, match=r"no odometry of 'robot 0' for 3\.1 s"):
        fleet.commands(motion(), 14.1)


class Pipe:
    """Lines that come when they are written, until it is closed."""

    def __init__(self) -> None:
        self._lines: queue.SimpleQueue[str] = queue.SimpleQueue()
        self.readline = self._lines.get

    def say(self, content: object) -> None:
        self._lines.put(json.dumps(content) + "\n")

    def end(self) -> None:
        self._lines.put("")

    def __iter__(self) -> Iterator[str]:
        return iter(self.readline, "")


def until(holds: Callable[[], bool], seconds: float) -> None:
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.005)


def test_the_guard_sends_zeros_when_nothing_comes_and_when_all_ends(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    sent: list[tuple[float, float]] = []
    backend = N(ready=True, close=lambda: sent.append((0, -1)))
    backend.publish = lambda topic, said: sent.append((time.monotonic(), said[0]))
    monkeypatch.setattr(guard, "make_messages", lambda options: N(command=lambda kind, stamp, frame, speed: speed))
    monkeypatch.setattr(guard, "open_backend", lambda *arguments: backend)
    monkeypatch.setattr(guard.signal, "signal", lambda *arguments: None)
    options: Options = Ros2(mode="real", command_timeout=0.2, command_rate=100, max_acceleration=100)
    topic = {"key": "cmd_vel", "name": "/cmd_vel", "kind": "geometry_msgs/msg/Twist", "outgoing": True,
             "qos": {"depth": 1}, "robot": "rover"}  # fmt: skip
    pipe = Pipe()
    pipe.say({"options": options.model_dump(mode="json"), "topics": [topic]})
    thread = threading.Thread(target=guard.main, args=(pipe,))
    thread.start()
    pipe.say({"rover": [9.0, 0.0, 0.0]})
    began = time.monotonic()
    until(lambda: any(speed == 0.5 for _, speed in list(sent)), 5)  # limited to max_speed
    until(lambda: sent[-1][1] == 0.0, 5)
    last = max(when for when, speed in sent if speed == 0.5)
    assert last - began < 0.2 + 0.3
    pipe.say({"rover": [0.2, 0.0, 0.0]})
    until(lambda: sent[-1][1] == 0.2, 5)
    backend.ready = False  # the connection is made anew: what is dropped was not driven
    pipe.say({"rover": [0.3, 0.0, 0.0]})
    until(lambda: sent[-1][1] == 0.0, 0.15)  # before the command is too old
    pipe.end()
    thread.join(10)
    assert not thread.is_alive()
    assert [speed for _, speed in sent[-11:]] == [0.0] * 10 + [-1]
    assert capsys.readouterr().out == "ready\n"
    assert "rospy" not in sys.modules
