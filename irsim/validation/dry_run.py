"""A first look at what happens: some seeded steps, of which nothing is kept but what is worth telling."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from irsim.common.text import seconds
from irsim.env import Env
from irsim.episodes.episode import horizon_of
from irsim.episodes.out_of_bounds import MOST_LEFT, left_told, left_world
from irsim.episodes.run_report import has_one_end, others_arrived
from irsim.episodes.stuck import circling, gets_nowhere_since, in_the_way, jam_told, jammed, lacks_heading
from irsim.results.results import DryRun, EventRecord, Stuck
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.resolve.randomness import random_parts
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario
from irsim.simulation.events import Event, collision_of, partner_of, passable_names
from irsim.simulation.simulation import Simulation
from irsim.simulation.step_cost import step_work
from irsim.simulation.trace import Trace, joined, next_rows, present_row

__all__ = ["BUDGET", "SECONDS", "dry_run"]

BUDGET = 300_000
"""Work of a dry run: steps times objects, weighted by cost (:mod:`irsim.simulation.step_cost`); about a second.
It is also the number of rows in memory for a moment."""
SECONDS = 5.0
"""After which it ends whatever was estimated, told as such: several times what its work takes [s]."""
_CHUNK = 0.1
"""Time between two looks at the clock, where one step does not take longer [s]."""
_MOST = 10

Flags = NDArray[np.bool_]


def dry_run(
    scenario: ResolvedScenario,
    *,
    seed: int | None = None,
    budget: int = BUDGET,
    seconds: float = SECONDS,
    steps: int | None = None,
    limits: Limits | None = None,
) -> DryRun:
    """Simulate the first steps of a scenario and say what happens.

    Args:
        scenario: What to try.
        seed: Over the scenario's own; with neither, 0: the same look every time.
        budget: Work at most, estimated from the scenario: who gives the same gets the same steps on every machine.
        seconds: For which it goes on after its first step, in which routes are planned, so that what a budget does not
            foresee ends too.
        steps: Steps at most; default: those of a whole episode.
        limits: Of a run.

    Raises:
        PlacementError: A random object finds no room with this seed.
    """
    if seed is None:
        seed = scenario.world.seed if scenario.world.seed is not None else 0
    env = Env(scenario, seed=seed, display=False, headless=True, log_level="ERROR")
    try:
        horizon, source = horizon_of(scenario, env, None, limits or DEFAULT_LIMITS)
        affordable = max(1, int(budget / max(1.0, step_work(scenario, env.simulation))))
        wanted = min(horizon, affordable if steps is None else min(steps, affordable))
        trace, late = _recorded(env.simulation, wanted, seconds)
        return _told(env, scenario, trace, seed, None if source == "limits" else horizon, seconds if late else None)
    finally:
        env.end(ending_time=0.0)


def _recorded(simulation: Simulation, steps: int, seconds: float) -> tuple[Trace, bool]:
    """What happens until everybody is done, or the steps or seconds are over; and whether it was the seconds.

    The first step is free.
    """
    parts, done, size, end, late = [present_row(simulation)], 0, 1, math.inf, False
    while done < steps:
        begin, size = time.monotonic(), min(size, steps - done)
        parts.append(next_rows(simulation, size))
        now = time.monotonic()
        done += size
        if len(parts[-1]) < size:
            break
        if now >= end:
            late = done < steps and not bool(simulation.done()[0])
            break
        if end == math.inf:
            end = now + seconds
        size = max(1, min(2 * size, int(size * _CHUNK / max(now - begin, 1e-9))))
    return joined(parts), late


def _told(
    env: Env, scenario: ResolvedScenario, trace: Trace, seed: int, horizon: int | None, cut: float | None
) -> DryRun:
    steps = len(trace) - 1
    events, passable = env.events, passable_names(env.simulation)
    robots = [index for index, item in enumerate(scenario.objects) if item.role == "robot"]
    names = {scenario.objects[index].name for index in robots}
    hits = [e for e in events if any(collision_of(e, name, passable) for name in names)]
    arrived = list(dict.fromkeys(e.object for e in events if e.kind == "arrival" and e.object in names))
    parked = [record.name for record in scenario.robots() if scenario.is_parked(record)]
    held = jammed(env.simulation, events)
    stuck, count = _stuck(env, trace, [row for row in robots if scenario.objects[row].name not in parked], events, held)
    left = left_world(scenario, lambda row: trace.pose[:, row], steps)
    ended: Literal["done", "horizon", "budget"] = "budget"
    if bool(env.simulation.done()[0]):
        ended = "done"
    elif horizon is not None and steps >= horizon:
        ended = "horizon"
    return DryRun(
        seed=seed,
        random=random_parts(scenario),
        steps=steps,
        sim_time=float(trace.time[-1]),
        ended=ended,
        summary="; ".join(
            [
                _begin(trace, len(robots), arrived, parked, ended, cut),
                *_troubles(hits, stuck, count),
                *filter(
                    None,
                    (others_arrived(scenario, events), jam_told(env.simulation, held), left_told(scenario, left)),
                ),
            ]
        ),
        arrived=arrived,
        collisions=[EventRecord(**{key: getattr(e, key) for key in EventRecord.model_fields}) for e in hits[:_MOST]],
        stuck=stuck,
        left=left[:MOST_LEFT],
        parked=parked,
        jammed=list(held),
    )


def _stuck(
    env: Env, trace: Trace, robots: Sequence[int], events: Sequence[Event], held: dict[str, Event]
) -> tuple[list[Stuck], int]:
    """Robots under way that get nowhere at the end of the trace, the first ones, and how many there are."""
    found, count = list[Stuck](), 0
    records, views = env.scenario.objects, {view.row: view for view in env.robot_list}
    for index in robots:
        if trace.arrived[-1, index]:
            continue
        record, place = records[index], trace.pose[-1, index]
        since = gets_nowhere_since(trace.pose[:, index, :2], trace.step_time, views[index].max_speed)
        doing: Literal["stands", "circles its goal"] = "stands"
        why = None
        if since is None:
            begin = _present_goal(trace, index)
            circle = circling(trace.pose[begin:, index], trace.goal[-1, index, :2]) if has_one_end(record) else None
            if circle is None:
                continue
            since, doing, why = begin + circle.since, "circles its goal", circle.told
        count += 1
        if len(found) < _MOST:
            why = why or _why(record, trace, index, events) or _blocked(env, trace, index, held)
            time, (x, y) = float(trace.time[since]), (float(value) for value in place[:2])
            found.append(Stuck(name=record.name, doing=doing, since=time, x=x, y=y, why=why))
    return found, count


def _present_goal(trace: Trace, index: int) -> int:
    """The row since which an object has the goal that it has at the end."""
    others = np.flatnonzero((trace.goal[:, index, :2] != trace.goal[-1, index, :2]).any(axis=1))
    return int(others[-1]) + 1 if others.size and others[-1] + 1 < len(trace) else 0


def _why(record: ObjectRecord, trace: Trace, index: int, events: Sequence[Event]) -> str | None:
    """A cause that is certain."""
    if trace.stopped[-1, index] or trace.collided[-1, index]:
        hit = next((e for e in events if e.kind == "collision" and record.name in (e.object, e.partner)), None)
        if hit is not None:
            return f"it hit '{partner_of(hit, record.name)}' at {seconds(hit.time)}"
    if record.kinematics is None or record.static:
        return "it is static" if record.kinematics is not None else "it has no kinematics"
    if record.behavior is None and record.group_behavior is None:
        return "it has no behavior (none needed if it is meant to stand or a program drives it)"
    if not any(record.vel_max):
        return "its vel_max is zero"
    if any(e.kind == "no_path" and e.object == record.name for e in events):
        return "there is no path to its goal"
    return lacks_heading(record, trace.pose[-1, index], trace.goal[-1, index])


def _blocked(env: Env, trace: Trace, index: int, held: dict[str, Event]) -> str:
    """What stands close to it at the end, or that there is no telling."""
    near = in_the_way(env.simulation, index, held, trace.pose[-1])
    if near is None:
        return "its behavior keeps it where it is"
    return near.told if near.held else f"{near.told}, in the way of its behavior"


def _begin(
    trace: Trace, robots: int, arrived: Sequence[str], parked: Sequence[str], ended: str, cut: float | None
) -> str:
    """How far it went and who arrived; why no farther, where a clock said so."""
    time = seconds(trace.time[-1])
    begin = f"in the first {time} only: " if ended == "budget" else f"in {time}: "
    if cut is not None:
        begin = (
            f"in the first {time} only, after which {cut:g} s of computing were over (steps are slower than estimated; "
            "the next look may get farther or less far): "
        )
    still = f", {len(parked)} {'is' if len(parked) == 1 else 'are'} parked (cannot move, no goal written)"
    return begin + (f"{len(arrived)} of {robots} robots arrived" if robots else "no robots") + (still if parked else "")


def _troubles(hits: Sequence[Event], stuck: Sequence[Stuck], count: int) -> list[str]:
    """Who collided and who gets nowhere."""
    parts = []
    if hits:
        first = hits[0]
        several = f"{len(hits)} collisions, the first of " if len(hits) > 1 else "collision of "
        place = f"at {seconds(first.time)} near ({first.x:.2f}, {first.y:.2f})"
        parts.append(f"{several}'{first.object}' with '{first.partner}' {place}")
    if stuck:
        parts.append(f"'{stuck[0].name}' {stuck[0].doing} since {seconds(stuck[0].since)}: {stuck[0].why}")
    if count > 1:
        parts.append(f"{count - 1} more get{'s' * (count == 2)} nowhere")
    return parts
