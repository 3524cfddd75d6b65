"""Methods of an environment that decide for its robots: a policy, and modules of user behaviors."""

from __future__ import annotations

import importlib
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.env.state import EnvState
from irsim.objects.extensions.behaviors import attach_python_behaviors
from irsim.objects.lifecycle import amend_all

if TYPE_CHECKING:
    from irsim.policies.catalog import PolicySource
    from irsim.policies.policy import Policy
    from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario
    from irsim.simulation.simulation import Simulation

__all__ = ["as_written", "attach", "drive_again", "driven", "load_behavior", "opened", "remember_written", "set_policy"]


def opened(policy: PolicySource | None) -> Policy | None:
    """Open the policy that a caller gives; None stands for the behaviors of the scenario."""
    if policy is None:
        return None
    from irsim.policies.catalog import open_policy  # most environments have no policy, and start without this room

    return open_policy(policy)


def driven(scenario: ResolvedScenario, policy: Policy | None) -> ResolvedScenario:
    """Return the scenario with the behavior that a policy stands for; unchanged for all other policies."""
    if policy is None:
        return scenario
    from irsim.policies.behavior import with_policy

    return with_policy(scenario, policy)


def attach(simulation: Simulation, policy: Policy | None) -> None:
    """Let a policy drive the robots of a new simulation."""
    if policy is not None:
        from irsim.policies.driver import attach_policy

        attach_policy(simulation, policy)


def set_policy(env: EnvState, policy: PolicySource | None) -> None:
    """Let a policy drive all robots that can move, from the next step on; objects keep their states.

    Actions that are given to ``step`` take precedence over it. ``reset`` and ``reload`` keep it.

    Args:
        policy: An argument of :func:`irsim.open_policy`: a policy, a function of observations, a name such as
            ``orca``. None gives the robots back to the behaviors of the scenario.

    Raises:
        PolicyError: The policy cannot drive these robots (``policy-mismatch``); nothing is changed then.
        InputError: There is no such policy, or a behavior cannot drive these robots.
    """
    from irsim.policies.behavior import with_policy
    from irsim.policies.driver import attach_policy

    chosen, simulation = opened(policy), env._simulation
    now = simulation.scenario
    plain = replace(now, objects=[_as_written(record, env._written) for record in now.objects])
    wanted = with_policy(plain, chosen)
    attach_policy(simulation, chosen)
    env.scenario = with_policy(as_written(env.scenario, env._written), chosen)
    remember_written(env, plain, wanted)
    env._policy = chosen
    if wanted.objects != now.objects:
        amend_all(simulation, wanted.objects)


def remember_written(env: EnvState, plain: ResolvedScenario, driven: ResolvedScenario) -> None:
    """Remember the records that a policy has replaced, to restore their behaviors later."""
    pairs = zip(plain.objects, driven.objects, strict=True)
    env._written = {before.id: before for before, after in pairs if before is not after}


def drive_again(env: EnvState) -> None:
    """Give robots that have come the behavior that drives them; policies in Python find new robots themselves."""
    if env._policy is None:
        return
    from irsim.policies.behavior import BehaviorPolicy

    if any(isinstance(one, BehaviorPolicy) for one in (env._policy, *env._policy.parts.values())):
        set_policy(env, env._policy)


def as_written(scenario: ResolvedScenario, written: dict[int, ObjectRecord]) -> ResolvedScenario:
    """The scenario with the behaviors that a policy has replaced."""
    return replace(scenario, objects=[_as_written(record, written) for record in scenario.objects])


def _as_written(record: ObjectRecord, written: dict[int, ObjectRecord]) -> ObjectRecord:
    """The record with the behavior that the scenario gives it."""
    before = written.get(record.id)
    if before is None:
        return record
    from irsim.policies.behavior import TASK_AND_BEHAVIOR

    own: dict[str, Any] = {key: getattr(before, key) for key in TASK_AND_BEHAVIOR}
    return replace(record, **own)


def load_behavior(env: EnvState, behaviors: str = "behavior_methods") -> None:
    """Import a module that registers behaviors, and construct behaviors that are classes again.

    Python executes a module once per process, however often it is loaded. If the import fails, an error is logged.

    Args:
        behaviors: Name of a module beside the running script, or anywhere on the path of Python.
    """
    folder = str(Path(sys.argv[0]).resolve().parent) if sys.argv and sys.argv[0] else str(Path.cwd())
    if folder not in sys.path:
        sys.path.append(folder)
    try:
        importlib.import_module(behaviors)
    except ImportError as error:
        env.logger.error(f"module {behaviors!r} could not be loaded: {error}")
        return
    attach_python_behaviors(env._simulation, anew=True)
