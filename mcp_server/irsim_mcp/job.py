"""Runs in a worker process: read one job from standard input, do it, write the answer to standard output.

The answer has one JSON object per line: ``{"progress": [done, total]}`` now and then, ``{"run": id}`` when a recording
starts, and at the end either ``{"result": …}`` or ``{"error": …}``.
"""

from __future__ import annotations

import base64
import json
import os
import sys
import time
from collections.abc import Callable
from contextlib import nullcontext
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.common.child import answers, end_with_input, limit, write_to_pipe
from irsim.common.held import hold_for_good, not_held
from irsim_mcp.job_errors import error_data

if TYPE_CHECKING:
    from irsim.results.picture import SnapshotResult
    from irsim.scenario.limits import Limits
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["main"]

_SIZE_PX = 500
"""Longer side of the picture that comes with several episodes."""
_MAX_NEAR = 10
"""Number of objects that can move, up to which several episodes tell of how near they came to one another."""
_PROGRESS_PERIOD_S = 0.5
"""Least time between two progress messages [s]."""
_MAX_FILES = 256
"""Number of files that a worker may have open."""


def main() -> None:
    """Do the job and exit."""
    pipe = answers()
    job = json.loads(sys.stdin.buffer.readline())
    end_with_input()
    limit(files=_MAX_FILES, **job["resources"])
    job["workspace"] = _enter(**job["workspace"])  # paths of scenarios, and in them, are relative to it

    def answer(text: str) -> None:
        write_to_pipe(pipe, text.encode() + b"\n")

    try:
        result = _TASKS[job["task"]](job, _Progress(answer))
        answer(f'{{"result": {result}}}')
    except Exception as error:
        answer(json.dumps({"error": error_data(error)}))
    os._exit(0)  # at once: there is nothing to clean up


def _enter(path: str, descriptor: int | None) -> str:
    """Hold the workspace from now on, or work in it where folders cannot be held, and return its path."""
    if descriptor is None:
        os.chdir(path)
    else:
        hold_for_good(path, descriptor)
    return path


class _Progress:
    """Writes progress messages, not too often."""

    def __init__(self, answer: Callable[[str], None]) -> None:
        self._answer, self._next = answer, 0.0

    def __call__(self, done: int, total: int) -> None:
        now = time.monotonic()
        if now >= self._next or done == total:
            self._next = now + _PROGRESS_PERIOD_S
            self._answer(json.dumps({"progress": [done, total]}))

    def recorded(self, run_id: str) -> None:
        """Write the id of the run whose recording has started."""
        self._answer(json.dumps({"run": run_id}))


def _limits(job: dict[str, Any]) -> Limits:
    from irsim.scenario.limits import Limits

    return Limits(**job["limits"])


def _validate(job: dict[str, Any], progress: _Progress) -> str:
    from irsim.api import validate

    report = validate(**job["arguments"], strict=True, limits=_limits(job))
    return report.model_dump_json()


def _validate_new(job: dict[str, Any], progress: _Progress) -> str:
    """Validate the text of a file that is not written yet; files that it names are sought relative to its path."""
    from irsim.episodes.scene_summary import counts_of, in_words
    from irsim.scenario.read import or_raise, read
    from irsim.scenario.yaml.document import load_text
    from irsim.validation.feasibility.check import feasibility_findings

    limits, path = _limits(job), job["arguments"]["path"]
    document = load_text(job["arguments"]["text"], name=path, path=path, limits=limits)
    scenario, findings = or_raise(read(document, strict=True, limits=limits, feasibility=feasibility_findings))
    warnings = sum(item.severity == "warning" for item in findings)
    return json.dumps({"contents": in_words(counts_of(scenario), sensors=False), "warnings": warnings})


def _run(job: dict[str, Any], progress: _Progress) -> str:
    from irsim.api import run

    return str(_recorded(run, job, progress).model_dump_json())


def _run_seeds(job: dict[str, Any], progress: _Progress) -> str:
    """Run several episodes, and draw and describe the first that failed, or else the first."""
    from irsim.api import validate
    from irsim.api.run_seeds import run_seeds
    from irsim.runs.inspection import inspect_run
    from irsim.validation.scene_table import scene_table

    given = {key: job["arguments"].get(key) for key in ("path", "text")}
    base = {key: job["arguments"].pop(key) for key in ("base", "base_text") if key in job["arguments"]}
    result = _recorded(run_seeds, job, progress)
    shown, answer = result.shown, dict[str, Any](png="", scene=None, table=None, closest=[], zones=[], changes=None)
    if base:
        report = validate(**given, **base, strict=True, simulate=True, seed=shown.seed, limits=_limits(job))
        answer["changes"] = None if report.changes is None else report.changes.model_dump(mode="json")
        old = {(item.code, item.path) for item in report.findings if item.in_base}
        for item in result.warnings:
            item.in_base = (item.code, item.path) in old
    if shown.run_id is not None:
        drawn = {"size": _SIZE_PX, "overlays": None, "region": None, "draw": True, "strip": None}
        job["arguments"] = {"run_id": shown.run_id, "steps": shown.decisive_step or shown.steps, **drawn}
        scenario, picture = _draw_run(job, _Progress(lambda line: None))
        answer |= json.loads(_picture(picture))
        answer["table"] = scene_table(scenario, shown.seed).model_dump(mode="json")
        if len(shown.robots) + len(picture.moving) <= _MAX_NEAR:
            asked = {"robot": "all", "limit": None, "workspace": job["workspace"], "limits": _limits(job)}
            for view in ("closest", *(["zones"] if scenario.world.zones else [])):
                answer[view] = inspect_run(shown.run_id, view=view, **asked).records()
    return f'{json.dumps(answer)[:-1]}, "result": {result.model_dump_json()}}}'


def _recorded(work: Callable[..., Any], job: dict[str, Any], progress: _Progress) -> Any:
    """The result of runs that are recorded, or are not where the disk is full or refuses."""
    from irsim.runs import RunError

    arguments = {**job["arguments"], "strict": True, "limits": _limits(job), "progress": progress}
    try:
        return work(**arguments, record=True, recorded=progress.recorded)
    except RunError as error:
        if error.code not in ("disk-full", "file-access"):
            raise
        print(f"irsim-mcp: no record of this run: {error.message}", file=sys.stderr)
        return work(**arguments)


def _snapshot(job: dict[str, Any], progress: _Progress) -> str:
    from irsim.api.read_input import read_scenario
    from irsim.api.take_snapshot import snapshot_of
    from irsim.episodes.opening import MAX_TRIES

    arguments, limits = job["arguments"], _limits(job)
    path, text = arguments.pop("path", None), arguments.pop("text", None)
    checked, perturb = "", arguments.pop("perturb", [])
    base = {key: arguments.pop(key) for key in ("base", "base_text") if key in arguments}
    if arguments.pop("check"):
        from irsim.api import validate

        report = validate(path, text=text, strict=True, simulate=True, seed=arguments["seed"], limits=limits, **base)
        checked = f', "report": {report.model_dump_json()}'
        if not report.valid:
            return f'{{"png": "", "scene": null{checked}}}'
        if arguments["seed"] is None and report.dry_run is not None:
            arguments["seed"] = report.dry_run.seed  # the picture and the check are of the same layout
        if report.changes is not None and report.changes.world:
            other, _ = read_scenario(base.get("base"), text=base.get("base_text"), strict=True, limits=limits)
            changed = dict.fromkeys(item.object for item in report.changes.world if item.object is not None)
            arguments |= {"base": other, "changed": list(changed)}
    scenario, warnings = read_scenario(path, text=text, strict=True, limits=limits, perturb=perturb)
    if arguments["draw"]:
        _load_elsewhere("irsim.rendering.snapshot")
    arguments |= {"warnings": warnings, "strict": True, "limits": limits, "progress": progress}
    result = snapshot_of(scenario, path, tries=range(MAX_TRIES), **arguments)
    if checked:
        from irsim.validation.scene_table import scene_table

        checked += f', "table": {scene_table(scenario, result.seed).model_dump_json()}'
    return _picture(result, checked)


def _load_elsewhere(module: str) -> None:
    """Import a module outside the workspace, as Matplotlib obeys a matplotlibrc in the current directory."""
    with not_held():
        back = os.getcwd()
        os.chdir(os.path.dirname(__file__))
        try:
            import_module(module)
        finally:
            os.chdir(back)


def _picture(result: SnapshotResult, checked: str = "") -> str:
    """The answer with a picture and the scene in it."""
    png = base64.b64encode(result.png).decode()
    return f'{{"png": "{png}", "scene": {result.model_dump_json()}{checked}}}'


def _run_snapshot(job: dict[str, Any], progress: _Progress) -> str:
    return _picture(_draw_run(job, progress)[1])


def _draw_run(job: dict[str, Any], progress: _Progress) -> tuple[ResolvedScenario, SnapshotResult]:
    """The scenario of a recorded run as it was simulated, and a picture of the run."""
    from irsim.api.film_strip import moments_of
    from irsim.api.take_snapshot import dress, snapshot_of_env
    from irsim.runs import open_run
    from irsim.runs.resimulation import check_reproduced, follow_record, has_modules, resimulate, step_of

    arguments, moments = job["arguments"], None
    run = open_run(arguments["run_id"], job["workspace"])
    if arguments["strip"] is not None:
        moments = moments_of(step_of(run, arguments["steps"] or None), arguments["strip"])
    env = resimulate(run, arguments["steps"] if moments is None else 0, limits=_limits(job), progress=progress)
    dress(env, arguments.get("style"))
    if arguments["draw"]:
        _load_elsewhere("irsim.rendering.snapshot")
    shown = {key: arguments[key] for key in ("size", "overlays", "region", "draw")}
    source, move = run.meta.get("scenario"), follow_record(run, env) if has_modules(run) else None
    result = snapshot_of_env(
        env, source, **shown, moments=moments, warnings=[], reproduce="", progress=progress, move=move
    )
    if not has_modules(run):
        check_reproduced(run, env)
    return env.scenario, result


def _inspect(job: dict[str, Any], progress: _Progress) -> str:
    from irsim.runs.inspection import inspect_run

    arguments = job["arguments"]
    table = inspect_run(arguments.pop("run_id"), **arguments, workspace=job["workspace"], limits=_limits(job))
    return table.model_dump_json()


def _export(job: dict[str, Any], progress: _Progress) -> str:
    from irsim.bridges.export.episode import CHOICES
    from irsim.bridges.export.export import export_run
    from irsim.bridges.export.registry import find_format
    from irsim_mcp.sandbox import set_aside

    arguments = job["arguments"]
    run_id, objects, form = arguments["run_id"], arguments["objects"], find_format(arguments["to"], None)
    target = Path(arguments["out"]) / f"{run_id}{form.suffix}"
    names = objects if objects in CHOICES else [name.strip() for name in objects.split(",")]
    options: dict[str, Any] = {"limits": _limits(job), "workspace": job["workspace"], "progress": progress}
    with set_aside(target) if form.folder else nullcontext():
        return export_run(run_id, target, to=form.name, objects=names, overwrite=True, **options).model_dump_json()


def _artifact(job: dict[str, Any], progress: _Progress) -> str:
    from irsim.runs import open_run
    from irsim.runs.artifacts import artifact

    arguments = job["arguments"]
    run = open_run(arguments.pop("run_id"), job["workspace"])
    if arguments["name"] == "replay.json":
        _load_elsewhere("matplotlib.colors")
    return json.dumps({"text": artifact(run, arguments.pop("name"), limits=_limits(job), **arguments)})


def _benchmark(job: dict[str, Any], progress: _Progress) -> str:
    from irsim.benchmarks import benchmark
    from irsim.benchmarks.stored import PLAN, TIMING, measure_plan
    from irsim.runs.files import replace_file

    arguments = job["arguments"]
    folder = os.path.dirname(arguments["log"])
    timing: dict[str, Any] = {}
    options: dict[str, Any] = {"limits": _limits(job), "progress": progress, "timing": timing}
    if "plan" in arguments:
        from irsim.benchmarks.plan import Plan

        plan = Plan.model_validate(arguments["plan"])
        replace_file(os.path.join(folder, PLAN), plan.model_dump_json().encode())
        result = measure_plan(plan, log=arguments["log"], **options)
    else:
        result = benchmark(**arguments, strict=True, **options)
    replace_file(os.path.join(folder, TIMING), json.dumps(timing).encode())
    return result.model_dump_json()


def _logged(job: dict[str, Any], progress: _Progress) -> str:
    """Write the result of the episodes that a stopped benchmark had completed, beside its log."""
    from irsim.benchmarks import logged
    from irsim.benchmarks.stored import PLAN, read_plan, result_of_plan
    from irsim.runs.files import replace_file

    log = Path(job["arguments"]["log"])
    result = logged(log)
    if log.with_name(PLAN).is_file():  # of a suite, which names scenarios and policies
        result = result_of_plan(read_plan(log.parent), result)
    replace_file(job["arguments"]["to"], result.model_dump_json().encode())
    return "null"


def _suite_plan(job: dict[str, Any], progress: _Progress) -> str:
    from irsim_mcp.suites import plan_of

    return plan_of(**job["arguments"], root=Path(job["workspace"])).model_dump_json()


def _suite_policy(job: dict[str, Any], progress: _Progress) -> str:
    from irsim.benchmarks.suite_plan import suite_policy

    return json.dumps({"text": suite_policy(**job["arguments"])})


def _suite_rules(job: dict[str, Any], progress: _Progress) -> str:
    from irsim.benchmarks.suite_plan import suite_rules

    perturb, until = suite_rules(**job["arguments"]) or ([], "done")
    return json.dumps({"perturb": perturb, "until": until})


def _suite_scene(job: dict[str, Any], progress: _Progress) -> str:
    from irsim_mcp.suites import scenario_of_suite

    return json.dumps({"text": scenario_of_suite(**job["arguments"])})


def _lookup(job: dict[str, Any], progress: _Progress) -> str:
    from irsim_mcp.reference import explanation

    return json.dumps({"text": explanation(**job["arguments"])})


def _schema(job: dict[str, Any], progress: _Progress) -> str:
    from irsim_mcp.reference import schema_text

    return json.dumps({"text": schema_text(**job["arguments"])})


_TASKS: dict[str, Callable[[dict[str, Any], _Progress], str]] = {
    "benchmark": _benchmark,
    "logged": _logged,
    "validate": _validate,
    "validate_new": _validate_new,
    "run": _run,
    "run_seeds": _run_seeds,
    "snapshot": _snapshot,
    "run_snapshot": _run_snapshot,
    "inspect": _inspect,
    "export": _export,
    "artifact": _artifact,
    "suite_plan": _suite_plan,
    "suite_policy": _suite_policy,
    "suite_rules": _suite_rules,
    "suite_scene": _suite_scene,
    "lookup": _lookup,
    "schema": _schema,
}


if __name__ == "__main__":
    main()
