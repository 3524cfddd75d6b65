"""The process that unpacks splats: gaussforge makes a plain PLY file of what other programs have packed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gaussforge
import numpy as np
from numpy.typing import NDArray

from irsim.bridges.maps.apart import Refused, serve

__all__ = ["main"]


def main() -> None:
    """Read the request, answer it."""
    serve(_unpacked)


def _unpacked(path: Path, request: dict[str, Any]) -> tuple[NDArray[np.uint8], dict[str, Any]]:
    """Bytes of a PLY file with the same splats."""
    result = gaussforge.GaussForge().convert(path.read_bytes(), request["format"], "ply")
    if "data" not in result:
        raise Refused(f"it is damaged ({str(result.get('error'))[:150]})")
    return np.frombuffer(result["data"], np.uint8), {}
