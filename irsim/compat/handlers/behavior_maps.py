"""Behaviors by kinematics and name: built-in ones and ones that user code has registered."""

from __future__ import annotations

from irsim.compat.handlers import built_in, group_built_in
from irsim.options.registry import CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS

__all__ = ["behaviors_class_map", "behaviors_map", "group_behaviors_class_map", "group_behaviors_map"]

BUILT_IN = (built_in, group_built_in)
"""Modules that register the built-in behaviors when they are imported."""

behaviors_map = CUSTOM_BEHAVIORS.functions
"""Functions by (kinematics, name)."""
behaviors_class_map = CUSTOM_BEHAVIORS.classes
"""Classes by (kinematics, name); user code alone registers them."""
group_behaviors_map = CUSTOM_GROUP_BEHAVIORS.functions
"""Functions for groups by (kinematics, name); user code alone registers them."""
group_behaviors_class_map = CUSTOM_GROUP_BEHAVIORS.classes
"""Classes for groups by (kinematics, name)."""
