"""Damaged stages of OpenUSD: each is read, or is an error with a code; a process reads each, so that ways are few."""

from __future__ import annotations

import os
import random
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from irsim.bridges.export.export import export_run
from tests.bridges.maps.round_trips import SHAPES
from tests.bridges.scenes import recorded
from tests.fuzz.damaged.kind import read_map_of
from tests.fuzz.damaged.test_damaged import read
from tests.fuzz.damaged.ways import damaged

pytestmark = [pytest.mark.interop, pytest.mark.nightly, pytest.mark.xdist_group("usd")]
pytest.importorskip("pxr")

_WAYS = 100 if os.environ.get("IRSIM_NIGHTLY") else 5
_PARTS = (
    '#usda 1.0\n(\n    upAxis = "Y"\n    metersPerUnit = 0.01\n    defaultPrim = "Part"\n)\ndef Xform "Part"\n{\n'
    '    def Mesh "floor"\n    {\n        point3f[] points = [(0, 0, 0), (0, 0, 400), (300, 0, 400), (300, 0, 0)]\n'
    "        int[] faceVertexCounts = [4]\n        int[] faceVertexIndices = [0, 1, 2, 3]\n    }\n"
    '    def PointInstancer "posts"\n    {\n        rel prototypes = </Part/posts/post>\n'
    "        int[] protoIndices = [0, 0]\n        point3f[] positions = [(50, 50, 50), (200, 50, 200)]\n"
    '        def Cylinder "post"\n        {\n            double height = 100\n            double radius = 10\n'
    '            token axis = "Y"\n        }\n    }\n}\n'
)
_SCENE = '#usda 1.0\n(\n    upAxis = "Y"\n    metersPerUnit = 0.01\n)\ndef "W" (references = @./part.usda@)\n{\n}\n'


def _own(suffix: str) -> Callable[[Path], Path]:
    """A stage that irsim wrote."""

    def make(folder: Path) -> Path:
        export_run(recorded(SHAPES, 1), folder / f"run.{suffix}", to="usd", objects="all")
        return folder / f"run.{suffix}"

    return make


def _layer(folder: Path) -> Path:
    """A layer to which a stage refers."""
    (folder / "scene.usda").write_text(_SCENE)
    (folder / "part.usda").write_text(_PARTS)
    return folder / "part.usda"


def _package(folder: Path) -> Path:
    with zipfile.ZipFile(folder / "part.usdz", "w") as archive:
        archive.writestr("part.usda", _PARTS)
    return folder / "part.usdz"


_KINDS = {"own-text": _own("usda"), "own-binary": _own("usdc"), "layer": _layer, "package": _package}


@pytest.mark.parametrize("name", _KINDS)
def test_damaged_stages(name: str, tmp_path: Path) -> None:
    file = _KINDS[name](tmp_path)
    stage = tmp_path / "scene.usda" if name == "layer" else file
    content = file.read_bytes()
    read_map_of(stage, random.Random(0))  # it is sound
    for number in range(_WAYS):
        draw = random.Random(f"{name} {number}")
        file.write_bytes(damaged(content, draw))
        read(read_map_of, stage, draw, f"{name}, way {number}")
