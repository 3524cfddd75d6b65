"""Methods of an environment that advance time: step, rollout, advance, pause."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NoReturn

from irsim.common.arguments import check_steps
from irsim.common.log import LEVELS
from irsim.diagnostics.errors import InputError
from irsim.env.drawing import note_unseen
from irsim.env.live import drive_by_keyboard
from irsim.env.queries import get_object_by_name
from irsim.env.state import EnvState
from irsim.objects.actions import assign_actions
from irsim.simulation.active_env import use
from irsim.simulation.events import BETWEEN_STEPS, Event, read_events
from irsim.simulation.outcome import at_rest
from irsim.simulation.protocols import EpisodeRecorder
from irsim.simulation.trace import Rollout, record_rollout

__all__ = ["advance", "done", "log_collisions", "pause", "refresh", "resume", "rollout", "step"]


_STEPS_UNSEEN = 20
"""Steps without a frame after which the user is told how to see them."""


def step(env: EnvState, action: Any = None, action_id: Any = None) -> None:
    """Advance the simulation by one period, ``step_time`` [s].

    Args:
        action: One control vector, a list of control vectors, or a mapping ``{name or id: vector}``. Vectors are in the
            command frame of the drive: for ``diff`` forward speed [m/s] and yaw rate [rad/s]. None, also as an entry of
            the list, leaves objects to their behaviors.
        action_id: Id or name of the target, or a list of them; by default actions go to the objects in order, from the
            first one.

    Raises:
        ValueError: A target does not exist, a vector has the wrong size, an action is given in external mode, or there
            are more actions than objects in a ``strict`` environment.
    """
    use(env)
    if (env.pause_flag or env.quit_flag or env.debug_flag or env._ended) and _held(env):
        return
    simulation = env._simulation
    if env.world_param.step_mode == "external":
        if action is not None:
            raise InputError(
                "step_mode 'external' takes no actions",
                "move the objects with set_state, or set step_mode to 'internal'",
            )
        simulation.step_external()
    else:
        if action is not None:
            surplus: Callable[[str], None] = env.logger.warning_once
            if env._strict:
                surplus = _refuse
            for view, control in assign_actions(env._objects, action, action_id, surplus):
                if simulation.impose(view.row, control) and view.id not in env._limit_warnings:
                    _report_limits(env, view, control)
        if env.world_param.control_mode == "keyboard":
            drive_by_keyboard(env)
        simulation.step()
    _after_step(env)


def _refuse(message: str) -> NoReturn:
    """Refuse surplus actions in a strict environment."""
    raise InputError(message)


def _report_limits(env: EnvState, view: Any, control: Sequence[float]) -> None:
    """Log, once per object, that its limits cut an action."""
    if view.static:
        return
    env._limit_warnings.add(view.id)
    low, high = (", ".join(f"{v:.6g}" for v in limit[:, 0]) for limit in view.get_vel_range())
    given = ", ".join(f"{v:.6g}" for v in control)
    env.logger.warning(
        f"{view.name}: action [{given}] is cut to the limits of its drive, now [{low}] to [{high}] "
        "(vel_min, vel_max, acce; logged once per object)"
    )


def _after_step(env: EnvState) -> None:
    env._label = env._written_status = None
    if env._unseen:
        note_unseen(env, _STEPS_UNSEEN)
    if env._simulation.state.event_count != env._events_seen:
        log_collisions(env)


def _held(env: Any) -> bool:
    """Return whether the step must be skipped because of a pause or of debugging; quit if that was requested."""
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
    """Advance the simulation by up to ``steps`` periods in one call, driven by behaviors, and return the whole record.

    The result is the same as after as many calls of :func:`step`, bit for bit.

    Args:
        steps: Largest number of periods.
        until_done: Stop as soon as every robot has arrived or stopped.
    """
    if env.world_param.step_mode == "external":
        raise InputError("rollout needs step_mode 'internal'")
    env._ended = False
    result = record_rollout(env._simulation, steps, until_done=until_done)
    _after_step(env)
    return result


def advance(env: EnvState, steps: int, *, until_done: bool = True, recorder: EpisodeRecorder | None = None) -> int:
    """Advance the simulation by up to ``steps`` periods in one call, driven by behaviors, without keeping a record.

    Args:
        steps: Largest number of periods.
        until_done: Stop as soon as every robot has arrived or stopped.
        recorder: Recorder that writes the episode to a file.

    Returns:
        Number of executed periods.

    Raises:
        InputError: ``steps`` is not a whole number from 0 on.
    """
    # The usual case needs no call, as recorded runs advance in small pieces.
    if type(steps) is not int or not 0 <= steps < 2**63:
        steps = check_steps(steps)
    env._ended = False
    if env.world_param.step_mode == "external":
        done = _wait(env, steps, until_done, recorder)
    else:
        done = (recorder or env._simulation).advance(steps, until_done=until_done)
    _after_step(env)
    return done


def _wait(env: EnvState, steps: int, until_done: bool, recorder: EpisodeRecorder | None) -> int:
    """Advance time in external mode, in which only the caller moves objects; return the number of periods."""
    for done in range(steps):
        if until_done and env._simulation.state.done(0):
            return done
        env._simulation.step_external()
        if recorder is not None:
            recorder.write_if_due()
    return steps


def done(env: EnvState, mode: str = "all") -> bool | None:
    """Return whether the robots have arrived or have been stopped by a collision.

    ``world.time_limit`` does not count, as in IR-SIM 2.12: it stays false for a robot that is stuck, so a loop must
    count its steps. ``irsim.run`` and ``irsim.episodes`` end at the time limit.

    Args:
        mode: ``all`` asks for all robots, ``any`` for at least one; any other word returns None.
    """
    simulation = env._simulation
    if mode == "all":
        return simulation.state.done(0)
    ended = at_rest(simulation)[simulation.robots]
    return bool(ended.any()) if mode == "any" else None


def refresh(env: EnvState) -> None:
    """Update collisions and sensors after objects were moved; time does not advance."""
    env._simulation.refresh()


def pause(env: EnvState) -> None:
    """Pause the simulation: ``step`` has no effect until ``resume`` is called."""
    env.pause_flag = True
    env._written_status = None


def resume(env: EnvState) -> None:
    """Continue after ``pause`` or debugging."""
    env.pause_flag = env.debug_flag = False
    env._label = env._written_status = None


def log_collisions(env: EnvState) -> None:
    """Log the collisions of robots, and their contacts between steps, that have not been logged yet."""
    env._events_seen = env._simulation.state.event_count
    if env.logger.level > LEVELS["WARNING"]:
        return
    events = read_events(env._simulation, start=env._events_logged)
    env._events_logged += len(events)
    for event in events:
        if event.kind in BETWEEN_STEPS:
            _log_between_steps(env, event)
        if event.kind != "collision":
            continue
        pair = [event.object, event.partner]
        for name, other in (pair, pair[::-1]):
            view = get_object_by_name(env, str(name))
            if view is not None and view.role == "robot" and view.collision:
                state = [round(float(v), 3) for v in view.state[:, 0]]
                env.logger.warning(f"{name} collided with {other} at state {state}")


def _log_between_steps(env: EnvState, event: Event) -> None:
    views = [get_object_by_name(env, str(name)) for name in (event.object, event.partner)]
    if any(view is not None and view.role == "robot" for view in views):
        what = "passed through" if event.kind == "passed_through" else "touched"
        place = f"at {event.time:.3f} s, contact near ({event.x:.2f}, {event.y:.2f})"
        env.logger.warning(f"{event.object} {what} {event.partner} between two steps {place}")
