"""A first look at what happens: some seeded steps, of which nothing is kept but what is worth telling."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from irsim.env import Env
from irsim.episode import horizon_of
from irsim.metrics import clearance
from irsim.observers.events import Event, collision_of, passable_names
from irsim.observers.trace import Trace, record
from irsim.results import DryRun, EventRecord, Left, Stuck
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.objects import ObjectRecord, ResolvedScenario
from irsim.scenario.randomness import random_parts
from irsim.text import seconds
from irsim.verdict import others_arrived

__all__ = ["BUDGET", "dry_run"]

BUDGET = 300_000
"""Steps times objects of a look; as many rows are in memory for a moment."""
_MOST = 10
_WINDOW = 5.0
"""A robot that has moved by less than ``_LITTLE`` for so long gets nowhere [s]."""
_LITTLE = 0.1
"""[m]"""
_CLOSE = 0.5
"""What is nearer than this is in the way of a robot that stands [m]."""

Flags = NDArray[np.bool_]


def dry_run(
    scenario: ResolvedScenario,
    *,
    seed: int | None = None,
    budget: int = BUDGET,
    steps: int | None = None,
    limits: Limits | None = None,
) -> DryRun:
    """Simulate the first steps of a scenario and say what happens.

    Args:
        scenario: What to try.
        seed: Over the scenario's own; with neither, 0: the same look every time.
        budget: Steps times objects at most.
        steps: Steps at most; default: those of a whole episode.
        limits: Of a run.

    Raises:
        PlacementError: A random object finds no room with this seed.
    """
    if seed is None:
        seed = scenario.world.seed if scenario.world.seed is not None else 0
    env = Env(scenario, seed=seed, display=False, headless=True, log_level="ERROR")
    try:
        horizon, _ = horizon_of(scenario, env, None, limits or DEFAULT_LIMITS)
        affordable = max(1, budget // max(1, len(scenario.objects)))
        wanted = min(horizon, affordable if steps is None else min(steps, affordable))
        trace = record(env.simulation, wanted, until_done=True)
        return _told(env, scenario, trace, seed, horizon)
    finally:
        env.end(ending_time=0.0)


def _told(env: Env, scenario: ResolvedScenario, trace: Trace, seed: int, horizon: int) -> DryRun:
    steps = len(trace) - 1
    events, passable = env.events, passable_names(env.simulation)
    robots = [index for index, item in enumerate(scenario.objects) if item.role == "robot"]
    names = {scenario.objects[index].name for index in robots}
    hits = [e for e in events if any(collision_of(e, name, passable) for name in names)]
    arrived = list(dict.fromkeys(e.object for e in events if e.kind == "arrival" and e.object in names))
    stuck = _stuck(env, trace, robots, events)
    left = _left(scenario, trace)
    ended: Literal["done", "horizon", "budget"] = "budget"
    if bool(env.simulation.done()[0]):
        ended = "done"
    elif steps >= horizon:
        ended = "horizon"
    return DryRun(
        seed=seed,
        random=random_parts(scenario),
        steps=steps,
        sim_time=float(trace.time[-1]),
        ended=ended,
        summary=_summary(trace, len(robots), arrived, hits, stuck, left, others_arrived(scenario, events), ended),
        arrived=arrived,
        collisions=[EventRecord(**{key: getattr(e, key) for key in EventRecord.model_fields}) for e in hits[:_MOST]],
        stuck=stuck,
        left=left,
    )


def _stuck(env: Env, trace: Trace, robots: Sequence[int], events: Sequence[Event]) -> list[Stuck]:
    """Robots under way that have hardly moved for some seconds at the end of the trace."""
    window = max(1, round(_WINDOW / trace.step_time))
    if len(trace) <= window:
        return []
    found = []
    records = env.scenario.objects
    for index in robots:
        if trace.arrived[-1, index]:
            continue
        away = np.linalg.norm(trace.pose[:, index, :2] - trace.pose[-1, index, :2], axis=1)
        far = np.flatnonzero(away >= _LITTLE)
        since = int(far[-1]) + 1 if far.size else 0
        if len(trace) - 1 - since < window:
            continue
        x, y = (float(value) for value in trace.pose[-1, index, :2])
        why = _why(records[index], trace, index, events)
        why = why or _blocked(env, trace, index) or "its behavior keeps it where it is"
        found.append(Stuck(name=records[index].name, since=float(trace.time[since]), x=x, y=y, why=why))
        if len(found) >= _MOST:
            break
    return found


def _why(record: ObjectRecord, trace: Trace, index: int, events: Sequence[Event]) -> str | None:
    """A cause that is certain."""
    if trace.stopped[-1, index] or trace.collided[-1, index]:
        hit = next((e for e in events if e.kind == "collision" and record.name in (e.object, e.partner)), None)
        if hit is not None:
            other = hit.partner if hit.object == record.name else hit.object
            return f"it hit '{other}' at {seconds(hit.time)}"
    if record.kinematics is None or record.static:
        return "it is static" if record.kinematics is not None else "it has no kinematics"
    if record.behavior is None and record.group_behavior is None:
        return "it has no behavior (none needed if it is meant to stand or a program drives it)"
    if not any(record.vel_max):
        return "its vel_max is zero"
    if any(e.kind == "no_path" and e.object == record.name for e in events):
        return "there is no path to its goal"
    return None


def _blocked(env: Env, trace: Trace, index: int) -> str | None:
    """What stands close to it at the end."""
    found = clearance(trace.pose[-1:], env.simulation)
    row = int(np.flatnonzero(found.robots == index)[0])
    distance, partner = found.distance[0, row], found.partner[0, row]
    near = [k for k in np.argsort(np.nan_to_num(distance, nan=np.inf)) if distance[k] < _CLOSE]
    if not near:
        return None
    k = int(near[0])
    return f"'{found.names[int(partner[k])]}' is {distance[k]:.2f} m from it, in the way of its behavior"


def _left(scenario: ResolvedScenario, trace: Trace) -> list[Left]:
    """Moving objects whose position left the world's extent, in order of time."""
    x, y, right, top = scenario.world.bounds
    moving = [index for index, item in enumerate(scenario.objects) if not item.static]
    inside = (
        (trace.pose[:, moving, 0] >= x)
        & (trace.pose[:, moving, 0] <= right)
        & (trace.pose[:, moving, 1] >= y)
        & (trace.pose[:, moving, 1] <= top)
    )
    found = []
    for column, index in enumerate(moving):
        out = np.flatnonzero(~inside[:, column])
        if out.size and inside[0, column]:
            px, py = (float(value) for value in trace.pose[out[0], index, :2])
            found.append(Left(name=scenario.objects[index].name, time=float(trace.time[out[0]]), x=px, y=py))
    return sorted(found, key=lambda item: item.time)[:_MOST]


def _summary(
    trace: Trace,
    robots: int,
    arrived: Sequence[str],
    hits: Sequence[Event],
    stuck: Sequence[Stuck],
    left: Sequence[Left],
    others: str | None,
    ended: str,
) -> str:
    more = ", more was not tried" if ended == "budget" else ""
    parts = [
        f"in {seconds(trace.time[-1])}{more}: "
        + (f"{len(arrived)} of {robots} robots arrived" if robots else "no robots")
    ]
    if hits:
        first = hits[0]
        count = f"{len(hits)} collisions, the first of " if len(hits) > 1 else "collision of "
        place = f"at {seconds(first.time)} near ({first.x:.2f}, {first.y:.2f})"
        parts.append(f"{count}'{first.object}' with '{first.partner}' {place}")
    if stuck:
        parts.append(f"'{stuck[0].name}' stands since {seconds(stuck[0].since)}: {stuck[0].why}")
    if len(stuck) > 1:
        parts.append(f"{len(stuck) - 1} more stand still")
    if others:
        parts.append(others)
    if left:
        parts.append(f"'{left[0].name}' left the world at {seconds(left[0].time)}")
    return "; ".join(parts)
