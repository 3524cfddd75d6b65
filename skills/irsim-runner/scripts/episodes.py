#!/usr/bin/env python3
# /// script
# requires-python = ">=3.10"
# dependencies = ["irsim-mcp==0.1.0"]
# ///
"""Run episodes of a scenario with actions from a function of yours, and print the outcome of each as JSON.

The function is called with the environment before each step. It returns an argument for env.step: one action for the
first robot, a list of actions, a mapping {name: action}, or None to let behaviors drive all robots.

Exits with 0 if all episodes ran, 1 if the function failed, 2 if an argument is invalid.
"""

from __future__ import annotations

import argparse
import importlib
import json
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import irsim
from irsim.simulation.time_limit import default_time_limit

MAX_LISTED = 100
"""Episodes that are listed, and collisions that are listed of each."""


def read_arguments() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", type=Path, help="the YAML file")
    parser.add_argument("--policy", metavar="MODULE:FUNCTION", help="the function; default: behaviors drive all robots")
    parser.add_argument("--episodes", type=int, default=10, help="number of episodes (default: 10)")
    parser.add_argument("--seed", type=int, help="default: the scenario's, else a random one, which is printed")
    parser.add_argument("--steps", type=int, help="steps of an episode at most; default: as `irsim run`")
    parser.add_argument(
        "--same-layout", action="store_true", help="repeat the first layout instead of drawing the next"
    )
    parser.add_argument(
        "--import",
        dest="imports",
        metavar="MODULE",
        action="append",
        default=[],
        help="import a module first; repeatable",
    )
    parser.add_argument("--picture", type=Path, help="PNG or SVG to write at the end of the first episode")
    return parser.parse_args()


def find_policy(name: str | None) -> Callable[[Any], Any]:
    """Return the function of that name; without a name, one that lets behaviors drive all robots."""
    if name is None:
        return lambda env: None
    module, _, function = name.partition(":")
    policy: Callable[[Any], Any] = getattr(importlib.import_module(module), function or "act")
    return policy


def horizon_of(env: Any, steps: int | None) -> int:
    """Return the greatest number of steps of an episode."""
    if steps is not None:
        return steps
    limit = env.scenario.world.time_limit
    seconds = default_time_limit(env.simulation) if limit is None else limit
    return math.ceil(seconds / env.step_time - 1e-9)  # as irsim run does


def run_episode(env: Any, policy: Callable[[Any], Any], horizon: int) -> dict[str, Any]:
    """Run one episode from the current state and return its row of the result."""
    for _ in range(horizon):
        if env.done():
            break
        env.step(policy(env))
    return {
        "outcome": env.outcome if env.outcome != "running" else "timeout",
        "time": env.time,
        "arrived": [robot.name for robot in env.robot_list if robot.arrive],
        "collisions": [[e.time, e.object, e.partner] for e in env.events if e.kind == "collision"][:MAX_LISTED],
    }


def main() -> int:
    """Run all episodes."""
    given = read_arguments()
    sys.path.insert(0, str(Path.cwd()))
    try:
        for name in given.imports:
            importlib.import_module(name)
        policy = find_policy(given.policy)
        env = irsim.make(given.scenario, display=False, seed=given.seed, strict=True, log_level="ERROR")
        horizon = horizon_of(env, given.steps)
    except (ImportError, AttributeError, OSError, ValueError, irsim.IrsimError) as error:
        print(f"episodes.py: {error}", file=sys.stderr)
        return 2
    rows = []
    try:
        for episode in range(given.episodes):
            if episode:
                env.reset(random=not given.same_layout)
            rows.append({"episode": episode, **run_episode(env, policy, horizon)})
            if episode == 0 and given.picture:
                env.render(0)
                env.save_figure(given.picture.absolute())
    except Exception as error:
        print(f"episodes.py: episode {len(rows)} failed: {type(error).__name__}: {error}", file=sys.stderr)
        return 1
    finally:
        env.end(ending_time=0)
    counts = {name: sum(row["outcome"] == name for row in rows) for name in ("success", "collision", "timeout")}
    result = {"seed": env.seed, "steps_at_most": horizon, **counts, "episodes": rows[:MAX_LISTED]}
    if len(rows) > MAX_LISTED:
        result["left_off"] = len(rows) - MAX_LISTED
    print(json.dumps(result, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
