"""One seeded episode of a scenario, stepped to its end whether the robots have arrived or not."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.simulation.build import is_watching
from irsim.simulation.events import BETWEEN_STEPS, Event, partner_of
from irsim.simulation.trace import Trace, join_traces, next_rows, present_row
from irsim_evals.grader.body import GradedBody
from irsim_evals.grader.scene import GradedScene, open_scene

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["GradedEpisode", "Look", "at_start", "dense", "run_episode", "without_noise"]

_PATH_STEP = 0.05
"""Distance [m] between points of a path."""
_MAX_PARTS = 50
"""Parts of a step."""
_CHUNK_STEPS = 100
"""Steps between two looks at the explored share of a fog map."""


@dataclass(frozen=True)
class Look:
    """One look of a sensor, or of a field of view, at one time.

    Attributes:
        object: Index of the object that looks.
        by: Name of the kind of sensor; ``fov`` for the field of view.
        met: Index of the object that each beam hits, or of each object in the field of view.
        radial: Radial velocity that each of these beams measures [m/s]; NaN where none is measured.
    """

    object: int
    by: str
    met: Any
    radial: Any


@dataclass
class GradedEpisode:
    """A simulated episode.

    Attributes:
        scene: The world at its start; its environment has been stepped.
        seed: Seed.
        trace: Poses, controls and flags of all objects, from the start to the end.
        events: Arrivals, waypoints, collisions.
        explored: (time [s], explored share) of the fog map, at some times.
        looks: Looks of all sensors and fields of view at each row of the trace; empty if they were not asked for.
    """

    scene: GradedScene
    seed: int
    trace: Trace
    events: list[Event]
    explored: list[tuple[float, float]]
    looks: list[list[Look]]

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
        touches = [event for event in self.events if event.kind in ("collision", *BETWEEN_STEPS)]
        own = [event for event in touches if name in (event.object, event.partner)]
        contacts = [(event.time, partner_of(event, name) or "") for event in own]
        return [contact for contact in contacts if contact[1] not in passable]

    def moment(self, time: float) -> float:
        """A time [s]; a negative one counts back from the end."""
        return time if time >= 0 else self.duration + time

    def velocities(self, body: GradedBody) -> tuple[Any, Any, Any]:
        """Velocities of a body, measured from one row to the next.

        Returns:
            (T - 1,) signed speed along the heading [m/s]; (T - 1,) the same, of an omnidirectional drive its speed in
            any direction; (T - 1,) turn rate [rad/s].
        """
        pose, period = self.trace.pose[:, body.index], self.trace.step_time
        step, turn = np.diff(pose[:, :2], axis=0), np.diff(np.unwrap(pose[:, 2]))
        heading = pose[:-1, 2] + turn / 2
        along = (step[:, 0] * np.cos(heading) + step[:, 1] * np.sin(heading)) / period
        everywhere = np.hypot(*step.T) / period if "leftward" in body.ranges else along
        return along, everywhere, turn / period


def dense(rows: Any, parts: int) -> Any:
    """(K, D) rows of a (T, D) table with others between them, so that each step has a number of equal parts."""
    parts = min(parts, _MAX_PARTS)
    if parts <= 1 or len(rows) < 2:
        return rows
    at = np.arange(parts * (len(rows) - 1) + 1) / parts
    return np.stack([np.interp(at, np.arange(len(rows)), column) for column in rows.T], axis=1)


def at_start(scene: GradedScene) -> GradedEpisode:
    """The episode of no steps: the world at its start."""
    trace = join_traces([present_row(scene.env.simulation)])
    return GradedEpisode(scene, scene.seed, trace, list(scene.env.events), [], [_looks(scene)])


def run_episode(scenario: ResolvedScenario, seed: int, seconds: float, *, looks: bool = False) -> GradedEpisode:
    """Simulate one episode to its end.

    Args:
        scenario: The scenario.
        seed: Seed.
        seconds: Simulated time.
        looks: Whether the looks of the sensors and fields of view are kept.
    """
    scene = open_scene(scenario, seed)
    simulation, step_time = scene.env.simulation, float(scene.world.step_time)
    steps = max(1, round(seconds / step_time))
    parts, explored, done = [present_row(simulation)], [], 0
    kept = [_looks(scene)] if looks else []
    while done < steps:
        count = 1 if looks or not done else min(_CHUNK_STEPS, steps - done)
        parts.append(next_rows(simulation, count, until_done=False))
        done += count
        fog = getattr(scene.env._world, "fog_map", None) if scene.world.fog_map else None
        if fog is not None:
            explored.append((done * step_time, float(fog.explored_ratio)))
        if looks:
            kept.append(_looks(scene))
    return GradedEpisode(scene, seed, join_traces(parts), list(scene.env.events), explored, kept)


def without_noise(scenario: ResolvedScenario) -> ResolvedScenario:
    """The scenario with drives and sensors that do exactly what they should; itself if they do so already."""
    objects = [
        replace(record, kinematics=_exact(record.kinematics), sensors=[_exact(sensor) for sensor in record.sensors])
        for record in scenario.objects
    ]
    return scenario if objects == scenario.objects else replace(scenario, objects=objects)


def _exact(options: Any) -> Any:
    return options.model_copy(update={"noise": False}) if getattr(options, "noise", False) else options


def _looks(scene: GradedScene) -> list[Look]:
    """The looks of all sensors and fields of view in the scenario: the objects that each of them meets now."""
    looks = []
    views = sorted([*scene.env.robot_list, *scene.env.obstacle_list], key=lambda view: view.index)
    index = {view.id: view.index for view in views}
    for view in views:
        for sensor in view.sensors:
            if hasattr(sensor, "hits"):
                hit = sensor.valid
                met = np.array([index[number] for number in sensor.hits[hit].tolist()], dtype=int)
                radial = getattr(sensor, "radial_velocity", None)
                looks.append(Look(view.index, sensor.sensor_type, met, met * np.nan if radial is None else radial[hit]))
        if is_watching(view.record):
            met = np.array([other.index for other in view.surroundings.seen], dtype=int)
            looks.append(Look(view.index, "fov", met, met * np.nan))
    return looks
