"""Splats as viewers and trainers pack them: the same splats as in a plain file, or the command that converts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map
from irsim.bridges.maps.kinds.splats import unpacked_splats
from irsim.bridges.maps.source import ImportLimits

pytestmark = pytest.mark.interop
pytest.importorskip("gaussforge")


@pytest.mark.foreign
def test_packed_splats_are_read(foreign) -> None:
    files = {"m.splat": 4, "m.ksplat": 4, "mv4.spz": 4, "s_train.spz": 1000, "s_train.compressed.ply": 1000}
    read = {name: unpacked_splats(foreign / "splats" / name, ImportLimits()) for name in files}
    assert {name: len(splats) for name, splats in read.items()} == files
    first, second = (np.sort(read[name].center, axis=0) for name in ("s_train.spz", "s_train.compressed.ply"))
    assert np.abs(first - second).max() < 0.01 * np.ptp(first)


@pytest.mark.foreign
def test_scenes_without_a_floor_are_said(foreign, tmp_path) -> None:
    for name in ("m.splat", "m.ksplat", "mv4.spz", "s_train.spz", "s_train.compressed.ply"):
        with pytest.raises(BridgeError, match=r"no connected floor|no splat stands|no splat is level"):
            import_map(foreign / "splats" / name, tmp_path / "x.yaml")


def test_damaged_files_and_formats_without_a_library(tmp_path) -> None:
    Path(tmp_path / "a.lcc").write_bytes(b"{}")
    with pytest.raises(BridgeError, match=r"splat-transform scene\.lcc scene\.ply"):
        import_map(tmp_path / "a.lcc", tmp_path / "x.yaml")
    for suffix in ("splat", "ksplat", "spz", "sog"):
        Path(tmp_path / f"a.{suffix}").write_bytes(b"damaged")
        with pytest.raises(BridgeError):
            import_map(tmp_path / f"a.{suffix}", tmp_path / "x.yaml")
