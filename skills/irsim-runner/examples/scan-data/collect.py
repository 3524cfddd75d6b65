#!/usr/bin/env python3
"""Collect (scan, goal, action) samples from many worlds at once; prints JSON.

For each robot that is still driving: its ranges [m], the goal in its own frame [m], and the control that its behavior
then chose (forward m/s, yaw rate rad/s).
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

import irsim


def main() -> None:
    """Parse the command line, collect the samples, write them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", type=Path)
    parser.add_argument("--out", type=Path, default=Path("samples.npz"), help="default: samples.npz")
    parser.add_argument(
        "--worlds", type=int, default=64, help="number of worlds that are stepped together (default: 64)"
    )
    parser.add_argument("--steps", type=int, default=300, help="steps of each world (default: 300)")
    parser.add_argument(
        "--seed", type=int, default=0, help="seed of the first world; the others count up from it (default: 0)"
    )
    given = parser.parse_args()

    worlds = irsim.batch(given.scenario, given.worlds, seeds=range(given.seed, given.seed + given.worlds))
    robots = worlds.robots
    horizon = round((worlds.scenario.world.time_limit or 60.0) / worlds.scenario.world.step_time)
    samples: dict[str, list[np.ndarray]] = {"scan": [], "goal": [], "action": []}
    episodes = 0
    for _ in range(given.steps):
        active = ~(worlds.arrived | worlds.stopped)[:, robots].astype(bool)
        scan = worlds.ranges.reshape(given.worlds, len(robots), -1)[active]  # indexing with a mask copies
        goal = in_own_frame(worlds.goal[:, robots], worlds.pose[:, robots])[active]
        worlds.step()
        samples["scan"].append(scan.astype(np.float32))
        samples["goal"].append(goal.astype(np.float32))
        samples["action"].append(worlds.velocity[:, robots, :2][active].astype(np.float32))
        over = worlds.done | (worlds.count >= horizon)
        if over.any():
            episodes += int(over.sum())
            worlds.reset(over)  # each world that is done or out of time draws its next layout
    arrays = {name: np.concatenate(parts) for name, parts in samples.items()}
    np.savez_compressed(given.out, **arrays)
    shapes = {name: list(array.shape) for name, array in arrays.items()}
    print(json.dumps({"file": str(given.out), "shapes": shapes, "episodes": episodes, "seed": given.seed}))


def in_own_frame(goals: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """Transform goals (…, 3) into the frames of poses (…, 3): ahead and to the left [m], (…, 2)."""
    dx, dy = goals[..., 0] - poses[..., 0], goals[..., 1] - poses[..., 1]
    cos, sin = np.cos(poses[..., 2]), np.sin(poses[..., 2])
    return np.stack([cos * dx + sin * dy, -sin * dx + cos * dy], axis=-1)


if __name__ == "__main__":
    main()
