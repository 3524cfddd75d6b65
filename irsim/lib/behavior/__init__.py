"""Names that IR-SIM scripts import from ``irsim.lib.behavior``; plain re-exports."""

from irsim.lib.behavior.behavior import Behavior
from irsim.lib.behavior.behavior_registry import (
    register_behavior,
    register_behavior_class,
    register_group_behavior,
    register_group_behavior_class,
)

__all__ = [
    "Behavior",
    "register_behavior",
    "register_behavior_class",
    "register_group_behavior",
    "register_group_behavior_class",
]
