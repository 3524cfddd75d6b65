"""One seeded episode of a scenario, stepped to its end whether the robots have arrived or not."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.navigation.clearances import clearance
from irsim.simulation.events import Event, partner_of
from irsim.simulation.trace import Trace, join_traces, next_rows, present_row
from irsim_evals.grader.scene import GradedScene, open_scene

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["GradedEpisode", "run_episode"]

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

    def arrival(self, name: str) -> float | None:
        """When an object reached its last goal first; None if it did not [s]."""
        return next((event.time for event in self.events if event.kind == "arrival" and event.object == name), None)

    def collisions(self, name: str) -> list[tuple[float, str]]:
        """Time and partner of each collision of an object, but for those with objects that others pass through."""
        passable = {body.name for body in self.scene.bodies if body.passable}
        contacts = []
        for event in self.events:
            if event.kind == "collision" and name in (event.object, event.partner):
                partner = partner_of(event, name) or ""
                if partner not in passable:
                    contacts.append((event.time, partner))
        return contacts

    @cached_property
    def distances(self) -> Any:
        """Distances between footprints at every row; see :func:`irsim.navigation.clearances.clearance`."""
        return clearance(self.trace, self.scene.env.simulation)

    def speeds(self, index: int) -> Any:
        """(T - 1,) signed speeds along the heading [m/s], measured from one row to the next."""
        pose = self.trace.pose[:, index]
        step = np.diff(pose[:, :2], axis=0) / self.trace.step_time
        turn = np.diff(np.unwrap(pose[:, 2]))
        heading = pose[:-1, 2] + turn / 2
        return step[:, 0] * np.cos(heading) + step[:, 1] * np.sin(heading)


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
