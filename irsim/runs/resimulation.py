"""A recorded run, simulated once more up to a step: the same seed gives the same, which is checked."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from irsim.env import Env
from irsim.episodes.episode import Progress, advance
from irsim.runs.files import RunError, plain_file, unreadable
from irsim.runs.reading import Run
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.open import or_raise
from irsim.scenario.path_confinement import why_outside
from irsim.scenario.read import read
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.scenario.yaml.document import load_text

__all__ = ["check_same", "has_modules", "replayed", "scenario_of", "step_of"]

_MAP = re.compile(r"map-\d{1,3}(\.\w{1,10})?")


def scenario_of(run: Run, limits: Limits | None = None) -> ResolvedScenario:
    """The scenario of a run to look at, with the maps that it had.

    Modules that the run had imported are not: they could be anything by now, and it is only looked at. Behaviors of
    theirs are unknown here.

    Args:
        run: Recorded.
        limits: Of the reader; with a ``root``, files outside are not looked for.

    Raises:
        RunError: A map that was kept is missing.
        ScenarioError: It can't be used any more.
    """
    limits = limits or DEFAULT_LIMITS
    options = run.options
    document = load_text(run.scenario_text, path=_place(run, limits), limits=limits)
    document.maps = _maps(run)
    strict, behavior = bool(options.get("strict")) and not has_modules(run), options.get("behavior")
    if isinstance(behavior, str):
        from irsim.scenario.behavior_override import parse_behavior, with_behavior

        return with_behavior(document, parse_behavior(behavior), strict=strict)
    return or_raise(read(document, strict=strict, limits=limits))[0]


def replayed(
    run: Run, step: int | None = None, *, limits: Limits | None = None, progress: Progress | None = None
) -> Env:
    """An environment at a step of a run; to be ended by the caller.

    It is simulated once more, with all that a world remembers, unless modules of a user took part.

    Args:
        run: Recorded.
        step: Which step; None or -1: the last one.
        limits: Of the reader.
        progress: Told how far it is.

    Raises:
        RunError: There is no such step, or simulating it again gives something else, because a map or irsim itself has
            changed since.
    """
    wanted = step_of(run, step)
    env = Env(scenario_of(run, limits), seed=int(run.meta["seed"]), headless=True, log_level="ERROR")
    if has_modules(run):
        _put(run, env, wanted)
        return env
    advance(env, wanted, progress, until_done=False)
    check_same(run, env)
    return env


def has_modules(run: Run) -> bool:
    """Whether modules of a user took part, which nobody imports to look at it: it can't be simulated again."""
    return bool(run.options.get("imports"))


def _put(run: Run, env: Env, step: int) -> None:
    """Move everybody as the record says that they moved; sensors measure, and trails grow, as they did."""
    trace, simulation = run.trace(), env.simulation
    if trace.pose[0].shape != simulation.pose.shape:
        raise RunError("unreadable-run", f"the scenario of run {run.id} has other objects now", "run it again")
    for row in range(1, step - int(trace.step[0]) + 1):
        simulation.pose[:], simulation.control[:] = trace.pose[row], trace.control[row]
        simulation.step_external()
        simulation.goal[:], simulation.stopped[:] = trace.goal[row], trace.stopped[row]
        simulation.arrived[:], simulation.collided[:] = trace.arrived[row], trace.collided[row]


def step_of(run: Run, step: int | None) -> int:
    """A step of a run; None or -1 is the last one.

    Raises:
        RunError: There is no such step.
    """
    last = run.last_step
    wanted = last if step is None or step == -1 else step
    if not 0 <= wanted <= last:
        raise RunError("step-out-of-range", f"run {run.id} has no step {wanted}", run.extent, where="step")
    return wanted


def check_same(run: Run, env: Env) -> None:
    """Refuse an environment that is not where the run was at its step.

    Raises:
        RunError: Simulating it again has given something else, because a map or irsim itself has changed since.
    """
    trace, step = run.trace(), int(env.simulation.count[0])
    row = step - int(trace.step[0])
    if trace.pose[row].shape != env.simulation.pose.shape or not np.array_equal(
        trace.pose[row], env.simulation.pose, equal_nan=True
    ):
        what = f"simulating run {run.id} again gives other poses at step {step}"
        raise RunError("unreadable-run", what, "a map or the version of irsim has changed since: run it again")


def _maps(run: Run) -> dict[str, str]:
    """Maps by their names in the scenario, as the run has kept them."""
    kept = run.meta.get("maps", [])
    try:
        files = [(str(name), plain_file(run.folder, file)) for name, file in kept if _MAP.fullmatch(file)]
    except (TypeError, ValueError):
        raise unreadable(f"run.json of run {run.id} has been changed") from None
    if len(files) < len(kept) or any(file is None for _, file in files):
        raise unreadable(f"the map of run {run.id} is missing")
    return {name: str(file) for name, file in files}


def _place(run: Run, limits: Limits) -> str | None:
    """Where the scenario was, so that files it names are found; None if that is not to be looked at."""
    scenario, folder = run.meta.get("scenario"), run.meta.get("folder")
    if not isinstance(scenario, str):
        return None
    if limits.root is not None:
        return scenario if why_outside(scenario, Path(limits.root)) is None else None
    return str(Path(folder) / Path(scenario).name) if isinstance(folder, str) else scenario
