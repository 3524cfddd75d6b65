"""The share of scenes that a central planner with full knowledge solves, bounded from below.

    python -m tests.benchmarks.central_planner --robots 15,20,25 --seeds 100-149

A robot that has arrived under the protocol ``freeze`` may block others for good, so not every order of arrivals solves
a scene. The planner knows everything: all goals, all footprints and how every robot decides. It plans by simulating
joint plans with the exact footprints and drives, and takes the first in which all robots arrive without a
contact. Plan 0 is `footprint_orca` as it is. In the others robots set off one after the other, in random orders of
priority, while waiting robots are obstacles; the spacing of their departures leaves the last one time to arrive.
Scenes without a plan may still have one: the share is a lower bound.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np

import irsim._core as core
from irsim.benchmarks.suite_plan import suite_plan
from irsim.scenario.read import or_raise, read
from irsim.simulation.events import read_events
from irsim.simulation.simulation import Simulation

SUITE = "random_polygons_v1"
POLICY = "footprint_orca"
LAST_DEPARTURE = (0.5, 0.25, 0.1)
"""Departure of the last robot, as a share of the time limit; plans take these in turns."""


def scene(robots: int) -> str:
    """The scenario of the suite with this number of robots, which run the policy and freeze on arrival."""
    (one,) = suite_plan(SUITE, policies=["dash"], scenarios=[f"robots-{robots}"], protocols=["freeze"]).scenarios
    return one.text.replace("  kinematics:", f"  behavior: {{name: {POLICY}}}\n  kinematics:", 1)


def succeeds(text: str, seed: int, departures: Sequence[int], steps: int) -> bool:
    """Whether all robots of a scene arrive without a touch if they set off in these steps.

    Args:
        text: The scenario.
        seed: Its seed.
        departures: (N,) steps in which the robots set off; until then they stand at their starts.
        steps: Time limit [steps].
    """
    simulation = Simulation(or_raise(read(text, strict=True))[0], [seed])
    for step in range(steps):
        waits = np.asarray(departures) > step
        if not waits.any():
            core.advance(simulation.world, simulation.state, steps - step, until_done=True)
            break
        simulation.command[waits] = 0.0
        simulation.given[waits] = 1
        simulation.step()
    touched = any(event.kind == "collision" for event in read_events(simulation))
    return bool(simulation.arrived.all()) and not touched


def plan(text: str, robots: int, seed: int, steps: int, most: int) -> int | None:
    """Index of the first joint plan that solves a scene, None if the first ``most`` do not."""
    rng = np.random.default_rng([seed, robots])
    for index in range(most):
        departures = np.zeros(robots, dtype=int)
        if index > 0:
            last = LAST_DEPARTURE[(index - 1) % len(LAST_DEPARTURE)] * steps
            departures[rng.permutation(robots)] = np.linspace(0, last, robots).astype(int)
        if succeeds(text, seed, departures.tolist(), steps):
            return index
    return None


def share(robots: int, seeds: Sequence[int], *, steps: int = 500, most: int = 30) -> tuple[dict[int, int], list[int]]:
    """Plan scenes.

    Args:
        robots: Number of robots.
        seeds: Seeds of the scenes.
        steps: Time limit [steps].
        most: Number of joint plans tried for each.

    Returns:
        The index of the plan of each solved seed, and the seeds without a plan.
    """
    text = scene(robots)
    plans = {seed: plan(text, robots, seed, steps, most) for seed in seeds}
    solved = {seed: index for seed, index in plans.items() if index is not None}
    return solved, [seed for seed in seeds if seed not in solved]


def main() -> None:
    """Print the share for each number of robots."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--robots", default="15,20,25", help="numbers of robots")
    parser.add_argument("--seeds", default="100-149", help="first and last seed, or a list of seeds")
    parser.add_argument("--plans", type=int, default=30, help="joint plans tried for each scene")
    given = parser.parse_args()
    first, _, last = given.seeds.partition("-")
    seeds = list(range(int(first), int(last) + 1)) if last else [int(seed) for seed in first.split(",")]
    for robots in map(int, given.robots.split(",")):
        solved, unsolved = share(robots, seeds, most=given.plans)
        alone = sum(index == 0 for index in solved.values())
        print(
            f"{robots} robots: {len(solved)} of {len(seeds)} scenes solved ({alone} by the first plan), "
            f"no plan for {unsolved or 'none'}",
            flush=True,
        )


if __name__ == "__main__":
    main()
