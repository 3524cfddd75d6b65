"""Maps against Recast and Detour, which make the navigation meshes of Habitat: the same flat, and Detour's own file."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from irsim.bridges.maps.grid import Grid
from irsim.bridges.maps.importing import import_map, read_occupancy
from irsim.bridges.maps.occupancy import eroded
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Occupancy
from irsim.components.maps._site import FREE
from tests.bridges.maps.scenes import flat, house, write_glb, y_up

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("recast")]
SOURCE = Path(__file__).with_name("recast_flat.cpp")
RADIUS = 0.1
"""Habitat's radius of an agent [m]."""


@pytest.fixture(scope="module")
def recast(tmp_path_factory) -> Path:
    if shutil.which("g++") is None or not Path("/usr/include/recastnavigation/Recast.h").is_file():
        pytest.skip("needs g++ and librecast-dev")
    pytest.importorskip("trimesh")
    program = tmp_path_factory.mktemp("recast") / "recast_flat"
    command = ["g++", "-O1", "-std=c++17", str(SOURCE), "-o", str(program), "-lRecast", "-lDetour"]
    subprocess.run(command, check=True, capture_output=True, timeout=300)
    return program


def build(recast: Path, folder: Path, triangles: np.ndarray, version: int) -> Path:
    """The navigation mesh that Recast makes of triangles; its cells lie beside it."""
    y_up(triangles).astype("<f4").tofile(folder / "triangles.bin")
    out = folder / f"version{version}.navmesh"
    command = [str(recast), str(folder / "triangles.bin"), str(out), str(version)]
    subprocess.run(command, check=True, capture_output=True, timeout=120)
    return out


def recast_cells(file: Path, grid: Grid, height: float) -> np.ndarray:
    """(nx, ny) cells that Recast's height field has as floors near a height."""
    x, y, z = np.fromfile(f"{file}.cells", "<f4").reshape(-1, 3).T
    floor = np.abs(y - height) < 0.3
    cells = np.zeros((grid.nx, grid.ny), bool)
    i = np.floor((x[floor] - grid.x) / grid.resolution + 1e-3).astype(int)
    j = np.floor((-z[floor] - grid.y) / grid.resolution + 1e-3).astype(int)
    cells[i, j] = True
    return cells


def free_on(result: Occupancy, grid: Grid) -> np.ndarray:
    """(nx, ny) the free cells of a map on another grid with the same lines."""
    cells = np.zeros((grid.nx, grid.ny), bool)
    i, j = np.nonzero(result.values == FREE)
    shift = [round((a - b) / grid.resolution) for a, b in ((result.grid.x, grid.x), (result.grid.y, grid.y))]
    cells[i + shift[0], j + shift[1]] = True
    return cells


def iou(a: np.ndarray, b: np.ndarray) -> float:
    return float((a & b).sum() / (a | b).sum())


def read_map(file: Path, **options) -> Occupancy:
    return read_occupancy(file, ImportOptions(**options), ImportLimits())[1]


def test_a_flat_as_recast_sees_it(recast, tmp_path, record_property) -> None:
    """Habitat's parameters: cells of 5 cm, headroom 1.5 m, climb 0.2 m, 45°, radius 0.1 m."""
    mesh = read_map(write_glb(tmp_path / "flat.glb", flat()))
    file = build(recast, tmp_path, flat(), 1)
    theirs = recast_cells(file, mesh.grid, 0.1)
    mesh.values = eroded(mesh.values, RADIUS / mesh.grid.resolution)
    ours = free_on(mesh, mesh.grid)
    record_property("iou_cells", iou(ours, theirs))
    assert ours.sum() > 13_000
    assert iou(ours, theirs) > 0.95
    navigation = free_on(read_map(file), mesh.grid)
    assert iou(ours, navigation) > 0.95
    assert iou(theirs, navigation) > 0.97


@pytest.mark.parametrize("version", [1, 2])
def test_files_of_detour_are_read(recast, tmp_path, version) -> None:
    file = build(recast, tmp_path, flat(), version)
    result = import_map(file, tmp_path / "flat.yaml", robot=True)
    assert result.kind == "navmesh"
    assert result.level == 0
    assert result.free_area == pytest.approx(34.95, abs=0.3)
    assert "0.10 m" in result.notes[0]


def test_both_storeys_of_a_house(recast, tmp_path) -> None:
    file = build(recast, tmp_path, house(), 2)
    glb = write_glb(tmp_path / "house.glb", house())
    for level, height in enumerate((0.0, 2.8)):
        ours = read_map(glb, level=level)
        assert ours.height == pytest.approx(height, abs=0.02)
        ours.values = eroded(ours.values, RADIUS / ours.grid.resolution)
        theirs = read_map(file, height=height)
        assert iou(free_on(ours, ours.grid), free_on(theirs, ours.grid)) > 0.93
