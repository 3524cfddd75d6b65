"""Random scenes of which one decision is compared; the same numbers on every platform and version of Python.

No scene has what a difference id is about: static shapes other than circles and linestrings (D6), drives without a law
of their own (D13). Where lines (D6) or `acce` (D28) matter, the test leaves the scene out. Objects pass through each
other, so that none stops.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any

import numpy as np
import yaml

DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)  # of libyaml, where there is one

FAMILIES = {"rvo": 700, "sfm": 600, "sfm-group": 150}
"""Scenes per family. In a scene of a group every member's decision counts, else only the first robot's."""


def scene(family: str, index: int) -> dict[str, Any]:
    """The scenario of one decision, as YAML data."""
    rng = Random(f"{family} {index}")
    size = rng.choice([4.0, 6.0, 10.0])
    make = _Maker(rng, size)
    if family != "rvo":
        # of two with the same velocity, the sideways force of 2.12 has the sign of a rounding error
        make.shares = [0.2, 0.5, 1.0]
    count = rng.choice([0, 1, 2, 3, 5, 8, 12])
    if family == "sfm-group":
        robots = _group(make, rng.randint(2, 9))
        robots += [make.mover() for _ in range(count // 3)]
    else:
        key = _rvo(rng) if family == "rvo" else _sfm(rng)
        robots = [make.decider(key), *(make.mover() for _ in range(count // 2))]
    obstacles = [make.obstacle() for _ in range(count - count // 2)]
    world = {"width": size, "height": size, "collision_mode": "unobstructed", "step_time": rng.choice([0.1, 0.05, 0.2])}
    document: dict[str, Any] = {"world": world, "robot": robots}
    if obstacles:
        document["obstacle"] = obstacles
    return document


class _Maker:
    def __init__(self, rng: Random, size: float) -> None:
        self.rng, self.size = rng, size
        self.shares = [0.0, 0.5, 1.0]
        """Of the top speed, to draw initial velocities from."""

    def _pose(self) -> list[float]:
        rng = self.rng
        return [rng.uniform(0, self.size), rng.uniform(0, self.size), rng.uniform(-3.1, 3.1)]

    def _shape(self) -> dict[str, Any]:
        rng = self.rng
        kind = rng.choice(["circle", "circle", "circle", "offset", "rectangle", "polygon"])
        if kind == "circle":
            return {"name": "circle", "radius": rng.uniform(0.15, 0.5)}
        if kind == "offset":
            return {"name": "circle", "radius": rng.uniform(0.15, 0.5), "center": [rng.uniform(-0.2, 0.2), 0.1]}
        if kind == "rectangle":
            return {"name": "rectangle", "length": rng.uniform(0.3, 0.8), "width": rng.uniform(0.2, 0.5)}
        corners = sorted(rng.uniform(0, 2 * math.pi) for _ in range(3))
        return {"name": "polygon", "vertices": [[0.5 * math.cos(a), 0.5 * math.sin(a)] for a in corners]}

    def _moving(self, drives: Sequence[str]) -> dict[str, Any]:
        rng = self.rng
        drive = rng.choice(drives)
        top = [rng.uniform(0.5, 2.5) for _ in range(3 if drive == "omni_angular" else 2)]
        return {
            "kinematics": {"name": drive},
            "shape": self._shape(),
            "state": self._pose(),
            "goal": self._pose(),
            "vel_max": top,
            "vel_min": [-value for value in top],
            "velocity": [rng.uniform(-value, value) * rng.choice(self.shares) for value in top],
        }

    def mover(self) -> dict[str, Any]:
        return {**self._moving(["diff", "omni", "omni_angular", "acker"]), "behavior": {"name": "dash"}}

    def decider(self, behavior: dict[str, Any], drives: Sequence[str] = ("diff", "omni")) -> dict[str, Any]:
        rng = self.rng
        entry = {**self._moving(drives), "behavior": behavior}
        if rng.random() < 0.3:
            entry["behavior"]["target_roles"] = rng.choice(["all", "robot", "obstacle"])
        if rng.random() < 0.1:
            x, y, _ = entry["state"]
            entry["goal"] = [x + rng.uniform(-0.15, 0.15), y + rng.uniform(-0.15, 0.15)]
        if rng.random() < 0.2:
            entry["acce"] = [rng.uniform(1, 20), rng.uniform(1, 20)]
        return entry

    def obstacle(self) -> dict[str, Any]:
        rng = self.rng
        kind = rng.choice(["mover", "circle", "line", "unobstructed"])
        if kind == "mover":
            return self.mover()
        if kind == "line":
            ends = [[rng.uniform(-2, 2), rng.uniform(-2, 2)] for _ in range(rng.choice([2, 2, 3, 5]))]
            return {"shape": {"name": "linestring", "vertices": ends}, "state": self._pose()}
        shape = {"name": "circle", "radius": rng.uniform(0.1, 0.6)}
        return {"shape": shape, "state": self._pose(), "unobstructed": kind == "unobstructed"}


def _rvo(rng: Random) -> dict[str, Any]:
    options: dict[str, Any] = {"name": "rvo", "mode": rng.choice(["rvo", "hrvo", "vo"])}
    for key, low, high in (("vxmax", 0.5, 2.0), ("vymax", 0.5, 2.0), ("acce", 0.2, 1.5), ("factor", 0.0, 4.0)):
        if rng.random() < 0.7:
            options[key] = rng.uniform(low, high)
    if rng.random() < 0.5:
        options["neighbor_threshold"] = rng.uniform(1.0, 6.0)
    return options


def _sfm(rng: Random) -> dict[str, Any]:
    options: dict[str, Any] = {"name": "sfm"}
    for key, low, high in (
        ("vmax", 0.5, 2.5),
        ("neighbor_threshold", 1.0, 8.0),
        ("relaxation_time", 0.2, 2.0),
        ("force_factor_desired", 0.0, 3.0),
        ("force_factor_social", 0.0, 6.0),
        ("force_factor_obstacle", 0.0, 15.0),
        ("sigma_obstacle", 0.05, 1.0),
        ("lambda_importance", 0.0, 4.0),
        ("gamma", 0.1, 1.0),
        ("n_angular", 0.0, 4.0),
        ("n_velocity", 0.0, 4.0),
        ("safety_radius", 0.0, 0.5),
    ):
        if rng.random() < 0.3:
            options[key] = rng.uniform(low, high)
    return options


def _group(make: _Maker, count: int) -> list[dict[str, Any]]:
    rng = make.rng
    options = _sfm(rng)
    for key, low, high in (
        ("force_factor_coherence", 0.0, 5.0),
        ("force_factor_group_repulsion", 0.0, 3.0),
        ("group_repulsion_threshold", 0.0, 3.0),
        ("force_factor_gaze", 0.0, 6.0),
        ("gaze_vision_angle", 10.0, 180.0),
    ):
        if rng.random() < 0.4:
            options[key] = rng.uniform(low, high)
    if rng.random() < 0.8:
        order = list(range(count))
        rng.shuffle(order)
        cut = rng.randint(0, count)
        options["social_groups"] = [part for part in (order[:cut], order[cut : cut + rng.randint(0, 3)]) if part]
    if rng.random() < 0.3:
        options["target_roles"] = rng.choice(["all", "robot", "obstacle"])
    drive = rng.choice(["diff", "omni"])
    members = []
    for _ in range(count):
        member = make.decider({"name": "dash"}, [drive])
        if rng.random() < 0.6:
            del member["behavior"]
        members.append({**member, "group": 1000, "group_behavior": options})
    return members


def deciders(family: str, document: dict[str, Any]) -> list[int]:
    """Ids of the robots whose decision is compared."""
    if family != "sfm-group":
        return [0]
    return [i for i, robot in enumerate(document["robot"]) if "group_behavior" in robot]


def decide(irsim: ModuleType, document: dict[str, Any], ids: list[int], folder: Path) -> np.ndarray:
    """(K, 3) commands that objects execute in the first step of a scene with whichever `irsim` is installed."""
    path = folder / "scene.yaml"
    path.write_text(yaml.dump(document, Dumper=DUMPER), encoding="utf-8")
    env = irsim.make(str(path), headless=True, log_level="ERROR", seed=0)
    env.step()
    out = np.zeros((len(ids), 3))
    for k, i in enumerate(ids):
        velocity = np.asarray(env.robot_list[i].velocity, dtype=float).ravel()
        out[k, : velocity.size] = velocity
    env.end()
    return out
