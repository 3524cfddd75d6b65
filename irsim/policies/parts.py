"""Which part of a policy drives which robot: several policies can share the robots of a world."""

from __future__ import annotations

from collections.abc import Sequence

from irsim.common.text import clean, listed
from irsim.diagnostics.diagnostic import nearest
from irsim.diagnostics.errors import PolicyError
from irsim.policies.policy import Policy
from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["OTHERS", "check_parts", "part_of", "robots_of_parts"]

OTHERS = "others"
"""Selection of the robots that no other one has."""
_LISTED = 10
"""Number of names and tags that a message lists."""


def part_of(policy: Policy, record: ObjectRecord) -> str | None:
    """The selection of a policy of several that has a robot: the first with its name or one of its tags.

    Returns:
        The selection; None if no policy drives the robot, which then keeps its own behavior.
    """
    chosen = next((key for key in policy.parts if key == record.name or key in record.tags), None)
    return OTHERS if chosen is None and OTHERS in policy.parts else chosen


def robots_of_parts(policy: Policy, records: Sequence[ObjectRecord]) -> dict[str, list[str]]:
    """The names of the robots that each policy of several drives; empty for a policy that drives all robots."""
    robots = {key: list[str]() for key in policy.parts}
    for record in records if robots else ():
        if record.role == "robot" and record.kinematics is not None and (part := part_of(policy, record)) is not None:
            robots[part].append(record.name)
    return robots


def check_parts(policy: Policy, records: Sequence[ObjectRecord]) -> None:
    """Refuse a policy of several if one of its selections has no robot.

    Raises:
        PolicyError: No robot has such a name or tag, or every robot with it belongs to an earlier selection.
    """
    robots = [record for record in records if record.role == "robot" and record.kinematics is not None]
    for key, names in robots_of_parts(policy, records).items():
        if names:
            continue
        known = list(dict.fromkeys([*(tag for one in robots for tag in one.tags), *(one.name for one in robots)]))
        near = nearest(key, known)
        fix = f"did you mean {clean(near)}?" if near and near != key else f"choose from {listed(known, _LISTED)}"
        fix = fix if known else "give the scenario a robot that can move"
        raise PolicyError("policy-mismatch", f"policy {policy.name!r} {_why(key, known)}", fix, where="policy")


def _why(key: str, known: Sequence[str]) -> str:
    """Why a selection is empty, as the second half of a sentence."""
    if key == OTHERS:
        return "has nothing to do for 'others': the other selections have every robot"
    if key in known:
        return f"has nothing to do for {clean(key)!r}: the selections before it have all of these robots"
    return f"has a part for {clean(key)!r}, and no robot has this name or tag"
