"""The part of the page on crowds in a corridor without ends: speed against density, and lanes of two directions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.scenario.read import or_raise, read
from irsim.scenario.yaml.document import load_text
from irsim.simulation.simulation import Simulation

LENGTH, WIDTH = 20.0, 4.0
"""Of the corridor [m]; who leaves it at one end comes in at the other."""
RADIUS, STEP = 0.2, 0.1
"""Radius of people [m], and period [s]."""
FREE_SPEED, SPREAD, SLOWEST = 1.34, 0.26, 0.6
"""Mean and standard deviation of the wanted speeds, and the least of them [m/s]."""
SETTLING, MEASURED = 30.0, 20.0
"""Time before the measurement, and of it [s]."""
DENSITIES = (0.25, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0)
"""People per m²."""
LANE_DENSITIES = (0.25, 0.5, 1.0, 1.5)
WORLDS = 3
"""Corridors, each with other starts and speeds, whose mean is shown."""
BEHAVIORS: dict[str, dict[str, Any]] = {
    "sfm": {"name": "sfm", "sigma_obstacle": 0.2},
    "sfm, keep_gap: true": {"name": "sfm", "keep_gap": True, "sigma_obstacle": 0.2},
    "sfm, people: eth": {"name": "sfm", "people": "eth", "sigma_obstacle": 0.2},
    "sfm, people: eth, keep_gap: true": {"name": "sfm", "people": "eth", "keep_gap": True, "sigma_obstacle": 0.2},
    "sfm, people: zara01": {"name": "sfm", "people": "zara01", "sigma_obstacle": 0.2},
}
_BAND = 0.4
"""People whose y differs by less walk in one line, when lanes are counted [m]."""
_AHEAD = 100.0
"""Distance to the goal, which stays ahead [m]."""


@dataclass(frozen=True)
class Flow:
    """A crowd's speed and order, as the mean of several corridors.

    Attributes:
        speed: Mean speed along the corridor, in the direction that each one wants [m/s].
        overlapping: Share of people who overlap others at a time.
        lanes: Order of lanes at the end, see :func:`lane_order`.
        mixed: The same with directions at random.
    """

    speed: float
    overlapping: float
    lanes: float
    mixed: float


def weidmann(density: float) -> float:
    """Speed [m/s] at a density [1/m²] (Weidmann: Transporttechnik der Fussgänger, 1993)."""
    return float(1.34 * (1.0 - np.exp(-1.913 * (1.0 / density - 1.0 / 5.4))))


def walk(behavior: Mapping[str, Any], density: float, *, both: bool = False, worlds: int = WORLDS) -> Flow:
    """Let people walk through the corridor.

    Args:
        behavior: Their behavior.
        density: People per m².
        both: Every second one walks in the other direction.
        worlds: Number of corridors.
    """
    count = round(density * LENGTH * WIDTH)
    rng = np.random.default_rng(0)
    simulation = Simulation(_scenario(behavior, count), range(worlds), threads=2)
    shape = (worlds, simulation.objects)
    pose, control = simulation.pose.reshape(*shape, 3), simulation.control.reshape(*shape, 3)
    command, given = simulation.command.reshape(*shape, 3), simulation.given.reshape(shape)
    goal = simulation.goal.reshape(*shape, 3)
    people, images = slice(0, count), slice(count, 2 * count)
    wanted = np.maximum(rng.normal(FREE_SPEED, SPREAD, (worlds, count)), SLOWEST)
    simulation.pace.reshape(shape)[:, people] = wanted / FREE_SPEED
    simulation.state.vel_max.reshape(*shape, 3)[:, people, :2] = wanted[:, :, None]
    simulation.state.vel_min.reshape(*shape, 3)[:, people, :2] = -wanted[:, :, None]
    way = np.where(both & (np.arange(count) % 2 == 1), -1.0, 1.0)
    pose[:, people, :2] = np.stack([_places(count, rng) for _ in range(worlds)])
    speeds, overlaps = [], []
    for step in range(round((SETTLING + MEASURED) / STEP)):
        x = np.mod(pose[:, people, 0], LENGTH)
        pose[:, people, 0] = x
        pose[:, images, 0] = np.where(x < LENGTH / 2, x + LENGTH, x - LENGTH)
        pose[:, images, 1:] = pose[:, people, 1:]
        control[:, images] = command[:, images] = control[:, people]
        given[:, images] = 1
        goal[:, people, 0], goal[:, people, 1] = x + _AHEAD * way, pose[:, people, 1]
        if step * STEP >= SETTLING and step % 10 == 0:
            overlaps.append(_overlapping(pose[:, : 2 * count, :2], count))
        simulation.advance(1)
        if step * STEP >= SETTLING:
            speeds.append(float(((pose[:, people, 0] - x) / STEP * way).mean()))
    y = pose[:, people, 1]
    return Flow(
        float(np.mean(speeds)),
        float(np.mean(overlaps)),
        float(np.mean([lane_order(one, way) for one in y])),
        float(np.mean([lane_order(one, rng.permutation(way)) for one in y for _ in range(20)])),
    )


def lane_order(y: Floats, way: Floats) -> float:
    """How much people walk in lanes: 1 if all people in line with a person walk as the person does, or against it.

    It is the mean over people of the squared balance of directions among the others in their line: (same - opposite)² /
    (same + opposite)².

    Args:
        y: (N,) places across the corridor [m].
        way: (N,) directions, 1 or -1.
    """
    line = (np.abs(y[:, None] - y[None, :]) < _BAND) & ~np.eye(len(y), dtype=bool)
    number = line.sum(axis=1)
    balance = (line * way[:, None] * way[None, :]).sum(axis=1) / np.maximum(number, 1)
    return float((balance[number > 0] ** 2).mean()) if (number > 0).any() else float("nan")


def parts() -> dict[str, str]:
    """The text of this part of the page."""
    heads = ["density [1/m²]", "Weidmann [m/s]", *(f"`{name}`" for name in BEHAVIORS)]
    speed = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|", *map(speed_line, DENSITIES)]
    del heads[1]
    lanes = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|", *map(lane_line, LANE_DENSITIES)]
    return {"speeds": "\n".join(speed), "lanes": "\n".join(lanes)}


def speed_line(density: float) -> str:
    """Row of the table of speeds: of people in one direction, and how many of them overlap others."""
    flows = [walk(behavior, density) for behavior in BEHAVIORS.values()]
    cells = [f"{flow.speed:.2f} ({flow.overlapping:.0%})" for flow in flows]
    return f"| {density:g} | {weidmann(density):.2f} | {' | '.join(cells)} |"


def lane_line(density: float) -> str:
    """Row of the table of lanes: their order, the same with directions at random, and the speed."""
    flows = [walk(behavior, density, both=True) for behavior in BEHAVIORS.values()]
    cells = [f"{flow.lanes:.2f} ({flow.mixed:.2f}), {flow.speed:.2f} m/s" for flow in flows]
    return f"| {density:g} | {' | '.join(cells)} |"


def _places(count: int, rng: np.random.Generator) -> Floats:
    """(count, 2) places on a grid with gaps, a little out of place."""
    rows = max(1, round((WIDTH - 2 * RADIUS) / 0.5))
    columns = -(-count // rows)
    cells: NDArray[np.int64] = rng.permutation(rows * columns)[:count]
    spacing = np.array([LENGTH / columns, (WIDTH - 2 * RADIUS - 0.1) / rows])
    low = np.array([0.0, -WIDTH / 2 + RADIUS + 0.05])
    result: Floats = low + spacing * (
        np.stack([cells // rows, cells % rows], axis=1) + rng.uniform(0.4, 0.6, (count, 2))
    )
    return result


def _overlapping(places: Floats, count: int) -> float:
    """Share of the first ``count`` of (w, N, 2) people who overlap another one."""
    shares = []
    for one in places:
        apart = np.linalg.norm(one[:count, None] - one[None, :], axis=2)
        apart[np.arange(count), np.arange(count)] = np.inf
        shares.append(float((apart < 2 * RADIUS).any(axis=1).mean()))
    return float(np.mean(shares))


def _scenario(behavior: Mapping[str, Any], count: int) -> Any:
    """People, their images beyond the ends of the corridor, and its walls."""
    body = {"kinematics": {"name": "omni"}, "shape": {"name": "circle", "radius": RADIUS}, "number": count}
    own = {**behavior, **({"vmax": FREE_SPEED} if behavior["name"] == "sfm" else {})}
    spots = [[LENGTH * index / count, 0, 0] for index in range(count)]
    beyond = [[LENGTH + x, y, 0] for x, y, _ in spots]
    top = {"vel_max": [5, 5], "vel_min": [-5, -5]}
    wall = {"shape": {"name": "linestring", "vertices": [[-LENGTH, 0], [2 * LENGTH, 0]]}}
    entries: list[dict[str, Any]] = [
        {**body, **top, "state": spots, "goal": [[x + _AHEAD, y] for x, y, _ in spots], "behavior": own},
        {**body, **top, "state": beyond, "goal": [None] * count},
        *({**wall, "state": [0, side * WIDTH / 2, 0]} for side in (-1, 1)),
    ]
    world = {"width": 600, "height": 600, "offset": [-300, -300], "step_time": STEP, "collision_mode": "unobstructed"}
    document = load_text(yaml.safe_dump({"world": world, "obstacle": entries}), name="corridor")
    return or_raise(read(document, strict=True))[0]
