"""A recorded run, simulated once more up to a step: the same seed gives the same, which is checked."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from irsim.env import Env
from irsim.episode import Progress, advance, import_modules
from irsim.runs.files import RunError
from irsim.runs.reading import Run
from irsim.scenario.confine import why_outside
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.load import load_text
from irsim.scenario.objects import ResolvedScenario
from irsim.scenario.opening import or_raise
from irsim.scenario.read import read

__all__ = ["check_same", "replayed", "scenario_of", "step_of"]


def scenario_of(run: Run, limits: Limits | None = None) -> ResolvedScenario:
    """The scenario of a run, with maps looked for where it was.

    Args:
        run: Recorded.
        limits: Of the reader; with a ``root``, modules that the run had imported are not, and files outside are not
            looked for.

    Raises:
        ScenarioError: It can't be used any more.
    """
    limits = limits or DEFAULT_LIMITS
    options = run.meta.get("options")
    options = options if isinstance(options, dict) else {}
    if limits.root is None:
        import_modules(str(name) for name in options.get("imports", []))
    document = load_text(run.scenario_text, path=_place(run, limits), limits=limits)
    strict, behavior = bool(options.get("strict")), options.get("behavior")
    if isinstance(behavior, str):
        from irsim.benchmarks.variant import behavior_of, with_behavior

        return with_behavior(document, behavior_of(behavior), strict=strict)
    return or_raise(read(document, strict=strict, limits=limits))[0]


def replayed(
    run: Run, step: int | None = None, *, limits: Limits | None = None, progress: Progress | None = None
) -> Env:
    """An environment at a step of a run; to be ended by the caller.

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
    advance(env, wanted, progress, until_done=False)
    check_same(run, env)
    return env


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


def _place(run: Run, limits: Limits) -> str | None:
    """Where the scenario was, so that files it names are found; None if that is not to be looked at."""
    scenario, folder = run.meta.get("scenario"), run.meta.get("folder")
    if not isinstance(scenario, str):
        return None
    if limits.root is not None:
        return scenario if why_outside(scenario, Path(limits.root)) is None else None
    return str(Path(folder) / Path(scenario).name) if isinstance(folder, str) else scenario
