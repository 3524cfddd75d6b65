"""The registries of observation parts and of layers."""

from __future__ import annotations

from irsim.options.registry import Registry

__all__ = ["LAYERS", "PARTS"]

PARTS = Registry("part", "irsim.policies.networks.parts", "irsim.observation_parts")
"""Parts of observations: each is a function of :class:`irsim.policies.Observations`."""
LAYERS = Registry("layer", "irsim.policies.networks.layers", "irsim.network_layers")
"""Layers of networks."""
