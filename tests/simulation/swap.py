"""Circle swap: robots on a ring change places with those opposite, many seeds at once; prints a table.

    python -m tests.simulation.swap --robots 10 50 --behaviors orca --drives omni diff --seeds 100

Start distances from the middle and angles are jittered by seed, neighbours start at least four radii apart. Nothing
limits acceleration. A robot that touches another stops for good.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import irsim

RADIUS = 0.3  # of a robot [m]
SPEED = 1.0  # [m/s]
STEP_TIME = 0.1  # [s]
JITTER_RADIUS, JITTER_ANGLE = 0.1, math.radians(5.0)
LEAST_DISTANCE = 4 * RADIUS
LIMIT = 5.0  # longest episode, in times the straight way takes

BEHAVIORS: dict[str, dict[str, Any]] = {
    "orca": {"neighborDist": 10.0, "maxNeighbors": 10, "timeHorizon": 5.0, "timeHorizonObst": 5.0, "maxSpeed": SPEED},
    "rvo": {"vxmax": SPEED, "vymax": SPEED},
    "sfm": {"vmax": SPEED, "safety_radius": RADIUS + 0.1},
}
DRIVES: dict[str, dict[str, Any]] = {
    "omni": {"kinematics": {"name": "omni"}, "vel_max": [SPEED, SPEED]},
    "diff": {"kinematics": {"name": "diff"}, "vel_max": [SPEED, 2.0]},
    "acker": {"kinematics": {"name": "acker"}, "vel_max": [SPEED, 0.8], "wheelbase": 0.4},
    "omni_angular": {"kinematics": {"name": "omni_angular"}, "vel_max": [SPEED, SPEED, 2.0]},
}


@dataclass(frozen=True)
class Outcome:
    """Outcomes of the episodes of one setting, by seed."""

    arrived: np.ndarray  # (seeds,) robots at their goal
    collided: np.ndarray  # (seeds,) robots that touched another
    collided_freely: np.ndarray  # (seeds,) those for which the behavior had reported no step without a way out
    infeasible: np.ndarray  # (seeds,) robot steps without a way out
    steps: np.ndarray  # (seeds,) until all robots had arrived or stopped, or the end
    robots: int
    wall: float  # [s]

    @property
    def success(self) -> np.ndarray:
        """(seeds,) every robot arrived."""
        return np.asarray(self.arrived == self.robots)


def ring_radius(robots: int) -> float:
    """[m]; five radii of arc per robot, which leaves room for the jitter."""
    return max(4.0, robots * 5 * RADIUS / (2 * math.pi))


def starts(robots: int, seed: int) -> np.ndarray:
    """(robots, 2) start positions about the origin; goals are opposite."""
    rng = np.random.default_rng([robots, seed])
    ring = ring_radius(robots)
    placed: list[np.ndarray] = []
    for k in range(robots):
        while True:
            angle = 2 * math.pi * k / robots + rng.uniform(-JITTER_ANGLE, JITTER_ANGLE)
            p = ring * rng.uniform(1 - JITTER_RADIUS, 1 + JITTER_RADIUS) * np.array([math.cos(angle), math.sin(angle)])
            if all(np.hypot(*(p - q)) >= LEAST_DISTANCE for q in placed):
                break
        placed.append(p)
    return np.array(placed)


def scenario(robots: int, behavior: str, drive: str, options: dict[str, Any]) -> dict[str, Any]:
    """The world in which the first episode starts; `open_batch` moves the robots of each world."""
    parts = dict(DRIVES[drive])
    shape = {"name": "circle", "radius": RADIUS}
    if "wheelbase" in parts:
        shape["wheelbase"] = parts.pop("wheelbase")
    size = 2.4 * ring_radius(robots)
    key = "group_behavior" if behavior == "orca" else "behavior"
    place = [[0.0, 0.0, 0.0] for _ in range(robots)]
    return {
        "world": {"width": size, "height": size, "offset": [-size / 2, -size / 2], "step_time": STEP_TIME},
        "robot": [
            {
                "number": robots,
                "shape": shape,
                "distribution": {"name": "manual"},
                "state": place,
                "goal": [p[:2] for p in place],
                "goal_threshold": RADIUS,
                key: {"name": behavior, **BEHAVIORS[behavior], **options},
                **parts,
            }
        ],
    }


def open_batch(data: dict[str, Any], robots: int, seeds: Sequence[int], threads: int | None) -> irsim.Batch:
    """One world per seed, each robot facing its goal."""
    from irsim.scenario.read import or_raise, read

    resolved, _ = or_raise(read(data, strict=True))
    batch = irsim.batch(resolved, len(seeds), seeds=seeds, threads=threads)
    state = batch.simulation.state
    for w, seed in enumerate(seeds):
        place = starts(robots, seed)
        batch.pose[w, :robots, :2] = place
        batch.pose[w, :robots, 2] = np.arctan2(-place[:, 1], -place[:, 0])
        for k in range(robots):
            row = w * len(batch.names) + k
            state.set_goals(row, [[*(-place[k]).tolist()]], True)
            state.set_initial(row, True, True)
    batch.reset()
    return batch


def swap(
    robots: int,
    behavior: str,
    drive: str,
    seeds: Sequence[int],
    options: dict[str, Any] | None = None,
    threads: int | None = None,
) -> Outcome:
    """Run the swap of ``robots`` once per seed."""
    began = time.perf_counter()
    batch = open_batch(scenario(robots, behavior, drive, options or {}), robots, seeds, threads)
    horizon = math.ceil(LIMIT * 2 * ring_radius(robots) / SPEED / STEP_TIME)
    infeasible = batch.infeasible
    hurt = np.zeros((batch.n, robots), dtype=bool)
    freely = np.zeros((batch.n, robots), dtype=bool)
    for _ in range(horizon):
        if batch.done.all():
            break
        batch.advance(1, until_done=True)
        new = (batch.collided == 1) & ~hurt
        hurt |= new
        freely |= new & (infeasible == 0)
    return Outcome(
        arrived=batch.arrived.sum(axis=1),
        collided=hurt.sum(axis=1),
        collided_freely=freely.sum(axis=1),
        infeasible=infeasible.sum(axis=1).copy(),
        steps=batch.count.copy(),
        robots=robots,
        wall=time.perf_counter() - began,
    )


def table_row(name: str, drive: str, out: Outcome) -> str:
    """One line of the table."""
    good = out.success
    seconds = f"{out.steps[good].mean() * STEP_TIME:.1f}" if good.any() else "-"
    stuck = out.infeasible.sum() / (out.steps.sum() * out.robots)
    cells = [name, drive, str(out.robots), f"{good.mean():.0%}", f"{out.arrived.mean() / out.robots:.1%}"]
    cells += [str(out.collided.sum()), str(out.collided_freely.sum()), seconds, f"{stuck:.2%}", f"{out.wall:.1f}"]
    return f"| {' | '.join(cells)} |"


HEADER = """\
| behavior | drive | robots | all arrived | robots arrived | collided | freely | time [s] | infeasible | run [s] |
|---|---|---|---|---|---|---|---|---|---|"""
LEGEND = """
all arrived: episodes in which every robot reached its goal; collided: robots that touched another, in all episodes;
freely: those for which no infeasible step was reported before; time: mean length of episodes in which all arrived;
infeasible: share of robot steps in which the behavior found no velocity that avoids all objects (only orca says so)."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, nargs="+", default=[10, 20, 50, 100])
    parser.add_argument("--behaviors", nargs="+", choices=BEHAVIORS, default=list(BEHAVIORS))
    parser.add_argument("--drives", nargs="+", choices=DRIVES, default=list(DRIVES))
    parser.add_argument("--seeds", type=int, default=100, help="seeds 0, 1, …")
    parser.add_argument("--threads", type=int, default=None, help="default: one per core")
    parser.add_argument(
        "--options", type=json.loads, default={}, help='behavior options over ours, as JSON: {"factor": 2}'
    )
    arguments = parser.parse_args()
    print(HEADER)
    for behavior in arguments.behaviors:
        for drive in arguments.drives:
            for robots in arguments.robots:
                out = swap(robots, behavior, drive, range(arguments.seeds), arguments.options, arguments.threads)
                print(table_row(behavior, drive, out), flush=True)
    print(LEGEND, flush=True)


if __name__ == "__main__":
    main()
