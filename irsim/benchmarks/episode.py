"""Run and measure one episode of a benchmark."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Any, Literal

from irsim.diagnostics.errors import PlacementError
from irsim.env import Env
from irsim.episodes.episode import horizon_of, import_modules
from irsim.episodes.incidents import find_incidents
from irsim.episodes.out_of_bounds import find_exits
from irsim.metrics.definitions import EPISODE_METRICS, METRICS
from irsim.metrics.episode import EpisodeMetrics, episode_metrics
from irsim.metrics.geodesic import Geodesics
from irsim.metrics.progress import UNREACHABLE
from irsim.metrics.roles import travelling_humans
from irsim.results.labels import CROWDED
from irsim.scenario.behavior_override import parse_behavior, with_behavior
from irsim.scenario.limits import Limits
from irsim.scenario.perturbation import perturbed, read_perturbations
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.scenario.yaml.document import load_text
from irsim.simulation.events import first_collisions, first_events
from irsim.simulation.trace import cut_trace, record

__all__ = ["Job", "Outcome", "Task", "Until", "run_task", "scenario_of"]

Outcome = Literal["success", "collision", "timeout"]
Until = Literal["done", "first_collision"]
_STRIDE = 100
"""Number of steps between two checks whether all humans have arrived."""
_MAX_FAILURES = 10
"""Number of robots without success that an episode lists."""
_MAX_NAMES = 10
"""Number of objects that left the world, or jumped over their goal, that an episode lists."""
_NOTHING: Mapping[str, Any] = MappingProxyType(
    {
        "steps": 0,
        "sim_time": 0.0,
        "time_limit": 0.0,
        "robots": 0,
        "unreachable": 0,
        "failures": {},
        "human_contacts": 0,
        "left": [],
        "jumped": [],
        "zones": {},
    }
)
"""Result of an episode that does not take place, without its outcome and metrics."""


@dataclass(frozen=True)
class Job:
    """One scenario under one behavior.

    Attributes:
        text: Text of the scenario.
        path: Its file, relative to which it names other files; None for a text.
        behavior: Behavior of all robots, see :func:`irsim.scenario.behavior_override.parse_behavior`.
        steps: Horizon in steps; None: that of the scenario.
        strict: Refuse what IR-SIM would ignore.
        imports: Modules of the user that register behaviors.
        limits: Limits of the loader and of the run, as (name, value) pairs.
        until: ``done``, or ``first_collision`` to end the episode when a robot collides.
        perturb: Perturbations of the scenario, as on the command line.
        name: Name of the scenario in the results.
        maps: Name of a map in the scenario → file that holds it now; empty to find the files as the scenario does.
    """

    text: str
    path: str | None
    behavior: str
    steps: int | None
    strict: bool
    imports: tuple[str, ...]
    limits: tuple[tuple[str, Any], ...]
    until: Until = "done"
    perturb: tuple[str, ...] = ()
    name: str = ""
    maps: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Task:
    """One episode to run."""

    job: Job
    seed: int

    def as_data(self) -> dict[str, Any]:
        """The task as JSON types."""
        return asdict(self)

    @staticmethod
    def of_data(data: dict[str, Any]) -> Task:
        """The task of the data that :meth:`as_data` returns."""
        job = data["job"]
        job["imports"], job["perturb"] = tuple(job["imports"]), tuple(job["perturb"])
        for key in ("limits", "maps"):
            job[key] = tuple((name, value) for name, value in job.get(key, ()))
        return Task(Job(**job), data["seed"])


@lru_cache(maxsize=8)
def scenario_of(job: Job) -> ResolvedScenario:
    """The scenario of a job, ready to build; the last few scenarios are cached.

    Raises:
        ScenarioError: The scenario has errors.
        BenchmarkError: The behavior or a perturbation does not fit the scenario.
    """
    import_modules(job.imports)
    document = load_text(job.text, name=job.path, path=job.path, limits=Limits(**dict(job.limits)))
    document.maps = dict(job.maps)
    scenario = with_behavior(document, parse_behavior(job.behavior), strict=job.strict)
    return perturbed(scenario, read_perturbations(job.perturb))


def run_task(task: Task, ways: Geodesics | None = None) -> dict[str, Any]:
    """Run an episode, see :func:`_run`; a seed without room for an object is the outcome ``placement-crowded``."""
    try:
        return _run(task, ways)
    except PlacementError:
        metrics = {metric.key: math.nan for metric in (*METRICS, *EPISODE_METRICS)}
        return {**_NOTHING, "outcome": CROWDED, "metrics": metrics}


def _run(task: Task, ways: Geodesics | None) -> dict[str, Any]:
    """Run an episode until every robot has arrived or stopped, or the horizon is reached, and measure it.

    Args:
        task: The episode.
        ways: Shortest paths in a world with the same static objects, if they are known.

    Returns:
        ``outcome``, ``steps``, ``sim_time``, ``time_limit``, ``robots``, ``unreachable`` (number of robots without a
        path to their goal), ``failures`` (outcome of robots without success, by name), ``human_contacts`` (number of
        contacts between people), ``left`` and ``jumped`` (objects that left the world or jumped over their goal), and
        ``metrics`` of the episode by key (NaN where undefined), and ``zones``: metrics of each zone by its name.
    """
    job = task.job
    env = Env(scenario_of(job), seed=task.seed, display=False, headless=True, log_level="ERROR")
    horizon, _ = horizon_of(env.scenario, env, job.steps, Limits(**dict(job.limits)))
    simulation = env.simulation
    trace, events, records = record(simulation, horizon), env.events, env.scenario.objects
    if job.until == "first_collision":
        last = _first_collision(env)
        trace, events = cut_trace(trace, slice(last + 1)), [event for event in events if event.step <= last]
    steps = int(trace.step[-1])
    measured, incidents = episode_metrics(trace, simulation, events, ways=ways), find_incidents(records, events)
    measured.episode["pedestrian_delay"] = _pedestrian_delay(task, env, horizon)
    env.end(ending_time=0.0)
    robots = measured.robots
    outcome: Outcome = "timeout"
    if robots and all(robot["success"] for robot in robots):
        outcome = "success"
    elif any(not robot["success"] and not robot["timeout"] for robot in robots):
        outcome = "collision"
    return {
        "outcome": outcome,
        "steps": steps,
        "sim_time": steps * trace.step_time,
        "time_limit": horizon * trace.step_time,
        "robots": len(robots),
        "unreachable": sum(UNREACHABLE in flags for flags in measured.flags),
        "failures": _failures(measured),
        "human_contacts": len(incidents.human_contacts),
        "left": [item.name for item in find_exits(env.scenario, lambda row: trace.pose[:, row, :2], steps)][
            :_MAX_NAMES
        ],
        "jumped": list(incidents.jumps)[:_MAX_NAMES],
        "metrics": measured.episode,
        "zones": measured.zones,
    }


def _first_collision(env: Env) -> int:
    """Step of the first collision of a robot; that of the last step without one."""
    robots = {robot.name for robot in env.robot_list}
    steps = [event.step for name, event in first_collisions(env.simulation, env.events).items() if name in robots]
    return min([*steps, int(env.simulation.count[0])])


def _pedestrian_delay(task: Task, env: Env, horizon: int) -> float:
    """``pedestrian_delay`` [s]; advances the environment until all humans have arrived, at most to the horizon."""
    people = travelling_humans(env.scenario.objects)
    if not people or not env.robot_list:
        return math.nan
    with_robots: dict[str, float] = {}
    while True:
        with_robots = _arrival_times(env, people)
        left = horizon - int(env.simulation.count[0])
        if len(with_robots) == len(people) or left <= 0:
            break
        env.simulation.advance(min(left, _STRIDE))
    if not with_robots:
        return math.nan
    alone = Env(scenario_of(task.job), seed=task.seed, display=False, headless=True, log_level="ERROR")
    alone.delete_objects([robot.id for robot in alone.robot_list])
    alone.simulation.advance(int(env.simulation.count[0]))
    without = _arrival_times(alone, people)
    alone.end(ending_time=0.0)
    delays = [with_robots[name] - without[name] for name in with_robots if name in without]
    return math.fsum(delays) / len(delays) if delays else math.nan


def _arrival_times(env: Env, names: Collection[str]) -> dict[str, float]:
    """Time of the first arrival of each of some objects [s]; objects that have not arrived are left out."""
    return {name: event.time for name, event in first_events(env.events, "arrival").items() if name in names}


def _failures(measured: EpisodeMetrics) -> dict[str, str]:
    """Outcome of the first robots without success, by name."""
    found: dict[str, str] = {}
    for name, robot, hit in zip(measured.names, measured.robots, measured.hits, strict=True):
        if not robot["success"] and len(found) < _MAX_FAILURES:
            found[name] = "timeout" if robot["timeout"] else f"collision with {hit!r}"
    return found
