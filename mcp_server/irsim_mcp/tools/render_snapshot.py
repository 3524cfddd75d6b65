"""``render_snapshot``: draw a scenario or a run as a picture, with one line of text about it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, Literal

from mcp.server.mcpserver import Context
from mcp.types import ImageContent, TextContent
from pydantic import Field

from irsim.common.text import clean, metres, plural
from irsim.results.concise import is_command
from irsim.results.picture import MAX_MOMENTS, MIN_MOMENTS, view_message
from irsim.validation.scene_text import scene_lines
from irsim_mcp.answers import failure
from irsim_mcp.limits import MAX_SEED, MAX_STEPS
from irsim_mcp.resources import uri
from irsim_mcp.services import ScenarioPath, ScenarioYaml, Services
from irsim_mcp.tool import StrictTool, reporter, strict
from irsim_mcp.tools.validate_scenario import new_collisions, report_of, text_of, trial_has_problems

__all__ = ["PLACE", "table_lines", "tool"]

PLACE = 3

_DESCRIPTION = """
    Check a scenario and draw it at one `step`, or at several (`strip`), as a PNG: bodies, darts (heading; omni:
    where it moves), people, goals (rings), names, areas that lidars see, paths, contacts (red stars).
    At step 0 the text has what validate_scenario finds, and a table of all objects: drive, footprint, pose, goal,
    limits, ranges over seeds, narrowest passages (r0 is 'robot_0'). An invalid scenario gives only
    errors. Next: edit and look again, or run_episode.
"""
_OVERLAYS = (
    "Default: names, goals, paths, zones. clearance: shaded where a robot's middle can't be; plan: paths to goals."
)
_MAX_NAMED = 10
"""Number of robots, plans and moving obstacles that the text lists."""
_CORNER_M = 0.25
"""A margin below which the text says that a path that no behavior has planned keeps close to corners [m]."""
_MAX_FINDINGS = 20
"""Number of findings that the text lists."""


def tool(services: Services) -> StrictTool:
    """Make the tool."""

    async def render_snapshot(
        ctx: Context[Any, Any],
        scenario_path: ScenarioPath = None,
        scenario_yaml: ScenarioYaml = None,
        run_id: Annotated[str | None, Field(max_length=100, description="Or a recorded run, with its seed.")] = None,
        step: Annotated[int, Field(ge=-1, le=MAX_STEPS, description="0: start; -1: end of the episode.")] = 0,
        strip: Annotated[
            int | None,
            Field(ge=MIN_MOMENTS, le=MAX_MOMENTS, description="Moments on one sheet, from 0 to `step` (0: the end)."),
        ] = None,
        seed: Annotated[
            int | None,
            Field(ge=0, le=MAX_SEED, description="Default: the scenario's, else the first from 0 with room."),
        ] = None,
        size_px: Annotated[int, Field(ge=200, le=1024, description="Longer side; 600 px cost about 480 tokens.")] = 600,
        overlays: Annotated[
            list[Literal["names", "goals", "paths", "sensors", "zones", "clearance", "plan"]] | None,
            Field(description=_OVERLAYS),
        ] = None,
        region: Annotated[
            list[float] | None,
            Field(min_length=4, max_length=4, description="Zoom in: [x_min, y_min, x_max, y_max] in m."),
        ] = None,
        base: Annotated[str | None, Field(description="Scenario before an edit, to mark changes at step 0.")] = None,
        style: Literal["modern", "classic"] | None = None,
        return_image: Annotated[bool, Field(description="false: text only.")] = True,
    ) -> list[TextContent | ImageContent]:
        what: dict[str, Any] = {
            "seconds": services.limits.draw_seconds,
            "progress": reporter(ctx, "steps"),
            "steps": None if step == -1 else step,
            "strip": strip,
            "size": size_px,
            "overlays": overlays,
            "region": region,
            "draw": return_image,
            "style": style,
            **services.base(base),
        }
        if base is not None and (step != 0 or strip is not None or run_id is not None):
            fix = "leave out step, strip and run_id; validate_scenario with base compares the motion"
            raise failure("bad-argument", "base is compared at step 0 of a scenario only", where="base", fix=fix)
        if run_id is None:
            what["check"] = step == 0 and strip is None
            rules = await services.suite_rules(scenario_path)
            what["perturb"] = rules.get("perturb", [])
            answer = await services.scenario_job("snapshot", scenario_path, scenario_yaml, seed=seed, **what)
        elif scenario_path or scenario_yaml or seed is not None:
            fix = "give run_id alone: the run has its scenario and its seed"
            raise failure("bad-argument", "a run_id and a scenario or a seed are given", where="run_id", fix=fix)
        else:
            answer = await services.run_job("run_snapshot", run_id, **what)
        given = None if run_id else services.given(scenario_path, scenario_yaml)
        ran = given is not None and services.was_done("ran", given)
        if given is not None and "report" in answer and answer["scene"] is not None:
            services.note("looked", given)
        line = TextContent(type="text", text=_text(answer, run_id, given, services.limits.text, ran))
        if not return_image or answer["scene"] is None:
            return [line]
        return [line, ImageContent(type="image", data=answer["png"], mime_type="image/png")]

    return strict(render_snapshot, title="Draw a scenario", description=_DESCRIPTION, read_only=True, idempotent=True)


def _text(answer: dict[str, Any], run_id: str | None, given: str | None, most: int, ran: bool) -> str:
    """One line about the picture and, if the scenario was checked, the findings and a table of its objects.

    Args:
        answer: Answer of the worker.
        run_id: The run that it shows; None for a scenario.
        given: Argument that gives the scenario again; None for a run.
        most: Greatest number of characters.
        ran: Whether the scenario was run as it is now.
    """
    if "report" not in answer:
        return _line(answer["scene"], run_id)
    report = report_of(answer["report"], _MAX_FINDINGS, False, most // 2)
    if answer["scene"] is None:
        report.next = "No picture: fix the errors first; lookup explains a code or a key."
        return text_of(report)
    same = report.changes is not None and answer["report"]["changes"]["same"]
    first = "If the picture is right," if not report.issues else "Fix what is not meant, then"
    hits = new_collisions(answer["report"]["changes"])
    if hits:
        report.next += f" {given} seeds=3."
    elif not same and _says_all(answer["report"]):
        report.next = f"{first} report it: the trial is the whole run, every time."
        report.next += f" run_episode {given} keeps a record and measures distances."
    elif not same:
        report.next = f"{first} run_episode {given} seeds=3."
    if not same and not hits and any(item["code"] == "no-behavior" for item in answer["report"]["findings"]):
        name = str(given).removeprefix("scenario_path=")
        report.next = (
            f"{report.next.removesuffix(' seeds=3.')} policy=dash, compare policies with benchmark "
            f"scenarios=[{name!r}] policies=[...], or drive it by a program."
        )
    if ran and not same and not hits:
        report.next = "It has been run as it is: change it, or report what the run has shown."
    if not answer["scene"]["robots"] and not same:
        report.next = f"{first} it is done: without robots there is nothing to run."
    head, *findings, advice = text_of(report).splitlines()
    line = _line(answer["scene"], run_id, brief=True, passages=answer["table"]["passages"])
    if same:
        return "\n".join([line, head, *findings, advice])
    if any(answer["scene"]["size"]) and report.changes is not None:
        findings.append("Marked in magenta: what differs from base; dashed: where it was.")
    return "\n".join([line, head, *findings, *table_lines(answer), advice])


def table_lines(answer: dict[str, Any]) -> list[str]:
    """A line for each entry of a scenario, with the labels and the seed of its picture.

    Args:
        answer: Answer of a worker with ``table`` and ``scene``.
    """
    labels = {robot["name"]: robot["label"] for robot in answer["scene"]["robots"]}
    return scene_lines(answer["table"], labels, answer["scene"]["seed"])


def _line(
    scene: dict[str, Any], run_id: str | None, brief: bool = False, passages: Sequence[dict[str, Any]] = ()
) -> str:
    """Describe a picture.

    Args:
        scene: The snapshot.
        run_id: The run that it shows; None for a scenario.
        brief: Leave out places and warnings, which the other lines have.
        passages: Narrowest passages on the ways of robots, which the other lines tell.
    """
    left, right, low, top = scene["extent"]
    moments = f"steps {', '.join(map(str, scene['moments']))}, the last: " if scene["moments"] else ""
    size = "x".join(map(str, scene["size"])) + " px, " if any(scene["size"]) else ""
    chance = f"seed {scene['seed']}" if scene["random"] else "nothing is random"
    parts = [
        f"{size}{moments}t={scene['sim_time']:g} s (step {scene['steps']}, {chance})",
        f"world x {left:g}..{right:g} m, y {low:g}..{top:g} m",
    ]
    if scene["ended"] is not None:
        parts.append(f"beyond the end of the episode, which is step {scene['ended']}")
    if scene["explored"] is not None:
        seen = f"{100 * scene['explored']:.0f} % of the area of the world seen"
        parts.append(f"fog: {seen}, the rest is grey, with goals drawn above it")
    parts += scene["left_out"]
    if scene["view"] is not None:
        region = ", ".join(f"{value:g}" for value in (left, low, right, top))
        parts.append(f"{view_message(scene['view'])}: region=[{region}] shows the world")
    robots, moving = ([], []) if brief else (scene["robots"], scene["moving"])
    parts += [_robot(robot) for robot in robots[:_MAX_NAMED]]
    parts += [_plan(plan, passages) for plan in scene["plans"][:_MAX_NAMED]]
    more = len(robots) - _MAX_NAMED
    if more > 0:
        parts.append(f"{more} more robots")
    parts += [] if brief else [scene["contents"]]
    parts += [_moving(item) for item in moving[:_MAX_NAMED]]
    if (rest := len(moving) - _MAX_NAMED) > 0:
        parts.append(f"{rest} more moving obstacles")
    warnings = sum(item["severity"] == "warning" for item in scene["warnings"])
    if warnings and not brief:
        parts.append(f"{plural(warnings, 'warning')}, see validate_scenario")
    return "; ".join(parts) + f". {_source(scene, run_id)}".rstrip()


def _source(scene: dict[str, Any], run_id: str | None) -> str:
    """Where the run is, or the command that draws a file again; nothing for a text."""
    if run_id:
        return f"Run: {uri(run_id, 'run.json')}"
    return f"Again: {clean(scene['reproduce'], 300)}" if is_command(scene["reproduce"]) else ""


def _moving(item: dict[str, Any]) -> str:
    x, y, heading = item["pose"]
    moving = " moving ({:.2f}, {:.2f}) m/s".format(*item["velocity"]) if any(item["velocity"]) else ""
    return f"{clean(item['name'])!r} at ({x:.2f}, {y:.2f}) heading {heading:.2f} rad{moving}"


def _plan(plan: dict[str, Any], passages: Sequence[dict[str, Any]]) -> str:
    lost, margin = plan["lost"], plan["margin"]
    if lost is not None:
        return f"no path for {clean(plan['name'])!r} to ({lost[0]:.2f}, {lost[1]:.2f})"
    tight = ""
    if margin is not None:
        to, (x, y) = f" to {clean(plan['nearest_called'])}", plan["tightest"]
        least = (
            f"overlaps{to.removeprefix(' to')} by {metres(-margin)}"
            if margin < 0
            else f"least margin {metres(margin)}{to}"
        )
        corner = (
            " (a shortest path, which touches corners or nearly so)"
            if not plan["own"] and 0 <= margin < _CORNER_M
            else ""
        )
        tight = f", {least} at ({x:.2f}, {y:.2f}){_passage(plan, passages)}{corner}"
    return f"{'its own plan' if plan['own'] else 'a path'} for {clean(plan['name'])!r}: {metres(plan['length'])}{tight}"


def _passage(plan: dict[str, Any], passages: Sequence[dict[str, Any]]) -> str:
    """The passage of the table in which a plan is tightest; empty if it is in none."""
    for passage in passages:
        near = [place for place in passage["places"] if math.dist(place, plan["tightest"]) < passage["gap"]]
        if plan["name"] in passage["names"] and near:
            return f", in the passage of {metres(passage['gap'])} at ({near[0][0]:.2f}, {near[0][1]:.2f})"
    return ""


def _robot(robot: dict[str, Any]) -> str:
    x, y, heading = robot["pose"]
    label = "" if robot["name"] == robot["label"] else f" ({clean(robot['label'])})"
    goal = "no goal" if robot["goal"] is None else "goal ({:.2f}, {:.2f})".format(*robot["goal"])
    status = "" if robot["status"] == "under way" else f" {robot['status']}"
    return f"{clean(robot['name'])!r}{label}{status} at ({x:.2f}, {y:.2f}) heading {heading:.2f} rad, {goal}"


def _says_all(report: dict[str, Any]) -> bool:
    """Whether a trial is all there is to say about a run: it ended by itself, all went well, and nothing is random."""
    tried = report["dry_run"]
    return tried is not None and tried["ended"] == "done" and not tried["random"] and not trial_has_problems(report)
