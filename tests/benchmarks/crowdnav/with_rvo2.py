"""CrowdNav's evaluation of ORCA, stated anew over an RVO2 library, with the scenes of CrowdNav.

irsim neither needs nor installs RVO2; this file needs NumPy and the binding ``pyrvo`` and nothing of irsim, so it runs
in an environment of its own:

    python -m venv /tmp/v
    /tmp/v/bin/pip install --no-deps pyrvo numpy
    /tmp/v/bin/python tests/benchmarks/crowdnav/with_rvo2.py

It prints success, collision, time-out and time to goal of 500 scenes, under CrowdNav's rules and with contacts looked
for at the ends of steps only. ``--all`` adds the other scenarios of the page; ``--keep`` writes both into this folder,
for the page and the tests.

The rules (Chen et al., ICRA 2019, and their program, github.com/vita-epfl/CrowdNav):

- Scene k of the test set is drawn with NumPy's random numbers of seed 1000 + k. Discs of radius 0.3 m; the robot goes
  from (0, -4) to (0, 4). ``circle``: a person starts at a random angle of a circle of 4 m, up to 0.5 m off in x and in
  y, and goes to the opposite place. ``square``: it goes from one half of a square of 10 m to the other. A start that
  leaves less than 0.2 m to another start is drawn again, a goal likewise; on a circle starts keep away from goals.
- The robot and each person decide every 0.25 s with ORCA: 10 m, 10 neighbours, 5 s, radius 0.01 m larger, 1 m/s at
  most, towards the goal. Each has a simulator of its own, in which the others want to stand still. People see the
  robot only if it is visible.
- A contact counts within a step, too: along the straight line that the robot, with its new velocity, and the person,
  with the velocity that it *had*, would make in a step. The robot has arrived less than 0.3 m from its goal. From 24 s
  on an episode ends as a time-out, before contacts and arrival are looked for.
"""

from __future__ import annotations

import argparse
import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

DT = 0.25
"""Period [s]."""
RADIUS = 0.3
"""Radius of the robot and of each person [m]."""
MARGIN = 0.01
"""Added to each radius for ORCA [m]."""
APART = 0.2
"""Smallest gap between two starts or two goals [m]."""
FIRST_SEED = 1000
EPISODES = 500
LIMITS = {"within": 24.0, "ends": 25.0}
"""Where contacts are looked for -> time from which an episode is a time-out [s]."""
FOLDER = Path(__file__).parent
PUBLISHED = "circle-invisible-5"
"""The published scenario, whose episodes are kept one by one."""
SCENARIOS = (
    *(f"circle-{sight}-{people}" for sight in ("invisible", "visible") for people in (5, 10, 15)),
    *(f"square-{sight}-{people}" for sight in ("invisible", "visible") for people in (5, 10, 15, 20)),
)
"""All scenarios of the page in which there is room for all people."""

Point = tuple[float, float]


@dataclass
class Disc:
    """The robot, or a person.

    Attributes:
        place: Where it is [m].
        goal: Where it goes [m].
        velocity: Its velocity in the last step [m/s].
    """

    place: Point
    goal: Point
    velocity: Point = (0.0, 0.0)

    def moved(self, velocity: Point) -> Point:
        """Its place after a step with this velocity [m]."""
        return (self.place[0] + velocity[0] * DT, self.place[1] + velocity[1] * DT)

    def wanted(self) -> Point:
        """The velocity that it would like to have [m/s]: to the goal, 1 m/s at most."""
        x, y = self.goal[0] - self.place[0], self.goal[1] - self.place[1]
        far = math.hypot(x, y)
        return (x / far, y / far) if far > 1 else (x, y)


def scene(seed: int, people: int, shape: str = "circle") -> list[Disc]:
    """The robot, then the people.

    Args:
        seed: Seed of NumPy's global generator as it was in 2018.
        people: Number of people.
        shape: ``circle`` or ``square``.
    """
    draw = np.random.RandomState(seed).random_sample
    discs = [Disc((0.0, -4.0), (0.0, 4.0))]

    def free(point: Point, places: Sequence[Point]) -> bool:
        return all(math.dist(point, place) >= 2 * RADIUS + APART for place in places)

    while len(discs) <= people:
        starts, goals = [one.place for one in discs], [one.goal for one in discs]
        if shape == "circle":
            angle, dx, dy = 2 * math.pi * draw(), draw() - 0.5, draw() - 0.5
            start = (4 * math.cos(angle) + dx, 4 * math.sin(angle) + dy)
            if free(start, [*starts, *goals]):
                discs.append(Disc(start, (-start[0], -start[1])))
            continue
        side = -1 if draw() > 0.5 else 1
        ends = []
        for sign, places in ((side, starts), (-side, goals)):
            while not free(point := (5 * draw() * sign, 10 * (draw() - 0.5)), places):
                pass
            ends.append(point)
        discs.append(Disc(*ends))
    return discs


class Orca:
    """The decisions of one disc, in a simulator of RVO2 of its own."""

    def __init__(self, seen: Sequence[Disc]) -> None:
        """Put the one who decides, and then those whom it sees, into a simulator."""
        self._simulator: Any = import_module("pyrvo").RVOSimulator(DT, 10, 10, 5, 5, RADIUS, 1)
        for one in seen:
            self._simulator.add_agent(one.place, 10, 10, 5, 5, RADIUS + MARGIN, 1, one.velocity)

    def decide(self, seen: Sequence[Disc]) -> Point:
        """The next velocity of the first [m/s]."""
        for number, one in enumerate(seen):
            self._simulator.set_agent_position(number, one.place)
            self._simulator.set_agent_velocity(number, one.velocity)
            self._simulator.set_agent_pref_velocity(number, (0.0, 0.0) if number else one.wanted())
        self._simulator.do_step()
        velocity = self._simulator.get_agent_velocity(0)
        return (velocity.x, velocity.y)


def nearest(start: Point, end: Point) -> float:
    """Smallest distance between a segment and the origin [m]."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = dx * dx + dy * dy
    share = 0.0 if length == 0 else min(1.0, max(0.0, -(start[0] * dx + start[1] * dy) / length))
    return math.hypot(start[0] + share * dx, start[1] + share * dy)


def between(robot: Disc, person: Disc, command: Point) -> float:
    """Smallest distance of their centres within the step, in which the person keeps the velocity that it had [m]."""
    x, y = person.place[0] - robot.place[0], person.place[1] - robot.place[1]
    vx, vy = person.velocity[0] - command[0], person.velocity[1] - command[1]
    return nearest((x, y), (x + vx * DT, y + vy * DT))


def episode(discs: Sequence[Disc], *, visible: bool = False, contacts: str = "within") -> tuple[str, float]:
    """The outcome of an episode and its time [s].

    Args:
        discs: The robot, then the people.
        visible: Whether people see the robot.
        contacts: ``within`` steps, as CrowdNav looks for them, or at their ``ends`` only.
    """
    robot, *people = discs
    sights = [[robot, *people]]
    for person in people:
        others = [one for one in people if one is not person]
        sights.append([person, *others, *([robot] if visible else [])])
    minds = [Orca(seen) for seen in sights]
    time = 0.0
    while time < LIMITS[contacts]:
        commands = [mind.decide(seen) for mind, seen in zip(minds, sights, strict=True)]
        gaps = [between(robot, person, commands[0]) for person in people] if contacts == "within" else []
        for one, command in zip(discs, commands, strict=True):
            one.place, one.velocity = one.moved(command), command
        time += DT
        if contacts == "ends":
            gaps = [math.dist(robot.place, person.place) for person in people]
        if min(gaps) < 2 * RADIUS:
            return "collision", time
        if math.dist(robot.place, robot.goal) < RADIUS:
            return "success", time
    return "timeout", time


def run(name: str, contacts: str, episodes: int) -> list[tuple[str, float]]:
    """Outcome and time of each episode of a scenario, such as ``circle-invisible-5``."""
    shape, sight, people = name.split("-")
    seeds = range(FIRST_SEED, FIRST_SEED + episodes)
    return [episode(scene(seed, int(people), shape), visible=sight == "visible", contacts=contacts) for seed in seeds]


def summary(results: Sequence[tuple[str, float]]) -> list[float]:
    """Shares of success, collision and time-out, and mean time to goal [s]."""
    shares = [sum(one == what for one, _ in results) / len(results) for what in ("success", "collision", "timeout")]
    return [*shares, float(np.mean([time for outcome, time in results if outcome == "success"]))]


def main(arguments: list[str] | None = None) -> None:
    """Print a table, and keep it if it is asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter, prog="with_rvo2.py"
    )
    parser.add_argument("--all", action="store_true", help="all scenarios of the page, not only the published one")
    parser.add_argument("--episodes", type=int, default=EPISODES, help="number of scenes (default: %(default)s)")
    parser.add_argument("--keep", action="store_true", help="write rvo2.csv and, with --all, rvo2_scenarios.csv")
    given = parser.parse_args(arguments)
    print("| scenario | contacts | success | collision | timeout | time to goal |\n|---|---|---|---|---|---|")
    rows = []
    for name in SCENARIOS if given.all else (PUBLISHED,):
        results = {contacts: run(name, contacts, given.episodes) for contacts in LIMITS}
        for contacts, ones in results.items():
            success, collision, timeout, time = summary(ones)
            cells = [f"{success:.3f}", f"{collision:.3f}", f"{timeout:.3f}", f"{time:.2f}"]
            rows.append([name, contacts, *cells])
            print(f"| {name} | {contacts} | {' | '.join(cells)} s |", flush=True)
        if name == PUBLISHED and given.keep:
            seeds = range(FIRST_SEED, FIRST_SEED + given.episodes)
            pairs = zip(seeds, results["within"], results["ends"], strict=True)
            lines = [[seed, *within, *ends] for seed, within, ends in pairs]
            _write("rvo2.csv", ["seed", *(f"{what}_{key}" for key in LIMITS for what in ("outcome", "time"))], lines)
    if given.all and given.keep:
        _write("rvo2_scenarios.csv", ["scenario", "contacts", "success", "collision", "timeout", "time"], rows)


def _write(name: str, head: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    with (FOLDER / name).open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *rows])


if __name__ == "__main__":
    main()
