"""Contacts in MuJoCo, counted and checked against the footprints of irsim, and the report of an episode."""

from __future__ import annotations

import json
import math
import sys
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from shapely.affinity import affine_transform

from irsim.bridges.mujoco.mjcf import MAP_BODY, body_name
from irsim.bridges.mujoco.physics import Physics
from irsim.bridges.solids import merged_cells
from irsim.common.files import write_atomically
from irsim.common.outline import Outline
from irsim.common.text import plural

__all__ = ["Contact", "Contacts", "MujocoReport", "log_report", "write_report"]

_GHOST = 0.02
"""Distance of footprints from which a contact is one that irsim does not have [m]: walls are 1 cm thick in MuJoCo."""
_BOUNCE_S = 0.5
"""Time without contact after which the next one counts as another one [s]."""
_QUARTER = 32
"""Segments of a quarter circle of a footprint."""
_MAX_LISTED = 1000
"""Contacts beyond this number are counted but not listed."""


@dataclass(frozen=True)
class Contact:
    """The begin of a contact between two objects.

    Attributes:
        time: Simulated time [s].
        objects: Their names; ``map`` and ``walls`` for what is not an object.
        gap: Distance of their footprints in irsim [m].
        ghost: Whether the footprints do not touch, so that irsim has no contact there.
    """

    time: float
    objects: tuple[str, str]
    gap: float
    ghost: bool


class Contacts:
    """Watches which objects touch each other.

    Args:
        physics: The model.

    Attributes:
        begins: Begins of contacts, the first thousand.
        count: Number of begins of contacts.
        ghosts: Number of begins of contacts that irsim does not have.
    """

    def __init__(self, physics: Physics) -> None:
        self.begins: list[Contact] = []
        self.count = self.ghosts = 0
        self.follow(physics)

    def follow(self, physics: Physics) -> None:
        """Watch another model from now on, and go on counting."""
        self._scene = physics.scene
        self._physics = physics
        self._owner = self._owners(physics)
        self._last: dict[int, float] = {}
        for kept in ("_map", "_walls"):
            self.__dict__.pop(kept, None)

    def _owners(self, physics: Physics) -> np.ndarray:
        """(geoms,) row of the object that a geom belongs to; N: map, N + 1: walls, -1: ground and wheels."""
        model, count = physics.model, len(physics.scene.agents)
        rows = {body_name(agent): agent.index for agent in physics.scene.agents}
        rows |= {MAP_BODY: count, "irsim/walls": count + 1}
        owner = np.full(model.ngeom, -1, dtype=np.int64)
        for geom in range(model.ngeom):
            if model.geom_contype[geom] & 6:
                owner[geom] = rows.get(model.body(int(model.geom_bodyid[geom])).name, -1)
        return owner

    def watch(self, model: Any, data: Any, time: float) -> None:
        """Look at the contacts after a period of the physics; a pair that bounces goes on touching."""
        if not data.ncon:
            return
        pairs = self._owner[data.contact.geom]
        pairs = pairs[(pairs >= 0).all(axis=1) & (data.contact.dist <= 0)]
        if not len(pairs):
            return
        pairs.sort(axis=1)
        width = len(self._scene.agents) + 2
        for pair in sorted(set((pairs[:, 0] * width + pairs[:, 1]).tolist())):
            if time - self._last.get(pair, -math.inf) > _BOUNCE_S:
                self._begin(divmod(pair, width), data, time)
            self._last[pair] = time

    def _begin(self, pair: tuple[int, int], data: Any, time: float) -> None:
        gap = self._gap(pair, data)
        ghost = gap > _GHOST
        self.count += 1
        self.ghosts += ghost
        if len(self.begins) < _MAX_LISTED:
            one, other = map(self._name, pair)
            self.begins.append(Contact(round(time, 6), (one, other), gap, ghost))

    def _name(self, row: int) -> str:
        names = self._scene.names
        return names[row] if row < len(names) else ("map", "walls")[row - len(names)]

    def _gap(self, pair: tuple[int, int], data: Any) -> float:
        """Distance of the footprints of two objects as irsim has them, at their poses in MuJoCo [m]."""
        one, other = (self._placed(row, data) for row in pair)
        return float(shapely.distance(one, other).min())

    def _placed(self, row: int, data: Any) -> Any:
        if row >= len(self._scene.agents):
            return self._map if row == len(self._scene.agents) else self._walls
        agent = self._scene.agents[row]
        body = self._physics.model.body(body_name(agent)).id
        (x, y), turn = data.xpos[body, :2], data.xmat[body].reshape(3, 3)
        yaw = float(np.arctan2(turn[1, 0], turn[0, 0]))
        cosine, sine = np.cos(yaw), np.sin(yaw)
        return affine_transform(Outline(agent.parts).shapely(_QUARTER), [cosine, -sine, sine, cosine, x, y])

    @cached_property
    def _map(self) -> Any:
        assert self._scene.grid is not None
        return shapely.box(*merged_cells(self._scene.grid).T)

    @cached_property
    def _walls(self) -> Any:
        return shapely.box(*self._scene.low, *self._scene.high).exterior


@dataclass(frozen=True)
class MujocoReport:
    """Results of an episode.

    Attributes:
        steps: Number of steps of irsim.
        simulated_s, wall_s: Simulated time and time on the wall [s].
        objects: Names of the objects that MuJoCo has moved.
        contacts: Number of times that two objects began to touch.
        ghost_contacts: Number of those whose footprints do not touch in irsim.
        first_contacts: The first thousand: time [s], objects, gap between their footprints [m], and whether it is a
            ghost.
        step_difference_median_m, step_difference_largest_m: Distance between where irsim would have had a robot at the
            end of a step and where MuJoCo has it [m], over all robots and steps: slip, inertia and contacts.
        lidar_beams: Number of beams that hit something in both simulators.
        lidar_one_sided: Number of beams that hit something in one of them only, such as beams that graze a corner.
        lidar_median_m, lidar_p99_m, lidar_largest_m: Difference of the ranges of both simulators [m].
        warnings: Warnings of MuJoCo, and how often they came.
    """

    steps: int = 0
    simulated_s: float = 0.0
    wall_s: float = 0.0
    objects: list[str] = field(default_factory=list)
    contacts: int = 0
    ghost_contacts: int = 0
    first_contacts: list[dict[str, Any]] = field(default_factory=list)
    step_difference_median_m: float = 0.0
    step_difference_largest_m: float = 0.0
    lidar_beams: int = 0
    lidar_one_sided: int = 0
    lidar_median_m: float = 0.0
    lidar_p99_m: float = 0.0
    lidar_largest_m: float = 0.0
    warnings: dict[str, int] = field(default_factory=dict)

    def lines(self) -> list[str]:
        """The main numbers as text."""
        objects = plural(len(self.objects), "object")
        result = [
            (
                f"mujoco: moved {objects} for {self.simulated_s:.1f} s in {self.wall_s:.1f} s; in a step robots are "
                f"up to {self.step_difference_largest_m:.3f} m (median {self.step_difference_median_m:.4f} m) from "
                "where irsim would have them"
            ),
            f"mujoco: {self.contacts} contacts, {self.ghost_contacts} of them between footprints that do not touch",
        ]
        if self.lidar_beams:
            result.append(
                f"mujoco: ranges of {self.lidar_beams} beams differ by {self.lidar_median_m:.4f} m (median), "
                f"{self.lidar_p99_m:.4f} m (99 %), {self.lidar_largest_m:.4f} m (largest); "
                f"{self.lidar_one_sided} hit something in one simulator only"
            )
        result += [f"mujoco: MuJoCo warned {count} times: {text}" for text, count in self.warnings.items()]
        return result


def log_report(report: MujocoReport) -> None:
    """Write the main numbers to standard error; standard output belongs to the command."""
    sys.stderr.write("".join(f"{line}\n" for line in report.lines()))


def write_report(report: MujocoReport, target: Path) -> None:
    """Write all numbers as JSON."""
    write_atomically(target, json.dumps(asdict(report), indent=2) + "\n")
