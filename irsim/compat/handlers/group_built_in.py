"""The built-in group behaviors as classes; the engine computes them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from irsim.common.arrays import Floats
from irsim.compat.functions._decide import behavior_options
from irsim.compat.handlers.decide import decide_among
from irsim.options.registry import CUSTOM_GROUP_BEHAVIORS

__all__ = [
    "OrcaGroupBehavior",
    "SfmGroupBehavior",
    "beh_diff_orca",
    "beh_diff_sfm_group",
    "beh_omni_orca",
    "beh_omni_sfm_group",
]


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


def beh_omni_orca(members: Sequence[Any], **kwargs: Any) -> OrcaGroupBehavior:
    """`orca` for a group of holonomic drives."""
    return OrcaGroupBehavior(members, **kwargs)


def beh_diff_orca(members: Sequence[Any], **kwargs: Any) -> OrcaGroupBehavior:
    """`orca` for a group of differential drives."""
    return OrcaGroupBehavior(members, **kwargs)


def beh_omni_sfm_group(members: Sequence[Any], **kwargs: Any) -> SfmGroupBehavior:
    """`sfm` for a group of holonomic drives."""
    return SfmGroupBehavior(members, **kwargs)


def beh_diff_sfm_group(members: Sequence[Any], **kwargs: Any) -> SfmGroupBehavior:
    """`sfm` for a group of differential drives."""
    return SfmGroupBehavior(members, **kwargs)


CUSTOM_GROUP_BEHAVIORS.classes |= {
    ("omni", "orca"): beh_omni_orca,
    ("diff", "orca"): beh_diff_orca,
    ("omni", "sfm"): beh_omni_sfm_group,
    ("diff", "sfm"): beh_diff_sfm_group,
}
