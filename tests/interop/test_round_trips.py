"""Scenes that irsim writes with the libraries of other programs come back as maps with the same occupied area."""

from __future__ import annotations

import pytest

from tests.bridges.maps.round_trips import MAP, SHAPES, WALLS, differing_share

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("usd")]


@pytest.mark.parametrize("scene", [SHAPES, WALLS], ids=["shapes", "walls"])
def test_scenarios_of_commonroad_come_back(scene) -> None:
    pytest.importorskip("commonroad")
    assert differing_share(scene, "out.xml", to="commonroad", thick=0.05, wall=0.05) <= 0.01


@pytest.mark.parametrize("scene", [SHAPES, MAP], ids=["shapes", "map"])
def test_stages_of_usd_come_back(scene) -> None:
    """Walls of a few cells are left out: cells that a surface touches count."""
    pytest.importorskip("pxr")
    cells = {"unknown": "free", "resolution": 0.02, "grown": 0.01}
    assert differing_share(scene, "out.usda", to="usd", thick=0.05, wall=0.05, robots=True, **cells) <= 0.01
