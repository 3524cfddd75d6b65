"""The built-in behaviors as functions of arrays and of objects, and for groups; the engine computes the controls."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from irsim.common.arrays import Floats
from irsim.compat.functions._decide import behavior_options, dash, decide
from irsim.compat.functions.frames import WrapToPi, relative_position, vel_world2diff, vel_world2omni
from irsim.compat.functions.rvo import reciprocal_vel_obs
from irsim.compat.functions.social_force import social_force_model
from irsim.compat.handlers.decide import decide_among
from irsim.objects.extensions.drives import diff_control
from irsim.objects.extensions.registration import register_behavior
from irsim.options.registry import CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS

__all__ = [
    "AckerDash",
    "DiffDash",
    "DiffRVO",
    "OmniAngularDash",
    "OmniDash",
    "OmniRVO",
    "OrcaGroupBehavior",
    "SFMVelocity",
    "SfmGroupBehavior",
    "WrapToPi",
    "beh_acker_dash",
    "beh_diff_dash",
    "beh_diff_orca",
    "beh_diff_rvo",
    "beh_diff_sfm",
    "beh_diff_sfm_group",
    "beh_omni_angular_dash",
    "beh_omni_dash",
    "beh_omni_orca",
    "beh_omni_rvo",
    "beh_omni_sfm",
    "beh_omni_sfm_group",
    "reciprocal_vel_obs",
    "register_behavior",
    "relative_position",
    "social_force_model",
    "vel_world2diff",
    "vel_world2omni",
]

_SLOW = 0.02
"""Speed [m/s] below which a desired velocity counts as a stop."""


def DiffDash(
    state: Floats,
    goal: Floats,
    max_vel: Floats,
    goal_threshold: float = 0.1,
    angle_tolerance: float = 0.2,
    angular_acce: float = math.inf,
    dt: float = 0.0,
) -> Floats:
    """Return the (2, 1) control that drives a differential drive to its goal: forward speed [m/s], yaw rate [rad/s].

    Args:
        state: (3, 1) pose.
        goal: (2 or 3, 1).
        max_vel: (2, 1) upper limits.
        goal_threshold: Distance at which it has arrived [m].
        angle_tolerance: Smaller heading errors are left alone [rad].
        angular_acce: Largest change of the yaw rate [rad/s^2].
        dt: Period [s].
    """
    return dash("diff", state, goal, max_vel, goal_threshold, angle_tolerance, angular_acce, dt)


def OmniDash(state: Floats, goal: Floats, max_vel: Floats, goal_threshold: float = 0.1) -> Floats:
    """Return the (2, 1) body-frame velocity that moves a holonomic drive to its goal; see :func:`DiffDash`."""
    return dash("omni", state, goal, max_vel, goal_threshold)


def OmniAngularDash(
    state: Floats,
    goal: Floats,
    max_vel: Floats,
    goal_threshold: float = 0.3,
    angle_tolerance: float = 0.1,
    angular_acce: float = math.inf,
    dt: float = 0.0,
) -> Floats:
    """Return the (3, 1) velocity of a holonomic drive that turns towards the goal and, once there, to its heading."""
    return dash("omni_angular", state, goal, max_vel, goal_threshold, angle_tolerance, angular_acce, dt)


def AckerDash(state: Floats, goal: Floats, max_vel: Floats, goal_threshold: float, angle_tolerance: float) -> Floats:
    """Return the (2, 1) control that drives a car to its goal: forward speed [m/s], steering angle [rad]."""
    return dash("acker", state, goal, max_vel, goal_threshold, angle_tolerance)


def OmniRVO(
    state_tuple: Sequence[float],
    neighbor_list: Sequence[Sequence[float]] | None = None,
    vxmax: float = 1.5,
    vymax: float = 1.5,
    acce: float = 1,
    factor: float = 1.0,
    mode: str = "rvo",
    neighbor_threshold: float = 3.0,
    line_segments: Sequence[Sequence[float]] | None = None,
) -> Floats:
    """Return the (2, 1) world-frame velocity [m/s] with which a holonomic drive avoids other objects.

    Args:
        state_tuple: [x, y, vx, vy, padded radius, wanted vx, wanted vy, theta], as ``rvo_state`` of objects.
        neighbor_list: [x, y, vx, vy, padded radius] of each neighbor, as ``rvo_neighbors``.
        vxmax: Bound of the search [m/s].
        vymax: Bound of the search [m/s].
        acce: Half width of the search around the present velocity [m/s].
        factor: Weight of the time to a collision where none can be avoided.
        mode: ``rvo``, ``hrvo`` or ``vo``.
        neighbor_threshold: Others farther away are ignored [m].
        line_segments: [x1, y1, x2, y2] of lines.
    """
    keys = {"vxmax": vxmax, "vymax": vymax, "acce": acce, "factor": factor, "mode": mode}
    world = _rvo_velocity(state_tuple, neighbor_list, line_segments, {**keys, "neighbor_threshold": neighbor_threshold})
    return world[:, None]


def DiffRVO(
    state_tuple: Sequence[float],
    neighbor_list: Sequence[Sequence[float]] | None = None,
    vxmax: float = 1.5,
    vymax: float = 1.5,
    acce: float = 1,
    factor: float = 1.0,
    mode: str = "rvo",
    neighbor_threshold: float = 3.0,
    line_segments: Sequence[Sequence[float]] | None = None,
) -> Floats:
    """Return the (2, 1) control of a differential drive that avoids others; arguments as for :func:`OmniRVO`."""
    keys = {"vxmax": vxmax, "vymax": vymax, "acce": acce, "factor": factor, "mode": mode}
    world = _rvo_velocity(state_tuple, neighbor_list, line_segments, {**keys, "neighbor_threshold": neighbor_threshold})
    pose = [state_tuple[0], state_tuple[1], state_tuple[7]]
    control = diff_control(pose, world.tolist())
    near = any(math.hypot(other[0] - pose[0], other[1] - pose[1]) < neighbor_threshold for other in neighbor_list or ())
    if not any(control) and not near and not line_segments:
        control = [0.0, diff_control(pose, list(state_tuple[5:7]))[1]]
    return np.array(control)[:, None]


def _rvo_velocity(state: Sequence[float], discs: Any, lines: Any, keys: dict[str, Any]) -> Floats:
    return np.asarray(decide(behavior_options("rvo", keys), [state], discs, lines)[0])


def SFMVelocity(
    state_tuple: Sequence[float],
    neighbor_list: Sequence[Sequence[float]] | None = None,
    line_segments: Sequence[Sequence[float]] | None = None,
    vmax: float = 1.5,
    step_time: float = 0.1,
    **keys: Any,
) -> tuple[float, float]:
    """Return the world-frame velocity [m/s] to which social forces accelerate an object within one time step.

    Args:
        state_tuple: [x, y, vx, vy, padded radius, wanted vx, wanted vy, …].
        neighbor_list: [x, y, vx, vy, padded radius] of each neighbor.
        line_segments: [x1, y1, x2, y2] of lines.
        vmax: Speed cap [m/s].
        step_time: Period [s].
        **keys: Other options of ``sfm``; surplus ones are ignored.
    """
    options = behavior_options("sfm", {**keys, "vmax": vmax})
    vx, vy = decide(options, [state_tuple], neighbor_list, line_segments, step_time=step_time)[0]
    return float(vx), float(vy)


def _among(name: str, ego_object: Any, external_objects: Sequence[Any], keys: dict[str, Any]) -> Floats:
    return decide_among([ego_object], list(external_objects), behavior_options(name, keys))[0]


def _dashing(ego_object: Any, keys: dict[str, Any]) -> Floats:
    """Return the control of `dash`, clipped to the limits of the next step."""
    low, high = ego_object.get_vel_range()
    return np.clip(_among("dash", ego_object, [], keys), low, high)


def beh_diff_dash(ego_object: Any, external_objects: Sequence[Any], **kwargs: Any) -> Floats:
    """Return the (2, 1) control of `dash` for a differential drive; keywords are the keys of its YAML mapping."""
    return _dashing(ego_object, kwargs)


def beh_omni_dash(ego_object: Any, external_objects: Sequence[Any], **kwargs: Any) -> Floats:
    """Return the (2, 1) control of `dash` for a holonomic drive; keywords are the keys of its YAML mapping."""
    return _dashing(ego_object, kwargs)


def beh_omni_angular_dash(ego_object: Any, external_objects: Sequence[Any], **kwargs: Any) -> Floats:
    """Return the (3, 1) control of `dash` for a holonomic drive that turns; keywords are its YAML keys."""
    return _dashing(ego_object, kwargs)


def beh_acker_dash(ego_object: Any, external_objects: Sequence[Any], **kwargs: Any) -> Floats:
    """Return the (2, 1) control of `dash` for a car; keywords are the keys of its YAML mapping."""
    return _dashing(ego_object, kwargs)


def beh_diff_rvo(ego_object: Any, external_objects: Sequence[Any], **kwargs: Any) -> Floats:
    """Return the (2, 1) control of `rvo` for a differential drive; keywords are the keys of its YAML mapping."""
    return _among("rvo", ego_object, external_objects, kwargs)


def beh_omni_rvo(ego_object: Any, external_objects: Sequence[Any], **kwargs: Any) -> Floats:
    """Return the (2, 1) control of `rvo` for a holonomic drive; keywords are the keys of its YAML mapping."""
    return _among("rvo", ego_object, external_objects, kwargs)


def beh_diff_sfm(ego_object: Any, external_objects: Sequence[Any], **kwargs: Any) -> Floats:
    """Return the (2, 1) control of `sfm` for a differential drive; keywords are the keys of its YAML mapping."""
    return _among("sfm", ego_object, external_objects, kwargs)


def beh_omni_sfm(ego_object: Any, external_objects: Sequence[Any], **kwargs: Any) -> Floats:
    """Return the (2, 1) control of `sfm` for a holonomic drive; keywords are the keys of its YAML mapping."""
    return _among("sfm", ego_object, external_objects, kwargs)


CUSTOM_BEHAVIORS.functions |= {
    ("diff", "dash"): beh_diff_dash,
    ("diff", "rvo"): beh_diff_rvo,
    ("diff", "sfm"): beh_diff_sfm,
    ("omni", "dash"): beh_omni_dash,
    ("omni", "rvo"): beh_omni_rvo,
    ("omni", "sfm"): beh_omni_sfm,
    ("omni_angular", "dash"): beh_omni_angular_dash,
    ("acker", "dash"): beh_acker_dash,
}


class _NativeGroup:
    """A built-in behavior for a group of objects.

    Args:
        members: The group, objects of one environment.
        **kwargs: Keys of the YAML mapping.

    Raises:
        ValidationError: A value is invalid.
    """

    behavior = ""

    def __init__(self, members: Sequence[Any], **kwargs: Any) -> None:
        self._options = behavior_options(self.behavior, kwargs)
        self._roles = str(kwargs.get("target_roles", "all"))

    def __call__(self, members: Sequence[Any], **kwargs: Any) -> list[Floats]:
        """Return the controls of all members, (vel_dim, 1) each, for the current state of the simulation."""
        if not members:
            return []
        others = [o for o in members[0].environment_objects if not any(o is m for m in members)]
        seen = [other for other in others if self._roles not in ("robot", "obstacle") or other.role == self._roles]
        return decide_among(list(members), seen, self._options, grouped=True)


class OrcaGroupBehavior(_NativeGroup):
    """`orca` for a group."""

    behavior = "orca"


class SfmGroupBehavior(_NativeGroup):
    """`sfm` for a group, with social groups within it."""

    behavior = "sfm"


beh_omni_orca = beh_diff_orca = OrcaGroupBehavior
beh_omni_sfm_group = beh_diff_sfm_group = SfmGroupBehavior
CUSTOM_GROUP_BEHAVIORS.classes |= {
    ("omni", "orca"): beh_omni_orca,
    ("diff", "orca"): beh_diff_orca,
    ("omni", "sfm"): beh_omni_sfm_group,
    ("diff", "sfm"): beh_diff_sfm_group,
}
