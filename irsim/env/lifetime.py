"""Methods of an environment that start and end it: reading the file, reset, reload, seeds, end."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NoReturn
from weakref import ref

from irsim.compat.objects.view import ScriptObject, make_view
from irsim.diagnostics.diagnostic import Diagnostic, format_path
from irsim.diagnostics.errors import CodedError
from irsim.env.drawing import finish_drawing, note_unseen, redraw
from irsim.env.loop import log_collisions
from irsim.env.object_list import count_ids, restore_objects
from irsim.env.parameters import EnvParam, WorldParam, checked_step_mode
from irsim.env.policies import attach, driven, remember_written
from irsim.env.queries import objects
from irsim.env.state import EnvState
from irsim.objects.lifecycle import attach_python
from irsim.scenario.open import open_scenario
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.simulation.active_env import next_seed, use
from irsim.simulation.random_streams import check_seed, fresh_seed
from irsim.simulation.simulation import Simulation

__all__ = ["end", "open_world", "quit_program", "reload", "reset", "set_random_seed"]


def open_world(env: EnvState, world_name: str | Path | ResolvedScenario | None) -> None:
    """Read a scenario and build its first scene."""
    if isinstance(world_name, ResolvedScenario):
        scenario = world_name
    else:
        scenario, warnings = open_scenario(world_name, strict=env._strict)
        for warning in warnings:
            (env.logger.hint if warning.severity == "hint" else env.logger.warning)(_one_line(warning))
    mode = checked_step_mode(env._wanted_mode if env._wanted_mode is not None else scenario.world.step_mode)
    chosen = env._wanted_seed if env._wanted_seed is not None else scenario.world.seed
    chosen = next_seed() if chosen is None else chosen
    plain, scenario = scenario, driven(scenario, env._policy)
    use(env)
    seed = fresh_seed() if chosen is None else check_seed(chosen)
    simulation = Simulation(scenario, [seed], history=True)
    simulation.report = env.logger.error_once
    simulation.owner = ref(env)
    simulation.make_view = make_view
    attach_python(simulation)
    env._originals = simulation.views()
    attach(simulation, env._policy)
    env.scenario, env._seed, env._simulation = scenario, seed, simulation
    remember_written(env, plain, scenario)
    env._objects = list(env._originals)
    env._exchanged = False
    env._world = env._world_class(simulation)
    env.world_param = WorldParam(simulation, mode)
    here = ref(env)
    env.env_param = EnvParam(lambda: _objects_of(here()), env.logger)
    count_ids(env)
    env._limit_warnings = set()
    env._next_seed = None
    env._events_seen = env._events_logged = 0
    env._label, env._written_status = scenario.world.status, None


def reset(env: EnvState, random: bool = False) -> None:
    """Start a new episode at time 0, with every object in its initial state.

    Args:
        random: Draw the next scene, with new random shapes, poses and goals, instead of repeating the present one.

    Raises:
        PlacementError: No free space was found for a random object of the next scene.
    """
    env._ended = False
    use(env)
    if random and env._next_seed is not None:
        set_random_seed(env, env._next_seed)
    if random and env._exchanged:
        restore_objects(env)
    else:
        env._simulation.reset(next_scene=random)
    if random:
        count_ids(env)
    _start_over(env, "Reset")


def reload(env: EnvState, world_name: str | Path | None = None) -> None:
    """Read the scenario file again, or another one, and start it as ``make`` does, with the present seed.

    All objects are new; variables that still hold an old object show its last state. The figure stays open.

    Args:
        world_name: Another file; by default the present one.

    Raises:
        CodedError: Bridges are open, which know the present scene only.
    """
    if env._simulation.movers:
        what = "the scenario cannot be read again while its bridges are open"
        raise CodedError("bridge-mismatch", what, "leave the with statement of irsim.connect first")
    env._ended = False
    name = env.world_name if world_name is None else world_name
    env._wanted_seed = env._seed
    open_world(env, name)
    env.world_name = name
    _start_over(env, env.scenario.world.status)


def _start_over(env: EnvState, label: str | None) -> None:
    env.pause_flag = env.debug_flag = env.reset_flag = False
    env.debug_count = 0
    env.reload_flag = False
    env._events_logged = 0
    env._label, env._written_status = label, None
    redraw(env)
    log_collisions(env)


def set_random_seed(env: Any, seed: int | None = None, reload: bool = False) -> None:
    """Set the seed; the next ``reset`` starts the first scene of this seed.

    Args:
        seed: Integer from 0 to 2**64 - 1; None draws it from fresh entropy.
        reload: Also read the scenario file again and start it with this seed.
    """
    env._next_seed = None
    env._seed = fresh_seed() if seed is None else check_seed(seed)
    env._simulation.reseed([env._seed])
    env._wanted_seed = env._seed
    if reload:
        env.reload()


def end(env: EnvState, ending_time: float = 3.0, **kwargs: Any) -> None:
    """Write the animation if frames were kept, and close the figure.

    The environment remains usable: drawing after ``end`` starts a new figure and a new animation. A second call right
    after the first has no effect.

    Args:
        ending_time: Time for which a window stays open before it closes [s].
        **kwargs: Options of the animation: ``ani_name``, ``suffix``, ``last_frame_duration``, ``fps``, …
    """
    if env._ended and env._plot is None:
        return
    if env._unseen:
        note_unseen(env)
    finish_drawing(env, ending_time, **kwargs)
    env._ended = True
    env.logger.info(f"{env} ended after {env._world.time} s")


def quit_program(env: Any) -> NoReturn:
    """End the environment and exit the program."""
    env.end(ending_time=1.0)
    raise SystemExit(0)


def _objects_of(env: EnvState | None) -> list[ScriptObject]:
    return [] if env is None else objects(env)


def _one_line(finding: Diagnostic) -> str:
    where = f"line {finding.line}: " if finding.line else ""
    fix = f" ({finding.fix})" if finding.fix else ""
    return f"{where}{format_path(finding.path)}: {finding.message}{fix} [{finding.code}]"
