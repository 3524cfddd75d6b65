"""``run_episode``: simulate one episode and report how it ended and why."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from mcp.server.mcpserver import Context
from mcp.types import CallToolResult, TextContent
from pydantic import Field

from irsim.results.concise import ConciseRun
from irsim.results.episode import EventRecord
from irsim.results.run import LOST_THINGS, MAX_CONCISE, MAX_DETAILED, RunResult
from irsim_mcp.answers import WorkerResult, json_answer
from irsim_mcp.limits import MAX_RUN_SECONDS, MAX_SEED, MAX_STEPS
from irsim_mcp.resources import PAGE, uri
from irsim_mcp.services import ScenarioPath, ScenarioYaml, Services
from irsim_mcp.tool import StrictTool, reporter, strict

__all__ = ["PLACE", "tool"]

PLACE = 4

_DESCRIPTION = """
    Simulate an episode until every robot has arrived or stopped, or time is up. Outcome is success (every robot
    reached its goal, no collision before), collision, or timeout; none is an error. The reason says what hit or passed
    through what, where, when, and distances to goals. Returns robots (unsuccessful first), first events, a run_id,
    kept 24 hours. Next: after a failure make the call in `next`, change the scenario and run again; after success
    try other seeds if anything is random.
"""
_UNDRIVEN = "has no behavior"
"""Part of the reason of a run with a robot that nothing drives."""
_ARTIFACTS = ("events.json", "trace.csv")
"""Artifacts that the result names; the template of the resource names all."""
_STRIP = "strip=6"
"""Argument of ``render_snapshot`` that shows a run from its start to a step, 0 being its end."""


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
                description=f"detailed: paths, poses, waypoints; {MAX_DETAILED} robots and events instead of "
                f"{MAX_CONCISE}. json: as irsim run --json."
            ),
        ] = "concise",
    ) -> Annotated[CallToolResult, ConciseRun]:
        data = await services.scenario_job(
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
        result = RunResult.model_validate(data)
        episode = result.concise(
            detailed=response_format == "detailed",
            artifacts=None if result.run_id is None else {name: uri(result.run_id, name) for name in _ARTIFACTS},
            advice=_advice(result, given),
        )
        text = TextContent(type="text", text=episode.text())
        if response_format == "json":
            text = _json_answer(data, services.limits.text)
        return CallToolResult(content=[text], structured_content=episode.model_dump(exclude_none=True))

    return strict(
        run_episode, title="Run a scenario", description=_DESCRIPTION, read_only=False, idempotent=True, page=PAGE,
        former_names={"behavior": "policy"},
    )  # fmt: skip


def _json_answer(data: WorkerResult, most: int) -> TextContent:
    """The complete JSON; if that is too long, the error says how the run ended and where to read the rest."""
    run, prefix = data["run_id"], f"the run is done, outcome {data['outcome']}, but "
    if run is None:
        return json_answer(data, most, "use response_format=detailed", prefix=prefix)
    views = f"inspect_run run_id={run} view=speeds, closest or collisions lists every robot, in pages"
    alternative = f"{views}; {uri(run, 'result.json')} has all; or use response_format=detailed"
    return json_answer(data, most, alternative, prefix=prefix)


def _advice(result: RunResult, given: str) -> str:
    """The next call to make; ``given`` is the argument that gives the scenario again."""
    seed, outcome = f" seed={result.seed}" if result.random else "", result.outcome
    run = f" {given}{seed}" if result.run_id is None else f" run_id={result.run_id}"
    if result.lost_code is not None:
        return f"The {LOST_THINGS[result.lost_code]} was lost: start it again, then run_episode {given}{seed}."
    jammed = set(result.jammed)
    if outcome == "success" and not jammed:
        if any(robot.contacts_between_steps for robot in result.robots):
            again = f"lower step_time, or set world.contacts: swept, and run_episode {given} again"
            look = "" if result.run_id is None else f" after inspect_run{run} view=collisions"
            return f"Do not trust this success: a robot touched something between two steps; {again}{look}."
        name = given.removeprefix("scenario_path=")
        more = f"; try other seeds with benchmark scenarios=[{name!r}]" if result.random else ""
        return f"See it with render_snapshot{run} {_STRIP}{more}."
    if outcome == "timeout" and _UNDRIVEN in str(result.reason):
        return (
            f"Nothing to change if a program drives it or it stays; to try the layout: run_episode {given} policy=dash."
        )
    late = {robot.name for robot in result.robots if robot.outcome != "success"}
    if late and late <= set(result.parked) and not jammed:
        return f"Nothing to change if it is meant to stay; see it with render_snapshot{run} {_STRIP}."
    stopped = min((event.step for event in result.events if _stops(event, jammed)), default=None)
    step = stopped if outcome == "success" else result.decisive_step
    look = f"render_snapshot{run} {_STRIP}" + (f" step={step}" if step else "")
    view = "collisions" if outcome != "timeout" or stopped is not None else "speeds"
    whose = " robot=all" if step == stopped and stopped is not None else ""  # by default the table is about robots
    more = "" if result.run_id is None else f" and inspect_run{run} view={view}{whose}"
    if outcome == "success":
        return f"A collision stopped moving obstacles: intended? Look with {look}{more}."
    when = f" (step {step} decided it)" if step else ""
    return f"Look with {look}{when}{more}, change the scenario, and run again."


def _stops(event: EventRecord, jammed: set[str]) -> bool:
    """Whether an event is a collision that stopped one of these obstacles."""
    return event.kind == "collision" and bool(jammed & {event.object, event.partner})
