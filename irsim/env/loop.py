"""The loop of an environment: step, rollout, advance, and what stands in the way of a step."""

from __future__ import annotations

from typing import Any

from irsim.common.log import LEVELS
from irsim.env.live import drive_by_keyboard
from irsim.env.queries import get_object_by_name
from irsim.env.state import EnvState
from irsim.objects.actions import assign_actions, beyond_limits
from irsim.objects.base import SimObject
from irsim.simulation.active_env import use
from irsim.simulation.episode_recorder import EpisodeRecorder
from irsim.simulation.events import read_events
from irsim.simulation.trace import Rollout, record_rollout

__all__ = ["advance", "done", "log_collisions", "pause", "refresh", "resume", "rollout", "step"]


def step(env: EnvState, action: Any = None, action_id: Any = None) -> None:
    """Advance by one period.

    Args:
        action: None lets behaviors drive. One control vector, a list of them (None inside = behavior), or a mapping
            ``{name or id: vector}``; vectors are in the command frame of the drive.
        action_id: Id or name of the target, or a list of them; default: the first robot, and on from there.

    Raises:
        ValueError: Unknown target, wrong number of numbers, or an action in external mode.
    """
    use(env)
    if (env.pause_flag or env.quit_flag or env.debug_flag or env._ended) and _held(env):
        return
    simulation = env._simulation
    if env.world_param.step_mode == "external":
        if action is not None:
            raise ValueError("step_mode 'external' takes no actions: move the objects with set_state")
        simulation.step_external()
    else:
        if action is not None:
            for view, control in assign_actions(env._objects, action, action_id, env.logger.warning_once):
                simulation.impose(view.row, control)
                if view.id not in env._limit_warnings:
                    _report_limits(env, view, control)
        if env.world_param.control_mode == "keyboard":
            drive_by_keyboard(env)
        simulation.step()
    _after_step(env)


def _report_limits(env: EnvState, view: SimObject, control: list[float]) -> None:
    """Say, once per object, that its limits cut an action."""
    if view.static or not beyond_limits(view, control):
        return
    env._limit_warnings.add(view.id)
    low, high = (", ".join(f"{v:.6g}" for v in limit[:, 0]) for limit in view.get_vel_range())
    given = ", ".join(f"{v:.6g}" for v in control)
    env.logger.warning(
        f"{view.name}: action [{given}] is cut to the limits of its drive, now [{low}] to [{high}] "
        "(vel_min, vel_max, acce; said once per object)"
    )


def _after_step(env: EnvState) -> None:
    env._label = None
    if env._simulation.state.event_count != env._events_seen:
        log_collisions(env)


def _held(env: Any) -> bool:
    """What stands in the way of a step; True when the step is left out."""
    env._ended = False
    if env.quit_flag:
        env.quit()
    if env.pause_flag:
        return True
    if env.debug_flag:
        if env.debug_count <= 0:
            return True
        env.debug_count -= 1
    return False


def rollout(env: EnvState, steps: int, *, until_done: bool = True) -> Rollout:
    """Let behaviors drive for up to ``steps`` periods, in one go, and return everything that happened.

    The result is bit for bit what as many calls of :func:`step` give.

    Args:
        steps: Periods at most.
        until_done: End as soon as every robot has arrived or stopped.
    """
    if env.world_param.step_mode == "external":
        raise ValueError("rollout needs step_mode 'internal'")
    env._ended = False
    result = record_rollout(env._simulation, steps, until_done=until_done)
    _after_step(env)
    return result


def advance(env: EnvState, steps: int, *, until_done: bool = True, recorder: EpisodeRecorder | None = None) -> int:
    """Like :func:`rollout`, keeping nothing here.

    Args:
        steps: Periods at most.
        until_done: End as soon as every robot has arrived or stopped.
        recorder: Keeps what happens.

    Returns:
        Periods executed.
    """
    env._ended = False
    if env.world_param.step_mode == "external":
        done = _wait(env, steps, until_done, recorder)
    else:
        done = (recorder or env._simulation).advance(steps, until_done=until_done)
    _after_step(env)
    return done


def _wait(env: EnvState, steps: int, until_done: bool, recorder: EpisodeRecorder | None) -> int:
    """Periods in which the caller, who alone could, moves nothing."""
    for done in range(steps):
        if until_done and env._simulation.state.done(0):
            return done
        env._simulation.step_external()
        if recorder is not None:
            recorder.write_if_due()
    return steps


def done(env: EnvState, mode: str = "all") -> bool | None:
    """Whether the robots are through: arrived, or stopped by a collision.

    Args:
        mode: ``all`` robots or ``any`` of them; another word gives None.
    """
    simulation = env._simulation
    if mode == "all":
        return simulation.state.done(0)
    ended = (simulation.arrived | simulation.stopped)[simulation.robots]
    return bool(ended.any()) if mode == "any" else None


def refresh(env: EnvState) -> None:
    """Evaluate collisions and sensors anew after objects were moved; time does not advance."""
    env._simulation.refresh()


def pause(env: EnvState) -> None:
    """Let ``step`` do nothing until ``resume``."""
    env.pause_flag = True


def resume(env: EnvState) -> None:
    """Go on after ``pause`` or debugging."""
    env.pause_flag = env.debug_flag = False
    env._label = None


def log_collisions(env: EnvState) -> None:
    """Log the collisions of robots that have not been logged yet."""
    env._events_seen = env._simulation.state.event_count
    if env.logger.level > LEVELS["WARNING"]:
        return
    events = read_events(env._simulation, start=env._events_logged)
    env._events_logged += len(events)
    for event in events:
        if event.kind != "collision":
            continue
        pair = [event.object, event.partner]
        for name, other in (pair, pair[::-1]):
            view = get_object_by_name(env, str(name))
            if view is not None and view.role == "robot" and view.collision:
                state = [round(float(v), 3) for v in view.state[:, 0]]
                env.logger.warning(f"{name} collided with {other} at state {state}")
