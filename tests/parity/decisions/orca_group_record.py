"""Record the first step of IR-SIM 2.12 groups of `orca`: writes ``orca_group.npz``.

    /tmp/reference/bin/python tests/parity/decisions/orca_group_record.py

In the first step the solver of 2.12 knows no velocities yet, so that both start from the same.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

ROBOTS, SNAPSHOTS = 6, 120
FILE = Path(__file__).with_name("orca_group.npz")


def scenario(place: np.ndarray, goal: np.ndarray, options: np.ndarray, drive: str) -> dict[str, Any]:
    """The world of one snapshot; options: neighborDist, timeHorizon, safe_radius, maxSpeed (0: none), two limits."""
    behavior = {"name": "orca", "neighborDist": options[0], "timeHorizon": options[1], "safe_radius": options[2]}
    if options[3] > 0:
        behavior["maxSpeed"] = options[3]
    return {
        "world": {"width": 20, "height": 20, "step_time": 0.1, "collision_mode": "unobstructed"},
        "robot": [
            {
                "number": ROBOTS,
                "kinematics": {"name": drive},
                "shape": {"name": "circle", "radius": 0.25},
                "distribution": {"name": "manual"},
                "state": place.tolist(),
                "goal": goal.tolist(),
                "vel_max": options[4:6].tolist(),
                "vel_min": (-options[4:6]).tolist(),
                "group_behavior": {key: v if isinstance(v, str) else float(v) for key, v in behavior.items()},
            }
        ],
    }


def main() -> None:
    import yaml

    import irsim

    rng = np.random.default_rng(212)
    kept: dict[str, list[np.ndarray]] = {"place": [], "goal": [], "options": [], "velocity": []}
    with tempfile.TemporaryDirectory() as folder:
        for index in range(SNAPSHOTS):
            size = rng.uniform(1.5, 5.0)
            place = np.column_stack([rng.uniform(5, 5 + size, (ROBOTS, 2)), rng.uniform(-np.pi, np.pi, ROBOTS)])
            goal = rng.uniform(3, 12, (ROBOTS, 2))
            options = np.array([rng.uniform(2, 12), rng.uniform(1, 15), rng.uniform(0, 0.2), 0.0, 1.0, 1.0])
            options[3] = rng.choice([0.0, 0.7, 5.0])
            options[4:] = rng.uniform(0.5, 2.0, 2)
            values = [v.astype(np.float32) for v in (place, goal, options)]
            data = scenario(*(v.astype(float) for v in values), "omni" if index % 2 else "diff")
            file = Path(folder) / "world.yaml"
            file.write_text(yaml.safe_dump(data), encoding="utf-8")
            env = irsim.make(str(file), display=False, log_level="ERROR")
            env.step()
            velocity = np.array([robot.velocity[:, 0] for robot in env.robot_list])
            env.end()
            for name, value in zip(kept, [*values, velocity.astype(np.float32)], strict=True):
                kept[name].append(value)
    np.savez_compressed(FILE, **{name: np.array(values) for name, values in kept.items()})
    print(f"{FILE}: {FILE.stat().st_size} bytes")


if __name__ == "__main__":
    main()
