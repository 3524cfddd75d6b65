"""Random crowds among circles, lines and walls, and what each object of them sees."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np

import irsim._core as core
from tests.core import crowd_oracle as oracle
from tests.core.oracle import rotation
from tests.core.worlds import DRIVES, PI, circle, line, obstacle, polygon, rectangle, robot, scene

PADDING = 0.1


class Crowd:
    """A scene of random objects; the first ones run `behavior` on `drive`.

    Attributes:
        deciders: How many do.
    """

    def __init__(self, rng: np.random.Generator, drive: str, behavior: Any, *, walls: bool = True, **decider: Any):
        self.rng, self.size = rng, float(rng.uniform(2, 8))
        self.drives: list[str | None] = []
        self.specs: list[dict[str, Any]] = []
        self.deciders = int(rng.integers(1, 5))
        for _ in range(self.deciders):
            self._mover(drive, behavior=behavior, role=int(rng.integers(2)), **decider)
        for _ in range(rng.integers(5)):
            self._mover(list(DRIVES)[rng.integers(len(DRIVES))], behavior=None, role=int(rng.integers(2)))
        for _ in range(rng.integers(4)):
            self._static([circle(rng.uniform(0.1, 0.5), rng.uniform(-0.3, 0.3, 2))])
        for _ in range(rng.integers(3)):
            self._static([line(*rng.uniform(-2, 2, (rng.integers(2, 5), 2)))], unobstructed=bool(rng.integers(2)))
        if walls:
            for _ in range(rng.integers(4)):
                self._static([rectangle(*rng.uniform(0.2, 3, 2))], unobstructed=bool(rng.random() < 0.2))
        self.dt = float(rng.choice([0.05, 0.1, 0.3]))
        build = {True: obstacle, False: robot}
        objects = [build[d is None](**spec) for d, spec in zip(self.drives, self.specs, strict=True)]
        self.world, self.state = scene(*objects, mode=1, step_time=self.dt)

    def _pose(self) -> list[float]:
        return [*self.rng.uniform(0, self.size, 2), self.rng.uniform(-PI, PI)]

    def _mover(self, drive: str, **more: Any) -> None:
        rng = self.rng
        shapes = [
            [circle(rng.uniform(0.1, 0.4))],
            [circle(rng.uniform(0.1, 0.4))],
            [polygon((0, 0), (0.6, 0), (0, 0.3))],
            [line((0, 0), (0.5, 0.2))],
        ]
        top = rng.uniform(0.3, 2, 3)
        self.drives.append(drive)
        self.specs.append(
            {
                "drive": DRIVES[drive],
                "parts": shapes[rng.integers(4)],
                "pose": self._pose(),
                "control": rng.uniform(-1, 1, 3) * top,
                "extra": [rng.uniform(-0.5, 0.5)],
                "vel_max": top,
                "vel_min": -top,
                "acce": [
                    math.inf,
                    math.inf if drive.startswith("omni") else rng.uniform(0.5, 30),
                    rng.uniform(0.5, 30),
                ],
                "goals": [self._pose()],
                "target_roles": int(rng.choice([0, 0, 1, 2])),
                **more,
            }
        )

    def _static(self, parts: list[Any], **more: Any) -> None:
        self.drives.append(None)
        self.specs.append({"parts": parts, "pose": self._pose(), "role": int(self.rng.integers(2)), **more})

    def velocity(self, i: int) -> np.ndarray:
        """World frame."""
        drive, spec = self.drives[i], self.specs[i]
        if drive is None:
            return np.zeros(2)
        u = np.array(spec["control"][:2]) if drive.startswith("omni") else np.array([spec["control"][0], 0.0])
        return rotation(spec["pose"][2]) @ u

    def radius(self, i: int) -> float:
        return float(self.state.radius[i])

    def centroid(self, i: int) -> np.ndarray:
        pose, part = self.specs[i]["pose"], self.specs[i]["parts"][0]
        if isinstance(part, core.Circle):
            return np.array(pose[:2]) + rotation(pose[2]) @ np.array(part.center)
        return self.state.vertices(i, 0, True).mean(axis=0)

    def view(self, i: int, *, grouped: bool = False) -> oracle.View:
        """The view of object i."""
        spec = self.specs[i]
        position, goal = np.array(spec["pose"][:2]), np.array(spec["goals"][0][:2])
        way, top = goal - position, np.array(spec["vel_max"][:2])
        if not str(self.drives[i]).startswith("omni"):
            top = top[[0, 0]]
        distance = math.hypot(*way)
        desired = top * way / distance if distance > 0.1 else np.zeros(2)
        view = oracle.View(
            position, self.velocity(i), desired, self.radius(i) + PADDING, goal=distance, ahead=way / distance
        )
        for j, other in enumerate(self.specs):
            roles, role = spec["target_roles"], other["role"]
            mate = grouped and j < self.deciders
            if j == i or (roles == 1 and role != 0 and not mate) or (roles == 2 and role != 1 and not mate):
                continue
            part = other["parts"][0]
            if isinstance(part, core.Linestring):
                v = self.state.vertices(j, 0, True)
                edges = list(itertools.pairwise(v))
                if self.drives[j] is not None:
                    view.lines += edges
                else:  # a static one has walls on both sides
                    view.rings.append(oracle.Ring([*edges, *((b, a) for a, b in reversed(edges))], v))
            elif self.drives[j] is not None or isinstance(part, core.Circle):
                centre = np.array(other["pose"][:2]) if mate else self.centroid(j)
                view.discs.append((centre, self.velocity(j), self.radius(j)))
            elif not other.get("unobstructed"):
                v = self.state.vertices(j, 0, True)
                view.rings.append(oracle.Ring(list(zip(v, np.roll(v, -1, axis=0), strict=True)), v))
        return view

    def control(self, i: int, velocity: np.ndarray, turning: dict[str, float], fastest: float = math.inf) -> np.ndarray:
        """The control of the drive for a wanted velocity; no faster along the heading than `fastest`."""
        drive, spec = str(self.drives[i]), self.specs[i]
        theta = spec["pose"][2]
        if drive.startswith("omni"):
            return np.array([*(rotation(-theta) @ velocity), 0.0])
        speed, error, rate = oracle.forward(velocity, theta, **turning)
        acce = float(spec["acce"][1])
        if drive == "diff":
            most = oracle.stopping_rate(abs(error), acce, self.dt)
            return np.array([min(speed, fastest), np.clip(rate, -most, most), 0.0])
        if error != 0.0:
            speed = max(speed, 0.2 * float(np.hypot(*velocity)))
        if drive == "steer":
            return np.array([min(speed, fastest), error, 0.0])
        left = np.clip(error, -PI / 4, PI / 4) - spec["extra"][0]
        most = min(turning["max_rate"], oracle.stopping_rate(abs(left), acce, self.dt))
        return np.array([min(speed, fastest), np.clip(left / turning["guarantee_time"], -most, most), 0.0])
