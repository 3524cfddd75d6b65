"""Methods of an environment that keep its present state, return to it, and copy the environment."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

from irsim.common.log import LEVELS
from irsim.diagnostics.errors import InputError
from irsim.env.drawing import redraw
from irsim.env.policies import as_written
from irsim.env.state import EnvState
from irsim.simulation.active_env import last_used, use
from irsim.simulation.snapshot import dump, load, load_simulation, save_simulation

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["copy_env", "reduce", "restore", "snapshot"]

_FLAGS = ("pause_flag", "quit_flag", "debug_flag", "reset_flag", "reload_flag", "save_figure_flag", "debug_count")
_OWN = ("_seed", "_next_seed", "_wanted_seed", "_ended", "_title", "_label", "_written_status", "_limit_warnings")
_SEEN = ("_events_seen", "_events_logged")
_OWNER = "an environment"
_MODES = ("step_mode", "control_mode", "collision_mode")


def snapshot(env: EnvState) -> bytes:
    """The present state, from which :func:`restore` goes on bit for bit: planning and checkpoints need it.

    It has the state of the engine, all random streams, and what behaviors, drives, policies and sensors in Python
    remember. It can be restored as often as you like, in this environment, in a copy of it, or in one that was made
    of the same scenario by the same version of irsim. Restore only snapshots that you trust: they are pickles.

    Raises:
        InputError: Code in Python keeps something that pickle cannot store, or a bridge is open.
    """
    values = {name: getattr(env, name) for name in (*_FLAGS, *_OWN, *_SEEN)}
    modes = {name: getattr(env.world_param, name) for name in _MODES}
    return dump((values, modes, save_simulation(env._simulation)), env._simulation, _OWNER)


def restore(env: EnvState, data: bytes) -> None:
    """Return to the state of a snapshot.

    Raises:
        InputError: It is of another scenario, or objects were added or deleted in between.
    """
    values, modes, simulation = load(data, env._simulation, _OWNER)
    load_simulation(env._simulation, simulation)
    for name, value in values.items():
        setattr(env, name, copy.copy(value))
    for name, value in modes.items():
        setattr(env.world_param, name, value)
    redraw(env)


def reduce(env: Any) -> tuple[Any, ...]:
    """The function and arguments with which pickle makes the environment again, without its figure and log file.

    Raises:
        InputError: Objects were added or deleted, or the state cannot be saved.
    """
    if env._exchanged:
        what = "objects were added or deleted, and only an environment with the objects of its file can be copied"
        raise InputError(what, "copy it before that, or put the objects into the scenario")
    return _remake, (type(env), as_written(env.scenario, env._written), _options(env), env.world_name, snapshot(env))


def copy_env(env: Any, memo: dict[int, Any]) -> Any:
    """A copy that goes on bit for bit as the environment does; both share the scenario, which does not change."""
    active = last_used()
    make, (kind, scenario, options, name, data) = reduce(env)
    made = make(kind, scenario, options | {"policy": copy.deepcopy(env._policy, memo)}, name, data)
    if active is not None:
        use(active)
    return made


def _options(env: Any) -> dict[str, Any]:
    level = next(name for name, number in LEVELS.items() if number == env.logger.level)
    names = ("save_ani", "ani_kwargs", "full", "headless")
    options: dict[str, Any] = {name: getattr(env, name) for name in names}
    return options | {"display": False, "log_level": level, "strict": env._strict, "policy": env._policy}


def _remake(kind: Any, scenario: ResolvedScenario, options: dict[str, Any], name: Any, data: bytes) -> Any:
    """An environment of a scenario, in the state of a snapshot; it shows no window."""
    level = options.pop("log_level")
    env = kind(scenario, seed=0, log_level="CRITICAL", **options)  # its first scene is not looked at
    env.logger.level = LEVELS[level]
    env.world_name = name
    restore(env, data)
    return env
