"""Writes the report of a benchmark beside its result: Markdown, a page, a table, replays of episodes that failed."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from irsim.api.film_strip import draw_strip, moments_of
from irsim.api.look import dress
from irsim.api.run_scenario import run
from irsim.benchmarks.episode import Job, environment_of
from irsim.benchmarks.plan import Plan, PlannedScenario
from irsim.benchmarks.policies import job_keys, label_of
from irsim.benchmarks.report.markdown import markdown
from irsim.benchmarks.report.page import Shown, page
from irsim.benchmarks.report.rows import policy_labels, worst_episodes
from irsim.benchmarks.report.table import MISSING, TABLE, has_tables, write_table
from irsim.benchmarks.roles import shared_with
from irsim.benchmarks.stored import read_plan
from irsim.common.files import code_of, write_atomically
from irsim.common.text import plural
from irsim.diagnostics.errors import ScenarioError
from irsim.episodes.opening import reproduce_command
from irsim.results.benchmark import SuiteResult
from irsim.runs.files import RunError
from irsim.runs.replay.export import replay
from irsim.scenario.behavior_override import AS_WRITTEN
from irsim.scenario.limits import DEFAULT_LIMITS
from irsim.scenario.perturbation import perturbation_text

if TYPE_CHECKING:
    from irsim.policies.policy import Policy
    from irsim.results.benchmark import BenchmarkResult, EpisodeRow
    from irsim.results.run import RunResult

__all__ = ["MARKDOWN", "PAGE", "REPLAYS", "TABLE", "Report", "record_episode", "write_report"]

MARKDOWN, PAGE, REPLAYS = "results.md", "results.html", "replays"
"""Names of the files, and of the folder of the replays."""
_MOMENTS, _WIDTH_PX = 4, 1400
MAX_NAME = 120
"""Number of characters of the name of a replay that tell the scenario and the policy."""


@dataclass(frozen=True)
class Report:
    """The files that were written.

    Attributes:
        page: The page.
        notes: Files that could not be written, and how that is changed.
    """

    page: Path
    notes: list[str]


def write_report(result: BenchmarkResult, folder: Path) -> Report:
    """Write the report of a benchmark into its folder.

    The table of episodes needs pyarrow, of the extra ``records``; without it, a note says so.

    Args:
        result: The result.
        folder: Folder in which :func:`irsim.benchmarks.stored.run_plan` has run it.

    Raises:
        RunError: The folder cannot be written.
    """
    notes = [] if has_tables() else [MISSING]
    plan = read_plan(folder)
    scenarios = {scenario.name: scenario for scenario in plan.scenarios}
    try:
        shown = [_shown(plan, scenarios[one.scenario], one, result, folder) for one in worst_episodes(result)]
        notes += [
            f"{one.caption}: without a replay, because its map cannot be copied" for one in shown if not one.replay
        ]
        if has_tables():
            write_table(result, plan.hash, folder / TABLE)
        write_atomically(folder / MARKDOWN, markdown(result, notes))
        write_atomically(folder / PAGE, page(result, shown, notes, partial(_command, plan, result)))
    except OSError as error:
        code = code_of(error, "not-writable")
        raise RunError(code, f"{folder}: {error.strerror}", "make room, then give --resume") from None
    return Report(folder / PAGE, notes)


def _shown(plan: Plan, scenario: PlannedScenario, one: EpisodeRow, result: BenchmarkResult, folder: Path) -> Shown:
    """An episode as a picture, and its replay."""
    document = scenario.document()
    compared = next(policy for policy in plan.opened() if label_of(policy) == one.behavior)
    policy = shared_with(compared, plan.parts().get(scenario.name, {}))
    job = Job(
        text=scenario.text, path=document.path, steps=plan.steps, strict=plan.strict, imports=tuple(plan.imports),
        limits=tuple(vars(DEFAULT_LIMITS).items()), perturb=tuple(plan.perturb), **job_keys(policy),
    )  # fmt: skip
    env = environment_of(job, one.seed)
    dress(env)
    png = draw_strip(env, moments_of(max(one.steps, 1), _MOMENTS), size=_WIDTH_PX, may_be_lost=True)
    env.end(ending_time=0.0)
    label = policy_labels(result)[one.behavior]
    words = re.sub(r"[^\w.-]+", "-", f"{one.scenario}-{label}").strip("-.")  # a policy may be the path of a file
    name = f"{words[-MAX_NAME:]}-{one.seed}.html"
    title = f"{one.scenario}, {label}, seed {one.seed}"
    replayed = _replay(scenario, one, plan, policy, folder / REPLAYS / name, title)
    caption = f"seed {one.seed}: {_how_it_failed(one, replayed)} ({one.scenario}, {label})"
    return Shown(
        caption,
        png,
        "" if replayed is None else f"{REPLAYS}/{name}",
        _command(plan, result, one.scenario, one.behavior, one.seed),
    )


def _command(plan: Plan, result: BenchmarkResult, scenario: str, behavior: str, seed: int) -> str:
    """The command that runs and records an episode again, in the folder in which the benchmark was started."""
    path, policy, perturb = scenario, behavior, plan.perturb
    if isinstance(result, SuiteResult) and plan.suite is not None:
        suite = shlex.split(result.reproduce)[2]  # as the user named it: irsim benchmark SUITE …
        path = f"{suite}/{scenario}"
        policy = next(name for name, text in result.policies.items() if text == behavior)
        perturb = perturb if perturb != [perturbation_text(item) for item in plan.suite.perturb] else []
    extra = [] if behavior == AS_WRITTEN else ["--policy", policy]
    extra += [word for text in perturb for word in ("--perturb", text)]
    file = None if path.startswith("(text") else path
    return reproduce_command("run", file, seed, plan.steps, plan.strict, plan.imports, [*extra, "--record"])


def _how_it_failed(one: EpisodeRow, replayed: RunResult | None) -> str:
    """The first robot that failed, how and when, and how many others did."""
    robot, how = next(iter(one.failures.items()), ("", one.outcome))
    contacts = [
        event for event in (replayed.events if replayed is not None else ())
        if event.kind == "collision" and event.object in one.failures
    ]  # fmt: skip
    if contacts:  # the first one in time, which the replay tells, too
        robot, how = contacts[0].object, f"collision with {contacts[0].partner!r}"
    hit = how.startswith("collision")
    when = f"at {contacts[0].time:.1f} s" if contacts else f"after {one.sim_time:.1f} s"
    words = how.replace("collision", "collided") if hit else "had not arrived"
    others = f", and {plural(len(one.failures) - 1, 'other')} failed" if len(one.failures) > 1 else ""
    return f"{robot} {words} {when}{others}".strip()


def _replay(
    scenario: PlannedScenario, one: EpisodeRow, plan: Plan, policy: Policy, target: Path, title: str
) -> RunResult | None:
    """Run an episode again, and write its replay; None if a map cannot be copied."""
    target.parent.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as place:
        again = record_episode(scenario, one.seed, plan, policy, Path(place) / "run", steps=one.steps)
        if again is not None:
            replay(Path(place) / "run", target, title=title)
    return again


def record_episode(
    scenario: PlannedScenario, seed: int, plan: Plan, policy: Policy, target: Path, *, steps: int | None = None
) -> RunResult | None:
    """Run an episode of a plan again, and record it into a new folder; None if a map cannot be copied.

    Args:
        scenario: Its scenario.
        seed: Its seed.
        plan: The plan.
        policy: The policy that drives its robots.
        target: The folder.
        steps: Number of steps after which it ends; default: as the plan says.
    """
    until = plan.until if steps is None else "done"
    with tempfile.TemporaryDirectory() as place:
        try:
            source = {"text": scenario.text} if scenario.folder is None else {"path": _copied(scenario, Path(place))}
            return run(
                **source, seed=seed, steps=plan.steps if steps is None else steps, strict=plan.strict,
                imports=plan.imports, record=target, policy=policy, perturb=plan.perturb or None, until=until,
            )  # fmt: skip
        except ScenarioError:
            return None


def _copied(scenario: PlannedScenario, place: Path) -> Path:
    """The file of a scenario in another folder, with its maps beside it, as they are found from there."""
    up = max((Path(name).parts.count("..") for name in scenario.maps), default=0)
    folder = place.joinpath("maps", *(str(depth) for depth in range(up)))
    folder.mkdir(parents=True)
    for name in scenario.maps:
        source, copy = Path(scenario.folder or ".", name), Path(os.path.normpath(folder / name))
        if copy.is_relative_to(place) and source.is_file():  # a full path needs no copy
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, copy)
    file = folder / "scenario.yaml"
    file.write_text(scenario.text, encoding="utf-8")
    return file
