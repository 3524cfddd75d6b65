"""Messages that come in between two steps, as feedback: commands, goals, starts, scans, odometry."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.ros.backends.base import Backend
from irsim.bridges.ros.guard import ZERO, Velocity
from irsim.bridges.ros.incoming import (
    Arrival,
    Inbox,
    MessageError,
    decode,
    fitted_ranges,
    read_goal,
    read_odometry,
    read_scan,
    read_twist,
)
from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.real import Pose, RealRobots
from irsim.bridges.ros.topics import Topic
from irsim.bridges.state import Feedback
from irsim.common.text import clean
from irsim.components.bridges._ros import RosOptions
from irsim.simulation.scene import SceneObject

__all__ = ["Receiver", "Reports"]

_MAX_KINDS = 100
"""Reasons that are told apart; what a peer sends must not fill the memory."""


def _print(text: str) -> None:
    print(text, file=sys.stderr)


class Reports:
    """Counts problems of messages.

    Args:
        name: Name of the bridge.
        say: Shows a line; default: on standard error.

    Attributes:
        counts: Topic and problem -> how often it occurred.
        heard: Sentence of the other program -> how often it came.
    """

    def __init__(self, name: str, say: Callable[[str], None] = _print) -> None:
        self.counts: Counter[tuple[str, str]] = Counter()
        self.heard: Counter[str] = Counter()
        self._name, self._say = name, say

    def add(self, topic: str, problem: str) -> None:
        """Count a problem; the first one of each kind is shown."""
        key = (topic, clean(problem, 200))
        if key not in self.counts:
            if len(self.counts) >= _MAX_KINDS:
                key = ("", "further problems")
            self._say(f"{self._name}: {topic}: {key[1]}; the message is ignored")
        self.counts[key] += 1

    def hear(self, sentence: str) -> None:
        """Count what the other program says; the first time it is shown."""
        text = clean(sentence, 300)
        if text not in self.heard:
            if len(self.heard) >= _MAX_KINDS:
                return
            self._say(f"{self._name}: {text}")
        self.heard[text] += 1

    def finish(self) -> None:
        """Say how often repeated problems occurred."""
        for (topic, problem), count in self.counts.items():
            if count > 1:
                self._say(f"{self._name}: {topic}: {count} times: {problem}")


class Receiver:
    """Reads messages and keeps what they say until the next step.

    Args:
        options: Options of the bridge.
        messages: Reads CDR.
        robots: The robots of the bridge; topics of the scene mean the first one.
        reports: Where problems are counted.
        real: The robots if they are real ones.
    """

    def __init__(
        self, options: RosOptions, messages: Messages, robots: Sequence[SceneObject], reports: Reports,
        real: RealRobots | None,
    ) -> None:  # fmt: skip
        self._options, self._messages, self._reports, self._real = options, messages, reports, real
        self._first = robots[0].name if robots else None
        self._lidars = {lidar.key: lidar for robot in robots for lidar in robot.lidars}
        self._commands: dict[str, tuple[Velocity, float]] = {}
        self._goals: dict[str, Pose] = {}
        self._starts: dict[str, Pose] = {}
        self._ranges: dict[str, tuple[NDArray[np.float32], float]] = {}

    def receive(self, backend: Backend, inbox: Inbox) -> None:
        """Read what has come since the last call."""
        backend.poll()
        for sentence in inbox.told():
            self._reports.hear(sentence)
        for topic, arrival in inbox.take().items():
            try:
                self._read(topic, arrival)
            except MessageError as error:
                self._reports.add(topic.name, str(error))

    def feedback(self) -> Feedback:
        """Commands, goals, starts and ranges to apply before a step."""
        goals, self._goals = self._goals, {}
        starts, self._starts = self._starts, {}
        return Feedback(
            commands=self._fresh_commands(), goals=goals, starts=starts if self._real is None else {},
            ranges=self._fresh_ranges(),
        )  # fmt: skip

    def _read(self, topic: Topic, arrival: Arrival) -> None:
        message = decode(self._messages, topic, arrival.content)
        robot = topic.robot or self._first
        if robot is None:
            raise MessageError("there is no robot")
        if topic.key == "cmd_vel":
            self._commands[robot] = (read_twist(message), arrival.when)
        elif topic.key in ("goal_pose", "robot_goal_pose"):
            self._goals[robot] = read_goal(message, self._options.frame)
        elif topic.key in ("initialpose", "robot_initialpose"):
            pose = read_goal(message, self._options.frame)
            if self._real is None:
                self._starts[robot] = pose
            else:
                self._real.relocate(robot, pose)
        elif topic.key == "odom" and self._real is not None:
            self._real.take(robot, read_odometry(message), arrival.when)
        elif topic.key == "scan" and topic.lidar is not None:
            self._ranges[topic.lidar] = (fitted_ranges(read_scan(message), self._lidars[topic.lidar]), arrival.when)
            if self._real is not None:
                self._real.take_scan(robot, topic.lidar, arrival.when)

    def _fresh_commands(self) -> dict[str, Velocity]:
        """Commands of robots that have got some; zero if the last one is too old."""
        oldest = time.monotonic() - self._options.command_timeout
        result = {}
        for name, (command, when) in list(self._commands.items()):
            if when >= oldest:
                result[name] = command
            elif self._options.after_command == "stop":
                result[name] = ZERO
            else:
                del self._commands[name]
        return result

    def _fresh_ranges(self) -> dict[str, NDArray[np.float32]]:
        """Scans that are not older than odometry may be."""
        oldest = time.monotonic() - self._options.odom_timeout
        return {key: ranges for key, (ranges, when) in self._ranges.items() if when >= oldest}
