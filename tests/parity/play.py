"""Play a scenario through the drop-in API and note what can be seen from outside.

The same lines run on the reference implementation (record.py) and on irsim (test_parity.py), so they use nothing but
names that scripts use, the standard library and NumPy.

A scenario file says under `custom` how it is played:

    steps      number of calls of env.step()
    actions    {object id: [[steps, action], ...]}: consecutive segments; null and anything after the last segment
               leave the object to its behavior
    style      how actions are handed over: ids (default), list, flat, names, array, from (a list with
               the id of its first target; empty without one)
    calls      [[step, object id or "env", method, arguments], ...]: called before the step of that number
    reset      true: env.reset() right after irsim.make(); with D12 among `differs` record.py does it anyway, because
               irsim.make() already evaluates what the reference evaluates in its reset()
    look       what else is compared: sensors (all of each robot, not only the first), fov, fog
    differs    ids of intended differences that touch this scenario (README.md)
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

WIDTH = {"state": 6, "velocity": 3, "velocity_xy": 2, "goal": 3}


def column(values: Any, width: int, fill: float) -> np.ndarray:
    """A vector of any length as ``width`` numbers, missing ones filled up."""
    row = np.full(width, fill)
    if values is not None:
        flat = np.asarray(values, dtype=float).ravel()
        row[: len(flat)] = flat
    return row


def look(env: Any, more: Sequence[str] = ()) -> dict[str, Any]:
    """Everything compared, at this moment: one array per field, first axis objects (or beams)."""
    objects = list(env.objects)
    seen: dict[str, Any] = {
        "state": [column(o.state, WIDTH["state"], np.nan) for o in objects],
        "velocity": [column(o.velocity, WIDTH["velocity"], 0.0) for o in objects],
        "velocity_xy": [column(o.velocity_xy, WIDTH["velocity_xy"], np.nan) for o in objects],
        "goal": [column(o.goal, WIDTH["goal"], np.nan) for o in objects],
        "heading": [float(o.heading) for o in objects],
        "arrive": [bool(o.arrive_flag) for o in objects],
        "collision": [bool(o.collision_flag) for o in objects],
        "stop": [bool(o.stop_flag) for o in objects],
        "time": float(env.time),
        "status": str(env.status),
        "done": bool(env.done()),
    }
    for index, robot in enumerate(env.robot_list):
        if robot.lidar is not None:
            seen.update(read_scan(env.get_lidar_scan(index), index))
        if "sensors" in more:
            for place, sensor in enumerate(robot.sensors):
                seen.update(read_scan(sensor.get_scan(), 100 * index + place + 10))
        if "fov" in more:
            detected = {o.id for o in robot.get_fov_detected_objects()}
            seen[f"in_view_{index}"] = [o.id in detected for o in objects]
            seen[f"detected_{index}"] = [o is not robot and robot.fov_detect_object(o) for o in objects]
    if "fog" in more:
        seen["explored"] = np.array(env._world.fog_map.explored)
        seen["explored_ratio"] = float(env._world.fog_map.explored_ratio)
    return {name: np.array(value) for name, value in seen.items()}


def read_scan(scan: dict[str, Any], number: int) -> dict[str, Any]:
    """The measurements of one sensor."""
    seen = {f"ranges_{number}": np.array(scan["ranges"], dtype=float)}
    seen[f"valid_{number}"] = np.array(scan["valid"], dtype=bool)
    if "velocity" in scan:
        seen[f"hit_velocity_{number}"] = np.array(scan["velocity"], dtype=float)
    if "radial_velocity" in scan:
        seen[f"radial_velocity_{number}"] = np.array(scan["radial_velocity"], dtype=float)
    return seen


def once(env: Any) -> dict[str, np.ndarray]:
    """Facts of the objects, not of the moment: sizes, limits, names, scan header; footprints of the last pose."""
    objects = list(env.objects)
    facts: dict[str, Any] = {
        "name": [o.name for o in objects],
        "radius": [float(o.radius) for o in objects],
        "length": [float(o.length) for o in objects],
        "width": [float(o.width) for o in objects],
        "max_speed": [float(o.max_speed) for o in objects],
    }
    for o in objects:
        if o.shape != "map" and o.vertices is not None:
            facts[f"vertices_{o.id}"] = np.array(o.vertices, dtype=float)
    world = env._world
    if world.grid_map is not None:
        facts.update(grid_map=world.grid_map, cells=world.obstacle_positions, cell_size=world.reso)
    keys = ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max")
    for index, robot in enumerate(env.robot_list):
        if robot.lidar is not None:
            scan = env.get_lidar_scan(index)
            facts[f"scan_{index}"] = [float(scan[key]) for key in keys]
            facts[f"offset_{index}"] = [float(number) for number in env.get_lidar_offset(index)]
    return {name: np.array(value) for name, value in facts.items()}


def unroll(segments: list[Any], steps: int) -> list[Any]:
    """One action (or None) per step from ``[[steps, action], ...]``."""
    flat = [action for count, action in segments for _ in range(count)]
    return (flat + [None] * steps)[:steps]


def step(env: Any, given: dict[int, Any], style: str) -> None:
    """One env.step() with the actions handed over in one of the accepted ways."""
    given = {key: action for key, action in given.items() if action is not None}
    if style == "from":
        env.step(list(given.values()), min(given, default=0))
    elif not given:
        env.step()
    elif style == "ids":
        env.step([np.array(action, dtype=float) for action in given.values()], list(given))
    elif style == "list":
        env.step([given.get(key) for key in range(max(given) + 1)])
    elif style == "names":
        names = {o.id: o.name for o in env.objects}
        env.step({names[key]: action for key, action in given.items()})
    else:
        ((key, action),) = given.items()
        if style == "flat":
            env.step(list(action), key)
        elif style == "array":
            env.step(np.array(action, dtype=float), key)
        else:
            raise ValueError(f"unknown style {style!r}")


def play(irsim: ModuleType, path: Path, custom: dict[str, Any], reset: bool) -> dict[str, np.ndarray]:
    """Run one scenario; fields of `look` get a leading axis of steps + 1 (row 0: before the first step)."""
    env = irsim.make(str(path), headless=True, log_level="ERROR", seed=0)
    if reset:
        env.reset()
    steps = custom["steps"]
    actions = {key: unroll(segments, steps) for key, segments in custom.get("actions", {}).items()}
    more = custom.get("look", [])
    rows = [look(env, more)]
    for k in range(steps):
        for when, target, method, arguments in custom.get("calls", []):
            if when == k:
                owner = env if target == "env" else next(o for o in env.objects if o.id == target)
                getattr(owner, method)(*arguments)
        step(env, {key: plan[k] for key, plan in actions.items()}, custom.get("style", "ids"))
        rows.append(look(env, more))
    trace = {name: np.stack([row[name] for row in rows]) for name in rows[0]}
    trace.update(once(env))
    env.end()
    return trace
