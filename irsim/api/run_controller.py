"""``irsim.episodes``: many episodes of a scenario with a controller of one's own, on all cores."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
import weakref
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

from irsim.api.run_seeds import failed_seeds, seeds_summary
from irsim.benchmarks.controlled import Controller, ControllerJob, packed
from irsim.benchmarks.episode import Task, scenario_of
from irsim.benchmarks.pool import cores, run_tasks
from irsim.benchmarks.seeds import seeds_from
from irsim.common.arguments import as_given, check_whole_number
from irsim.common.installed import version
from irsim.common.keywords import answers_misspelt
from irsim.diagnostics.errors import InputError
from irsim.episodes.episode import Progress
from irsim.results.run import Again, RunResult, RunsResult
from irsim.runs.files import RunError
from irsim.scenario.open import document_of

__all__ = ["episodes"]


@answers_misspelt
def episodes(
    scenario: str | Path,
    controller: Controller,
    seeds: int | str | Iterable[int] = 20,
    *,
    workers: int | None = None,
    steps: int | None = None,
    strict: bool = False,
    imports: Iterable[str] = (),
    record: str | Path | None = None,
    progress: Progress | None = None,
) -> RunsResult:
    """Run an episode for each seed with a controller of your own, on all cores, and keep every step.

    The result depends on the seeds only, to the last bit, whatever the number of workers: each episode begins with a
    fresh copy of the controller, so a class remembers what it likes in ``self``. Draw random numbers from ``env.rng``,
    and keep nothing in variables of a module.

    ::

        import math                         # controller.py: turn to the goal, then drive

        def act(env):
            (x, y, heading), (to_x, to_y) = env.robot.state[:3, 0], env.robot.goal[:2, 0]
            turn = math.remainder(math.atan2(to_y - y, to_x - x) - heading, math.tau)
            return [0.0 if abs(turn) > 0.5 else 1.0, 2 * turn]

    ::

        import irsim
        from controller import act

        result = irsim.episodes("hall.yaml", act, seeds=100)
        result.to_pandas()                  # one row per step and object; "run" has the seed
        result.to_pandas("robots")          # one row per episode and robot
        result.episodes[0].replay()         # in a notebook; .save("page.html") in a script

    Args:
        scenario: YAML file.
        controller: Function, or object that can be called, ``controller(env)``. It is called before each step and
            returns the action of :meth:`Env.step`: controls of the first robot, a list of controls, a mapping ``{name:
            controls}``, or None to let behaviors drive all robots.
        seeds: The number of seeds (0, 1, 2, …), or the seeds: a list, or text such as ``5-9`` or ``1,4,7``.
        workers: Greatest number of processes; default: the number of cores. With 1 all runs in this process, and the
            controller may be anything.
        steps: Horizon in steps, which overrides ``world.time_limit``.
        strict: Refuse what IR-SIM would ignore.
        imports: Modules to import first, for behaviors that they register.
        record: New or empty folder for the recordings, ``seed-7`` and so on, which is kept. Default: a temporary one,
            deleted with the result.
        progress: Callback ``(episodes_done, episodes_total)``.

    Raises:
        ScenarioError: The scenario has errors; ScenarioNotFoundError: there is no such file.
        InputError: The controller cannot be called or sent to other processes, or another argument is invalid.
        PolicyError: The controller failed; the message has seed and step.
        RunError: The folder is not empty.
        WorkerError: Several processes have died in the same episode.
    """
    if not callable(controller):
        what = f"the controller cannot be called: {as_given(controller)}"
        raise InputError(what, "give a function controller(env) that returns an action", "controller")
    chosen = seeds_from(seeds)
    most = min(len(chosen), cores() if workers is None else check_whole_number("workers", workers, 1))
    kept = None if record is None else Path(record).absolute()
    if kept is not None and kept.exists() and (not kept.is_dir() or any(kept.iterdir())):
        raise RunError("file-exists", f"'{record}' exists and is not empty", "name another folder for the recordings")
    data = packed(controller) if most > 1 else None
    document = document_of(scenario, None, None)
    again, folder = Again(), Path(tempfile.mkdtemp(prefix="irsim-"))
    weakref.finalize(again, shutil.rmtree, folder, ignore_errors=True)
    if data is not None:
        (folder / "controller").write_bytes(data)
    job = ControllerJob(
        text=str(document.text),
        path=document.path,
        behavior="as-written",
        steps=None if steps is None else check_whole_number("steps", steps),
        strict=strict,
        imports=tuple(imports),
        limits=tuple(asdict(document.limits).items()),
        name=str(scenario),
        controller=str(folder / "controller"),
        called=str(getattr(controller, "__name__", type(controller).__name__)),
        folder=str(kept or folder),
        places=tuple(os.path.abspath(place) for place in sys.path),
        own=controller if data is None else None,
    )
    try:
        scenario_of(job)
        answers = run_tasks([Task(job, seed) for seed in chosen], workers=most, progress=progress)
    except BaseException:  # Ctrl-C, too
        shutil.rmtree(folder, ignore_errors=True)
        raise
    runs = [RunResult.model_validate(one["run"]) for one in answers if one["run"] is not None]
    crowded = [seed for seed, one in zip(chosen, answers, strict=True) if one["run"] is None]
    for run in runs:
        run._again = again  # the recordings last as long as one of the results
    failed, same = failed_seeds(runs), len(runs) > 1 and all(run.robots == runs[0].robots for run in runs)
    summary = seeds_summary(runs, failed, crowded)
    if same:
        summary += "; all are the same, as nothing is random in the scenario or the controller"
    return RunsResult(
        scenario=str(scenario),
        summary=summary,
        failed=failed,
        crowded=crowded,
        not_run=[],
        same=same,
        episodes=runs,
        warnings=[],
        version=version(),
    )
