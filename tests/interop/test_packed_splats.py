"""Splats as viewers and trainers pack them: the same splats as in a plain file, or the command that converts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map
from irsim.bridges.maps.kinds.splats import unpacked_splats
from irsim.bridges.maps.source import ImportLimits
from tests.bridges.splats.scenes import room, write_ply

pytestmark = pytest.mark.interop
pytest.importorskip("gaussforge")
HALL = Path(__file__).with_name("hall.sog")


@pytest.mark.foreign
def test_packed_splats_are_read(foreign) -> None:
    files = {"m.splat": 4, "m.ksplat": 4, "mv4.spz": 4, "s_train.spz": 1000, "s_train.compressed.ply": 1000}
    read = {name: unpacked_splats(foreign / "splats" / name, ImportLimits()) for name in files}
    assert {name: len(splats) for name, splats in read.items()} == files
    first, second = (np.sort(read[name].center, axis=0) for name in ("s_train.spz", "s_train.compressed.ply"))
    assert np.abs(first - second).max() < 0.01 * np.ptp(first)


def test_a_file_of_sog_that_another_program_wrote_has_the_splats_of_its_source(tmp_path) -> None:
    """``splat-transform`` 2.7.1 of PlayCanvas has written ``hall.sog`` from this room."""
    source = write_ply(tmp_path / "hall.ply", room(spacing=0.4, floaters=0.0).columns)
    packed, plain = (unpacked_splats(file, ImportLimits()) for file in (HALL, source))
    assert len(packed) == len(plain)
    assert np.abs(np.sort(packed.center, axis=0) - np.sort(plain.center, axis=0)).max() < 0.01
    assert packed.opacity.mean() == pytest.approx(plain.opacity.mean(), abs=0.01)
    maps = [import_map(file, tmp_path / "x.yaml", overwrite=True) for file in (HALL, source)]
    assert maps[0].free_area == pytest.approx(maps[1].free_area, rel=0.01)
    assert maps[0].occupied == pytest.approx(maps[1].occupied, rel=0.01)


@pytest.mark.foreign
def test_scenes_without_a_floor_are_said(foreign, tmp_path) -> None:
    for name in ("m.splat", "m.ksplat", "mv4.spz", "s_train.spz", "s_train.compressed.ply"):
        with pytest.raises(BridgeError, match=r"splats show no connected floor|no splat stands|no splat is level"):
            import_map(foreign / "splats" / name, tmp_path / "x.yaml")


def test_damaged_files_and_formats_without_a_library(tmp_path) -> None:
    Path(tmp_path / "a.lcc").write_bytes(b"{}")
    with pytest.raises(BridgeError, match=r"splat-transform scene\.lcc scene\.ply"):
        import_map(tmp_path / "a.lcc", tmp_path / "x.yaml")
    for suffix in ("splat", "ksplat", "spz", "sog"):
        Path(tmp_path / f"a.{suffix}").write_bytes(b"damaged")
        with pytest.raises(BridgeError):
            import_map(tmp_path / f"a.{suffix}", tmp_path / "x.yaml")
