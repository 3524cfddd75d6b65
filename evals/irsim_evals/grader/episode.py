"""One seeded episode of a scenario, stepped to its end whether the robots have arrived or not."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.simulation.events import BETWEEN_STEPS, Event, partner_of
from irsim.simulation.trace import Trace, join_traces, next_rows, present_row
from irsim_evals.grader.scene import GradedScene, open_scene

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["GradedEpisode", "dense", "run_episode"]

_PATH_STEP = 0.05
"""Distance [m] between points of a path."""
_MAX_PARTS = 50
"""Parts of a step."""
_CHUNK_STEPS = 100
"""Steps between two looks at the explored share of a fog map."""


@dataclass
class GradedEpisode:
    """A simulated episode.

    Attributes:
        scene: The world at its start; its environment has been stepped.
        seed: Seed.
        trace: Poses, controls and flags of all objects, from the start to the end.
        events: Arrivals, waypoints, collisions.
        explored: (time [s], explored share) of the fog map, at some times.
        scans: Time [s] → scans of the sensors, for the times that were asked for: object name → list of
            ``ranges`` and ``velocities``.
    """

    scene: GradedScene
    seed: int
    trace: Trace
    events: list[Event]
    explored: list[tuple[float, float]]
    scans: dict[float, dict[str, list[dict[str, Any]]]]

    @property
    def duration(self) -> float:
        """Simulated time [s]."""
        return float(self.trace.time[-1])

    def positions(self, index: int) -> Any:
        """(T, 2) positions of an object [m]."""
        return self.trace.pose[:, index, :2]

    def path(self, index: int) -> Any:
        """(K, 2) the path of an object while it is in the world, with points between distant steps [m]."""
        points = self.positions(index)
        points = points[~np.isnan(points[:, 0])]
        far = np.hypot(*np.diff(points, axis=0).T).max(initial=0.0)
        return dense(points, math.ceil(far / _PATH_STEP))

    def arrival(self, name: str) -> float | None:
        """When an object reached its last goal first; None if it did not [s]."""
        return next((event.time for event in self.events if event.kind == "arrival" and event.object == name), None)

    def collisions(self, name: str) -> list[tuple[float, str]]:
        """Time and partner of each contact of an object, within steps, too, but for those with passable objects."""
        passable = {body.name for body in self.scene.bodies if body.passable}
        contacts = []
        for event in self.events:
            if event.kind in ("collision", *BETWEEN_STEPS) and name in (event.object, event.partner):
                partner = partner_of(event, name) or ""
                if partner not in passable:
                    contacts.append((event.time, partner))
        return contacts

    def speeds(self, index: int) -> Any:
        """(T - 1,) signed speeds along the heading [m/s], measured from one row to the next."""
        pose = self.trace.pose[:, index]
        step = np.diff(pose[:, :2], axis=0) / self.trace.step_time
        turn = np.diff(np.unwrap(pose[:, 2]))
        heading = pose[:-1, 2] + turn / 2
        return step[:, 0] * np.cos(heading) + step[:, 1] * np.sin(heading)


def dense(rows: Any, parts: int) -> Any:
    """(K, D) rows of a (T, D) table with others between them, so that each step has a number of equal parts."""
    parts = min(parts, _MAX_PARTS)
    if parts <= 1 or len(rows) < 2:
        return rows
    at = np.arange(parts * (len(rows) - 1) + 1) / parts
    return np.stack([np.interp(at, np.arange(len(rows)), column) for column in rows.T], axis=1)


def run_episode(
    scenario: ResolvedScenario, seed: int, seconds: float, scan_times: tuple[float, ...] = ()
) -> GradedEpisode:
    """Simulate one episode to its end.

    Args:
        scenario: The scenario.
        seed: Seed.
        seconds: Simulated time.
        scan_times: Times at which the scans are kept [s].
    """
    scene = open_scene(scenario, seed)
    simulation, step_time = scene.env.simulation, float(scene.world.step_time)
    steps = max(1, round(seconds / step_time))
    stops = sorted({min(steps, max(1, round(time / step_time))) for time in scan_times} | {1, steps})
    parts, explored, scans, done = [present_row(simulation)], [], {}, 0
    while done < steps:
        due = next(stop for stop in stops if stop > done)
        count = min(_CHUNK_STEPS, due - done)
        parts.append(next_rows(simulation, count, until_done=False))
        done += count
        time = done * step_time
        fog = getattr(scene.env._world, "fog_map", None) if scene.world.fog_map else None
        if fog is not None:
            explored.append((time, float(fog.explored_ratio)))
        if done == due and scan_times:
            scans[time] = _scans(scene)
    return GradedEpisode(scene, seed, join_traces(parts), list(scene.env.events), explored, scans)


def _scans(scene: GradedScene) -> dict[str, list[dict[str, Any]]]:
    scans: dict[str, list[dict[str, Any]]] = {}
    for view in [*scene.env.robot_list, *scene.env.obstacle_list]:
        if view.sensors:
            scans[view.name] = [
                {key: np.array(value, copy=True) for key, value in sensor.get_scan().items() if value is not None}
                for sensor in view.sensors
                if hasattr(sensor, "get_scan")
            ]
    return scans
