"""The bridges ``ros2``, ``ros1``, ``rosbridge`` and ``rosbag``: what they do in each step."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

from irsim.bridges.base import Bridge, BridgeError, BridgeLostError
from irsim.bridges.ros.backends.bag import BagBackend
from irsim.bridges.ros.backends.base import Backend, Node
from irsim.bridges.ros.backends.opening import AnyOptions, make_messages, open_backend
from irsim.bridges.ros.guard import ZERO, Guard, Velocity
from irsim.bridges.ros.incoming import Inbox
from irsim.bridges.ros.outgoing import Outgoing
from irsim.bridges.ros.real import RealRobots
from irsim.bridges.ros.receiver import Receiver, Reports
from irsim.bridges.ros.topics import Mode, Qos, Topic, nanoseconds, ros_names, scene_topics
from irsim.bridges.state import Feedback, Motion, WorldState
from irsim.components.bridges._ros import RosOptions
from irsim.diagnostics.diagnostic import suggestion
from irsim.simulation.scene import SceneDescription, SceneObject

__all__ = ["RosBridge", "make"]

_POLL_S = 0.02
_ZEROS = 5
"""Zero commands that this process sends itself if the process that sends commands is lost."""


def make(options: AnyOptions) -> RosBridge:
    """The bridge of some options."""
    return RosBridge(options)


class RosBridge(Bridge):
    """A node that shows a scene, listens, and drives real robots.

    Attributes:
        options: Its options.
        backend: Its connection, after ``open``.
        topics: Its topics, after ``open``.
    """

    def __init__(self, options: AnyOptions) -> None:
        self.options: Any = options
        self.name = options.name
        self.clock = options.clock
        self.backend: Backend | None = None
        self.topics: tuple[Topic, ...] = ()
        self._mode: Mode = "sim"
        if isinstance(options, RosOptions) and options.mode == "real":
            self._mode, self.mode = "real", "dry-run" if options.dry_run else "real"
        self._began = False
        self._inbox = Inbox()
        self._spelled: dict[str, str] = {}
        self._reports = Reports(self.name)
        self._guard: Guard | None = None
        self._real: RealRobots | None = None
        self._receiver: Receiver | None = None

    @property
    def peer(self) -> str:
        """The node's other side."""
        return self.name if self.backend is None else self.backend.peer

    def open(self, scene: SceneDescription, start: WorldState) -> None:
        """Connect, show what does not change, and wait for real robots."""
        options = self.options
        robots = _chosen(scene, options.robots)
        names = zip(scene.names, ros_names(scene.names), strict=True)
        self._spelled = {name: spelled for name, spelled in names if name != spelled and scene.agent(name) in robots}
        messages = make_messages(options)
        self.topics = self._topics(scene, robots)
        name = options.node if isinstance(options, RosOptions) else "irsim"
        self.backend = open_backend(options, Node(name, self.topics, self._inbox, messages))
        self._messages = messages
        self._outgoing = self._shown(scene)
        if isinstance(options, RosOptions):
            if self._mode == "real":
                self._real = RealRobots(options, scene.step_time)
                self._real.add(robots)
                self.agents = frozenset(robot.name for robot in robots)
            self._receiver = Receiver(options, messages, robots, self._reports, self._real)
        self._publish_once(start)
        if self._real is not None:
            self._wait_for_robots(self._real)
            if not options.dry_run:
                self._guard = Guard(options, self._command_topics())
        self.push(start)

    def renew(self, scene: SceneDescription, start: WorldState) -> None:
        """Show the static things of the new scene instead of the old one's."""
        if gone := {topic.robot for topic in self.topics if topic.robot is not None} - set(scene.names):
            what = f"the scene does not have the robot '{min(gone)}' any more, which has topics"
            raise BridgeError("bridge-mismatch", what, "connect again")
        self._outgoing = self._shown(scene)
        self._publish_once(start)

    def pull(self) -> Feedback | None:
        """Goals, commands to simulated robots, and scans of real ones."""
        self._began = True
        if self._receiver is None or self.backend is None:
            return None
        self._receiver.receive(self.backend, self._inbox)
        return self._receiver.feedback()

    def exchange(self, motion: Motion) -> Feedback | None:
        """Command the real robots, and say where they are."""
        real = self._real
        if real is None or self._receiver is None or self.backend is None:
            return None
        self._receiver.receive(self.backend, self._inbox)
        now = time.monotonic()
        self._command(real.commands(motion, now))
        return Feedback(poses=real.poses(), twists=real.twists(now))

    def push(self, state: WorldState) -> None:
        """Publish the state."""
        stamp = nanoseconds(state.time) if self._mode == "sim" else time.time_ns()
        for topic, message in self._outgoing.step(state, stamp):
            self._publish(topic, message, stamp)

    def notes(self) -> list[str]:
        """Problems of messages from outside, and how often robots had to stop."""
        result = [
            f"{self.name}: {topic}: {count} message(s) ignored: {problem}"
            for (topic, problem), count in self._reports.counts.items()
        ]
        result += [
            f"{self.name}: the topics of '{name}' are below /{spelled}" for name, spelled in self._spelled.items()
        ]
        result += [f"{self.name}: {text} ({count} times)" for text, count in self._reports.heard.items()]
        if self._inbox.refused:
            result.append(f"{self.name}: {self._inbox.refused} messages were too long")
        if self._real is not None:
            result += self._real.notes()
            if self.options.dry_run:
                result.append(f"{self.name}: dry run: no robot was commanded; dry_run: false sends commands")
        elif isinstance(self.options, RosOptions):
            given = [key for key in ("dry_run", "odom_origin", "max_speed") if key in self.options.model_fields_set]
            if given:
                result.append(f"{self.name}: {', '.join(given)} had no effect: no robot is real without mode: real")
        return result

    def close(self) -> None:
        """Send zero commands to real robots and disconnect."""
        guard, self._guard = self._guard, None
        backend, self.backend = self.backend, None
        try:
            if guard is not None:
                guard.stop()
        finally:
            if isinstance(backend, BagBackend) and not self._began:
                backend.drop()  # another bridge could not be opened
            if backend is not None:
                backend.close()
            self._reports.finish()

    def _shown(self, scene: SceneDescription) -> Outgoing:
        return Outgoing(self._messages, scene, self.topics, self.options.frame, self._mode)

    def _topics(self, scene: SceneDescription, robots: Sequence[SceneObject]) -> tuple[Topic, ...]:
        options = self.options
        qos = {
            key: Qos(one.reliability == "reliable", one.durability == "transient_local", one.depth)
            for key, one in options.qos.items()
        }
        stamped = isinstance(options, RosOptions) and options.stamped
        result = scene_topics(scene, robots, self._mode, names=options.topics, qos=qos, stamped=stamped)
        if self._mode == "sim":
            return result
        unused = "cmd_vel" if options.dry_run else "cmd_vel_preview"
        return tuple(topic for topic in result if topic.key != unused)

    def _command_topics(self) -> list[Topic]:
        result = [topic for topic in self.topics if topic.key == "cmd_vel"]
        if {topic.robot for topic in result} != self.agents:
            raise BridgeError("bridge-mismatch", "robots without the topic cmd_vel cannot be driven",
                              "topics: {cmd_vel: /cmd_vel}, or dry_run: true")  # fmt: skip
        return result

    def _publish_once(self, start: WorldState) -> None:
        stamp = nanoseconds(start.time) if self._mode == "sim" else time.time_ns()
        for topic, message in self._outgoing.once(stamp):
            self._publish(topic, message, stamp)

    def _publish(self, topic: Topic, message: Any, stamp: int) -> None:
        backend = self.backend
        if backend is None:
            return
        if isinstance(backend, BagBackend):
            backend.stamp = stamp
        backend.publish(topic, message)

    def _command(self, commands: dict[str, Velocity]) -> None:
        """Hand commands to the process that sends them; in a dry run, publish what it would get."""
        if self._guard is not None:
            try:
                self._guard.send(commands)
            except BridgeLostError:
                with suppress(BridgeError):
                    self._send_zeros()
                raise
            return
        for topic in self.topics:
            if topic.key == "cmd_vel_preview":
                now = time.time_ns()
                wanted = commands.get(str(topic.robot), ZERO)
                self._publish(topic, self._messages.command(topic.kind, now, "base_link", wanted), now)

    def _send_zeros(self) -> None:
        for _ in range(_ZEROS):
            for topic in self._command_topics():
                now = time.time_ns()
                self._publish(topic, self._messages.command(topic.kind, now, "base_link", ZERO), now)
            time.sleep(_POLL_S)

    def _wait_for_robots(self, real: RealRobots) -> None:
        assert self._receiver is not None
        assert self.backend is not None
        until = time.monotonic() + self.options.timeout
        while real.missing:
            self._receiver.receive(self.backend, self._inbox)
            if not real.missing:
                break
            if time.monotonic() > until:
                names = [topic.name for topic in self.topics if topic.key == "odom" and topic.robot in real.missing]
                what = f"no odometry came on {', '.join(names)} within {self.options.timeout:g} s"
                raise BridgeLostError(what, "start the robot, or name its topic: topics: {odom: /odom}")
            time.sleep(_POLL_S)


def _chosen(scene: SceneDescription, names: Sequence[str]) -> list[SceneObject]:
    """The robots with these names, or all robots."""
    result = {robot.name: robot for robot in scene.robots}
    for name in names:
        if name not in result:
            fix = suggestion(name, result, f"the robots are {', '.join(result)}")
            raise BridgeError("bridge-mismatch", f"robots: there is no robot {name!r}", fix)
    return [result[name] for name in names] if names else list(result.values())
