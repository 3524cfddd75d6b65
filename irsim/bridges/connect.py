"""``irsim.connect``: the bridges of a scenario take part in the steps of its environment."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from contextlib import nullcontext, suppress
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from typing_extensions import Self

from irsim.bridges.base import Bridge, BridgeError, BridgeLostError
from irsim.bridges.controls import native_control
from irsim.bridges.state import Feedback, Motion, world_state
from irsim.common.angles import wrap
from irsim.common.arrays import Floats
from irsim.common.keywords import answers_misspelt
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import CodedError
from irsim.objects.describe import agent_rows, describe_scene
from irsim.options.registry import BRIDGES
from irsim.simulation.scene import SceneDescription

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["Connection", "connect", "open_bridges"]

_MAX_NUMBER = 1e7
"""Greatest number that is believed of what comes from outside [m, rad, m/s, rad/s]."""
_MAX_DELAY_S = 1.0
"""Delay from which on steps in real time are not caught up: the world outside has seen none of them."""
_CONTENTS = {"commands": "forward and leftward speed and yaw rate", "twists": "vx, vy and yaw rate"}
"""Meaning of the three numbers; x, y and yaw where nothing is written."""


def open_bridges(options: Iterable[Any]) -> list[Bridge]:
    """The bridges of options models; nothing is connected yet.

    Raises:
        ExtraError: A library is missing; the message has the command that installs it.
        BridgeError: The options cannot be used here.
    """
    made, written = [], set[Any]()
    for item in options:
        files = {getattr(item, key) for key in getattr(item, "files", ())} - {None}
        if both := files & written:
            what = f"two bridges write to '{min(both)}'"
            raise BridgeError("bridge-mismatch", what, "give each of them a name of its own")
        written |= files
        feature = BRIDGES.get(str(item.name))
        assert feature is not None
        assert feature.function is not None
        bridge: Bridge = feature.function(item)
        bridge.clock = item.clock
        made.append(bridge)
    return made


@answers_misspelt
def connect(env: Any, bridges: Sequence[Bridge] | None = None) -> Connection:
    """Connect an environment with other programs; use the result in a ``with`` statement.

    ```python
    env = irsim.make("scene.yaml")
    with irsim.connect(env):
        while not env.done():
            env.step()
    ```

    Args:
        env: The environment, at the start of an episode.
        bridges: The bridges; default: the key ``bridges`` of its scenario.

    Raises:
        BridgeError: A program cannot be reached, or the scenario does not fit; all bridges are closed then.
        ExtraError: A library is missing.
    """
    simulation: Simulation = env.simulation
    return Connection(simulation, open_bridges(simulation.scenario.bridges) if bridges is None else bridges)


class Connection:
    """Bridges that take part in the steps of a simulation with one world, until :meth:`close`.

    Objects that a bridge moves are placed after the others have moved and before contacts, collisions and sensors, so
    that these see them where the other program has them.

    Args:
        simulation: The simulation.
        bridges: The bridges.

    Attributes:
        scene: The scene that the bridges got.
        lost: Why a program is lost, after which no step is possible; None otherwise.
        late: Longest time by which a step in real time came too late [s].
    """

    def __init__(self, simulation: Simulation, bridges: Sequence[Bridge]) -> None:
        if simulation.copies != 1:
            raise BridgeError("bridge-mismatch", "bridges connect one world", f"got {simulation.copies}; use one")
        self.simulation, self.bridges = simulation, list(bridges)
        self.late = 0.0
        self.lost: str | None = None
        self._owned: dict[str, Bridge] = {}
        self.scene: SceneDescription
        self._describe()
        self._ranges: dict[str, NDArray[np.float32]] = {}
        self._before: Floats = simulation.pose.copy()
        self._count = int(simulation.count[0])
        self._wall: float | None = None
        self._open = False
        try:
            start = world_state(simulation, self._rows)
            for number, bridge in enumerate(self.bridges):
                if not isinstance(bridge, Bridge):
                    self.bridges = self.bridges[:number]
                    raise BridgeError("bridge-mismatch", f"{bridge!r} is not a bridge",
                                      "leave out the bridges to use the scenario's")  # fmt: skip
                self._guarded(bridge, bridge.open, self.scene, start)
                self._claim(bridge)
        except BaseException:
            with suppress(BridgeError):
                self._close_all()
            raise
        self._open = bool(self.bridges)
        if self._open:
            simulation.decisions.insert(0, self)
            simulation.movers.append(self.move)
            simulation.measurements.append(self.measure)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *rest: object) -> None:
        with suppress(BridgeError) if kind is not None else nullcontext():
            self.close()

    def peers(self) -> str:
        """To what the bridges are connected, and whether robots are simulated or real, as the words of a sentence."""
        return " and ".join(f"{clean(bridge.peer, 200)} (mode: {bridge.mode})" for bridge in self.bridges)

    def notes(self) -> list[str]:
        """Remarks of the bridges at the end of a run."""
        result = [note for bridge in self.bridges for note in bridge.notes()]
        if self.late > 0.5 * float(self.simulation.scenario.world.step_time):
            result.append(f"steps came up to {self.late:.2g} s later than the time on the wall asks for")
        return result

    def close(self) -> None:
        """Stop the robots of the other program and disconnect; a second call does nothing."""
        if self._open:
            self._open = False
            simulation = self.simulation
            simulation.decisions.remove(self)
            simulation.movers.remove(self.move)
            simulation.measurements.remove(self.measure)
        self._close_all()

    # a step -----------------------------------------------------------------------------------------------------------
    def claim(self, simulation: Simulation) -> None:
        """Before decisions: wait for the time of the step, and take over what has come from outside."""
        if self.lost is not None:
            raise BridgeLostError(self.lost)
        self._follow()
        self._before = simulation.pose.copy()
        self._ranges = {}
        self._wait()
        for bridge in self.bridges:
            feedback = self._guarded(bridge, bridge.pull)
            if feedback is not None:
                self._guarded(bridge, self._take, bridge, feedback, True)

    def __call__(self, simulation: Simulation) -> None:
        """Bridges decide nothing: commands were imposed before."""

    def move(self, simulation: Simulation) -> None:
        """In the middle of the step: place the objects that other programs move."""
        rows = self._rows
        period = float(simulation.scenario.world.step_time)
        twist = (simulation.pose[rows] - self._before[rows]) / period
        twist[:, 2] = wrap(simulation.pose[rows, 2] - self._before[rows, 2]) / period
        motion = Motion(
            step=int(simulation.count[0]),
            time=simulation.time,
            control=simulation.control[rows].copy(),
            pose=simulation.pose[rows].copy(),
            twist=twist,
        )
        for bridge in self.bridges:
            feedback = self._guarded(bridge, bridge.exchange, motion)
            if feedback is not None:
                self._guarded(bridge, self._take, bridge, feedback, False)

    def measure(self, simulation: Simulation, mask: Any = None) -> None:
        """After the step: put in scans from outside, and show the world."""
        self._put_ranges(simulation)
        count, anew = int(simulation.count[0]), self._follow()
        if count == self._count and not anew:
            return
        if count < self._count:
            self._wall = None
        self._count = count
        state = world_state(simulation, self._rows)
        for bridge in self.bridges:
            self._guarded(bridge, bridge.push, state)

    def _follow(self) -> bool:
        """Tell the bridges of another scene, if there is one; whether there was."""
        if self._key_of_scene() == self._key:
            return False
        self._describe()
        state = world_state(self.simulation, self._rows)
        for bridge in self.bridges:
            self._guarded(bridge, bridge.renew, self.scene, state)
        return True

    def _describe(self) -> None:
        """Describe the present scene.

        Raises:
            BridgeError: It lacks an object that a bridge moves.
        """
        self._key = self._key_of_scene()
        self._rows = agent_rows(self.simulation)
        self.scene = describe_scene(self.simulation)
        self._row_of = dict(zip(self.scene.names, self._rows.tolist(), strict=True))
        for name, bridge in self._owned.items():
            if name not in self._row_of:
                what = f"{bridge.name} moves '{name}', which the scene does not have any more"
                raise BridgeError("bridge-mismatch", what, "connect again")

    def _key_of_scene(self) -> tuple[int, int, int]:
        """The numbers that tell two scenes apart: seed, number, and number of changes of bodies."""
        seed, scene, _ = self.simulation.key()
        return seed, scene, self.simulation.revision

    # what comes from outside ------------------------------------------------------------------------------------------
    def _take(self, bridge: Bridge, feedback: Feedback, before: bool) -> None:
        if not isinstance(feedback, Feedback):
            what = f"{bridge.name} returned {type(feedback).__name__} instead of Feedback"
            raise BridgeError("bridge-failed", what, "return irsim.bridges.state.Feedback or None")
        for what in ("poses", "twists", "commands", "goals", "starts"):
            self._check(bridge, what, getattr(feedback, what))
        for name, pose in feedback.poses.items():
            self._place(name, pose, feedback.twists.get(name), moved=not before)
        for name, pose in feedback.starts.items():
            self._place(name, pose, (0.0, 0.0, 0.0), moved=False)
        for name, goal in feedback.goals.items():
            self.simulation.state.set_goals(self._row_of[name], [list(goal)], False)
        for name, command in feedback.commands.items():
            self._command(name, command)
        self._ranges |= self._checked_ranges(bridge, feedback.ranges)
        if feedback.end is not None:
            self.lost = f"{bridge.name} ended the episode: {clean(feedback.end, 200)}"
            raise BridgeLostError(self.lost, "run it again")

    def _check(self, bridge: Bridge, what: str, named: Mapping[str, Sequence[float]]) -> None:
        for name, values in named.items():
            if name not in self._row_of:
                listed = ", ".join(self.scene.names[:5])
                fix = suggestion(name, self.scene.names, f"the objects are {listed}")
                what = f"{bridge.name} sent {what} of an unknown object {clean(name)!r}"
                raise BridgeError("bridge-failed", what, fix)
            if what in ("poses", "twists") and self._owned.get(name) is not bridge:
                fix = "name it in the agents of the bridge; for another start send starts"
                raise BridgeError("bridge-failed", f"{bridge.name} sent {what} of '{name}', which irsim moves", fix)
            if not _are_three_numbers(values):
                message = f"{bridge.name} sent {what} of '{name}' that are not three finite numbers: {values}"
                fix = f"send {_CONTENTS.get(what, 'x, y and yaw')}, none beyond {_MAX_NUMBER:g}"
                raise BridgeError("bridge-failed", message, fix)

    def _place(self, name: str, pose: Sequence[float], twist: Sequence[float] | None, *, moved: bool) -> None:
        """Set the pose of an object; one that moved in this step gets the velocity that led there."""
        simulation, row = self.simulation, self._row_of[name]
        if moved and twist is None:
            period = float(simulation.scenario.world.step_time)
            step = np.asarray(pose, dtype=np.float64) - self._before[row]
            step[2] = wrap(step[2])
            twist = (step / period).tolist()
        simulation.pose[row] = pose
        if twist is not None:
            simulation.twist[row] = twist
        simulation.state.moved(row)

    def _command(self, name: str, command: Sequence[float]) -> None:
        simulation, row = self.simulation, self._row_of[name]
        kinematics: Any = simulation.scenario.objects[row].kinematics
        if getattr(kinematics, "mode", "") == "acceleration":
            what = f"'{name}' takes accelerations, but another program gives it speeds"
            raise BridgeError("bridge-mismatch", what, "mode: steer")
        control = native_control(
            self.scene.agent(name),
            command,
            steering_rate=getattr(kinematics, "mode", "") == "angular",
            steer=float(simulation.extra[row, 0]),
            period=float(simulation.scenario.world.step_time),
        )
        simulation.impose(row, control)

    def _checked_ranges(self, bridge: Bridge, ranges: Mapping[str, Any]) -> dict[str, NDArray[np.float32]]:
        lidars = {lidar.key: lidar for agent in self.scene.agents for lidar in agent.lidars}
        result = {}
        for key, values in ranges.items():
            beams = np.asarray(values, dtype=np.float32).reshape(-1)
            if key not in lidars or len(beams) != lidars[key].beams or np.isnan(beams).any():
                listed = ", ".join(f"{lidar.key} ({lidar.beams} beams)" for lidar in list(lidars.values())[:5])
                what = f"{bridge.name} sent {len(beams)} ranges of {clean(key)!r} that cannot be used"
                fix = f"the lidars are {listed}; infinite is a beam that hit nothing"
                raise BridgeError("bridge-failed", what, fix)
            result[key] = beams
        return result

    def _put_ranges(self, simulation: Simulation) -> None:
        """Replace the scans that irsim has measured by scans from other programs."""
        if not self._ranges:
            return
        first = {lidar.key: lidar for agent in self.scene.agents for lidar in agent.lidars}
        numbers: dict[str, int] = {}
        for owner, start, count in simulation.scans:
            name = simulation.scenario.objects[owner].name
            number = numbers[name] = numbers.get(name, -1) + 1
            beams = self._ranges.get(f"{name}/{number}")
            if beams is not None:
                lidar = first[f"{name}/{number}"]
                hit = np.isfinite(beams) & (beams >= lidar.range_min) & (beams <= lidar.range_max)
                simulation.ranges[start : start + count] = np.where(hit, beams, lidar.range_max)
                simulation.valid[start : start + count] = hit

    # bridges ----------------------------------------------------------------------------------------------------------
    def _claim(self, bridge: Bridge) -> None:
        """Let a bridge have its agents."""
        for name in bridge.agents:
            if name not in self._row_of:
                fix = suggestion(name, self.scene.names, f"the objects are {', '.join(self.scene.names[:5])}")
                raise BridgeError("bridge-mismatch", f"{bridge.name} moves an unknown object {clean(name)!r}", fix)
            if name in self._owned:
                what = f"{bridge.name} and {self._owned[name].name} both move '{name}'"
                raise BridgeError("bridge-mismatch", what, "give each object to one bridge")
            self._owned[name] = bridge

    def _wait(self) -> None:
        """Wait until it is time for the step, if a bridge runs in real time."""
        if not any(bridge.clock == "wall" for bridge in self.bridges):
            return
        now, due = time.monotonic(), float(self.simulation.count[0]) * float(self.simulation.scenario.world.step_time)
        if self._wall is None:
            self._wall = now - due
        ahead = self._wall + due - now
        if ahead > 0:
            time.sleep(ahead)
            return
        self.late = max(self.late, -ahead)
        if ahead < -_MAX_DELAY_S:
            self._wall = now - due

    def _guarded(self, bridge: Bridge, call: Any, *arguments: Any) -> Any:
        """Call a bridge; an exception that is not one of irsim's becomes one, and all bridges are closed."""
        try:
            return call(*arguments)
        except BridgeLostError as error:
            self.lost = error.message
            raise
        except CodedError:
            raise
        except OSError as error:
            self.lost = f"{bridge.name}: {error.strerror or error}"
            raise BridgeLostError(self.lost) from error
        except Exception as error:
            what = f"{bridge.name} raised {type(error).__name__}: {error}"
            raise BridgeError("bridge-failed", what, "the error above this one says where") from error

    def _close_all(self) -> None:
        """Close all bridges, each whatever happens to the others."""
        errors = []
        for bridge in reversed(self.bridges):
            try:
                bridge.close()
            except Exception as error:
                errors.append((bridge.name, error))
        if not errors:
            return
        name, first = errors[0]
        if isinstance(first, CodedError):
            raise first
        what = f"{name} could not be closed: {getattr(first, 'strerror', None) or first}"
        raise BridgeError("bridge-failed", what, "see what it has written so far; some of it is missing") from first


def _are_three_numbers(values: object) -> bool:
    try:
        numbers = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        return False
    return numbers.shape == (3,) and bool((np.abs(numbers) <= _MAX_NUMBER).all())
