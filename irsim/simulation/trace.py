"""Traces: states, controls and flags of all objects over an episode, as arrays; and the past of an environment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.components.sensors._gauges import GaugeOptions
from irsim.diagnostics.errors import InputError
from irsim.simulation.build import steps_within

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = [
    "Rollout",
    "Trace",
    "all_poses",
    "by_name",
    "cut_trace",
    "gauges",
    "join_traces",
    "measured_steps",
    "mounted_gauges",
    "next_rows",
    "past_goals",
    "past_poses",
    "present_readings",
    "present_row",
    "record",
    "record_rollout",
    "record_worlds",
    "recorded_rows",
    "sensors",
]


Flags = NDArray[np.bool_]
_BY_ROW = ("step", "time", "pose", "control", "goal", "arrived", "collided", "stopped")
"""Arrays of a trace that always have one row for each step."""


@dataclass(frozen=True)
class Rollout:
    """Arrays over T executed steps and N objects; row t is the state after step t + 1 of the rollout.

    Attributes:
        time: (T,) simulated time [s].
        pose: (T, N, 3) x, y [m], heading [rad], world frame.
        control: (T, N, 3) executed controls, command frame, zero padded.
        arrived, collided: (T, N) flags.
        names: Names of the objects, in order.
    """

    time: Floats
    pose: Floats
    control: Floats
    arrived: Flags
    collided: Flags
    names: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.time)


@dataclass(frozen=True)
class Trace:
    """Arrays over T rows and N objects; row 0 is the initial state, each further row the state after one more step.

    Attributes:
        step: (T,) number of executed steps, 0 at the start of the episode.
        time: (T,) simulated time [s].
        pose: (T, N, 3) x, y [m], heading [rad], world frame.
        control: (T, N, 3) control executed in the step that led to the row, command frame, zero padded. In a recorded
            run it has single precision.
        goal: (T, N, 3) present goal x, y [m], heading [rad]; NaN without a goal.
        arrived, collided, stopped: (T, N) flags.
        command: (T, N, 3) what was commanded in the step that led to the row, of objects with ``actuation``, and
            NaN of all other objects. None if no object has any, and in traces that are not of a recorded run.
        ranges: (T, B) ranges [m] of each sensor, infinite for a beam that hit nothing. The keys are ``<object
            name>/<number of the sensor among the native sensors of the object>``. Empty if scans were not recorded; a
            recorded run has fewer than T rows if it was too large to store all of them.
        readings: Numbers of each sensor that reports numbers, by its key ``<object name>/<sensor>`` (``_2`` for a
            second one of a kind): a structured array (T,), or (T, K) of a sensor that reports K rows, whose fields have
            the names that ``sensor.read()`` gives: ``readings["robot_0/odometry"]["x"]``. Empty in traces that are not
            of a recorded run; as many rows as ``ranges`` have.
        names: Names of the objects, in order.
        step_time: Period [s].
    """

    step: NDArray[np.int64]
    time: Floats
    pose: Floats
    control: Floats
    goal: Floats
    arrived: Flags
    collided: Flags
    stopped: Flags
    ranges: dict[str, NDArray[np.float32]]
    names: tuple[str, ...]
    step_time: float
    command: Floats | None = None
    readings: dict[str, NDArray[np.void]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.step)

    @property
    def actions(self) -> Floats:
        """(T, N, 3) what was commanded, of objects without ``actuation`` the executed control."""
        if self.command is None:
            return self.control
        return np.where(np.isnan(self.command), self.control, self.command)


def record(simulation: Simulation, steps: int, *, until_done: bool = True, scans: bool = False) -> Trace:
    """Advance a simulation with a single world and return its trace, including the present state.

    Args:
        simulation: The simulation.
        steps: Largest number of periods.
        until_done: End once every robot has arrived or stopped.
        scans: Also record the measurements of native range sensors.

    Raises:
        ValueError: ``steps`` is negative.
    """
    return join_traces(
        [present_row(simulation, scans), next_rows(simulation, steps, until_done=until_done, scans=scans)]
    )


def record_worlds(simulation: Simulation, steps: Sequence[int]) -> list[Trace]:
    """Advance all worlds until every robot of each has arrived or stopped, and return their traces.

    The traces include the present state, and equal what :func:`record` returns for the worlds alone. While
    Python code takes part, worlds that are done move on until the last one is done.

    Args:
        simulation: The simulation, at the start of an episode in every world.
        steps: Largest number of periods of each world.
    """
    worlds, objects, most = simulation.copies, simulation.objects, max(steps)
    first = _present(simulation, scans=False)[:-1]
    if simulation.in_python:
        taken = [first]
        ended = [0 if simulation.state.done(world) or not steps[world] else -1 for world in range(worlds)]
        for step in range(1, most + 1):
            if min(ended) >= 0:
                break
            simulation.step()
            taken.append(_present(simulation, scans=False)[:-1])
            for world in range(worlds):
                if ended[world] < 0 and (step == steps[world] or simulation.state.done(world)):
                    ended[world] = step
        columns = [np.concatenate([row[number] for row in taken]) for number in range(len(first))]
    else:
        kept = core.rollout(simulation.world, simulation.state, most, threads=simulation.threads, until_done=True)
        after = (kept.pose, kept.control, kept.goal, kept.arrived, kept.collided, kept.stopped)
        columns = [np.concatenate([now, rows]) for now, rows in zip(first, after, strict=True)]
        ended = [min(int(executed), limit) for executed, limit in zip(kept.steps, steps, strict=True)]
    traces = []
    for world, last in enumerate(ended):
        rows = slice(world * objects, (world + 1) * objects)
        own = [np.ascontiguousarray(column[: last + 1, rows]) for column in columns]
        traces.append(_trace(simulation, 0, [*own, np.zeros((last + 1, 0), dtype=np.float32)], last + 1, scans=False))
    return traces


def present_row(simulation: Simulation, scans: bool = False) -> Trace:
    """Return the present state of a simulation with a single world as a trace of one row."""
    return _trace(simulation, int(simulation.count[0]), _present(simulation, scans), 1, scans)


def next_rows(simulation: Simulation, steps: int, *, until_done: bool = True, scans: bool = False) -> Trace:
    """Advance like :func:`record`, and return the rows after the present one.

    The trace is empty if the episode was already over. If no Python code takes part in the steps, the core writes all
    rows at once, which is faster.
    """
    if steps < 0:
        raise InputError(f"steps must be 0 or more, got {steps}")
    begin = int(simulation.count[0])
    if not simulation.in_python:
        kept = core.rollout(simulation.world, simulation.state, steps, until_done=until_done, returns=scans)
        rows = (kept.pose, kept.control, kept.goal, kept.arrived, kept.collided, kept.stopped, kept.returns)
        return _trace(simulation, begin + 1, rows, len(kept.pose), scans)
    taken: list[list[NDArray[Any]]] = []
    for _ in range(steps):
        if until_done and simulation.state.done(0):
            break
        simulation.step()
        taken.append(_present(simulation, scans))
    taken = taken or [[value[:0] for value in _present(simulation, scans)]]
    columns = [np.concatenate([row[number] for row in taken]) for number in range(len(taken[0]))]
    return _trace(simulation, begin + 1, columns, len(columns[0]), scans)


def join_traces(parts: Sequence[Trace]) -> Trace:
    """Concatenate traces that follow each other in time."""
    if len(parts) == 1:
        return parts[0]
    first = parts[0]
    stacked = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _BY_ROW}
    ranges = {key: np.concatenate([part.ranges[key] for part in parts]) for key in first.ranges}
    readings = {key: np.concatenate([part.readings[key] for part in parts]) for key in first.readings}
    commands = [part.command for part in parts if part.command is not None]
    command = np.concatenate(commands) if len(commands) == len(parts) else None
    return Trace(
        **stacked, ranges=ranges, names=first.names, step_time=first.step_time, command=command, readings=readings
    )


def cut_trace(trace: Trace, rows: slice) -> Trace:
    """Return some rows of a trace as views; its ranges have fewer rows where scans were not recorded to the end."""
    cut = {name: getattr(trace, name)[rows] for name in _BY_ROW}
    ranges = {key: block[rows] for key, block in trace.ranges.items()}
    readings = {key: block[rows] for key, block in trace.readings.items()}
    command = None if trace.command is None else trace.command[rows]
    return Trace(**cut, ranges=ranges, names=trace.names, step_time=trace.step_time, command=command, readings=readings)


def record_rollout(simulation: Simulation, steps: int, *, until_done: bool) -> Rollout:
    """Advance a simulation with a single world by up to ``steps`` periods; return poses, controls and flags."""
    rows = next_rows(simulation, steps, until_done=until_done)
    return Rollout(rows.time, rows.pose, rows.control, rows.arrived, rows.collided, rows.names)


def _present(simulation: Simulation, scans: bool) -> list[NDArray[Any]]:
    """Return the present pose, control, goal, flags and ranges, each with a leading axis of length 1."""
    flags = (simulation.arrived, simulation.collided, simulation.stopped)
    ranges = np.zeros(0, dtype=np.float32)
    if scans:
        ranges = np.where(simulation.valid.astype(bool), simulation.ranges, np.inf).astype(np.float32)
    values: tuple[NDArray[Any], ...] = (simulation.pose, simulation.control, simulation.goal, *flags, ranges)
    return [value[None].copy() for value in values]


def _trace(simulation: Simulation, begin: int, columns: Sequence[NDArray[Any]], count: int, scans: bool) -> Trace:
    names = tuple(record.name for record in simulation.scenario.objects)
    step_time = float(simulation.scenario.world.step_time)
    step = np.arange(begin, begin + count, dtype=np.int64)
    pose, control, goal, arrived, collided, stopped, ranges = columns
    return Trace(
        step=step,
        time=step.astype(np.float64) * step_time,
        pose=pose.astype(np.float64, copy=False),
        control=control.astype(np.float64, copy=False),
        goal=goal.astype(np.float64, copy=False),
        arrived=arrived.astype(bool),
        collided=collided.astype(bool),
        stopped=stopped.astype(bool),
        ranges={key: ranges[:, beams].astype(np.float32, copy=False) for key, beams in sensors(simulation)}
        if scans
        else {},
        names=names,
        step_time=step_time,
    )


def recorded_rows(simulation: Simulation) -> list[int]:
    """Rows of the objects whose states a recorded run keeps: all that can move, which any object can in Python."""
    records, any_can_move = simulation.scenario.objects, simulation.in_python
    return [row for row, record in enumerate(records) if any_can_move or not record.static or record.appear_time]


def sensors(simulation: Simulation) -> list[tuple[str, slice]]:
    """Return, for each sensor with beams, its key ``<object>/<number>`` and the slice of its beams in the ranges."""
    records = simulation.scenario.objects
    numbers: dict[int, int] = {}
    columns = []
    for owner, first, count in simulation.world.scans():
        number = numbers[owner] = numbers.get(owner, -1) + 1
        columns.append((f"{records[owner].name}/{number}", slice(first, first + count)))
    return columns


def gauges(simulation: Simulation) -> list[tuple[str, list[str], int]]:
    """Return, for each sensor that reports numbers: its key, the names of a row of them, and how many there are.

    The key is ``<object>/<sensor>``, of a second one of a kind ``<object>/<sensor>_2``. Their numbers follow each other
    in the readings.
    """
    counts = [count for _, _, count in simulation.world.gauges()]
    mounted = zip(mounted_gauges(simulation), counts, strict=True)
    return [(key, [name for name, _ in sensor.numbers()], count) for (_, key, sensor), count in mounted]


def measured_steps(rate: float, latency: float, step_time: float, steps: NDArray[np.int64]) -> NDArray[np.int64]:
    """The steps in which a sensor measured what it shows after some steps; -1 before its first data.

    Args:
        rate: Measurements per second [Hz]; 0: one in each step.
        latency: Time from a measurement until its data arrive [s].
        step_time: Period [s].
        steps: (T,) numbers of steps.
    """
    timing = core.SensorTiming(rate=rate, latency=latency)
    return np.array([core.shown_step(timing, step_time, step) for step in steps.tolist()], dtype=np.int64)


def mounted_gauges(simulation: Simulation) -> list[tuple[int, str, GaugeOptions]]:
    """Return, for each sensor that reports numbers: the row of its object, its key and its options."""
    taken: dict[str, int] = {}
    mounted = []
    options = {
        owner: [one for one in record.sensors if isinstance(one, GaugeOptions)]
        for owner, record in enumerate(simulation.scenario.objects)
    }
    for owner, _, _ in simulation.world.gauges():
        sensor = options[owner].pop(0)
        key = f"{simulation.scenario.objects[owner].name}/{sensor.name}"
        number = taken[key] = taken.get(key, 0) + 1
        mounted.append((owner, key if number == 1 else f"{key}_{number}", sensor))
    return mounted


def present_readings(simulation: Simulation) -> dict[str, NDArray[np.void]]:
    """Return what sensors without beams report now as :attr:`Trace.readings` of one row; of a single world."""
    readings, result, first = simulation.state.readings[None].copy(), {}, 0
    for key, names, count in gauges(simulation):
        result[key] = by_name(readings[:, first : first + count], names)
        first += count
    return result


def by_name(values: Floats, names: Sequence[str]) -> NDArray[np.void]:
    """Rows of numbers (T, n) as a structured array (T,) with these names, or (T, K) if a row has K times as many."""
    rows = np.ascontiguousarray(values).view([(name, np.float64) for name in names])
    return rows[:, 0] if values.shape[1] == len(names) else rows


def past_poses(simulation: Simulation, row: int) -> Floats | None:
    """Return the (T + 1, 3) poses of an object at the start and after each of T steps.

    Args:
        simulation: A simulation with a single world, made with history.
        row: Row of the object.

    Returns:
        x, y [m] and heading [rad], world frame, NaN before its ``appear_time`` and after
        it has left the world; None if a script added the object, or
        has interfered with its history.
    """
    state, steps = simulation.state, int(simulation.count[0])
    start = state.initial_state(row)[None, :3]
    appeared = int(simulation.appeared[row])
    gone, appeared = appeared < -1, appeared if appeared >= -1 else -2 - appeared
    begin = appeared if appeared >= 0 else steps + 1  # it records no state before
    absent = np.array([[np.nan, np.nan, start[0, 2]]])
    if simulation.scenario.objects[row].static:
        return np.concatenate([np.repeat(absent, begin, axis=0), np.repeat(start, steps + 1 - begin, axis=0)])
    since, _, stopped = state.standings(row)
    if not len(since) or since[0] != 0:
        return None
    held = np.repeat(stopped.astype(bool), np.diff([*since, steps + 1]))[:-1]  # a stopped object records no state
    if simulation.scenario.world.collision_mode == "contact":
        held[:] = False  # unless it can be pushed
    held[: max(0, begin - 1)] = True
    end = _last_step(simulation, row) if gone else steps
    held[end:] = True
    track = np.concatenate([absent if begin else start, state.trajectory(row)[:, :3]])
    last = np.concatenate([[0], np.cumsum(~held)])
    if last[-1] != len(track) - 1:
        return None
    poses: Floats = track[last]
    poses[end + 1 :, :2] = np.nan
    return poses


def _last_step(simulation: Simulation, row: int) -> int:
    """Return the last step in which an object that has left the world was in it."""
    until = simulation.scenario.objects[row].vanish_time or 0.0
    return steps_within(until, simulation.scenario.world.step_time)


def past_goals(simulation: Simulation, row: int) -> Floats | None:
    """Return the (T + 1, 3) goals of an object at the start and after each of T steps, with NaN for missing numbers.

    See :func:`past_poses`; None also for objects that never move.
    """
    since, goals, _ = simulation.state.standings(row)
    if not len(since) or since[0] != 0:
        return None
    return np.repeat(goals, np.diff([*since, int(simulation.count[0]) + 1]), axis=0)


def all_poses(simulation: Simulation) -> Floats | None:
    """Return the (T + 1, N, 3) poses of all objects; None if :func:`past_poses` lacks one of them."""
    paths = [past_poses(simulation, row) for row in range(simulation.objects)]
    known = [poses for poses in paths if poses is not None]
    return np.stack(known, axis=1) if known and len(known) == len(paths) else None
