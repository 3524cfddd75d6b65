"""The table that Parquet and CSV files have: one row per step and object, and the unit of each column."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.export.episode import Block, ExportedEpisode

__all__ = ["Column", "Ranges", "Words", "columns_of", "table_parts"]


@dataclass(frozen=True)
class Column:
    """A column of the table.

    Attributes:
        name: Its name.
        kind: Type of its cells; ``ranges`` is a list of numbers in single precision.
        meaning: Meaning of its cells, in one sentence without the unit.
        unit: Unit of its cells; empty for words, flags and numbers of steps.
    """

    name: str
    kind: Literal["integer", "number", "flag", "word", "ranges"]
    meaning: str
    unit: str = ""


@dataclass(frozen=True)
class Words:
    """Cells of a column of words: an index into ``words`` for each row."""

    words: tuple[str, ...]
    index: NDArray[np.int32]


@dataclass(frozen=True)
class Ranges:
    """Cells of a column of lists: ``values`` one after the other, and the length of each list, -1 for none."""

    values: NDArray[np.float32]
    lengths: NDArray[np.int64]


Cells: TypeAlias = "NDArray[Any] | Words | Ranges"

_COLUMNS = (
    Column("run", "word", "Id of the run"),
    Column("step", "integer", "Number of executed steps; 0 is the start"),
    Column("time", "number", "Simulated time", "s"),
    Column("name", "word", "Name of the object"),
    Column("role", "word", "robot or obstacle"),
    Column("x", "number", "Position in the world frame", "m"),
    Column("y", "number", "Position in the world frame", "m"),
    Column("theta", "number", "Heading in the world frame", "rad"),
    Column("vx", "number", "Mean velocity during the step that led here, world frame", "m/s"),
    Column("vy", "number", "Mean velocity during the step that led here, world frame", "m/s"),
    Column("yaw_rate", "number", "Mean yaw rate during the step that led here", "rad/s"),
    Column("speed", "number", "Magnitude of the velocity", "m/s"),
    Column("goal_x", "number", "Present goal in the world frame", "m"),
    Column("goal_y", "number", "Present goal in the world frame", "m"),
    Column("goal_theta", "number", "Heading of the present goal in the world frame", "rad"),
    Column("goal_distance", "number", "Distance to the present goal", "m"),
    Column("arrived", "flag", "Whether it has arrived"),
    Column("collided", "flag", "Whether it touches an object that blocks it"),
    Column("stopped", "flag", "Whether a collision keeps it from moving"),
    Column("between_steps", "flag", "Whether it touched something within the step that led here, at neither end of it"),
)


def columns_of(episodes: Sequence[ExportedEpisode]) -> list[Column]:
    """The columns of a table of some episodes."""
    controls = [
        Column(
            f"control_{number}",
            "number",
            "Control commanded in the step that led here, after limits and before the noise of the drive: "
            + _distinct(episodes, number, 0),
            _distinct(episodes, number, 1),
        )
        for number in range(max(episode.controls for episode in episodes))
    ]
    lidars = max((lidar.number + 1 for episode in episodes for lidar in episode.lidars), default=0)
    ranges = [
        Column(f"ranges_{number}", "ranges", "Ranges of a lidar from right to left; infinite: nothing was hit", "m")
        for number in range(lidars)
    ]
    before = [column.name for column in _COLUMNS].index("goal_x")
    return [*_COLUMNS[:before], *controls, *_COLUMNS[before:], *ranges, *_reading_columns(episodes)]


def _reading_columns(episodes: Sequence[ExportedEpisode]) -> list[Column]:
    """``<sensor>.<number>`` of all sensors that report numbers, each once."""
    columns: dict[str, Column] = {}
    for episode in episodes:
        for gauge in episode.gauges:
            kind: Literal["ranges", "number"] = "ranges" if gauge.has_rows else "number"
            told = "all that the sensor of the object reports" if gauge.has_rows else "what the sensor reports"
            for name, unit in gauge.units.items():
                called = f"{gauge.sensor}.{name}"
                columns.setdefault(called, Column(called, kind, f"{name} by the sensor {gauge.sensor}: {told}", unit))
    return list(columns.values())


def table_parts(episode: ExportedEpisode, columns: Sequence[Column]) -> Iterator[dict[str, Cells]]:
    """Yield the rows of an episode in parts: the cells of each column, step by step, in each step object by object.

    NaN stands for velocities at the start, goals of objects without one, and controls that only other drives have.
    """
    for block in episode.blocks():
        yield _cells(episode, block, columns)


def _cells(episode: ExportedEpisode, block: Block, columns: Sequence[Column]) -> dict[str, Cells]:
    trace, actors = block.trace, episode.actors
    steps, count = len(trace), len(actors)
    roles = ("robot", "obstacle")
    each = np.arange(count, dtype=np.int32)
    cells: dict[str, Cells] = {
        "run": Words((episode.run.id,), np.zeros(steps * count, dtype=np.int32)),
        "step": np.repeat(trace.step, count),
        "time": np.repeat(trace.time, count),
        "name": Words(tuple(actor.name for actor in actors), np.tile(each, steps)),
        "role": Words(roles, np.tile(np.array([roles.index(a.role) for a in actors], dtype=np.int32), steps)),
        "speed": np.linalg.norm(block.velocity[:, :, :2], axis=2).ravel(),
        "goal_distance": np.linalg.norm(trace.goal[:, :, :2] - trace.pose[:, :, :2], axis=2).ravel(),
        "arrived": trace.arrived.ravel(),
        "collided": trace.collided.ravel(),
        "stopped": trace.stopped.ravel(),
        "between_steps": block.between_steps.ravel(),
    }
    for names, values in (
        (("x", "y", "theta"), trace.pose),
        (("vx", "vy", "yaw_rate"), block.velocity),
        (("goal_x", "goal_y", "goal_theta"), trace.goal),
    ):
        cells.update({name: values[:, :, axis].ravel() for axis, name in enumerate(names)})
    for column in columns:
        kind, _, number = column.name.rpartition("_")
        if kind == "control":
            cells[column.name] = _control(episode, block, int(number))
        elif kind == "ranges":
            cells[column.name] = _ranges(episode, block, int(number))
        elif "." in column.name:
            cells[column.name] = _readings(episode, block, column)
    return {column.name: cells[column.name] for column in columns}


def _control(episode: ExportedEpisode, block: Block, number: int) -> NDArray[np.float64]:
    """A control of all actors; NaN for actors that have fewer controls, and before the first step."""
    has = np.array([number < len(actor.controls) for actor in episode.actors])
    values = np.where(has, block.trace.control[:, :, number] if number < 3 else np.nan, np.nan)
    values[block.trace.step == 0] = np.nan
    return values.ravel()


def _readings(episode: ExportedEpisode, block: Block, column: Column) -> NDArray[np.float64] | Ranges:
    """A number of a sensor of all actors; NaN for those without it, and where it was not recorded."""
    sensor, _, name = column.name.partition(".")
    steps, count = len(block.trace), len(episode.actors)
    values = np.full((steps, count), np.nan)
    rows: dict[int, NDArray[np.float64]] = {}
    for gauge in episode.gauges:
        readings = block.trace.readings[gauge.key]
        if gauge.sensor == sensor and gauge.has_rows:
            rows[gauge.actor] = readings[name]
        elif gauge.sensor == sensor:
            values[: len(readings), gauge.actor] = readings[name]
    if column.kind == "number":
        return values.ravel()
    lengths, parts = np.full((steps, count), -1, dtype=np.int64), [np.zeros(0)]
    for step in range(steps):
        for actor, table in sorted(rows.items()):
            if step < len(table):
                parts.append(table[step][np.isfinite(table[step])])
                lengths[step, actor] = len(parts[-1])
    return Ranges(np.concatenate(parts).astype(np.float32), lengths.ravel())


def _ranges(episode: ExportedEpisode, block: Block, number: int) -> Ranges:
    """Scans of one lidar of each actor."""
    steps = len(block.trace)
    lidars = [lidar for lidar in episode.lidars if lidar.number == number]
    known = min((len(block.trace.ranges[lidar.key]) for lidar in lidars), default=0)
    lengths = np.full((steps, len(episode.actors)), -1, dtype=np.int64)
    for lidar in lidars:
        lengths[:known, lidar.actor] = lidar.beams
    blocks = [block.trace.ranges[lidar.key][:known] for lidar in lidars]
    values = np.concatenate(blocks, axis=1).ravel() if blocks else np.zeros(0, dtype=np.float32)
    return Ranges(values, lengths.ravel())


def _distinct(episodes: Sequence[ExportedEpisode], number: int, what: int) -> str:
    """Names or units of one control of all drives, such as ``m/s`` or ``rad/s (diff), m/s (omni)``."""
    drives: dict[str, list[str]] = {}
    for episode in episodes:
        for actor in episode.actors:
            if number < len(actor.controls):
                users = drives.setdefault(actor.controls[number][what], [])
                if actor.drive is not None and actor.drive not in users:
                    users.append(actor.drive)
    if len(drives) == 1:
        return next(iter(drives))
    return ", ".join(f"{word} ({', '.join(users)})" for word, users in drives.items())
