"""Damaged bags, floor plans and meshes: the ways of ``tests/fuzz/damaged`` for files that need a library.

Bags are read in the process itself. The others are read by processes of their own, which start warm here.
"""

from __future__ import annotations

import os
import random
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest

from irsim.bridges.maps import apart
from irsim.bridges.maps.importing import import_map
from irsim.bridges.ros.backends.bag import BagFolder, Storage
from irsim.bridges.ros.bags.importing import BagOptions, import_bag
from irsim.bridges.ros.messages import Messages
from irsim.common.child import python
from tests.bridges.maps.scenes import box, flat, write_glb
from tests.fuzz.damaged.kind import IMPORT, Kind, made, read_map_of
from tests.fuzz.damaged.test_damaged import NIGHT, try_ways
from tests.interop.ros.test_import_bag import write_first_bag
from tests.warm import warm

pytestmark = [pytest.mark.interop, pytest.mark.nightly, pytest.mark.xdist_group("damaged")]
ezdxf = pytest.importorskip("ezdxf")
trimesh = pytest.importorskip("trimesh")
for _name in ("collada", "svgelements", "rosbags"):
    pytest.importorskip(_name)

_WAYS = 60
"""Ways of each kind in the gate."""
_APART = 6
"""Where a process reads the file, one way in six is tried."""
_ODOMETRY, _SCAN = "nav_msgs/msg/Odometry", "sensor_msgs/msg/LaserScan"
_READERS = tuple(f"irsim.bridges.maps.kinds._{kind}_process" for kind in ("dxf", "svg", "mesh"))
_SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" xmlns:x="http://www.w3.org/1999/xlink" width="9cm" viewBox="0 0 90 60">'
    '<style>.w {fill: black; stroke: none}</style><g id="walls" transform="translate(1 2) rotate(3)">'
    '<rect class="w" x="0" y="0" width="80" height="4"/><path class="w" d="M0 10 L20 10 C20 20 10 20 0 30 z"/></g>'
    '<g id="post"><circle cx="50" cy="30" r="5" fill="#333"/></g><use x:href="#post" x="20" y="10"/>'
    '<polyline points="5,40 50,40 50,55" stroke="black" stroke-width="2" fill="none"/></svg>'
)


def _bag(storage: Storage, ending: str) -> Callable[[Path], Path]:
    """A file of a bag with the odometry and the scans of a second."""

    def make(folder: Path) -> Path:
        messages = Messages()
        with BagFolder(folder / "drive", messages, storage, "drive") as bag:
            poses, scans = (bag.topic(*of) for of in (("/odom", _ODOMETRY), ("/scan", _SCAN)))
            for stamp in range(10**9, 2 * 10**9, 10**8):
                pose = (0.5 * stamp / 1e9, 1.0, 0.1)
                bag.add(poses, stamp, messages.odometry(stamp, "odom", "base_link", pose, (0.5, 0.0, 0.0)))
                ranges = np.full(20, 2.0, dtype=np.float32)
                scan = messages.scan(stamp, "base_link", (-1.0, 1.0, 0.1), (0.1, 5.0), 0.1, ranges)
                bag.add(scans, stamp, scan)
        return next((folder / "drive").glob(f"*{ending}"))

    return make


def _read_folder(file: Path, draw: random.Random) -> None:
    import_bag(file.parent, file.parents[1] / "a.yaml", BagOptions(), overwrite=True)


def _read_bag(file: Path, draw: random.Random) -> None:
    import_bag(file, file.with_name("a.yaml"), BagOptions(), overwrite=True)


def _read_drawing(file: Path, draw: random.Random) -> None:
    import_map(file, file.with_name("scene.yaml"), limits=IMPORT, overwrite=True, resolution=0.2, meters_per_unit=0.1)


def _write_mesh(file: Path) -> None:
    corners = flat().reshape(-1, 3)
    trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False).export(file)


def _write_plan(version: str) -> Callable[[Path], None]:
    def write(file: Path) -> None:
        document = ezdxf.new(version)
        space = document.modelspace()
        column = document.blocks.new("column")
        column.add_circle((0, 0), 0.5)
        space.add_blockref("column", (2, 1))
        space.add_line((0, 0), (4, 0))
        if version == "R12":
            space.add_polyline2d([(0, 0), (4, 0), (4, 3), (0, 3)], close=True)
        else:
            space.add_lwpolyline([(0, 0), (4, 0), (4, 3), (0, 3)], close=True)
            space.add_spline([(0, 1), (1, 2), (2, 1), (3, 2)])
            hatch = space.add_hatch()
            hatch.paths.add_polyline_path([(1, 1), (2, 1), (2, 3), (1, 3)], is_closed=True)
        document.saveas(file)

    return write


def _apart(
    write: Callable[[Path], object], name: str, read: Callable[[Path, random.Random], object] = read_map_of
) -> Kind:
    return Kind(made(write, name), read, share=_APART)


KINDS: Mapping[str, Kind] = {
    "bag-db3": Kind(_bag("sqlite3", ".db3"), _read_folder),
    "bag-metadata": Kind(_bag("sqlite3", ".yaml"), _read_folder),
    "bag-mcap": Kind(_bag("mcap", ".mcap"), _read_folder),
    "bag-ros1": Kind(made(write_first_bag, "drive.bag"), _read_bag),
    "dxf-r12": _apart(_write_plan("R12"), "a.dxf"),
    "dxf": _apart(_write_plan("R2010"), "a.dxf"),
    "svg": _apart(lambda file: file.write_text(_SVG), "a.svg", _read_drawing),
    "glb": _apart(lambda file: write_glb(file, box([0, 0, 0], [1, 1, 1])), "a.glb"),
    **{name: _apart(_write_mesh, f"a.{name}") for name in ("stl", "ply", "obj", "dae")},
}


@pytest.mark.parametrize("name", KINDS)
def test_damaged_files_are_read_or_refused(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(apart, "python", lambda module: warm(python(module), ("numpy", *_READERS)))
    ways = NIGHT if os.environ.get("IRSIM_NIGHTLY") else _WAYS
    try_ways(name, KINDS[name], tmp_path, range(0, ways, KINDS[name].share))
