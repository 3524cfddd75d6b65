"""`irsim map import` of splats."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from irsim.bridges.base import BridgeError
from irsim.bridges.frames import axes_of
from irsim.bridges.maps.importing import import_map, list_levels, read_occupancy
from irsim.bridges.maps.sidecar import read_sidecar
from irsim.bridges.maps.source import ImportLimits, ImportOptions
from irsim.cli.app import app
from tests.bridges.splats.conftest import Site
from tests.bridges.splats.scenes import room, write_ply


def test_the_plan_of_a_room_in_another_frame_is_its_truth(site: Site) -> None:
    options = ImportOptions(up="-y", resolution=0.1)
    kind, plan, _ = read_occupancy(site.scene, options, ImportLimits())
    assert (kind.name, plan.frame, plan.height) == ("splats", "colmap", pytest.approx(-1.2, abs=0.01))
    grid = plan.grid
    truth = site.room.truth((grid.x, grid.y), grid.resolution, plan.values.shape)
    inside = np.zeros(truth.shape, bool)
    x, y = (begin + (np.arange(n) + 0.5) * 0.1 for begin, n in zip((grid.x, grid.y), truth.shape, strict=True))
    inside[np.ix_((x > 0.05) & (x < 7.95), (y > 0.05) & (y < 5.95))] = True
    taken = (plan.values != 0) & inside
    assert (taken & truth & inside).sum() / ((taken | truth) & inside).sum() > 0.9


def test_the_sidecar_leads_back_to_the_scene(site: Site) -> None:
    sidecar = read_sidecar(site.scenario)
    assert sidecar.frame == "colmap"
    np.testing.assert_allclose(sidecar.T_scene_from_irsim[:3, :3], axes_of("colmap"))
    np.testing.assert_allclose(sidecar.to_scene([[3.0, 2.0]]), [[-2.0, 1.2, 3.0]], atol=0.01)


def test_units_and_bounds(tmp_path: Path) -> None:
    columns = room(spacing=0.1).columns
    columns[:, :3] *= 4  # a scene whose unit is a quarter of a metre
    columns[:, 10:13] += np.log(4)
    path = write_ply(tmp_path / "big.ply", columns)
    _, plan, _ = read_occupancy(
        path, ImportOptions(meters_per_unit=0.25, resolution=0.1, bounds=(0.0, 0.0, 8.0, 6.0)), ImportLimits()
    )
    assert plan.values.shape == (80, 60)
    assert (plan.values == 0).sum() * 0.01 == pytest.approx(39.5, abs=2.5)
    result = import_map(path, tmp_path / "big.yaml", meters_per_unit=0.25, resolution=0.1)
    assert read_sidecar(tmp_path / "big.yaml").scale == pytest.approx(4)
    assert result.kind == "splats"


def test_a_wrong_axis_is_an_error_that_says_so_and_writes_nothing(site: Site, tmp_path: Path) -> None:
    with pytest.raises(BridgeError, match="check which axis points up"):
        import_map(site.scene, tmp_path / "wrong.yaml", resolution=0.1)
    assert not list(tmp_path.iterdir())


def test_an_axis_that_is_in_doubt_is_noted(tmp_path: Path) -> None:
    path = write_ply(tmp_path / "a.ply", room(spacing=0.1, axes=axes_of("habitat_yup")).columns)
    with pytest.raises(BridgeError, match="no connected floor"):
        list_levels(path, resolution=0.1)
    result = list_levels(path, up="y", resolution=0.1)
    assert result.levels[0].height == pytest.approx(0, abs=0.01)


def test_a_seed_point_outside_of_the_floor_is_an_error(site: Site) -> None:
    with pytest.raises(BridgeError, match=r"no floor at the seed point \(3.8, 3\)"):
        list_levels(site.scene, up="-y", resolution=0.1, seed_point=(3.8, 3.0))
    assert list_levels(site.scene, up="-y", resolution=0.1, seed_point=(1.0, 1.0)).free_area > 30


def test_the_command(site: Site, tmp_path: Path) -> None:
    out = tmp_path / "room.yaml"
    arguments = ["map", "import", str(site.scene), "-o", str(out), "--up=-y", "--resolution", "0.1", "--robot"]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    assert "floor at -1.20 m" in done.output
    assert out.with_suffix(".bridge.json").is_file()
    broken = tmp_path / "broken.ply"
    broken.write_bytes(site.scene.read_bytes()[:5000])
    done = CliRunner().invoke(app, ["map", "import", str(broken), "-o", str(tmp_path / "b.yaml")])
    assert done.exit_code != 0
    assert not (tmp_path / "b.yaml").exists()
