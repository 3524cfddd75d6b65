"""Prompts: step-by-step instructions for typical tasks with the tools, which users can start."""

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
from irsim.diagnostics.diagnostic import suggestion
from irsim_mcp.answers import failure
from irsim_mcp.services import Services

__all__ = ["DIFFICULTIES", "add_prompts", "drives", "template_names"]

DIFFICULTIES = {
    "easy": "Passages at least three times as wide as a robot, few obstacles, no oncoming traffic.",
    "medium": "Passages about twice as wide as a robot, obstacles on the straight line to the goal, some moving.",
    "hard": "Narrow passages, crossing traffic and a dead end or two; the goals must still be reachable.",
}
_MAX_GOAL_LENGTH = 2_000
"""Number of characters of a goal that the prompt repeats."""
_MAX_SCENARIO_LENGTH = 300
"""Number of characters of a scenario's name."""


def drives() -> list[str]:
    """Names of the drives, read from the file names without importing them."""
    folder = Path(irsim.__file__).parent / "components" / "kinematics"
    return sorted(path.stem for path in folder.glob("[a-z]*.py"))


def template_names() -> tuple[str, ...]:
    """Names of the templates."""
    return tuple(sorted(path.parent.name for path in resources.templates_directory().glob("*/template.yaml")))


def add_prompts(server: MCPServer, services: Services) -> None:
    """Register the prompts with a server."""

    def design_scenario(
        goal: Annotated[str, Field(description="The situation that the scene should show or test, in plain words.")],
        kinematics: Annotated[str, Field(description="Drive of the robots: diff, acker, omni, …")] = "diff",
        difficulty: Annotated[str, Field(description="easy, medium or hard")] = "medium",
    ) -> str:
        _one_of("kinematics", kinematics, drives())
        _one_of("difficulty", difficulty, list(DIFFICULTIES))
        return _DESIGN.format(
            goal=_quoted(goal, _MAX_GOAL_LENGTH),
            kinematics=kinematics,
            difficulty=difficulty,
            meaning=DIFFICULTIES[difficulty],
        )

    def debug_run(
        run_id: Annotated[str, Field(description="run_id of run_episode (last: the last run), or a job_id.")],
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
        if len(scenario) > _MAX_SCENARIO_LENGTH:
            raise failure("bad-argument", "the name of the scenario is too long", where="scenario")
        return _COMPARE.format(what=f"the file {services.workspace.scenario(scenario, 'scenario')}")

    for function, title, description in (
        (
            design_scenario,
            "Design a scenario",
            "From a goal in plain words to a scenario that is validated, drawn and simulated.",
        ),
        (
            debug_run,
            "Find out why a run failed",
            "Inspect a recorded run, find the cause, change the scenario, test it.",
        ),
        (
            compare_policies,
            "Compare behaviors",
            "A fair comparison: same scenarios, seeds and horizon, with intervals.",
        ),
    ):
        server.prompt(title=title, description=description)(_with_protocol_errors(function))


def _with_protocol_errors(function: Callable[..., str]) -> Callable[..., str]:
    """A prompt whose refusals are errors of the protocol, whose text the client shows."""

    @functools.wraps(function)
    def prompt(**arguments: Any) -> str:
        try:
            return function(**arguments)
        except ToolError as error:
            raise MCPError(INVALID_PARAMS, str(error)) from None

    return prompt


def _one_of(name: str, value: str, choices: list[str]) -> None:
    if value not in choices:
        fix = suggestion(value, choices, f"give one of {', '.join(choices)}")
        raise failure("bad-argument", f"{clean(value)!r} is not accepted", where=name, fix=fix)


def _quoted(text: str, longest: int) -> str:
    """Text of a user on one line, to be put between quotation marks."""
    return clean(" ".join(text.split()).replace('"', "'"), longest)


_DESIGN = """\
Design a scenario for the robot-navigation simulator irsim that serves this goal: "{goal}"
Robots use the drive {kinematics}. Difficulty: {difficulty}. {meaning}

1. List the elements that the goal needs (robots, obstacles, which of them move, positions of goals), with numbers in \
m and s.
2. Call lookup once with all topics, separated by commas, then with the closest template; change that template rather \
than starting from scratch.
3. Call run_episode with seeds=3 after each edit, and fix what it reports by code and line, until the scenario is \
valid and each remaining warning is intended.
4. Look at its picture and table: is everything where it should be, is there a path to each goal?
5. If the outcome does not serve the goal, find the cause with inspect_run, change the scenario and go back to 3.
6. Report the YAML, each element with the lines that express it, the outcome, the seed, and what could not be done."""

_DEBUG = """\
Find out why the run {run_id} of the robot-navigation simulator irsim went as it did, and what to change.

1. Call inspect_run with run_id={run_id}, then view="collisions" and view="closest": which objects, when, how fast.
2. Call render_snapshot with that run_id and the step shortly before the failure, and look.
3. State the cause in one sentence: what was too fast, too narrow, in the way, misdirected, or seen too late.
4. Make the smallest change that removes the cause. Call validate_scenario, then run_episode with the same seed, then \
with two others: a change that helps with one seed only is not a fix.
5. Report the cause with its evidence (step, objects, distance), the change, and the outcomes before and after."""

_DEBUG_JOB = """\
Find out why episodes of the benchmark {job_id} of the robot-navigation simulator irsim failed, and what to change.

1. Call get_job with job_id={job_id} until it has ended, then inspect_run with run_id={job_id}, which lists its \
episodes, failed ones first, and the call of run_episode that repeats one.
2. Repeat one episode of each kind of failure; each returns a run_id of its own.
3. Call inspect_run with that run_id, then view="collisions" and view="closest": which objects, when, how fast.
4. Call render_snapshot with that run_id and the step shortly before the failure, and look.
5. State the cause in one sentence: what was too fast, too narrow, in the way, misdirected, or seen too late.
6. Make the smallest change that removes the cause. Call validate_scenario, then benchmark with the same seeds, then \
with others: a change that helps only with the seeds you inspected is not a fix.
7. Report the causes with their evidence (seed, step, objects), the change, and the table before and after."""

_COMPARE = """\
Compare fairly the behaviors that could drive the robots in {what} of the robot-navigation simulator irsim.

1. Call validate_scenario on it; it must be valid. lookup lists the behaviors; choose some that fit its drive.
2. Try one seed of each with run_episode (policy=…) to rule out trivial failures.
3. Call benchmark with all of them over at least 20 seeds, with the same scenario and horizon; get_job waits for it.
4. Read the intervals: where they overlap, the difference is not significant; say so, or use more seeds.
5. Inspect one failure of each kind with inspect_run and name its cause.
6. Report the table with intervals, the seeds, what distinguishes the behaviors, and what was not tested."""
