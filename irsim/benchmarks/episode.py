"""Run and measure one episode of a benchmark."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal

from irsim.benchmarks.policies import open_again
from irsim.benchmarks.roles import role_metrics
from irsim.diagnostics.errors import PlacementError, PolicyLostError
from irsim.env import Env
from irsim.episodes.episode import horizon_of
from irsim.episodes.incidents import find_exits, find_incidents
from irsim.metrics.definitions import EPISODE_METRICS, METRICS
from irsim.metrics.episode import EpisodeMetrics, episode_metrics
from irsim.metrics.progress import UNREACHABLE
from irsim.navigation.geodesic import Geodesics
from irsim.policies.driver import PolicyDriver, drivers_of
from irsim.policies.policy import Policy
from irsim.results.benchmark import CROWDED
from irsim.results.run import EpisodeUntil
from irsim.scenario.behavior_override import parse_behavior, with_behavior
from irsim.scenario.limits import Limits
from irsim.scenario.open import import_modules
from irsim.scenario.perturbation import perturbed, read_perturbations
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.scenario.yaml.document import load_text
from irsim.simulation.events import Event, first_collisions, first_events, partner_of, read_events
from irsim.simulation.outcome import explored_share
from irsim.simulation.roles import humans_of, travelling_humans
from irsim.simulation.simulation import Simulation
from irsim.simulation.trace import Trace, cut_trace, join_traces, next_rows, present_row, record

if TYPE_CHECKING:
    from typing_extensions import Self

__all__ = [
    "Episode",
    "Job",
    "Outcome",
    "Task",
    "check_policy",
    "crowded",
    "environment_of",
    "measure",
    "policy_of",
    "run_task",
    "scenario_of",
]

Outcome = Literal["success", "collision", "timeout"]
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
        "lost": None,
        "zones": {},
        "roles": {},
    }
)
"""Result of an episode that does not take place, without its outcome and metrics."""


@dataclass(frozen=True)
class Job:
    """One scenario under one policy.

    Attributes:
        text: Text of the scenario.
        path: Its file, relative to which it names other files; None for a text.
        behavior: Behavior of all robots, see :func:`irsim.scenario.behavior_override.parse_behavior`; ``as-written``
            under a policy in Python.
        steps: Horizon in steps; None takes the scenario's.
        strict: Refuse what IR-SIM would ignore.
        imports: Modules of the user that register behaviors.
        limits: Limits of the loader and of the run, as (name, value) pairs.
        until: ``done``, or ``first_collision`` to end the episode when a robot collides.
        perturb: Perturbations of the scenario, as on the command line.
        name: Name of the scenario in the results.
        policy: Text that opens the policy in Python that drives the robots, in any folder; None: behaviors do.
        digest: SHA-256 of its file; None without one.
        local: The policy itself, if only this process has it.
        maps: Name of a map in the scenario → file that holds it now; empty to find the files as the scenario does.
    """

    text: str
    path: str | None
    behavior: str
    steps: int | None
    strict: bool
    imports: tuple[str, ...]
    limits: tuple[tuple[str, Any], ...]
    until: EpisodeUntil = "done"
    perturb: tuple[str, ...] = ()
    name: str = ""
    policy: str | None = None
    digest: str | None = None
    local: Policy | None = None
    maps: tuple[tuple[str, str], ...] = ()

    @classmethod
    def of_data(cls, data: dict[str, Any]) -> Self:
        """The job of its fields as JSON types."""
        pairs = {key: tuple((name, value) for name, value in data[key]) for key in ("limits", "maps")}
        listed = {key: tuple(value) for key, value in data.items() if isinstance(value, list)}
        return cls(**{**data, **listed, **pairs})


@dataclass(frozen=True)
class Task:
    """One episode to run."""

    job: Job
    seed: int


@lru_cache(maxsize=8)
def scenario_of(job: Job) -> ResolvedScenario:
    """The scenario of a job, ready to build; the last few scenarios are cached.

    Raises:
        ScenarioError: The scenario has errors.
        InputError: The behavior or a perturbation does not fit the scenario.
    """
    import_modules(job.imports)
    document = load_text(job.text, name=job.path, path=job.path, limits=Limits(**dict(job.limits)))
    document.maps = dict(job.maps)
    scenario = with_behavior(document, parse_behavior(job.behavior), strict=job.strict)
    return perturbed(scenario, read_perturbations(job.perturb))


def policy_of(job: Job) -> Policy | None:
    """The policy in Python that drives the robots of a job; None: behaviors do.

    Raises:
        PolicyError: It cannot be opened, or its file has changed.
    """
    return job.local if job.policy is None else open_again(job.policy, job.digest)


def check_policy(job: Job) -> None:
    """Refuse a policy in Python that cannot drive the robots of a scenario, before any episode is run.

    Raises:
        PolicyError: It cannot drive them, or cannot be opened.
    """
    policy = policy_of(job)
    if policy is None:
        return
    with suppress(PlacementError):
        environment_of(job, 0).end(ending_time=0.0)


def environment_of(job: Job, seed: int) -> Env:
    """An environment at the start of an episode, which the caller must end.

    Raises:
        PlacementError: The seed leaves no room for an object.
        PolicyError: The policy cannot drive the robots.
    """
    scenario = scenario_of(job)
    return Env(scenario, seed=seed, display=False, headless=True, log_level="ERROR", policy=policy_of(job))


def run_task(task: Task, ways: Geodesics | None = None) -> dict[str, Any]:
    """Run an episode until every robot has arrived or stopped, or the horizon is reached, and measure it.

    Args:
        task: The episode.
        ways: Shortest paths in a world with the same static objects, if they are known.

    Returns:
        See :func:`measure`, and for a policy in Python ``decisions``: (wall-clock time [s], number of robots) of each
        of its decisions (times are never part of a result); :func:`crowded` if the seed leaves no room for an object.
    """
    job = task.job
    try:
        env = environment_of(job, task.seed)
        horizon, _ = horizon_of(env.simulation, job.steps, Limits(**dict(job.limits)))
    except PlacementError:
        return crowded()
    drivers = drivers_of(env.simulation)
    trace, lost = _recorded(env.simulation, horizon, drivers)
    decisions = [pair for one in drivers for pair in zip(one.seconds, one.decided, strict=True)]
    timed = {"decisions": decisions} if drivers else {}
    result = measure(task, Episode(trace, env.events, horizon, lost=lost), env, env.simulation, ways) | timed
    env.end(ending_time=0.0)
    return result


def _recorded(simulation: Simulation, horizon: int, drivers: Sequence[PolicyDriver]) -> tuple[Trace, str | None]:
    """The trace of an episode, and why its policy could not go on; None if it could."""
    if not any(one.policy.may_be_lost for one in drivers):
        return record(simulation, horizon), None
    rows = [present_row(simulation)]
    try:
        while len(rows) <= horizon and len((row := next_rows(simulation, 1)).step):
            rows.append(row)
    except PolicyLostError as error:
        return join_traces(rows), error.message
    return join_traces(rows), None


def crowded() -> dict[str, Any]:
    """Result of an episode that does not take place, as its seed leaves no room: ``placement-crowded``."""
    metrics = {metric.key: math.nan for metric in (*METRICS, *EPISODE_METRICS)}
    return {**_NOTHING, "outcome": CROWDED, "metrics": metrics}


@dataclass(frozen=True)
class Episode:
    """An episode that was run.

    Attributes:
        trace: Its trace, from the start.
        events: Its events.
        horizon: Its horizon in steps.
        world: Index of its world in the simulation that ran it.
        lost: Why its policy could not go on, which ended it; None otherwise.
    """

    trace: Trace
    events: list[Event]
    horizon: int
    world: int = 0
    lost: str | None = None


def measure(
    task: Task, episode: Episode, scene: Env, simulation: Simulation, ways: Geodesics | None = None
) -> dict[str, Any]:
    """Measure an episode.

    Args:
        task: The task that was run.
        episode: Its episode.
        scene: An environment with the scene of the episode.
        simulation: The simulation that ran it, and can go on.
        ways: Shortest paths in a world with the same static objects, if they are known.

    Returns:
        ``outcome``, ``steps``, ``sim_time``, ``time_limit``, ``robots``, ``unreachable`` (number of robots without a
        path to their goal), ``failures`` (outcome of robots without success, by name), ``human_contacts`` (number of
        contacts between people), ``left`` and ``jumped`` (objects that left the world or jumped over their goal), and
        ``metrics`` of the episode by key (NaN where undefined), ``zones``: metrics of each zone by its name, and
        ``roles``: see :func:`irsim.benchmarks.roles.role_metrics`.
    """
    trace, events, horizon, records = episode.trace, episode.events, episode.horizon, scene.scenario.objects
    hits = _first_hits(scene, events) if task.job.until == "first_collision" else {}
    if hits:
        last = min(event.step for event in hits.values())
        hits = {name: event for name, event in hits.items() if event.step == last}
        trace, events = cut_trace(trace, slice(last + 1)), [event for event in events if event.step <= last]
    steps = int(trace.step[-1])
    humans = {record.name for record in humans_of(records)}
    measured, incidents = episode_metrics(trace, scene.simulation, events, ways=ways), find_incidents(humans, events)
    measured.episode["explored"] = _explored(task, episode, simulation, steps)
    measured.episode["pedestrian_delay"] = _pedestrian_delay(task, episode, scene, simulation)
    robots = measured.robots
    if robots:
        times = [robot["time_to_goal"] for robot in robots]
        limit = horizon * trace.step_time
        known = [limit if math.isnan(time) else time for time in times]
        measured.episode["restricted_time"] = math.fsum(known) / len(known)
    outcome: Outcome = "timeout"
    if hits:  # also a collision of robots that had arrived before
        outcome = "collision"
        measured.episode.update(success=0.0, collision=1.0, timeout=0.0)
    elif robots and all(robot["success"] for robot in robots):
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
        "failures": _partners(hits) if hits else _failures(measured),
        "human_contacts": len(incidents.human_contacts),
        "left": [item.name for item in find_exits(scene.scenario, lambda row: trace.pose[:, row, :2], steps)][
            :_MAX_NAMES
        ],
        "jumped": list(incidents.jumps)[:_MAX_NAMES],
        "lost": episode.lost,
        "metrics": measured.episode,
        "zones": measured.zones,
        "roles": role_metrics(policy_of(task.job), records, measured, hits, horizon * trace.step_time),
    }


def _explored(task: Task, episode: Episode, simulation: Simulation, steps: int) -> float:
    """``explored``; an episode that was cut short at a collision is run again to that step."""
    share = explored_share(simulation, episode.world)
    if share is None or steps == int(episode.trace.step[-1]):
        return math.nan if share is None else share
    again = environment_of(task.job, task.seed)
    again.simulation.advance(steps)
    share = explored_share(again.simulation)
    again.end(ending_time=0.0)
    return math.nan if share is None else share


def _first_hits(scene: Env, events: list[Event]) -> dict[str, Event]:
    """First collision of each robot that had one, by its name."""
    robots = {robot.name for robot in scene.robot_list}
    return {name: event for name, event in first_collisions(scene.simulation, events).items() if name in robots}


def _partners(hits: Mapping[str, Event]) -> dict[str, str]:
    """Outcome of the robots that were in the collision that ended an episode, by name."""
    return {name: f"collision with {partner_of(hits[name], name)!r}" for name in sorted(hits)[:_MAX_FAILURES]}


def _pedestrian_delay(task: Task, episode: Episode, scene: Env, simulation: Simulation) -> float:
    """``pedestrian_delay`` [s]; advances the simulation until all humans have arrived, at most to the horizon."""
    people = travelling_humans(scene.scenario.objects)
    if not people or not scene.robot_list or episode.lost is not None:  # a lost policy cannot go on
        return math.nan
    world, horizon = episode.world, episode.horizon
    done = int(episode.trace.step[-1])
    with_robots = _arrivals(simulation, world, people, horizon)
    while len(with_robots) < len(people) and int(simulation.count[world]) < horizon:
        simulation.advance(min(horizon - int(simulation.count[world]), _STRIDE))
        with_robots = _arrivals(simulation, world, people, horizon)
    if not with_robots:
        return math.nan
    last = horizon
    if len(with_robots) == len(people):
        needed = max(0, max(event.step for event in with_robots.values()) - done)
        last = min(horizon, done + _STRIDE * math.ceil(needed / _STRIDE))
    alone = Env(scenario_of(task.job), seed=task.seed, display=False, headless=True, log_level="ERROR")
    alone.delete_objects([robot.id for robot in alone.robot_list])
    alone.simulation.advance(last)
    without = _arrivals(alone.simulation, 0, people, last)
    alone.end(ending_time=0.0)
    delays = [with_robots[name].time - without[name].time for name in with_robots if name in without]
    return math.fsum(delays) / len(delays) if delays else math.nan


def _arrivals(simulation: Simulation, world: int, names: Collection[str], last: int) -> dict[str, Event]:
    """First arrival of each of some objects, up to a step; objects that have not arrived are left out."""
    first = first_events(read_events(simulation, world), "arrival")
    return {name: event for name, event in first.items() if name in names and event.step <= last}


def _failures(measured: EpisodeMetrics) -> dict[str, str]:
    """Outcome of the first robots without success, by name."""
    failures: dict[str, str] = {}
    for name, robot, hit in zip(measured.names, measured.robots, measured.hits, strict=True):
        if not robot["success"] and len(failures) < _MAX_FAILURES:
            failures[name] = "timeout" if robot["timeout"] else f"collision with {hit!r}"
    return failures
