"""The registry of converters."""

from __future__ import annotations

from irsim.options.registry import Registry

__all__ = ["CONVERTERS"]

CONVERTERS = Registry("converter", "irsim.policies.converters.kinds", "irsim.policy_converters")
"""Kinds of weights: each has a function of (weights, options) that returns a network."""
