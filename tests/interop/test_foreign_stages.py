"""Stages of the USD working group, which refer to ``../assets``: what stands in them is where OpenUSD says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map
from irsim.bridges.maps.importing import read_occupancy
from irsim.bridges.maps.source import ImportLimits, ImportOptions
from irsim.components.maps._site import FREE

pytestmark = [pytest.mark.interop, pytest.mark.foreign, pytest.mark.xdist_group("usd")]
pxr = pytest.importorskip("pxr")
from pxr import Usd, UsdGeom  # noqa: E402


@pytest.fixture
def scenes(foreign) -> Path:
    return foreign / "usd" / "intent-vfx" / "scenes"


def _balls(file: Path) -> np.ndarray:
    """(N, 3) places x, y and radii of the spheres of a stage with y up, in units of the file."""
    stage = Usd.Stage.Open(str(file))
    time = Usd.TimeCode.EarliestTime()
    cache = UsdGeom.XformCache(time)
    prims = iter(Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)))
    places = []
    for prim in prims:
        world = np.array(cache.GetLocalToWorldTransform(prim)) if UsdGeom.Imageable(prim) else None
        if prim.IsA(UsdGeom.Sphere):
            assert UsdGeom.Sphere(prim).GetRadiusAttr().Get() == 1
            places.append(world)
        elif prim.IsA(UsdGeom.PointInstancer):  # each instance is a ball of radius 1
            prims.PruneChildren()
            given = UsdGeom.PointInstancer(prim).ComputeInstanceTransformsAtTime(time, time)
            places += [np.array(one) @ world for one in given]
    return np.array([[one[3, 0], -one[3, 2], np.linalg.norm(one[0, :3])] for one in places])


def test_a_field_of_balls(scenes) -> None:
    """A part of it, as if a unit were a meter; it has no floor, and a cell that a ball touches is occupied."""
    file = scenes / "simpleAssetScene.usd"
    root = str(file.parent.parent)
    with pytest.raises(BridgeError, match=f"'../assets/simpleAsset/simpleAsset.usd', which is outside.*--root {root} "):
        read_occupancy(file, ImportOptions(), ImportLimits())
    bounds = (20.0, -30.0, 80.0, 30.0)
    options = ImportOptions(root=root, meters_per_unit=1, ground=0, bounds=bounds, resolution=0.1)
    _, plan, _ = read_occupancy(file, options, ImportLimits())
    balls = _balls(file)
    assert len(balls) == 1000
    grid = plan.grid
    x, y = (np.array(start) + 0.1 * np.arange(n) for start, n in ((grid.x, grid.nx), (grid.y, grid.ny)))
    expected = np.zeros((grid.nx, grid.ny), bool)
    for center_x, center_y, radius in balls:
        across = np.maximum(0, np.maximum(x - center_x, center_x - x - 0.1))
        along = np.maximum(0, np.maximum(y - center_y, center_y - y - 0.1))
        expected |= across[:, None] ** 2 + along**2 <= radius**2
    inside = np.ix_((x > 20) & (x < 79.9), (y > -30) & (y < 29.9))
    stands = plan.values[inside] != FREE
    assert stands.sum() == pytest.approx(expected[inside].sum(), rel=0.01)
    assert (stands != expected[inside]).sum() < 0.02 * expected[inside].sum()


def test_teapots_one_of_whose_layers_is_missing(scenes, tmp_path) -> None:
    options = {"root": str(scenes.parent), "ground": 0.0, "climb": 0.02, "resolution": 0.05}
    result = import_map(scenes / "teapotScene.usd", tmp_path / "pots.yaml", robot=True, **options)
    assert "one of its layers was not found: 'teapot_animCycle.usd'" in result.notes
    size = np.array([result.columns, result.rows]) * result.resolution
    np.testing.assert_allclose(size, [38.7, 38.6], atol=0.15)
    assert result.free_area == pytest.approx(1362, rel=0.01)
