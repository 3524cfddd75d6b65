"""Episodes that a controller of the caller drives, as jobs of the processes that run benchmarks.

The controller is pickled once, into a file that every process reads. Each episode unpickles it anew, so that what it
remembers of one episode never reaches the next one, whichever process runs that.
"""

from __future__ import annotations

import copy
import pickle
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, cast

from irsim.benchmarks.episode import Job, scenario_of
from irsim.diagnostics.errors import InputError, PlacementError, PolicyError
from irsim.env import Env
from irsim.episodes.episode import horizon_of
from irsim.episodes.run_report import RunPlan, run_result
from irsim.policies.policy import FunctionPolicy
from irsim.runs.recorder import recording
from irsim.scenario.limits import Limits
from irsim.simulation.outcome import is_over

__all__ = ["Controller", "ControllerJob", "packed", "run_controlled"]

Controller = Callable[[Env], Any]
"""Called with the environment before each step; its result is the action of :meth:`irsim.Env.step`."""
_MAIN = b"__main__"


@dataclass(frozen=True)
class ControllerJob(Job):
    """One scenario under a controller.

    Attributes:
        controller: File of the pickled controller.
        called: Its name.
        folder: Folder in which each episode is recorded, as ``seed-SEED``.
        places: Folders in which modules are found.
        own: The controller itself, if only this process runs episodes.
    """

    controller: str = ""
    called: str = ""
    folder: str = ""
    places: tuple[str, ...] = ()
    own: Controller | None = field(default=None, compare=False)


def packed(controller: Controller) -> bytes:
    """A controller as bytes that other processes can read.

    Other processes do not import the running script or notebook. The library cloudpickle, where it is installed, sends
    a controller from there nevertheless.

    Raises:
        InputError: It cannot be sent.
    """
    why = "it is defined in the running script or notebook, which other processes do not import"
    try:
        data = pickle.dumps(controller)
    except Exception as error:
        data, why = _MAIN, str(error)
    if _MAIN in data and find_spec("cloudpickle") is not None:
        try:
            data = import_module("cloudpickle").dumps(controller)
        except Exception as error:
            raise _not_sent(str(error)) from error
    elif _MAIN in data:
        raise _not_sent(why)
    return data


def _not_sent(why: str) -> InputError:
    fix = (
        "put it into a module, such as controller.py, as a function or as a class whose instances can be pickled, and "
        "import it; or install cloudpickle; or give workers=1"
    )
    return InputError(f"the controller cannot be sent to other processes: {why}", fix, "controller")


@lru_cache(maxsize=2)
def _bytes_of(file: str) -> bytes:
    return Path(file).read_bytes()


def _fresh(job: ControllerJob) -> Controller:
    """The controller at the start of an episode.

    Raises:
        InputError: It cannot be copied.
    """
    if job.own is None:
        fresh: Controller = pickle.loads(_bytes_of(job.controller))
        return fresh
    try:
        return copy.deepcopy(job.own)
    except Exception as error:
        what = f"the controller cannot be copied for each episode: {error}"
        raise InputError(what, "make it in a function, or write its method __deepcopy__", "controller") from error


def run_controlled(job: ControllerJob, seeds: Sequence[int]) -> Iterator[dict[str, Any]]:
    """Run and record one episode for each seed, until every robot has arrived or stopped, or its horizon is reached.

    Args:
        job: Scenario and controller.
        seeds: The seeds.

    Yields:
        ``run``: the result of each seed as JSON types; None if the seed leaves no room for an object.

    Raises:
        PolicyError: The controller failed.
    """
    sys.path.extend(place for place in job.places if place not in sys.path)
    for seed in seeds:
        controller = _fresh(job)
        try:
            env = Env(scenario_of(job), seed=seed, display=False, headless=True, log_level="ERROR")
        except PlacementError:
            yield {"run": None}
            continue
        try:
            yield {"run": _run(job, env, controller)}
        finally:
            env.end(ending_time=0.0)


def _run(job: ControllerJob, env: Env, controller: Controller) -> dict[str, Any]:
    """The result of one episode."""
    simulation = env.simulation
    horizon, source = horizon_of(simulation, job.steps, Limits(**dict(job.limits)))
    driver = FunctionPolicy(cast("Any", controller), name=job.called)  # for its name
    plan = RunPlan(job.name, horizon, source, strict=job.strict, imports=job.imports, policy=driver)
    folder = Path(job.folder, f"seed-{env.seed}")
    shutil.rmtree(folder, ignore_errors=True)  # of a process that died in this episode
    with recording(simulation, job.name, folder, horizon=horizon, options=plan.record_options()) as recorder:
        assert recorder is not None
        for step in range(horizon):
            if env.done() or (not env.robot_list and is_over(simulation)):
                break
            try:
                env.step(controller(env))
            except Exception as error:
                what = f"the controller failed with seed {env.seed} in step {step}: {type(error).__name__}: {error}"
                raise PolicyError("policy-failed", what, "give workers=1 to debug it in this process") from error
            recorder.write_if_due()
        result = run_result(simulation, env.events, plan)
        result.reproduce = f"irsim.episodes({job.name!r}, {job.called}, seeds=[{env.seed}])"
        recorder.finish(result)
    return result.model_dump(mode="json")
