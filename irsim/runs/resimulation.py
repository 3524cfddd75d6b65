"""Simulate a recorded run again up to a step, and check that it reproduces the recording."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from irsim.common.angles import wrap
from irsim.env import Env
from irsim.episodes.episode import Progress, advance
from irsim.runs.files import RunError, plain_file, unreadable
from irsim.runs.reading import Run
from irsim.scenario.behavior_override import parse_behavior, with_behavior
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.locate import why_outside
from irsim.scenario.perturbation import perturbed, read_perturbations
from irsim.scenario.read import or_raise, read
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.scenario.yaml.document import load_text

__all__ = ["check_reproduced", "follow_record", "has_modules", "initial_scene", "resimulate", "scenario_of", "step_of"]


_MAP = re.compile(r"map-\d{1,3}(\.\w{1,10})?")


def scenario_of(run: Run, limits: Limits | None = None) -> ResolvedScenario:
    """The scenario of a run, with the maps that the run has kept.

    Modules that the run imported are not imported again, as they may have changed and reading a run must not execute
    code. Their behaviors are therefore unknown here.

    Args:
        run: The recorded run.
        limits: Limits of the reader; with a ``root``, files outside it are not read.

    Raises:
        RunError: A map that the run kept is missing.
        ScenarioError: The scenario has errors, for example because another file of it has changed.
    """
    limits = limits or DEFAULT_LIMITS
    options = run.options
    document = load_text(run.scenario_text, path=_scenario_path(run, limits), limits=limits)
    document.maps = _maps(run)
    strict, behavior = bool(options.get("strict")) and not options.get("imports"), options.get("behavior")
    if isinstance(behavior, str):
        scenario = with_behavior(document, parse_behavior(behavior), strict=strict)
    else:
        scenario = or_raise(read(document, strict=strict, limits=limits))[0]
    if tuple(record.name for record in scenario.objects) != run.names:
        raise unreadable(f"scenario.yaml of run {run.id} has been changed: it has other objects")
    return perturbed(scenario, read_perturbations(options.get("perturb")))


def resimulate(
    run: Run, step: int | None = None, *, limits: Limits | None = None, progress: Progress | None = None
) -> Env:
    """An environment at a step of a run, which the caller must end.

    The run is simulated again, so that the environment has its complete state. With modules of the user or a policy,
    objects are moved as recorded instead.

    Args:
        run: The recorded run.
        step: The step; None or -1: the last one.
        limits: Limits of the reader.
        progress: Callback ``(steps_done, steps_total)``.

    Raises:
        RunError: There is no such step, or the simulation does not reproduce the recording, because a map or irsim
            itself has changed.
    """
    wanted = step_of(run, step)
    env = Env(scenario_of(run, limits), seed=int(run.meta["seed"]), headless=True, log_level="ERROR")
    if has_modules(run):
        follow_record(run, env)(wanted)
        return env
    advance(env, wanted, progress, until="time_limit")
    check_reproduced(run, env)
    return env


def has_modules(run: Run) -> bool:
    """Whether modules of the user, a policy in Python or another program took part.

    Reading a run neither imports nor opens these, so such a run is not simulated again.
    """
    return any(run.options.get(part) for part in ("imports", "policy", "bridges"))


def follow_record(run: Run, env: Env) -> Callable[[int], None]:
    """A function that moves the objects of an environment as recorded, up to a step.

    It goes step by step, so that sensors measure and trails grow as in the run.

    Args:
        run: The recorded run.
        env: An environment of its scenario, at the start.

    Raises:
        RunError: The scenario has other objects now.
    """
    trace, simulation = run.trace(), env.simulation
    if trace.pose[0].shape != simulation.pose.shape:
        raise RunError("unreadable-run", f"the scenario of run {run.id} has other objects now", "run it again")
    start, period = int(trace.step[0]), simulation.scenario.world.step_time

    def move(step: int) -> None:
        for row in range(int(simulation.count[0]) - start + 1, step - start + 1):
            simulation.pose[:], simulation.control[:] = trace.pose[row], trace.control[row]
            moved = trace.pose[row] - trace.pose[row - 1]  # records have no velocities
            moved[:, 2] = wrap(moved[:, 2])
            simulation.twist[:] = np.nan_to_num(moved) / period
            simulation.step_external()
            simulation.goal[:], simulation.stopped[:] = trace.goal[row], trace.stopped[row]
            simulation.arrived[:], simulation.collided[:] = trace.arrived[row], trace.collided[row]

    return move


def step_of(run: Run, step: int | None) -> int:
    """The number of a step, checked; None or -1 is the last step of the run.

    Raises:
        RunError: There is no such step, or no trace.
    """
    last = run.last_step
    if last < 0:
        raise run.no_steps()
    wanted = last if step is None or step == -1 else step
    if not 0 <= wanted <= last:
        raise RunError("step-out-of-range", f"run {run.id} has no step {wanted}", run.extent, where="step")
    return wanted


def check_reproduced(run: Run, env: Env) -> None:
    """Check that the poses of an environment are the recorded poses of the same step.

    Raises:
        RunError: They differ, because a map or irsim itself has changed since.
    """
    trace, step = run.trace(), int(env.simulation.count[0])
    row = step - int(trace.step[0])
    if trace.pose[row].shape != env.simulation.pose.shape or not np.array_equal(
        trace.pose[row], env.simulation.pose, equal_nan=True
    ):
        what = f"simulating run {run.id} again gives other poses at step {step}"
        raise RunError("unreadable-run", what, "a map or the version of irsim has changed since: run it again")


def _maps(run: Run) -> dict[str, str]:
    """Name of each map file in the scenario -> the copy that the run has kept."""
    kept = run.meta.get("maps", [])
    try:
        files = [(str(name), plain_file(run.folder, file)) for name, file in kept if _MAP.fullmatch(file)]
    except (TypeError, ValueError):
        raise unreadable(f"run.json of run {run.id} has been changed") from None
    if len(files) < len(kept) or any(file is None for _, file in files):
        raise unreadable(f"the map of run {run.id} is missing")
    return {name: str(file) for name, file in files}


def _scenario_path(run: Run, limits: Limits) -> str | None:
    """Path of the scenario file, from which other files are found; None if it lies outside the root of the limits."""
    scenario, folder = run.meta.get("scenario"), run.meta.get("folder")
    if not isinstance(scenario, str):
        return None
    if limits.root is not None:
        return scenario if why_outside(scenario, Path(limits.root)) is None else None
    return str(Path(folder) / Path(scenario).name) if isinstance(folder, str) else scenario


@contextmanager
def initial_scene(run: Run, limits: Limits | None = None) -> Iterator[Env]:
    """Context with an environment at the start of a run, whose shapes and map can be read.

    Args:
        run: The recorded run.
        limits: Limits of the reader of its scenario.

    Raises:
        RunError: The scenario now has other initial poses, because a map or irsim itself has changed.
        ScenarioError: The scenario has errors, for example because another file of it has changed.
    """
    recorded = next(run.blocks(1, scans=False)).pose[0]
    env = Env(scenario_of(run, limits), seed=int(run.meta["seed"]), headless=True, log_level="ERROR")
    try:
        start = env.simulation.pose
        if recorded.shape != start.shape or not np.array_equal(recorded, start, equal_nan=True):
            what = f"the scenario of run {run.id} now has other initial poses"
            raise RunError("unreadable-run", what, "a map or the version of irsim has changed since: run it again")
        yield env
    finally:
        env.end(ending_time=0.0)
