"""Behaviors as policies: they run in the engine, in place of the behaviors in the scenario."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from irsim.common.arrays import Floats
from irsim.components.options import BehaviorOptions, behavior_fields
from irsim.diagnostics.errors import PolicyError, ScenarioError
from irsim.options.knowledge import Fact
from irsim.options.registry import BEHAVIORS
from irsim.policies.observations import Observations
from irsim.policies.parts import check_parts, part_of
from irsim.policies.policy import Policy
from irsim.scenario.behavior_override import AS_WRITTEN, merged_options, parse_behavior, raise_if_about_behavior
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario
from irsim.scenario.single_object import read_object

__all__ = ["TASK_AND_BEHAVIOR", "BehaviorPolicy", "with_policy"]

TASK_AND_BEHAVIOR = ("behavior", "group_behavior", "wander", "loop", "range_low", "range_high", "target_roles")
"""Fields of an object that may change with its behavior."""


class BehaviorPolicy(Policy):
    """A behavior for all robots, or their own (``as-written``); it never sees observations.

    Args:
        text: The behavior as text, see :func:`irsim.scenario.behavior_override.parse_behavior`.

    Attributes:
        options: Its keys; None for the behaviors of the scenario.
    """

    output = "velocity"
    stochastic = False  # what it draws belongs to the scenario, which says so itself

    def __init__(self, text: str) -> None:
        self.text = self.source = text.strip()
        self.options: dict[str, Any] | None = parse_behavior(text)
        self.name = AS_WRITTEN if self.options is None else str(self.options["name"])

    def known(self) -> frozenset[Fact] | None:
        """The information of the behavior with its options; None for ``as-written`` and behaviors of Python."""
        feature = None if self.options is None else BEHAVIORS.get(self.name)
        if feature is None or self.options is None:
            return None
        try:
            made = feature.options.model_validate(self.options)
        except ValidationError:  # said where it drives robots
            return None
        return made.known() if isinstance(made, BehaviorOptions) else None

    def act(self, observations: Observations) -> Floats:
        """Refuse, because behaviors run in the engine.

        Raises:
            PolicyError: Always.
        """
        raise PolicyError(
            "policy-failed",
            f"the behavior {self.name!r} runs in the engine and takes no observations",
            "give it to irsim.make, irsim.batch, env.set_policy or irsim.benchmark",
        )


def with_policy(scenario: ResolvedScenario, policy: Policy | None) -> ResolvedScenario:
    """The scenario with the behaviors that a policy, or its parts, stand for; unchanged for all other policies.

    Raises:
        InputError: The behavior has an unknown option or an invalid value, or cannot drive one of the robots.
        PolicyError: A part of a policy of several has no robot.
    """
    if policy is None:
        return scenario
    check_parts(policy, scenario.objects)
    if not any(isinstance(one, BehaviorPolicy) and one.options is not None for one in (policy, *policy.parts.values())):
        return scenario
    objects = list[ObjectRecord]()
    for record in scenario.objects:
        part = part_of(policy, record)
        own = policy.parts[part] if part is not None else policy
        options = own.options if isinstance(own, BehaviorPolicy) else None
        objects.append(record if options is None else _changed(record, options, scenario))
    return replace(scenario, objects=objects)


def _changed(record: ObjectRecord, options: Mapping[str, Any], scenario: ResolvedScenario) -> ObjectRecord:
    """A robot with another behavior, which keeps its task; other objects as they are."""
    if record.role != "robot" or record.kinematics is None:
        return record
    keys = merged_options(_keys(record.behavior), _keys(record.group_behavior), options)
    drive = {"name": str(getattr(record.kinematics, "name", ""))}
    try:
        made, result = read_object("robot", {"kinematics": drive, "behavior": keys}, scenario.world, record.id)
    except ScenarioError as error:
        for item in error.diagnostics:
            raise_if_about_behavior(item, options)
        raise
    for item in result:
        raise_if_about_behavior(item, options)
    task = behavior_fields(made.behavior, scenario.world.bounds)
    given = {key: value for key, value in task.items() if key in keys}  # scripts may have changed the others
    return replace(record, behavior=made.behavior, group_behavior=None, **given)


def _keys(options: Any) -> dict[str, Any] | None:
    return None if options is None else dict(options.model_dump(exclude_unset=True))
