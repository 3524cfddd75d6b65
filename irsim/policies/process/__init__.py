"""Policies in other processes, for stacks that cannot be imported: they read and write lines of JSON."""

from __future__ import annotations

from irsim.policies.process.policy import ProcessPolicy

__all__ = ["ProcessPolicy"]
