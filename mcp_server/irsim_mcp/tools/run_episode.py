"""``run_episode``: simulate one episode and report how it ended and why."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from mcp.server.mcpserver import Context
from mcp.types import CallToolResult, TextContent
from pydantic import BaseModel, ConfigDict, Field

from irsim.common.event_kinds import BETWEEN_STEPS, SIGHTS
from irsim.common.text import clean, listed
from irsim_mcp.json_answer import Found, json_answer
from irsim_mcp.limits import MAX_RUN_SECONDS, MAX_SEED, MAX_STEPS
from irsim_mcp.progress import reporter
from irsim_mcp.replay_page import PAGE
from irsim_mcp.run_resources import uri
from irsim_mcp.services import ScenarioPath, ScenarioYaml, Services, is_command
from irsim_mcp.tool import StrictTool, strict

__all__ = ["Episode", "tool"]

_DESCRIPTION = """
    Simulate an episode, until every robot has arrived or stopped, or time is up. Outcome is success (every robot
    reached its goal, no collision before), collision, or timeout; none is an error. The reason says what hit or passed
    through what, where, when, and how far robots were from goals. Returns robots (unsuccessful first), first events, a
    run_id, kept for 24 hours. Next: after a failure the call that `next` has, change the scenario and run again; after
    success try other seeds if anything is random.
"""
_LOST = {"bridge-lost": "program of a bridge", "policy-lost": "policy"}
"""What was lost, by its code."""
_UNDRIVEN = "has no behavior"
"""Part of the reason of a run with a robot that nothing drives."""
_ARTIFACTS = ("events.json", "trace.csv")
"""Artifacts that the result names; the template of the resource names all."""
_MAX_CONCISE = 10
"""Number of robots and events in a concise result."""
_MAX_DETAILED = 50
"""Number of robots and events in a detailed result."""
_DECIMALS = 3
_STRIP = "strip=6"
"""Argument of ``render_snapshot`` that shows a run from its start to a step, 0 being its end."""
_WATCHED = {
    "time_in_zone": "in zones for {:g} s",
    "zone_crossings": "{:g} zone crossings",
    "seen_ratio": "seen {:g} of the time",
    "goal_visible_ratio": "saw its goal {:g} of the time",
}
"""Metrics of zones and of sight, and how the text says them."""


class Robot(BaseModel):
    """Result of one robot; lengths in m, times in s."""

    model_config = ConfigDict(extra="allow")  # and those of _WATCHED, _places and _between_steps that are defined

    name: str
    outcome: str
    time_to_goal: float | None = None
    distance_to_goal: float | None = None
    min_clearance: float | None = None
    nearest: str | None = None
    collision_count: int
    infeasible_steps: int | None = None
    path_length: float | None = None
    pose: list[float] | None = None


class Event(BaseModel):
    """An event of the episode; the partner is the other object, or the zone."""

    model_config = ConfigDict(extra="forbid", json_schema_extra=lambda schema: schema.pop("description"))

    time: float
    step: int
    kind: str
    object: str
    partner: str | None = None
    x: float
    y: float


class Episode(BaseModel):
    """The result of an episode."""

    model_config = ConfigDict(extra="forbid")

    run_id: str | None = None
    outcome: Literal["success", "collision", "timeout"]
    reason: str | None = None
    summary: str
    seed: int
    random: list[str]
    behavior: str | None = None
    incidents: dict[str, Any] | None = None
    steps: int
    sim_time: float
    time_limit: float
    time_limit_from: str
    robots: list[Robot]
    robot_count: int
    events: list[Event]
    event_count: int
    warnings: list[str]
    artifacts: dict[str, str] | None = None
    reproduce: str | None = None
    next: str


def tool(services: Services) -> StrictTool:
    """Make the tool."""

    async def run_episode(
        ctx: Context[Any, Any],
        scenario_path: ScenarioPath = None,
        scenario_yaml: ScenarioYaml = None,
        seed: Annotated[
            int | None, Field(ge=0, le=MAX_SEED, description="Default: the scenario's, else drawn.")
        ] = None,
        policy: Annotated[str | None, Field(max_length=500, description="Of all robots, as in benchmark.")] = None,
        perturb: Annotated[str | None, Field(max_length=500, description="As in benchmark.")] = None,
        max_steps: Annotated[
            int | None,
            Field(ge=1, le=MAX_STEPS, description=f"Default: the scenario's time limit, at most {MAX_STEPS:,}."),
        ] = None,
        max_wall_s: Annotated[
            int, Field(ge=1, le=MAX_RUN_SECONDS, description="Seconds of computing.")
        ] = MAX_RUN_SECONDS,
        response_format: Annotated[
            Literal["concise", "detailed", "json"],
            Field(
                description=f"detailed: paths, poses, waypoints; {_MAX_DETAILED} robots and events instead of "
                f"{_MAX_CONCISE}. json: as irsim run --json."
            ),
        ] = "concise",
    ) -> Annotated[CallToolResult, Episode]:
        found = await services.scenario_job(
            "run",
            scenario_path,
            scenario_yaml,
            seconds=max_wall_s,
            progress=reporter(ctx, "steps"),
            seed=seed,
            steps=max_steps,
            policy=await services.suite_policy(scenario_path, policy),
            perturb=perturb,
        )
        given = services.given(scenario_path, scenario_yaml)
        episode = _episode(found, response_format == "detailed", given)
        text = TextContent(type="text", text=_text(episode))
        if response_format == "json":
            text = _json_answer(found, services.limits.text)
        return CallToolResult(content=[text], structured_content=episode.model_dump(exclude_none=True))

    return strict(
        run_episode, title="Run a scenario", description=_DESCRIPTION, read_only=False, idempotent=True, page=PAGE,
        former_names={"behavior": "policy"},
    )  # fmt: skip


def _json_answer(found: Found, most: int) -> TextContent:
    """The complete JSON; if that is too long, the error says how the run ended and where to read the rest."""
    run, prefix = found["run_id"], f"the run is done, outcome {found['outcome']}, but "
    if run is None:
        return json_answer(found, most, "use response_format=detailed", prefix=prefix)
    views = f"inspect_run run_id={run} view=speeds, closest or collisions lists every robot, in pages"
    alternative = f"{views}; {uri(run, 'result.json')} has all; or use response_format=detailed"
    return json_answer(found, most, alternative, prefix=prefix)


def _episode(found: dict[str, Any], detailed: bool, given: str) -> Episode:
    most = _MAX_DETAILED if detailed else _MAX_CONCISE
    robots = sorted(found["robots"], key=lambda robot: robot["outcome"] == "success")
    warnings = [item for item in found["warnings"] if item["severity"] == "warning"]
    lines = [f"{item['code']} at {item['path']}: {item['message']}" for item in warnings[:_MAX_CONCISE]]
    if len(warnings) > _MAX_CONCISE:
        lines.append(f"{len(warnings) - _MAX_CONCISE} more: validate_scenario lists them")
    lines += [f"the recording is incomplete: {note}" for note in found["notes"]]
    run_id = found["run_id"]
    return Episode(
        run_id=run_id,
        outcome=found["outcome"],
        reason=None if found["reason"] is None else clean(found["reason"], 500),
        summary=clean(found["summary"], 300),
        seed=found["seed"],
        random=found["random"],
        behavior=clean(found["behavior"] or found["policy"] or "", 200) or None,
        incidents=_incidents(found) or None,
        steps=found["steps"],
        sim_time=_rounded(found["sim_time"]),
        time_limit=_rounded(found["time_limit"]),
        time_limit_from=found["time_limit_from"],
        robots=[_robot(robot, detailed) for robot in robots[:most]],
        robot_count=len(robots),
        events=[_event(event) for event in _chosen(found, detailed, most)],
        event_count=found["event_count"],
        warnings=[clean(line, 300) for line in lines],
        artifacts=None if run_id is None else {name: uri(run_id, name) for name in _ARTIFACTS},
        reproduce=clean(found["reproduce"], 300) if is_command(found["reproduce"]) else None,
        next=_advice(found, given),
    )


def _incidents(found: dict[str, Any]) -> dict[str, Any]:
    """What happened besides outcomes: contacts between steps or people, objects that left the world or jumped goals."""
    incidents: dict[str, Any] = {
        "contacts_between_steps": found["contacts_between_steps"],
        "human_contacts": found["human_contacts"],
        "left": [clean(item["name"]) for item in found["left"]],
        "jumped": [clean(name) for name in found["jumped"]],
    }
    return {key: value for key, value in incidents.items() if value}


def _chosen(found: dict[str, Any], detailed: bool, most: int) -> list[dict[str, Any]]:
    """The first events in order.

    A concise result prefers contacts between steps, then those of robots, and leaves out sights first.
    """
    events: list[dict[str, Any]] = found["events"]
    if detailed:
        return events[:most]
    robots = {robot["name"] for robot in found["robots"]}
    important = [event for event in events if event["kind"] != "waypoint"]

    def rank(event: dict[str, Any]) -> tuple[bool, bool, bool]:
        kind, of_robot = event["kind"], bool(robots & {event["object"], event["partner"]})
        return kind not in BETWEEN_STEPS, kind in SIGHTS, not of_robot

    kept = sorted(important, key=rank)[:most]
    kept += [event for event in events if event["kind"] == "waypoint"][: most - len(kept)]
    return sorted(kept, key=lambda event: int(event["step"]))  # a stable sort keeps the order within a step


def _rounded(value: Any) -> Any:
    """A number rounded to a millimetre or a millisecond."""
    return round(value, _DECIMALS) if isinstance(value, float) else value


def _robot(robot: dict[str, Any], detailed: bool) -> Robot:
    return Robot(
        name=clean(robot["name"]),
        outcome=robot["outcome"],
        time_to_goal=_rounded(robot["time_to_goal"]),
        distance_to_goal=_rounded(robot["distance_to_goal"]),
        min_clearance=_rounded(robot["min_clearance"]),
        nearest=None if robot["nearest"] is None else clean(robot["nearest"]),
        collision_count=robot["collision_count"],
        infeasible_steps=robot["infeasible_steps"],
        path_length=_rounded(robot["path_length"]) if detailed else None,
        pose=[_rounded(value) for value in robot["pose"]] if detailed else None,
        **{key: _rounded(robot[key]) for key in _shown(detailed) if robot[key] is not None},
        **_places(robot),
        **_between_steps(robot),
    )


def _places(robot: dict[str, Any]) -> dict[str, Any]:
    """What it came nearest to, in words, where that was, and the error of its heading, where these are defined."""
    found: dict[str, Any] = {}
    if robot["nearest_called"] is not None:
        found["nearest_called"] = clean(robot["nearest_called"])
    if robot["nearest_at"] is not None:
        found["nearest_at"] = [_rounded(value) for value in robot["nearest_at"]]
    if robot["heading_error"] is not None:
        found["heading_error"] = _rounded(robot["heading_error"])
    return found


def _between_steps(robot: dict[str, Any]) -> dict[str, Any]:
    """Its contacts within a step, if there were any."""
    through = [clean(name) for name in robot["passed_through"]]
    found = {"contacts_between_steps": robot["contacts_between_steps"], "passed_through": through}
    return {key: value for key, value in found.items() if value}


def _shown(detailed: bool) -> list[str]:
    """Keys of :data:`_WATCHED` of a result; a concise one leaves out what every robot has."""
    return [key for key in _WATCHED if detailed or key != "goal_visible_ratio"]


def _event(event: dict[str, Any]) -> Event:
    partner = event["partner"] or event["zone"]
    kind = event["kind"] if event["direction"] is None else f"{event['kind']} {event['direction']}"
    numbers = {key: _rounded(event[key]) for key in ("time", "step", "x", "y")}
    name = clean(event["object"])
    return Event(kind=kind, object=name, partner=None if partner is None else clean(partner), **numbers)


def _advice(found: dict[str, Any], given: str) -> str:
    """What to do next; ``given`` is the argument that gives the scenario again."""
    run = f" run_id={found['run_id']}"
    if found["run_id"] is None:
        run = f" {given}" + (f" seed={found['seed']}" if found["random"] else "")
    if found["lost"] is not None:
        again = f"run_episode {given}" + (f" seed={found['seed']}" if found["random"] else "")
        return f"The {_LOST[found['lost_code']]} was lost: start it again, then {again}."
    held = set(found["jammed"])
    if found["outcome"] == "success" and not held and any(r["contacts_between_steps"] for r in found["robots"]):
        again = f"lower step_time, or set world.contacts: swept, and run_episode {given} again"
        look = f" after inspect_run{run} view=collisions" if found["run_id"] is not None else ""
        return f"Do not trust this success: a robot touched something between two steps; {again}{look}."
    if found["outcome"] == "success" and not held:
        name = given.removeprefix("scenario_path=")
        more = f"; try other seeds with benchmark scenarios=[{name!r}]" if found["random"] else ""
        return f"See it with render_snapshot{run} {_STRIP}{more}."
    if found["outcome"] == "timeout" and _UNDRIVEN in str(found["reason"]):
        return (
            f"Nothing to change if a program drives it or it stays; to try the layout: run_episode {given} policy=dash."
        )
    late = [robot["name"] for robot in found["robots"] if robot["outcome"] != "success"]
    if late and set(late) <= set(found["parked"]) and not held:
        return f"Nothing to change if it is meant to stay; see it with render_snapshot{run} {_STRIP}."
    first = min((event["step"] for event in found["events"] if _stops(event, held)), default=None)
    step = first if found["outcome"] == "success" else found["decisive_step"]
    look = f"render_snapshot{run} {_STRIP}" + (f" step={step}" if step else "")
    view = "collisions" if found["outcome"] != "timeout" or first is not None else "speeds"
    whose = " robot=all" if step == first and first is not None else ""  # by default the table is about robots
    more = "" if found["run_id"] is None else f" and inspect_run{run} view={view}{whose}"
    if found["outcome"] == "success":
        return f"A collision stopped moving obstacles: intended? Look with {look}{more}."
    when = "" if not step else f" (step {step} decided it)"
    return f"Look with {look}{when}{more}, change the scenario, and run again."


def _stops(event: dict[str, Any], held: set[str]) -> bool:
    """Whether an event is a collision that stopped one of these obstacles."""
    return event["kind"] == "collision" and bool(held & {event["object"], event["partner"]})


def _text(episode: Episode) -> str:
    """The result in words, with everything that the structured content has."""
    limit = f"{episode.time_limit:g} s ({episode.time_limit_from})"
    lines = [f"{episode.outcome}: {episode.summary}"]
    if episode.run_id is not None:
        lines.append(f"Run: {episode.run_id}")
    if episode.reason is not None:
        lines.append(f"Reason: {episode.reason}")
    chance = f"seed {episode.seed} (random: {', '.join(episode.random)})" if episode.random else "nothing is random"
    lines.append(f"{episode.steps} steps, {episode.sim_time:g} s of at most {limit}, {chance}")
    lines.append(f"Robots ({len(episode.robots)} of {episode.robot_count}):")
    lines += [f"- {_robot_text(robot)}" for robot in episode.robots]
    if episode.events:
        lines.append(f"Events ({len(episode.events)} of {episode.event_count}):")
    for event in episode.events:
        link = " with" if event.kind in ("collision", *BETWEEN_STEPS) else ":"
        partner = "" if event.partner is None else f"{link} {event.partner!r}"
        place = f"({event.x:g}, {event.y:g})"
        lines.append(f"- {event.time:g} s, step {event.step}: {event.kind} of {event.object!r}{partner} at {place}")
    lines += [f"Warning: {warning}" for warning in episode.warnings]
    lines.append(
        "Record: " + ", ".join((episode.artifacts or {"": "none, the workspace cannot be written to"}).values())
    )
    lines += [] if episode.reproduce is None else [f"Again: {episode.reproduce}"]
    return "\n".join([*lines, f"Next: {episode.next}"])


def _robot_text(robot: Robot) -> str:
    facts = [f"{robot.name!r} {robot.outcome}"]
    if robot.time_to_goal is not None:
        off = "" if (error := getattr(robot, "heading_error", None)) is None else f", heading {error:.2f} rad off"
        facts.append(f"arrived at {robot.time_to_goal:g} s{off}")
    if robot.distance_to_goal is not None:
        facts.append(f"{robot.distance_to_goal:g} m from its goal")
    if robot.min_clearance is not None:
        place, other = getattr(robot, "nearest_at", None), getattr(robot, "nearest_called", repr(robot.nearest))
        at = "" if place is None else " at ({:g}, {:g})".format(*place)
        near = f"came as near as {robot.min_clearance + 0.0:g} m to {other}, edge to edge"
        if robot.min_clearance < 0:
            near = f"overlapped {other} by {-robot.min_clearance:g} m when they collided"
        within = " at the ends of steps" if getattr(robot, "contacts_between_steps", 0) else ""
        facts.append(near + at + within)
    facts.append(f"{robot.collision_count} collision{'s' * (robot.collision_count != 1)}")
    if count := getattr(robot, "contacts_between_steps", 0):
        passed = [repr(name) for name in getattr(robot, "passed_through", [])]
        through = f" (passed through {listed(passed, 3)})" if passed else ""
        facts.append(f"{count} contact{'s' * (count != 1)} between steps{through}")
    if robot.infeasible_steps is not None:
        many = f"{robot.infeasible_steps} step{'s' * (robot.infeasible_steps != 1)}"
        end = "but it touched nothing, so that did no harm"
        if robot.collision_count or count:
            end = "and it did touch something: more room or slower others would help it"
        facts.append(f"in {many} no velocity avoided everybody, {end}")
    if robot.path_length is not None:
        facts.append(f"drove {robot.path_length:g} m")
    facts += [
        words.format(value) for key, words in _WATCHED.items() if (value := getattr(robot, key, None)) is not None
    ]
    if robot.pose is not None:
        facts.append("ends at x {:g} y {:g} heading {:g}".format(*robot.pose))
    return ", ".join(facts)
