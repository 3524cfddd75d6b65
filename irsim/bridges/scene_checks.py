"""What must hold of a scene or of states that come from a file."""

from __future__ import annotations

import math
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from irsim.common.outline import Circle, Line, Polygon
from irsim.simulation.scene import Lidar, SceneDescription, SceneObject

__all__ = ["MAX_CELLS", "check_scene", "check_states", "read_arrays"]

MAX_CELLS = 64_000_000
"""Number of cells of a map."""
_MAX_BEAMS = 100_000
_MAX_BYTES = 2**30
"""Largest content of a file of states, unpacked."""


def check_scene(scene: SceneDescription) -> None:
    """Check what the types of a scene do not say.

    Raises:
        ValueError: Something of it cannot be.
    """
    _need(isinstance(scene.name, str), "the name is no text")
    _need(_is_number(scene.step_time) and scene.step_time > 0, "step_time is no time")
    _need(isinstance(scene.about, Mapping), "about is no mapping")
    _need(len(set(scene.names)) == len(scene.agents), "two agents have the same name")
    for index, agent in enumerate(scene.agents):
        _need(agent.index == index, f"the agent at place {index} has the index {agent.index}")
        _check_agent(agent)


def check_states(data: Mapping[str, Any]) -> None:
    """Check the arrays of successive states.

    Args:
        data: Name of an array -> the array; those of scans begin with ``ranges:``.

    Raises:
        ValueError: They do not fit each other, or have numbers that cannot be.
    """
    count, rows = len(data["step"]), data["pose"].shape[1] if data["pose"].ndim == 3 else -1
    kinds: dict[str, tuple[str, tuple[int, ...]]] = {"step": ("i", (count,)), "time": ("f", (count,))}
    kinds |= dict.fromkeys(("pose", "twist", "control", "goal"), ("f", (count, rows, 3)))
    kinds |= dict.fromkeys(("arrived", "collided", "stopped"), ("b", (count, rows)))
    for key, (kind, shape) in kinds.items():
        array = data[key]
        _need(array.dtype.kind == kind and array.shape == shape, f"{key} is {array.dtype} of the shape {array.shape}")
        _need(kind != "f" or not np.isinf(array).any(), f"{key} is infinite somewhere")
    _need(bool(np.isfinite(data["time"]).all()), "a time is no number")
    for key, array in data.items():
        if key.startswith("ranges:"):
            fits = array.dtype.kind == "f" and array.ndim == 2 and len(array) == count
            _need(fits and not np.isnan(array).any(), f"{key} does not have one row of ranges for each state")


def read_arrays(path: Path) -> dict[str, Any]:
    """The arrays of an NPZ file, whose sizes are compared with those of the file before memory is taken.

    Raises:
        ValueError: It is no such file, or too large.
        OSError: It cannot be read.
    """
    found = {}
    with zipfile.ZipFile(path) as archive:
        if sum(item.file_size for item in archive.infolist()) > _MAX_BYTES:
            raise ValueError(f"it has more than {_MAX_BYTES // 2**20} MB")
        for item in archive.infolist():
            with archive.open(item) as file:
                found[item.filename.removesuffix(".npy")] = _array(file, item.file_size)
    return found


def _array(file: Any, size: int) -> Any:
    read_header = {
        (1, 0): np.lib.format.read_array_header_1_0,
        (2, 0): np.lib.format.read_array_header_2_0,
    }.get(np.lib.format.read_magic(file))
    _need(read_header is not None, "an array has an unknown format")
    assert read_header is not None
    shape, by_columns, dtype = read_header(file)
    _need(dtype.kind in "fbi", f"an array has the type {dtype}")
    _need(math.prod(shape) * dtype.itemsize == size - file.tell(), "an array has another size than it says")
    return np.frombuffer(file.read(), dtype=dtype).reshape(shape, order="F" if by_columns else "C").copy()


def _check_agent(agent: SceneObject) -> None:
    who = f"agent {agent.index}"
    _need(isinstance(agent.name, str), f"the name of {who} is no text")
    _need(agent.role in ("robot", "obstacle"), f"the role of {who} is {agent.role!r}")
    _need(agent.drive is None or isinstance(agent.drive, str), f"the drive of {who} is no text")
    _need(_is_number(agent.radius) and agent.radius >= 0, f"the radius of {who} is {agent.radius!r}")
    _need(agent.wheelbase is None or _is_number(agent.wheelbase), f"the wheelbase of {who} is {agent.wheelbase!r}")
    _need(agent.mass > 0, f"the mass of {who} is {agent.mass!r}")
    _need(len(agent.low) == len(agent.high) == len(agent.acceleration), f"the limits of {who} are not equally many")
    for part in agent.parts:
        if isinstance(part, Circle):
            _need(part.radius > 0, f"a circle of {who} has the radius {part.radius}")
        elif isinstance(part, Polygon):
            _need(len(part.corners) > 2, f"a polygon of {who} has {len(part.corners)} corners")
        elif isinstance(part, Line):
            _need(len(part.points) > 1, f"a line of {who} has {len(part.points)} points")
    for lidar in agent.lidars:
        _check_lidar(lidar, who)


def _check_lidar(lidar: Lidar, who: str) -> None:
    what = f"a lidar of {who}"
    beams: Any = lidar.beams
    _need(isinstance(lidar.key, str), f"the key of {what} is no text")
    _need(isinstance(beams, int) and 0 < beams <= _MAX_BEAMS, f"{what} has {beams!r} beams")
    numbers = (lidar.angle_min, lidar.angle_max, lidar.range_min, lidar.range_max, lidar.period)
    _need(all(map(_is_number, numbers)), f"{what} has angles, ranges or a period that are no numbers")
    _need(0 <= lidar.range_min < lidar.range_max, f"{what} sees from {lidar.range_min} to {lidar.range_max} m")


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _need(holds: object, why: str) -> None:
    if not holds:
        raise ValueError(why)
