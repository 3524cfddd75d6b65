"""Ground plans: one splat by hand, scenes in other frames, a room whose plan is known, and imports of its map."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from irsim.bridges.base import BridgeError
from irsim.bridges.frames import axes_of
from irsim.bridges.maps.importing import import_map, list_levels, read_occupancy
from irsim.bridges.maps.sidecar import read_sidecar
from irsim.bridges.maps.source import ImportLimits, ImportOptions
from irsim.bridges.splats import occupancy
from irsim.bridges.splats.occupancy import Footprints, PlanOptions, find_floor, ground_plan, spread
from irsim.bridges.splats.splats import Splats
from tests.bridges.splats.conftest import Site
from tests.bridges.splats.scenes import room, write_ply


def balls(centers: list[list[float]], sigma: float = 0.1, opacity: float = 0.5) -> Splats:
    count = len(centers)
    return Splats(
        np.array(centers, np.float32),
        np.full((count, 3), sigma, np.float32),
        np.tile(np.array([1, 0, 0, 0], np.float32), (count, 1)),
        np.full(count, opacity, np.float32),
        np.full((count, 3), 0.5, np.float32),
    )


def test_one_splat_adds_its_normal_distribution() -> None:
    options = PlanOptions(cell=0.05, low=0.5, high=1.5, bounds=(-0.525, -0.525, 0.525, 0.525), occupied=0.2)
    plan = ground_plan(balls([[0, 0, 1.0]]), np.eye(4), options)
    assert plan.density.shape == (21, 21)
    at = 0.05 * (np.arange(21) - 10)
    expected = 0.5 * np.exp(-(at[:, None] ** 2 + at[None, :] ** 2) / (2 * 0.1**2))
    np.testing.assert_allclose(plan.density, expected, atol=0.012)
    half = ground_plan(balls([[0, 0, 0.5]]), np.eye(4), options)  # half of it lies below the band
    np.testing.assert_allclose(half.density, plan.density / 2, atol=1e-5)
    assert plan.occupied.sum() == (expected >= 0.2).sum()


def test_a_splat_smaller_than_a_cell_adds_its_mean_over_the_cell() -> None:
    options = PlanOptions(cell=0.3, low=0.5, high=1.5, bounds=(0, 0, 0.9, 0.9))
    plan = ground_plan(balls([[0.45, 0.45, 1.0]], sigma=0.02), np.eye(4), options)
    assert plan.density.sum() == pytest.approx(0.5 * 2 * math.pi * 0.02**2 / 0.3**2, rel=0.03)
    assert plan.density[1, 1] == pytest.approx(plan.density.sum(), rel=0.02)


def test_large_splats_on_coarser_grids_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(0)
    axes = rng.normal(size=(40, 2, 2)) * 0.25 + 0.3 * np.eye(2)
    cover = axes @ axes.transpose(0, 2, 1)
    cover = np.stack([cover[:, 0, 0], cover[:, 0, 1], cover[:, 1, 1]], axis=1)
    some = Footprints(rng.uniform(-1, 5, (40, 2)), rng.uniform(0.1, 1, 40), cover)
    coarse = spread(some, (0.0, 0.0), (80, 60), 0.05)
    monkeypatch.setattr(occupancy, "_MAX_REACH", 10_000)
    fine = spread(some, (0.0, 0.0), (80, 60), 0.05)
    assert np.abs(coarse - fine).max() < 0.1 * fine.max()


def test_plans_do_not_depend_on_batches_and_order(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(1)
    scene = balls(rng.uniform(0, 3, (300, 3)).tolist(), 0.04, 0.4)
    options = PlanOptions(low=0.5, high=2.0, bounds=(0, 0, 3, 3))
    before = ground_plan(scene, np.eye(4), options).density
    monkeypatch.setattr(occupancy, "_PAIRS", 1000)
    np.testing.assert_allclose(ground_plan(scene, np.eye(4), options).density, before, atol=1e-6)
    mixed = scene.take(rng.permutation(300))
    np.testing.assert_allclose(ground_plan(mixed, np.eye(4), options).density, before, atol=1e-6)


def test_faint_and_huge_splats_and_those_outside_the_band_are_left_out() -> None:
    scene = balls([[1, 1, 1.0], [2, 1, 3.0]])
    far = Splats(
        np.array([[1.5, 1.5, 1.0]], np.float32), np.array([[9, 9, 9]], np.float32), scene.rotation[:1],
        np.array([0.9], np.float32), scene.color[:1],
    )  # fmt: skip
    faint = balls([[1.5, 1.5, 1.0]], opacity=0.03)
    parts = [np.concatenate(values) for values in zip(*(
        (part.center, part.scale, part.rotation, part.opacity, part.color) for part in (scene, far, faint)
    ), strict=True)]  # fmt: skip
    plan = ground_plan(Splats(*parts), np.eye(4), PlanOptions())
    assert (plan.used, plan.too_large) == (1, 1)
    assert plan.origin == pytest.approx((0.8, 0.8))


def test_nothing_in_the_way_and_too_many_cells_are_errors() -> None:
    with pytest.raises(BridgeError, match=r"no splat stands between 0.1 m and 1.5 m"):
        ground_plan(balls([[0, 0, 9.0]]), np.eye(4), PlanOptions())
    with pytest.raises(BridgeError, match="larger cells"):
        ground_plan(balls([[0, 0, 1.0], [9e5, 9e5, 1.0]]), np.eye(4), PlanOptions())
    with pytest.raises(BridgeError, match="other bounds"):
        ground_plan(balls([[0, 0, 1.0]]), np.eye(4), PlanOptions(bounds=(1, 1, 1, 2)))


def flat(heights: list[float], counts: list[int]) -> Splats:
    rng = np.random.default_rng(3)
    z = np.repeat(heights, counts)
    scene = balls(np.column_stack([rng.uniform(0, 5, (len(z), 2)), z]).tolist())
    scene.scale[:, 2] = 0.003
    return scene


def test_the_floor_is_the_lowest_large_level() -> None:
    scene = flat([-1.0, -0.62, 0.1, 2.0], [30, 900, 300, 1000])  # some below, the floor, a table, the ceiling
    assert find_floor(scene, np.array([0.0, 0, 1])) == pytest.approx(-0.62, abs=1e-6)
    assert find_floor(scene, np.array([0.0, 0, -1])) == pytest.approx(-2.0, abs=1e-6)
    with pytest.raises(BridgeError, match="no splat is level"):
        find_floor(scene, np.array([0.0, 1, 0]))


def test_the_floor_of_a_scene_of_round_splats_is_where_many_are() -> None:
    rng = np.random.default_rng(4)
    walls = np.column_stack([rng.uniform(0, 5, (2000, 2)), rng.uniform(0.3, 2.8, 2000)])
    planes = np.column_stack([rng.uniform(0, 5, (1800, 2)), np.repeat([0.3, 1.1, 2.8], [900, 100, 800])])
    scene = balls([*walls.tolist(), *planes.tolist()])
    assert find_floor(scene, np.array([0.0, 0, 1])) == pytest.approx(0.3, abs=0.03)


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
