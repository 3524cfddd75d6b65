"""Names that IR-SIM scripts import from ``irsim.lib.behavior``; plain re-exports."""

from irsim.lib.behavior.behavior_registry import register_behavior

__all__ = ["register_behavior"]
