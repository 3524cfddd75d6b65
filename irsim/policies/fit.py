"""Checks that a policy can drive the robots of a scenario, before the first step."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from irsim.common.arguments import as_given, is_number
from irsim.diagnostics.diagnostic import nearest
from irsim.diagnostics.errors import PolicyError
from irsim.policies.observe import Beams, beams_of
from irsim.policies.policy import Needs

if TYPE_CHECKING:
    from irsim.policies.policy import Policy
    from irsim.simulation.simulation import Simulation

__all__ = ["check_declaration", "check_fit", "drive_of", "lidar_problem"]


def drive_of(simulation: Simulation, robot: int) -> str:
    """Name of the drive of an object that has one."""
    return str(getattr(simulation.scenario.objects[robot].kinematics, "name", ""))


def check_declaration(policy: Policy) -> None:
    """Refuse a policy that declares what is not possible.

    Raises:
        PolicyError: ``output``, ``needs`` or ``decision_dt`` is not of its kind (``policy-failed``).
    """
    name, period = policy.name, policy.decision_dt
    if policy.output not in ("control", "velocity"):
        what = f"output of policy {name!r} must be 'control' or 'velocity', got {as_given(policy.output)}"
        near = nearest(str(policy.output), ["control", "velocity"])
        raise PolicyError("policy-failed", what, f"did you mean {near}?" if near else "choose one of them")
    if not isinstance(policy.needs, Needs):
        what = f"needs of policy {name!r} must be irsim.policies.Needs, got {as_given(policy.needs)}"
        raise PolicyError("policy-failed", what, "write needs = Needs(neighbors=5)")
    number = is_number(period)
    if period is not None and not (number and 0 < period < math.inf):
        what = f"decision_dt of policy {name!r} must be a time [s] above 0, got {as_given(period)}"
        raise PolicyError("policy-failed", what, "give a time such as 0.2, or None to decide in every step")


def check_fit(policy: Policy, simulation: Simulation, robots: Sequence[int]) -> None:
    """Refuse robots that a policy cannot drive.

    Args:
        policy: The policy.
        simulation: The simulation.
        robots: Indices of the robots within a world.

    Raises:
        PolicyError: A robot has another drive, or lacks the lidar that the policy needs (``policy-mismatch``).
    """
    for robot in robots:
        drive, name = drive_of(simulation, robot), simulation.scenario.objects[robot].name
        if policy.output == "control" and policy.drives is not None and drive not in policy.drives:
            known = ", ".join(sorted(policy.drives))
            raise _mismatch(
                policy,
                f"controls {known}, but {name!r} has the drive {drive}",
                f"give {name!r} kinematics {{name: {sorted(policy.drives)[0]}}}, or choose another policy",
            )
    problem = lidar_problem(policy.needs, simulation, robots)
    if problem is not None:
        raise _mismatch(policy, *problem)


def lidar_problem(needs: Needs, simulation: Simulation, robots: Sequence[int]) -> tuple[str, str] | None:
    """The problem with the lidars of robots, as the second half of a sentence, and its fix; None without a problem.

    Args:
        needs: Observations of the policy.
        simulation: The simulation.
        robots: Indices of the robots within a world.
    """
    if not needs.scan:
        return None
    count = needs.beams
    wanted = "sensors: [{name: lidar2d" + (f", number: {count}" if count else "") + "}]"
    first: tuple[str, Beams] | None = None
    for robot in robots:
        name, beams = simulation.scenario.objects[robot].name, beams_of(simulation, robot)
        if beams is None:
            return f"needs the scan of a lidar, but {name!r} has no lidar", f"give {name!r} {wanted}"
        if count is not None and len(beams.angles) != count:
            what = f"was made for {count} beams, but the first lidar of {name!r} has {len(beams.angles)}"
            return what, f"write number: {count} in the lidar of {name!r}"
        if first is not None and not first[1].equal(beams):
            what = f"needs equal lidars, but the lidars of {first[0]!r} and {name!r} differ in number, angle_range, "
            return what + "offset or range_max", f"give {name!r} the lidar of {first[0]!r}"
        first = first or (name, beams)
    return None


def _mismatch(policy: Policy, message: str, fix: str) -> PolicyError:
    return PolicyError("policy-mismatch", f"policy {policy.name!r} {message}", fix, where="policy")
