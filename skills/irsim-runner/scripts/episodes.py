#!/usr/bin/env python3
# /// script
# requires-python = ">=3.10"
# dependencies = ["irsim-mcp==0.1.0"]
# ///
"""Run episodes of a scenario with actions from a function of yours, and print the outcome of each as JSON.

The function is called with the environment before each step. It returns an argument for env.step: one action for the
first robot, a list of actions, a mapping {name: action}, or None to let behaviors drive all robots. irsim.episodes runs
it on all cores; a program that calls that has every step of every episode, too.

Exits with 0 if all episodes ran, 1 if the function failed, 2 if an argument is invalid.
"""

from __future__ import annotations

import argparse
import importlib
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import irsim
from irsim.api.render_run import render_run
from irsim.diagnostics.errors import PolicyError

MAX_LISTED = 100
"""Episodes that are listed, and collisions that are listed of each."""


def read_arguments() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", type=Path, help="the YAML file")
    parser.add_argument("--policy", metavar="MODULE:FUNCTION", help="the function; default: behaviors drive all robots")
    parser.add_argument("--episodes", type=int, default=10, help="number of episodes (default: 10)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the first one; the next has the next (default: 0)")
    parser.add_argument("--steps", type=int, help="steps of an episode at most; default: as `irsim run`")
    parser.add_argument("--import", dest="imports", metavar="MODULE", action="append", default=[],
                        help="import a module first; repeatable")  # fmt: skip
    parser.add_argument("--picture", type=Path, help="PNG or SVG to write at the end of the first episode")
    return parser.parse_args()


def find_policy(name: str) -> Callable[[Any], Any]:
    """Return the function of that name."""
    module, _, function = name.partition(":")
    policy: Callable[[Any], Any] = getattr(importlib.import_module(module), function or "act")
    return policy


def row(run: Any) -> dict[str, Any]:
    """Return what is listed of an episode."""
    hits = [[event.time, event.object, event.partner] for event in run.events if event.kind == "collision"]
    arrived = [robot.name for robot in run.robots if robot.time_to_goal is not None]
    known = {"seed": run.seed, "outcome": run.outcome, "time": run.sim_time}
    return {**known, "arrived": arrived, "collisions": hits[:MAX_LISTED]}


def main() -> int:
    """Run all episodes."""
    given = read_arguments()
    sys.path.insert(0, str(Path.cwd()))
    try:
        own = (lambda env: None) if given.policy is None else find_policy(given.policy)
        result = irsim.episodes(
            given.scenario, own, seeds=range(given.seed, given.seed + given.episodes), steps=given.steps, strict=True,
            imports=given.imports, workers=1 if given.policy is None else None,
        )  # fmt: skip
        if given.picture:
            render_run(Path(result.episodes[0].artifacts["run.json"]).parent, given.picture)
    except (ImportError, AttributeError, irsim.IrsimError) as error:
        print(f"episodes.py: {error}", file=sys.stderr)
        return 1 if isinstance(error, PolicyError) else 2
    rows = [row(run) for run in result.episodes]
    counts = {name: sum(one["outcome"] == name for one in rows) for name in ("success", "collision", "timeout")}
    summary = {"seed": given.seed, "time_limit": result.episodes[0].time_limit, **counts, "episodes": rows[:MAX_LISTED]}
    if len(rows) > MAX_LISTED:
        summary["left_off"] = len(rows) - MAX_LISTED
    print(json.dumps(summary, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
