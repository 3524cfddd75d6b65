"""Measure how ``footprint_orca`` does with limited acceleration: ``python -m tests.benchmarks.limits_planned``.

The scenes are the suite ``random_polygons_v1`` with ``acce: [1, 4]``, and variants of it. They are fixed here, before
anything is measured. An episode succeeds if every robot arrives within 50 s without contact: contacts at the
ends of steps and between them are both counted, the latter by the core and, with ``--sampled``, by shapely as well.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from irsim.scenario.read import or_raise, read
from irsim.simulation.events import BETWEEN_STEPS, read_events
from irsim.simulation.simulation import Simulation

DURATION = 50.0
"""Time limit of an episode [s], as in the suite."""
LIMITS = {
    "diff": "vel_max: [1, 3], vel_min: [-1, -3], acce: [1, 4]",
    "omni": "vel_max: [1, 1], vel_min: [-1, -1], acce: [1, 1]",
    "omni_angular": "vel_max: [1, 1, 3], vel_min: [-1, -1, -3], acce: [1, 1, 4]",
    "acker": "vel_max: [1, 0.7], vel_min: [-1, -0.7], acce: [1, 4]",
}
SHAPE = (
    "{name: polygon, random_shape: true, is_convex: true, avg_radius_range: [0.1, 0.5], irregularity_range: [0, 0.6],"
    " num_vertices_range: [4, 7], wheelbase: 0.4}"
)
STATIC = """
  - {shape: {name: rectangle, length: 1.2, width: 0.8}, state: [3.2, 3.4, 0.4]}
  - {shape: {name: polygon, vertices: [[-0.6, -0.5], [0.7, -0.4], [0, 0.7]]}, state: [6.8, 3.6, 0]}
  - {shape: {name: circle, radius: 0.5}, state: [5, 6.8]}
"""
PEOPLE = """
  - number: 5
    kinematics: {name: omni}
    tags: [pedestrian]
    distribution: {name: random, range_low: [0.5, 0.5, -3.1], range_high: [9.5, 9.5, 3.1], min_distance: 1}
    shape: {name: circle, radius: 0.25}
    vel_max: [1, 1]
    vel_min: [-1, -1]
    goal_threshold: 0.3
    behavior: {name: orca, neighborDist: 5, maxNeighbors: 10, timeHorizon: 2, safe_radius: 0.02}
"""
_REPLAYED = ([[-2, 2], [12, 3]], [[12, 5.2], [-2, 4.6]], [[4, 12], [5.2, -2]], [[8, -2], [7.2, 12]])
REPLAYED = "".join(
    f"""
  - {{kinematics: {{name: omni}}, tags: [pedestrian], shape: {{name: circle, radius: 0.25}},
     behavior: {{name: replay, times: [{2 * k}, {2 * k + 14}], poses: {way}}}}}"""
    for k, way in enumerate(_REPLAYED)
)
"""People who come from outside and walk on at 1 m/s whatever happens."""


@dataclass(frozen=True)
class Cell:
    """A row of the table."""

    group: str
    robots: int
    protocol: str
    drive: str = "diff"
    integration: str = "euler"
    step_time: float = 0.1
    limited: bool = True
    obstacles: str = ""
    others: str = ""
    behavior: str = "{name: footprint_orca}"

    def text(self) -> str:
        """The scenario."""
        limits = LIMITS[self.drive] if self.limited else LIMITS[self.drive].split(", acce")[0]
        obstacles = f"obstacle:{self.obstacles}" if self.obstacles else ""
        return f"""
world: {{width: 10, height: 10, step_time: {self.step_time}, collision_mode: stop, after_arrival: {self.protocol},
  integration: {self.integration}}}
robot:
  - number: {self.robots}
    kinematics: {{name: {self.drive}}}
    distribution: {{name: random, range_low: [0.5, 0.5, -3.141592653589793],
      range_high: [9.5, 9.5, 3.141592653589793], min_distance: 1}}
    shape: {SHAPE}
    {limits.replace("], ", "]" + chr(10) + "    ")}
    goal_threshold: 0.3
    behavior: {self.behavior}
{self.others}
{obstacles}
"""


def cells() -> Iterator[Cell]:
    """All rows, in their order."""
    for protocol in ("freeze", "yield"):
        for integration in ("euler", "exact"):
            for robots in (5, 10, 15, 25):
                yield Cell("robots", robots, protocol, integration=integration)
        for integration in ("euler", "exact"):
            yield Cell("static", 10, protocol, integration=integration, obstacles=STATIC)
        for step_time in (0.05, 0.2):
            for robots in (10, 25):
                yield Cell("steps", robots, protocol, step_time=step_time)
        for drive in ("omni", "omni_angular", "acker"):
            yield Cell("drives", 10, protocol, drive)
        for robots in (10, 25):
            yield Cell("unlimited", robots, protocol, limited=False)
        yield Cell("orca", 5, protocol, others=PEOPLE)
        yield Cell("replayed", 10, protocol, obstacles=REPLAYED)


@dataclass
class Result:
    """Outcomes of the episodes of a cell."""

    success: int = 0
    collided: int = 0
    late: int = 0
    between: int = 0
    sampled: int = 0


def run(cell: Cell, seeds: list[int], threads: int, *, sampled: bool) -> Result:
    """Run one episode for each seed."""
    simulation = Simulation(or_raise(read(cell.text(), strict=False))[0], seeds, threads=threads)
    steps = round(DURATION / cell.step_time)
    result = Result()
    if sampled:
        result.sampled = int(_sampled(simulation, cell, steps).sum())
    else:
        simulation.advance(steps, until_done=True)
    arrived = simulation.arrived.reshape(simulation.copies, -1)[:, simulation.robots[: simulation.objects]]
    for w in range(simulation.copies):
        kinds = [event.kind for event in read_events(simulation, w)]
        touched = "collision" in kinds
        within = any(kind in BETWEEN_STEPS for kind in kinds)
        result.between += within
        result.collided += touched
        result.late += not touched and not arrived[w].all()
        result.success += bool(arrived[w].all()) and not touched and not within
    return result


def _sampled(simulation: Simulation, cell: Cell, steps: int) -> NDArray[np.bool_]:
    """(W,) whether two bodies meet within a step though they are apart at both its ends."""
    count, copies = simulation.objects, simulation.copies
    bodies = [_Body(simulation, row) for row in range(count * copies)]
    met = np.zeros(copies, dtype=bool)
    before = simulation.pose.copy()
    for _ in range(steps):
        simulation.advance(1, until_done=True)
        now = simulation.pose.copy()
        for w in range(copies):
            met[w] = met[w] or _meets(bodies, before, now, range(w * count, (w + 1) * count), cell.integration)
        before = now
        if simulation.done().all():
            break
    return met


class _Body:
    """The outline of a row in its own frame."""

    def __init__(self, simulation: Simulation, row: int) -> None:
        state = simulation.state
        if state.parts(row)[0] == "circle":
            x, y, radius = state.circle(row, 0, False)
            angle = np.linspace(0, 2 * np.pi, 48, endpoint=False)
            self.corners = np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], 1)
        else:
            self.corners = np.array(state.vertices(row, 0, False))
        self.reach = float(np.hypot(*self.corners.T).max())

    def at(self, poses: NDArray[np.float64]) -> NDArray[np.object_]:
        """(K,) polygons at (K, 3) poses."""
        c, s = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
        x, y = self.corners.T
        points = np.stack([poses[:, :1] + c * x - s * y, poses[:, 1:2] + s * x + c * y], -1)
        return np.asarray(shapely.polygons(points))


def _path(before: NDArray[np.float64], now: NDArray[np.float64], integration: str) -> NDArray[np.float64]:
    """(K, 3) poses within a step."""
    share = np.linspace(0, 1, 65)
    turn = (now[2] - before[2] + np.pi) % (2 * np.pi) - np.pi
    chord = now[:2] - before[:2]
    if integration == "euler" or abs(turn) < 1e-9:
        way = share[:, None] * chord
    else:
        length = np.sin(share * turn / 2) / np.sin(turn / 2)
        angle = (share - 1) * turn / 2
        c, s = np.cos(angle) * length, np.sin(angle) * length
        way = np.stack([c * chord[0] - s * chord[1], s * chord[0] + c * chord[1]], 1)
    return np.column_stack([before[:2] + way, before[2] + share * turn])


def _meets(
    bodies: list[_Body], before: NDArray[np.float64], now: NDArray[np.float64], rows: range, integration: str
) -> bool:
    moved = np.hypot(*(now[:, :2] - before[:, :2]).T)
    turned = np.abs((now[:, 2] - before[:, 2] + np.pi) % (2 * np.pi) - np.pi)
    for i in rows:
        for j in range(i + 1, rows.stop):
            travel = moved[i] + moved[j] + bodies[i].reach * turned[i] + bodies[j].reach * turned[j]
            apart = np.hypot(*(before[i, :2] - before[j, :2])) - bodies[i].reach - bodies[j].reach
            if not travel > 0 or not apart < travel:
                continue
            [one], [other] = bodies[i].at(before[i : i + 1]), bodies[j].at(before[j : j + 1])
            if shapely.distance(one, other) > 1.2 * travel:
                continue
            paths = [_path(before[k], now[k], integration) for k in (i, j)]
            hits = shapely.intersects(bodies[i].at(paths[0]), bodies[j].at(paths[1]))
            if hits.any() and not hits[0] and not hits[-1]:
                return True
    return False


def main(arguments: list[str] | None = None) -> int:
    """Print a table in Markdown, line by line."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.limits_planned", description=__doc__)
    parser.add_argument("--first-seed", type=int, default=1000)
    parser.add_argument("--episodes", type=int, default=200)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--groups", nargs="*", help="only the rows of these groups")
    parser.add_argument("--behavior", default=Cell.behavior, help="the behavior of the robots, as in a scenario")
    parser.add_argument("--unlimited", action="store_true", help="without acce")
    parser.add_argument("--sampled", action="store_true", help="count contacts between steps with shapely, too (slow)")
    given = parser.parse_args(arguments)
    head = ["scene", "robots", "protocol", "drive", "integration", "step", "success", "collided", "late", "between"]
    head += ["sampled"] * given.sampled
    print(f"| {' | '.join(head)} | time |\n|{'---|' * (len(head) + 1)}")
    seeds = list(range(given.first_seed, given.first_seed + given.episodes))
    for cell in cells():
        if given.groups and cell.group not in given.groups:
            continue
        start = time.perf_counter()
        cell = replace(cell, behavior=given.behavior, limited=cell.limited and not given.unlimited)
        result = run(cell, seeds, given.threads, sampled=given.sampled)
        row = [cell.group, cell.robots, cell.protocol, cell.drive, cell.integration, f"{cell.step_time:g} s"]
        row += [f"{100 * result.success / len(seeds):.1f} %", result.collided, result.late, result.between]
        row += [result.sampled] * given.sampled
        print(f"| {' | '.join(map(str, row))} | {time.perf_counter() - start:.0f} s |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
