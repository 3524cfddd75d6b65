"""RL-RVO's weights by its authors on their circle, with and without the limit of right turns.

``RL_RVO_WEIGHTS=pre_train.pt python -m tests.benchmarks.authors_circle [EPISODES] [ROBOTS …]`` prints the table of
``policies_of_the_paper.md``: robots of radius 0.2 m on a circle of radius 4 m with random headings drive to the other
side at up to 1.5 m/s and 1.5 rad/s, in 30 s; an episode ends with the first collision.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence

import irsim

__all__ = ["main", "outcomes", "scene", "shares"]

_FAST_RIGHT = 16.0
"""Turn rate to the right that no heading error exceeds [rad/s]."""
_LIMIT = 1.5
"""Turn rate that the authors' file names [rad/s]."""


def scene(robots: int, right: float) -> str:
    """The authors' circle.

    Args:
        robots: Number of robots.
        right: Largest turn rate to the right [rad/s].
    """
    return f"""
world: {{width: 10, height: 10, step_time: 0.1, collision_mode: stop, after_arrival: freeze}}
robot:
  - number: {robots}
    kinematics: {{name: diff}}
    distribution: {{name: circle, center: [5, 5], radius: 4}}
    shape: {{name: circle, radius: 0.2}}
    vel_max: [1.5, {_LIMIT}]
    vel_min: [-1.5, {-right}]
    goal_threshold: 0.2
"""


def outcomes(robots: int, seeds: Sequence[int], *, free: bool, margin: float) -> str:
    """A letter for each seed: s, c or t for success, collision or time-out.

    Args:
        robots: Number of robots.
        seeds: Seeds of the headings.
        free: Whether right turns are not limited.
        margin: Margin of the policy [m].
    """
    policy = {"name": "rl_rvo_authors", "margin": margin, "unlimited_right_turns": free}
    made = irsim.benchmark(
        scene(robots, _FAST_RIGHT if free else _LIMIT),
        policies=[policy],
        seeds=list(seeds),
        steps=300,
        perturb={"heading": round(math.pi, 4)},
        until="first_collision",
    )
    return "".join(episode.outcome[0] for episode in made.episodes)


def shares(letters: str) -> str:
    """Numbers of successes, collisions and time-outs."""
    return "/".join(str(letters.count(kind)) for kind in "sct")


def main(episodes: int = 100, robots: Sequence[int] = (6, 8, 10, 12, 14)) -> None:
    """Print the table."""
    print("| robots | margin | right turns limited | not limited |\n|---|---|---|---|")
    for count in robots:
        for margin in (0.1, 0.2):
            cells = [outcomes(count, range(episodes), free=free, margin=margin) for free in (False, True)]
            print(f"| {count} | {margin} m |", " | ".join(map(shares, cells)), "|", flush=True)


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:]]
    main(*numbers[:1], **({"robots": numbers[1:]} if numbers[1:] else {}))
