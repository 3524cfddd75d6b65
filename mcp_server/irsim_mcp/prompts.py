"""Prompts: the ways of working with the tools, for people to start from."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

from mcp import MCPError
from mcp.server import MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import INVALID_PARAMS
from pydantic import Field

import irsim
from irsim.common import data_files as resources
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import nearest
from irsim_mcp.errors import failure
from irsim_mcp.services import Services

__all__ = ["DIFFICULTIES", "add_prompts", "drives", "template_names"]

DIFFICULTIES = {
    "easy": "Leave room: ways at least three times as wide as a robot, few obstacles, nothing that moves against it.",
    "medium": "Ways of about twice the width of a robot, obstacles on the straight line to the goal, a few that move.",
    "hard": "Tight ways, crossing traffic and a dead end or two; it must still be possible to arrive.",
}
_LONGEST_GOAL = 2_000
_LONGEST_SCENARIO = 300


def drives() -> list[str]:
    """Names of the drives, without loading them."""
    folder = Path(irsim.__file__).parent / "components" / "kinematics"
    return sorted(path.stem for path in folder.glob("[a-z]*.py"))


def template_names() -> tuple[str, ...]:
    """Names of the templates."""
    return tuple(sorted(path.parent.name for path in resources.templates_directory().glob("*/template.yaml")))


def add_prompts(server: MCPServer, services: Services) -> None:
    """Register all of them with a server."""

    def design_scenario(
        goal: Annotated[str, Field(description="What the scene should show or test, in plain words.")],
        kinematics: Annotated[str, Field(description="Drive of the robots: diff, acker, omni, …")] = "diff",
        difficulty: Annotated[str, Field(description="easy, medium or hard")] = "medium",
    ) -> str:
        _one_of("kinematics", kinematics, drives())
        _one_of("difficulty", difficulty, list(DIFFICULTIES))
        return _DESIGN.format(
            goal=_quoted(goal, _LONGEST_GOAL),
            kinematics=kinematics,
            difficulty=difficulty,
            meaning=DIFFICULTIES[difficulty],
        )

    def debug_run(
        run_id: Annotated[str, Field(description="Of run_episode; last is the last one. Or a job_id.")],
    ) -> str:
        if run_id not in services.workspace.runs() and services.jobs.known(run_id):
            return _DEBUG_JOB.format(job_id=clean(run_id))
        services.workspace.check_run(run_id)
        return _DEBUG.format(run_id=clean(run_id))

    def compare_policies(
        scenario: Annotated[str, Field(description="Scenario file of the workspace, or name of a template.")],
    ) -> str:
        if scenario in template_names():
            return _COMPARE.format(what=f"the template {scenario} (lookup gives its YAML; pass that as text)")
        if len(scenario) > _LONGEST_SCENARIO:
            raise failure("bad-argument", "the name of the scenario is too long", where="scenario")
        return _COMPARE.format(what=f"the file {services.workspace.scenario(scenario, 'scenario')}")

    for function, title, description in (
        (
            design_scenario,
            "Design a scenario",
            "From a wish in plain words to a scenario that is checked and looked at.",
        ),
        (debug_run, "Find out why a run failed", "Look into a recorded run, find the cause, change the scenario, try."),
        (
            compare_policies,
            "Compare behaviors",
            "A fair comparison: same scenarios, seeds and horizon, with intervals.",
        ),
    ):
        server.prompt(title=title, description=description)(_explained(function))


def _explained(function: Callable[..., str]) -> Callable[..., str]:
    """With refusals as errors of the protocol, whose text the client shows."""

    @functools.wraps(function)
    def prompt(**arguments: Any) -> str:
        try:
            return function(**arguments)
        except ToolError as error:
            raise MCPError(INVALID_PARAMS, str(error)) from None

    return prompt


def _one_of(name: str, value: str, choices: list[str]) -> None:
    if value not in choices:
        near = nearest(value, choices)
        fix = f"did you mean {near}?" if near else f"give one of {', '.join(choices)}"
        raise failure("bad-argument", f"{clean(value)!r} is not accepted", where=name, fix=fix)


def _quoted(text: str, longest: int) -> str:
    """Words of a user between quotation marks, on one line."""
    return clean(" ".join(text.split()).replace('"', "'"), longest)


_DESIGN = """\
Design a scenario for the robot-navigation simulator irsim that serves this goal: "{goal}"
Robots use the drive {kinematics}. Difficulty: {difficulty}. {meaning}

1. List the elements that the goal asks for (robots, obstacles, who moves, where goals are), with numbers in m and s.
2. Call lookup without a topic, then with the nearest template; change that rather than starting from nothing.
3. Call validate_scenario after each edit, and fix what it reports by code and line, until it is valid and each \
warning is meant.
4. Call render_snapshot and look: does everything stand where it should, is there a way to each goal?
5. Call run_episode with a seed. If the outcome is not what the goal wants, inspect_run says why: change it, and go \
back to 3.
6. Give the YAML, each element with the lines that express it, the outcome and the seed; say what could not be done."""

_DEBUG = """\
Find out why the run {run_id} of the robot-navigation simulator irsim went as it did, and what to change.

1. Call inspect_run with run_id={run_id}, then view="collisions" and view="closest": who, with whom, when, how fast.
2. Call render_snapshot with that run_id and the step shortly before, and look.
3. Say the cause in one sentence: what was too fast, too narrow, in the way, aimed wrong, or seen too late.
4. Change the least that cures it. Call validate_scenario, then run_episode with the same seed, then with two others: \
a cure for one seed only is none.
5. Report the cause with its evidence (step, objects, distance), the change, and the outcomes before and after."""

_DEBUG_JOB = """\
Find out why episodes of the benchmark {job_id} of the robot-navigation simulator irsim failed, and what to change.

1. Call get_job with job_id={job_id} until it has ended, then inspect_run with run_id={job_id}: its episodes, those \
that failed first, and the call of run_episode that runs one again.
2. Run one of each kind of failure again; each gives a run_id of its own.
3. Call inspect_run with that run_id, then view="collisions" and view="closest": who, with whom, when, how fast.
4. Call render_snapshot with that run_id and the step shortly before, and look.
5. Say the cause in one sentence: what was too fast, too narrow, in the way, aimed wrong, or seen too late.
6. Change the least that cures it. Call validate_scenario, then benchmark with the same seeds, then with others: a \
cure for the seeds you looked at only is none.
7. Report the causes with their evidence (seed, step, objects), the change, and the table before and after."""

_COMPARE = """\
Compare the behaviors that could drive the robots in {what} of the robot-navigation simulator irsim, fairly.

1. Call validate_scenario on it; it must be valid. lookup lists the behaviors; take those that fit its drive.
2. Try one seed of each with run_episode (behavior=…), so that nothing fails for a silly reason.
3. Call benchmark with all of them over at least 20 seeds, the same scenario and horizon for each; get_job waits for it.
4. Read the intervals: where they overlap the difference is not shown, so say that, or take more seeds.
5. Look into one failure of each kind with inspect_run and name its cause.
6. Report the table with intervals, the seeds, what decides between the behaviors, and what was not tested."""
