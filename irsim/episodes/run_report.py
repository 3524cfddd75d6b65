"""Makes the :class:`irsim.results.run.RunResult` of an episode after its last step."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from irsim.common.installed import version
from irsim.common.text import clean
from irsim.diagnostics.errors import CodedError
from irsim.episodes.explanation import reason_message, summary_message
from irsim.episodes.facts import EpisodeFacts, first_collision
from irsim.episodes.incidents import MAX_LISTED_EXITS, find_exits
from irsim.episodes.obstructions import find_obstruction
from irsim.episodes.opening import reproduce_command, seed_to_repeat
from irsim.episodes.progress import find_circling, has_one_end, no_progress_since, stalled_step
from irsim.episodes.rounds import laps_of, rounds_message
from irsim.episodes.watching import goal_visibility, watched_metrics, zone_results
from irsim.navigation.clearances import Approach, least
from irsim.results.episode import EventRecord, Left, RobotResult, ZoneResult
from irsim.results.findings import Finding
from irsim.results.run import LOST_THINGS, HorizonSource, RunResult, Until
from irsim.simulation.events import BETWEEN_STEPS, SIGHTS, Event, first_events
from irsim.simulation.outcome import robot_outcomes
from irsim.simulation.trace import all_poses

if TYPE_CHECKING:
    from irsim.common.arrays import Floats
    from irsim.policies.policy import Policy
    from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario
    from irsim.simulation.simulation import Simulation

__all__ = ["RunPlan", "run_result"]

_MAX_EVENTS = 100
"""Number of events that a result lists."""
_MAX_LATE = 50
"""Number of robots without success whose trajectories are searched for the decisive step."""


@dataclass(frozen=True)
class RunPlan:
    """The plan of one run: its scenario, its limits, and the arguments that it was called with.

    Attributes:
        path: The scenario file, None for a text.
        horizon: Greatest number of steps.
        source: Where the horizon comes from.
        warnings: Warnings about the scenario.
        strict: Whether the scenario was read strictly.
        imports: Modules that were imported for the scenario.
        behavior: Behavior that every robot has instead of its own.
        policy: Policy in Python that drives the robots.
        perturb: Perturbations of the scenario, as on the command line.
        bridges: Names of all bridges that are opened.
        added_bridges: Bridges that the scenario does not name, as on the command line.
        until: When the run ends.
    """

    path: str | Path | None
    horizon: int
    source: HorizonSource
    warnings: list[Finding] = field(default_factory=list)
    strict: bool = False
    imports: Sequence[str] = ()
    behavior: str | None = None
    policy: Policy | None = None
    perturb: Sequence[str] = ()
    bridges: Sequence[str] = ()
    added_bridges: Sequence[str] = ()
    until: Until = "done"

    @property
    def policy_text(self) -> str | None:
        """The text that opens the policy in Python, or its name; None without one."""
        return None if self.policy is None else self.policy.text or self.policy.name

    def record_options(self) -> dict[str, Any]:
        """The options that a recorded run keeps besides scenario, seed and horizon."""
        options: dict[str, Any] = {"strict": self.strict, "imports": list(self.imports)}
        if self.behavior is not None:
            options["behavior"] = self.behavior
        if self.policy is not None:
            options |= {"policy": self.policy_text, "policy_digest": self.policy.digest}
        if self.perturb:
            options["perturb"] = list(self.perturb)
        if self.bridges:
            options["bridges"] = list(self.bridges)
        if self.until != "done":
            options["until"] = self.until
        return options

    def reproduce(self, seed: int | None) -> str:
        """The command that repeats the run; without a seed where the seed decides nothing."""
        extra = [] if self.behavior is None else ["--policy", self.behavior]
        extra += [] if self.policy_text is None else ["--policy", self.policy_text]
        extra += [word for one in self.perturb for word in ("--perturb", one)]
        extra += [word for one in self.added_bridges for word in ("--bridge", one)]
        extra += [] if self.until == "done" else ["--until", self.until]
        given = self.horizon if self.source in ("argument", "limits") else None
        return reproduce_command("run", self.path, seed, given, self.strict, self.imports, extra)


def run_result(
    simulation: Simulation,
    events: list[Event],
    plan: RunPlan,
    *,
    files: Sequence[str] = (),
    lost: CodedError | None = None,
) -> RunResult:
    """Make the result of an episode.

    Args:
        simulation: The simulation after the last step.
        events: All its events.
        plan: The plan of the run.
        files: Files that were written.
        lost: Why the policy or the program of a bridge could not go on, which ended the run.
    """
    facts = EpisodeFacts.of(simulation, events, plan.policy)
    scenario, seed = facts.scenario, simulation.key()[0]
    listed = _without_repeats(scenario, events)
    robots, left, zones = _robots(facts, plan.until), _exits(facts), zone_results(simulation, events)
    ends = [robot.outcome for robot in robots]
    outcome: Literal["success", "collision", "timeout"] = "timeout"
    if ends and all(end == "success" for end in ends):
        outcome = "success"
    elif "collision" in ends:
        outcome = "collision"
    reason: str | None = None
    if outcome != "success":
        touched = plan.until == "first_collision" and facts.steps < plan.horizon
        source = None if touched else plan.source
        reason = reason_message(facts, robots, source) if lost is None else f"{lost.message}; the run ended"
    summary, lost_code = _summary(facts, robots, plan, left, zones), _lost_code(lost)
    if lost_code is not None:
        summary += f"; the {LOST_THINGS[lost_code]} was lost, which ended the run"
    return RunResult(
        scenario="(text)" if plan.path is None else str(plan.path),
        seed=seed,
        random=facts.random,
        behavior=plan.behavior,
        policy=plan.policy_text,
        policy_digest=None if plan.policy is None else plan.policy.digest,
        perturb=list(plan.perturb),
        until=plan.until,
        outcome=outcome,
        summary=summary,
        reason=reason,
        lost=None if lost is None else lost.message,
        lost_code=lost_code,
        decisive_step=_decisive_step(facts, robots),
        steps=facts.steps,
        sim_time=facts.time,
        time_limit=plan.horizon * facts.step_time,
        time_limit_from=plan.source,
        robots=robots,
        parked=facts.parked,
        jammed=list(facts.jammed),
        left=left[:MAX_LISTED_EXITS],
        jumped=list(facts.incidents.jumps)[:MAX_LISTED_EXITS],
        explored=facts.explored,
        human_contacts=len(facts.incidents.human_contacts),
        contacts_between_steps=len(facts.between),
        zones=zones,
        events=[EventRecord(**event._asdict()) for event in _first(listed)],
        event_count=len(listed),
        warnings=list(plan.warnings),
        files=list(files),
        version=version(),
        reproduce=plan.reproduce(seed_to_repeat(scenario, seed, facts.random)),
    )


def _summary(
    facts: EpisodeFacts, robots: list[RobotResult], plan: RunPlan, left: list[Left], zones: dict[str, ZoneResult]
) -> str:
    rounds = rounds_message(facts, robots, plan.until, plan.horizon * facts.step_time)
    return summary_message(facts, robots, _driven_by(plan), left, zones, rounds)


def _robots(facts: EpisodeFacts, until: Until) -> list[RobotResult]:
    simulation, robots, laps = facts.simulation, [], laps_of(facts)
    outcomes = robot_outcomes(simulation, events=facts.events)
    arrivals = first_events(facts.events, "arrival")
    on = set(laps) if until == "time_limit" else set[str]()  # robots whose first arrival ends nothing
    outcomes |= {name: "collision" for name in on if facts.hit_counts[name]}
    ends = {name: event for name, event in arrivals.items() if name not in on}
    nearest = _approaches(facts, ends) if facts.is_small else {}
    watched = watched_metrics(facts, arrivals)
    visible = goal_visibility(facts, arrivals) if facts.is_small else {}
    called = {item.name: item.called for item in facts.scenario.objects}
    for row, record in facts.robots.items():
        name, ended, arrival = record.name, outcomes[record.name], arrivals.get(record.name)
        approach, approach_place = nearest.get(row, (None, None))
        goals = None if name in facts.parked else simulation.state.goals(row)
        track = facts.track(row)
        x, y, heading = track[0] if simulation.appeared[row] < 0 else simulation.pose[row]
        robots.append(
            RobotResult(
                name=name,
                outcome="timeout" if ended == "running" else ended,
                time_to_goal=None if arrival is None else arrival.time,
                laps=laps.get(name),
                collision_count=facts.hit_counts[name],
                contacts_between_steps=facts.between.counts[name],
                passed_through=facts.between.passed.get(name, []),
                infeasible_steps=int(simulation.infeasible[row]) or None,
                path_length=_length(track),
                distance_to_goal=math.dist(goals[0][:2], (x, y)) if goals else None,
                min_clearance=None if approach is None else approach.distance,
                nearest=None if approach is None else approach.partner,
                nearest_called=None if approach is None else called[approach.partner],
                nearest_at=approach_place,
                heading_error=_heading_error(record, goals[0], float(heading)) if goals else None,
                goal_visible_ratio=visible.get(name),
                **watched[name],
                pose=(float(x), float(y), float(heading)),
            )
        )
    return robots


def _approaches(
    facts: EpisodeFacts, arrivals: dict[str, Event]
) -> dict[int, tuple[Approach | None, tuple[float, float] | None]]:
    """Find what each robot, by row, came nearest to until it arrived, and where it was then.

    Empty if objects came or went.
    """
    poses = all_poses(facts.simulation) if facts.robots else None
    if poses is None:
        return {}
    names = [record.name for record in facts.robots.values()]
    ends = [arrivals[name].step + 1 if name in arrivals else facts.steps + 1 for name in names]
    nearest: dict[int, tuple[Approach | None, tuple[float, float] | None]] = {}
    for row, approach in zip(facts.robots, least(poses, facts.simulation, list(facts.robots), ends), strict=True):
        place = None if approach is None else (float(poses[approach.row, row, 0]), float(poses[approach.row, row, 1]))
        nearest[row] = approach, place
    return nearest


def _heading_error(record: ObjectRecord, goal: Sequence[float], heading: float) -> float | None:
    """Difference between a heading and the heading of a goal [rad]; None where the heading does not count."""
    return abs(math.remainder(heading - goal[2], math.tau)) if record.heading_counts(goal) else None


def _length(track: Floats) -> float:
    """Length of a path [m]."""
    with np.errstate(over="ignore", invalid="ignore"):  # steps may be as long as a float allows
        return float(np.hypot(*np.diff(track[:, :2], axis=0).T).sum())


def _exits(facts: EpisodeFacts) -> list[Left]:
    """Find the objects that left the world; in very large runs only robots."""

    def track(row: int) -> Floats:
        searched = facts.is_small or row in facts.robots
        return facts.track(row) if searched else facts.simulation.state.initial_state(row)[None, :3]

    return find_exits(facts.scenario, track, facts.steps)


def _decisive_step(facts: EpisodeFacts, robots: Sequence[RobotResult]) -> int | None:
    """Find the step that decided the outcome; None on success, and if late robots moved on until the end."""
    failed = {robot.name for robot in robots if robot.outcome != "success"}
    passed = [event for event in facts.between.of_robots if event.kind == "passed_through"]
    through = [event.step for event in passed if failed & {event.object, str(event.partner)}]
    first = first_collision({robot.name for robot in robots if robot.outcome == "collision"}, facts.hits)
    if first is not None:
        return min([first.step, *through])
    if through:
        return through[0]
    late = {robot.name for robot in robots if robot.outcome == "timeout" and robot.name not in facts.parked}
    rows = [row for row, record in facts.robots.items() if record.name in late]
    return min((step for row in rows[:_MAX_LATE] if (step := _end_of_progress(facts, row))), default=None)


def _end_of_progress(facts: EpisodeFacts, row: int) -> int | None:
    """The step from which on a robot made no progress; None if it moved on until the end."""
    simulation, record, view = facts.simulation, facts.robots[row], facts.simulation.views()[row]
    mine = [event for event in facts.events if event.object == record.name]
    if (no_path := next((event for event in mine if event.kind == "no_path"), None)) is not None:
        return no_path.step
    track = simulation.state.trajectory(row)[:, :3]
    offset = facts.steps - len(track) + 1  # step of the first row
    if (since := no_progress_since(track[:, :2], facts.step_time, view.max_speed)) is not None:
        near = find_obstruction(simulation, row, facts.jammed) if facts.jammed else None
        if near is not None and near.held:
            return min(event.step for event in facts.jammed.values())
        return offset + since
    if (jump := next((event for event in mine if event.kind == "overshoot"), None)) is not None:
        return jump.step
    if view.goal is not None and has_one_end(record):
        if (circle := find_circling(track, view.goal[:2, 0])) is not None:
            return offset + circle.since
        return stalled_step(simulation, view, mine)
    return None


def _lost_code(error: CodedError | None) -> Literal["bridge-lost", "policy-lost"] | None:
    if error is None:
        return None
    return "bridge-lost" if error.code == "bridge-lost" else "policy-lost"


_FOR_ALL = " for all robots"


def _driven_by(plan: RunPlan) -> str | None:
    """The policy or behavior that drives robots instead of their own, in words; None if each has its own."""
    if plan.policy_text is not None:
        shared = plan.policy is not None and plan.policy.parts
        return f"policy {clean(plan.policy_text)}" + ("" if shared else _FOR_ALL)
    return None if plan.behavior is None else f"behavior {plan.behavior}{_FOR_ALL}"


def _without_repeats(scenario: ResolvedScenario, events: Sequence[Event]) -> list[Event]:
    """Drop repeated arrivals of an object at a fixed goal, around which it may oscillate."""
    staying = {record.name for record in scenario.objects if has_one_end(record)}
    seen, kept = set[str](), []
    for event in events:
        if event.kind == "arrival" and event.object in staying:
            if event.object in seen:
                continue
            seen.add(event.object)
        kept.append(event)
    return kept


def _first(events: list[Event]) -> list[Event]:
    """The events that a result lists, in order: if there are too many, contacts between steps stay and sights go first.

    Within a rank the first events stay.
    """
    ranks = sorted(range(len(events)), key=lambda place: _rank(events[place].kind))  # a stable sort
    return [events[place] for place in sorted(ranks[:_MAX_EVENTS])]


def _rank(kind: str) -> int:
    return 0 if kind in BETWEEN_STEPS else 2 if kind in SIGHTS else 1
