"""Scenes that irsim writes with the libraries of other programs come back as maps with the same occupied area."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from irsim.bridges.base import BridgeError
from irsim.bridges.export.export import export_run
from irsim.bridges.maps import import_map
from tests.bridges.maps.round_trips import LARGE_MAP, MAP, SHAPES, WALLS, differing_share
from tests.bridges.scenes import recorded

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("usd")]


@pytest.mark.parametrize("scene", [SHAPES, WALLS], ids=["shapes", "walls"])
def test_scenarios_of_commonroad_come_back(scene) -> None:
    pytest.importorskip("commonroad")
    assert differing_share(scene, "out.xml", to="commonroad", thick=0.05, wall=0.05) <= 0.01


@pytest.mark.parametrize("scene", [SHAPES, WALLS, MAP], ids=["shapes", "walls", "map"])
@pytest.mark.parametrize("suffix", ["usda", "usdz"])
def test_stages_of_usd_come_back(scene, suffix) -> None:
    pytest.importorskip("pxr")
    assert differing_share(scene, f"out.{suffix}", to="usd", thick=0.05, wall=0.05) <= 0.01


def test_large_stages_of_usd_come_back() -> None:
    """Thousands of boxes keep their area, in seconds, and cells of the map are cells of the import."""
    pytest.importorskip("pxr")
    started = time.process_time()
    assert differing_share(LARGE_MAP, "out.usdc", to="usd", thick=0.05, wall=0.05) <= 0.01
    assert time.process_time() - started < 40


def test_the_ground_of_a_stage_comes_back_and_what_moves_does_not() -> None:
    """The map is as large as the ground, which is 1 m wider than the world; what another program adds counts."""
    pxr = pytest.importorskip("pxr.Usd")
    export_run(recorded(SHAPES, 1), "out.usda", to="usd", objects="all")
    result = import_map("out.usda", "back.yaml")
    assert [round(size * result.resolution) for size in (result.columns, result.rows)] == [14, 10]
    assert "left out, as they move: 1 of its robots and people (r)" in result.notes
    assert result.free_area == pytest.approx((result.columns * result.rows - result.occupied) * result.resolution**2)
    import_map("out.usda", "things.yaml", obstacles=True)
    entries = Path("things.yaml").read_text()
    assert "shape: {name: circle, radius: 0.7}, state: [6.2, 3, 0" in entries
    assert "shape: {name: rectangle, length: 2, width: 0.8}, state: [3, 3, 0.4]}  # crate" in entries
    with pytest.raises(BridgeError, match="leave out --level"):
        import_map("out.usda", "level.yaml", level=0)
    Path("crate.usda").write_text('#usda 1.0\ndef Cube "crate"\n{\n    double size = 4\n}\n')
    stage = pxr.Stage.Open("out.usda")
    stage.DefinePrim("/World/Crate").GetReferences().AddReference("./crate.usda", "/crate")
    stage.Save()
    more = import_map("out.usda", "more.yaml", resolution=0.05)
    assert more.occupied * 0.05**2 > result.occupied * result.resolution**2 + 3
    assert not any("left out" in note for note in more.notes)
