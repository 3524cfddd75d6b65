"""Networks from files as policies: what they observe, their layers, and what their result means."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names

if TYPE_CHECKING:
    from irsim.policies.networks.errors import Limits, PolicyFileError, PolicyInputError
    from irsim.policies.networks.files import save_network
    from irsim.policies.networks.layout import Layout, layout_bounds, layout_needs, layout_shapes, observe
    from irsim.policies.networks.network import Network
    from irsim.policies.networks.network_policy import NetworkPolicy
    from irsim.policies.networks.opening import open_network
    from irsim.policies.networks.plain_weights import mlp

__all__ = [
    "Layout",
    "Limits",
    "Network",
    "NetworkPolicy",
    "PolicyFileError",
    "PolicyInputError",
    "layout_bounds",
    "layout_needs",
    "layout_shapes",
    "mlp",
    "observe",
    "open_network",
    "save_network",
]

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "Layout": "irsim.policies.networks.layout",
        "Limits": "irsim.policies.networks.errors",
        "Network": "irsim.policies.networks.network",
        "NetworkPolicy": "irsim.policies.networks.network_policy",
        "PolicyFileError": "irsim.policies.networks.errors",
        "PolicyInputError": "irsim.policies.networks.errors",
        "layout_bounds": "irsim.policies.networks.layout",
        "layout_needs": "irsim.policies.networks.layout",
        "layout_shapes": "irsim.policies.networks.layout",
        "mlp": "irsim.policies.networks.plain_weights",
        "observe": "irsim.policies.networks.layout",
        "open_network": "irsim.policies.networks.opening",
        "save_network": "irsim.policies.networks.files",
    },
)
