"""Dry run: simulate the first steps of a scenario with a fixed seed and summarise what happens, without a recording."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from irsim.common.text import seconds
from irsim.env import Env
from irsim.episodes.between_steps import between_steps_message
from irsim.episodes.episode import horizon_of
from irsim.episodes.explanation import others_arrived_message
from irsim.episodes.facts import EpisodeFacts
from irsim.episodes.incidents import MAX_LISTED_EXITS, exits_message, find_exits
from irsim.episodes.obstructions import find_obstruction, heading_message, jam_message, no_way_message
from irsim.episodes.opening import MAX_TRIES, crowded_message, first_with_room
from irsim.episodes.progress import find_circling, has_one_end, no_progress_since
from irsim.episodes.rounds import when_it_ends
from irsim.episodes.scene_summary import called
from irsim.episodes.watching import zone_results, zones_message
from irsim.results.episode import EventRecord
from irsim.results.validation import DryRun, Stuck
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario, random_parts
from irsim.simulation.events import Event, partner_of
from irsim.simulation.outcome import is_over
from irsim.simulation.simulation import Simulation
from irsim.simulation.step_cost import step_work
from irsim.simulation.trace import Trace, join_traces, next_rows, present_row

__all__ = ["SECONDS", "Trial", "dry_run", "try_out"]

BUDGET = 300_000
"""Work of a dry run: steps times objects, weighted by cost (:mod:`irsim.simulation.step_cost`); about a second.
It also bounds the number of trace rows held in memory."""
SECONDS = 5.0
"""Computing time [s] after which a dry run ends and says so, several times what its budget usually takes."""
_CLOCK_PERIOD_S = 0.1
"""Computing time [s] between two looks at the clock, unless a single step takes longer."""
_MAX_LISTED = 10
"""Number of collisions, and of stuck robots, that the result lists one by one."""

Flags = NDArray[np.bool_]


class Trial(NamedTuple):
    """A dry run and its steps."""

    result: DryRun
    trace: Trace


def dry_run(scenario: ResolvedScenario, **options: Any) -> DryRun:
    """Simulate the first steps of a scenario and summarise what happens.

    Args:
        scenario: The scenario.
        **options: As of :func:`try_out`.
    """
    return try_out(scenario, **options).result


def try_out(
    scenario: ResolvedScenario,
    *,
    seed: int | None = None,
    budget: int = BUDGET,
    seconds: float = SECONDS,
    steps: int | None = None,
    limits: Limits | None = None,
) -> Trial:
    """Simulate the first steps of a scenario, summarise what happens, and keep the steps.

    Args:
        scenario: The scenario.
        seed: Overrides the scenario's own seed. Without either it is the first one, from 0 on, that leaves room for
            every object, so every dry run is the same.
        budget: Greatest work, estimated from the scenario: the same budget gives the same steps on every machine.
        seconds: Computing time [s] after which the dry run ends even within its budget, counted from the end of the
            first step, in which routes are planned.
        steps: Greatest number of steps; default: a whole episode.
        limits: Limits of a run.

    Raises:
        PlacementError: There is no free place for a random object with this seed, or without one with any tried.
    """
    own = scenario.world.seed if seed is None else seed
    env, crowded = first_with_room(
        lambda tried: Env(scenario, seed=tried, display=False, headless=True, log_level="ERROR"),
        range(MAX_TRIES) if own is None else [own],
    )
    try:
        horizon, source = horizon_of(env.simulation, None, limits or DEFAULT_LIMITS)
        affordable = max(1, int(budget / max(1.0, step_work(scenario, env.simulation))))
        wanted = 0 if is_over(env.simulation) else min(horizon, affordable if steps is None else min(steps, affordable))
        trace, late = _simulate(env.simulation, wanted, seconds)
        answer = _summarise(
            env, scenario, trace, env.seed, None if source == "limits" else horizon, seconds if late else None
        )
        if skipped := crowded_message(crowded):
            answer.summary += f"; {skipped}"
        return Trial(answer, trace)
    finally:
        env.end(ending_time=0.0)


def _simulate(simulation: Simulation, steps: int, seconds: float) -> tuple[Trace, bool]:
    """Simulate until the episode is done, or the steps or seconds are used up.

    The seconds count from the end of the first step.

    Returns:
        The trace, and whether the seconds ended it.
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
        size = max(1, min(2 * size, int(size * _CLOCK_PERIOD_S / max(now - begin, 1e-9))))
    return join_traces(parts), late


def _summarise(
    env: Env, scenario: ResolvedScenario, trace: Trace, seed: int, horizon: int | None, cut: float | None
) -> DryRun:
    """The result of a dry run.

    Args:
        env: The environment after the last step.
        scenario: The scenario.
        trace: The recorded steps.
        seed: Seed of the dry run.
        horizon: Steps of a whole episode; None if only the limits bound it.
        cut: Computing time [s] that ended the dry run, None if it ended for another reason.
    """
    steps = len(trace) - 1
    facts = EpisodeFacts.of(env.simulation, env.events)
    events, hits, parked, held = facts.events, facts.hits, facts.parked, facts.jammed
    names = {record.name for record in facts.robots.values()}
    arrived = list(dict.fromkeys(e.object for e in events if e.kind == "arrival" and e.object in names))
    moving = [row for row, record in facts.robots.items() if record.name not in parked]
    driven = [row for row in moving if not _is_undriven(scenario.objects[row])]
    stuck, count = _find_stuck(env, trace, driven, events, held)
    waiting, _ = _find_stuck(env, trace, [row for row in moving if row not in driven], events, held)
    left = find_exits(scenario, lambda row: trace.pose[:, row], steps)
    ended: Literal["done", "horizon", "budget"] = "budget"
    if bool(env.simulation.done()[0]):
        ended = "done"
    elif horizon is not None and (steps >= horizon or is_over(env.simulation)):
        ended = "horizon"
    return DryRun(
        seed=seed,
        random=random_parts(scenario),
        steps=steps,
        sim_time=float(trace.time[-1]),
        ended=ended,
        summary="; ".join(
            [
                _progress_message(trace, len(names), arrived, parked, ended, cut),
                *filter(None, [when_it_ends(facts.robots.values())]),
                *filter(None, [between_steps_message(env.simulation, facts.between, hits)]),
                *_problem_messages(scenario, hits, stuck, count),
                *filter(
                    None,
                    (
                        others_arrived_message(scenario, events),
                        jam_message(env.simulation, held),
                        exits_message(scenario, left),
                        zones_message(zone_results(env.simulation, events)),
                    ),
                ),
            ]
        ),
        arrived=arrived,
        collisions=[EventRecord(**e._asdict()) for e in hits[:_MAX_LISTED]],
        contacts_between_steps=[EventRecord(**e._asdict()) for e in facts.between.of_robots[:_MAX_LISTED]],
        stuck=[*stuck, *waiting][:_MAX_LISTED],
        left=left[:MAX_LISTED_EXITS],
        parked=parked,
        jammed=list(held),
    )


def _find_stuck(
    env: Env, trace: Trace, robots: Sequence[int], events: Sequence[Event], held: dict[str, Event]
) -> tuple[list[Stuck], int]:
    """Find robots that make no progress at the end of the trace: the first ones, and their number."""
    stuck, count = list[Stuck](), 0
    records, views = env.scenario.objects, {view.row: view for view in env.robot_list}
    for index in robots:
        if trace.arrived[-1, index]:
            continue
        record, place = records[index], trace.pose[-1, index]
        since = no_progress_since(trace.pose[:, index, :2], trace.step_time, views[index].max_speed)
        doing: Literal["stands", "circles its goal"] = "stands"
        why = None
        if since is None:
            begin = _first_row_of_goal(trace, index)
            circle = (
                find_circling(trace.pose[begin:, index], trace.goal[-1, index, :2]) if has_one_end(record) else None
            )
            blocked = next((e for e in reversed(events) if (e.kind, e.object) == ("no_path", record.name)), None)
            if circle is not None:
                since, doing, why = begin + circle.since, "circles its goal", circle.message
            elif blocked is not None and no_way_message(env.simulation, events, record.name) is not None:
                since = min(blocked.step, len(trace) - 1)  # it may drive to and fro in front of what is in the way
            else:
                continue
        count += 1
        if len(stuck) < _MAX_LISTED:
            why = why or _certain_cause(env, record, trace, index, events) or _likely_cause(env, trace, index, held)
            time, (x, y) = float(trace.time[since]), (float(value) for value in place[:2])
            stuck.append(Stuck(name=record.name, doing=doing, since=time, x=x, y=y, why=why))
    return stuck, count


def _is_undriven(record: ObjectRecord) -> bool:
    """Whether a robot that could move has no behavior, which a hint says (``no-behavior``)."""
    movable = record.kinematics is not None and not record.static
    return movable and record.behavior is None and record.group_behavior is None


def _first_row_of_goal(trace: Trace, index: int) -> int:
    """First row from which on an object has the goal that it has at the end."""
    others = np.flatnonzero((trace.goal[:, index, :2] != trace.goal[-1, index, :2]).any(axis=1))
    return int(others[-1]) + 1 if others.size and others[-1] + 1 < len(trace) else 0


def _certain_cause(env: Env, record: ObjectRecord, trace: Trace, index: int, events: Sequence[Event]) -> str | None:
    """Why a robot makes no progress, where the record or the events say so."""
    if trace.stopped[-1, index] or trace.collided[-1, index]:
        hit = next((e for e in events if e.kind == "collision" and record.name in (e.object, e.partner)), None)
        if hit is not None:
            return f"it hit {called(env.simulation.scenario, partner_of(hit, record.name))} at {seconds(hit.time)}"
    if record.kinematics is None or record.static:
        return "it is static" if record.kinematics is not None else "it has no kinematics"
    if _is_undriven(record):
        return "it has no behavior (not needed if it is meant to stay or a program drives it)"
    if not any(record.vel_max):
        return "its vel_max is zero"
    no_way = no_way_message(env.simulation, events, record.name)
    return no_way or heading_message(record, trace.pose[-1, index], trace.goal[-1, index])


def _likely_cause(env: Env, trace: Trace, index: int, held: dict[str, Event]) -> str:
    """Why a robot probably makes no progress: an object close to it, else its behavior."""
    near = find_obstruction(env.simulation, index, held, trace.pose[-1])
    if near is None:
        return "its behavior keeps it where it is"
    if near.held:
        return near.message
    return f"{near.message}, in the way of its behavior" + (f" ({near.advice})" if near.advice else "")


def _progress_message(
    trace: Trace, robots: int, arrived: Sequence[str], parked: Sequence[str], ended: str, cut: float | None
) -> str:
    """How much time was simulated, how many robots arrived, and whether the computing time ended the dry run."""
    time = seconds(trace.time[-1])
    begin = f"in the first {time} only: " if ended == "budget" else f"in {time}: "
    if cut is not None:
        begin = (
            f"in the first {time} only, after which {cut:g} s of computing time were used up (steps are slower than "
            "estimated; the next dry run may end earlier or later): "
        )
    still = f", {len(parked)} {'is' if len(parked) == 1 else 'are'} parked (cannot move, no goal written)"
    if not robots:
        return f"{begin}no robots" if trace.time[-1] else "no robots, and nothing moves"
    return f"{begin}{len(arrived)} of {robots} robots arrived{still * bool(parked)}"


def _problem_messages(
    scenario: ResolvedScenario, hits: Sequence[Event], stuck: Sequence[Stuck], count: int
) -> list[str]:
    """Messages about collisions and about robots that make no progress."""
    parts = []
    if hits:
        first = hits[0]
        several = f"{len(hits)} collisions, the first of " if len(hits) > 1 else "collision of "
        place = f"at {seconds(first.time)}, contact near ({first.x:.2f}, {first.y:.2f})"
        pair = f"{called(scenario, first.object)} with {called(scenario, first.partner)}"
        parts.append(f"{several}{pair} {place}")
    if stuck:
        parts.append(f"'{stuck[0].name}' {stuck[0].doing} since {seconds(stuck[0].since)}: {stuck[0].why}")
    if count > 1:
        parts.append(f"{count - 1} more make{'s' * (count == 2)} no progress")
    return parts
