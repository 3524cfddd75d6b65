"""``packed_splats``: scenes of Gaussian splats as viewers and trainers pack them, known by their names."""

from __future__ import annotations

from dataclasses import replace

from irsim.bridges.maps.kinds import splats

__all__ = ["KIND"]

KIND = replace(
    splats.KIND,
    name="packed_splats",
    title="a packed scene of Gaussian splats",
    suffixes=(".splat", ".ksplat", ".spz", ".sog", ".lcc"),
    accepts=bool,
    by_name=True,
)
