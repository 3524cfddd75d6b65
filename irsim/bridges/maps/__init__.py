"""Maps from other worlds: meshes, navigation meshes, USD stages, roads and maps of ROS become scenarios.

from irsim.bridges.maps import import_map

result = import_map("flat.glb", "flat.yaml", robot=True)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names

if TYPE_CHECKING:
    from irsim.bridges.maps.importing import import_map, list_levels
    from irsim.bridges.maps.sidecar import read_sidecar

__all__ = ["import_map", "list_levels", "read_sidecar"]

_IMPORTING, _SIDECAR = "irsim.bridges.maps.importing", "irsim.bridges.maps.sidecar"
__getattr__, __dir__ = lazy_names(
    __name__, {"import_map": _IMPORTING, "list_levels": _IMPORTING, "read_sidecar": _SIDECAR}
)
