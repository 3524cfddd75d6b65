"""Measure how ``footprint_orca`` does with limited acceleration: ``python -m tests.benchmarks.limits_planned``.

The scenes are the suite ``random_polygons_v1`` with ``acce: [1, 4]``, and variants of it. They are fixed here, before
anything is measured. An episode succeeds if every robot arrives within 50 s without contact: contacts at the
ends of steps and between them are both counted.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

from irsim.scenario.read import or_raise, read
from irsim.simulation.events import BETWEEN_STEPS, read_events
from irsim.simulation.simulation import Simulation

DURATION = 50.0
"""Time limit of an episode [s], as in the suite."""
PROTOCOLS = ("freeze", "yield")
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
    for protocol in PROTOCOLS:
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


def run(cell: Cell, seeds: list[int], threads: int) -> Result:
    """Run one episode for each seed."""
    simulation = Simulation(or_raise(read(cell.text(), strict=False))[0], seeds, threads=threads)
    simulation.advance(round(DURATION / cell.step_time), until_done=True)
    result = Result()
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


def main(arguments: list[str] | None = None) -> int:
    """Print a table in Markdown, line by line."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.limits_planned", description=__doc__)
    parser.add_argument("--first-seed", type=int, default=1000)
    parser.add_argument("--episodes", type=int, default=200)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--groups", nargs="*", help="only the rows of these groups")
    parser.add_argument("--robots", type=int, nargs="*", help="only the rows with these numbers of robots")
    parser.add_argument("--protocols", nargs="*", choices=PROTOCOLS, help="only the rows of these protocols")
    parser.add_argument("--behavior", default=Cell.behavior, help="the behavior of the robots, as in a scenario")
    parser.add_argument("--unlimited", action="store_true", help="without acce")
    given = parser.parse_args(arguments)
    head = ["scene", "robots", "protocol", "drive", "integration", "step", "success", "collided", "late", "between"]
    print(f"| {' | '.join(head)} | time |\n|{'---|' * (len(head) + 1)}")
    seeds = list(range(given.first_seed, given.first_seed + given.episodes))
    for cell in cells():
        chosen = ((cell.group, given.groups), (cell.robots, given.robots), (cell.protocol, given.protocols))
        if any(wanted and value not in wanted for value, wanted in chosen):
            continue
        start = time.perf_counter()
        cell = replace(cell, behavior=given.behavior, limited=cell.limited and not given.unlimited)
        result = run(cell, seeds, given.threads)
        row = [cell.group, cell.robots, cell.protocol, cell.drive, cell.integration, f"{cell.step_time:g} s"]
        row += [f"{100 * result.success / len(seeds):.1f} %", result.collided, result.late, result.between]
        print(f"| {' | '.join(map(str, row))} | {time.perf_counter() - start:.0f} s |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
