"""Stages of OpenUSD that are made of several files: which of them are read, which may be missing, and what is said."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("usd")]
pytest.importorskip("pxr")

_HEAD = '#usda 1.0\n(\n    upAxis = "Z"\n    metersPerUnit = 1\n    defaultPrim = "Part"\n)\n'
_FLOOR = (
    'def Xform "Part"\n{\n    def Plane "floor"\n    {\n        double width = 4\n        double length = 3\n    }\n}\n'
)
_WHOLE = pytest.approx(12, rel=0.03)
"""Area of the floor [m²]."""


def stage(file: str, *, sublayers: str = "", head: str = "", body: str = "") -> str:
    """Write a stage whose prim has a head in parentheses, such as references."""
    path = Path(file)
    path.parent.mkdir(parents=True, exist_ok=True)
    layers = f"    subLayers = [{sublayers}]\n" if sublayers else ""
    path.write_text(f'{_HEAD[:-2]}{layers})\ndef Xform "World" (\n{head}\n)\n{{\n{body}\n}}\n')
    return file


def part(file: str) -> None:
    """Write a layer with a floor."""
    Path(file).parent.mkdir(parents=True, exist_ok=True)
    Path(file).write_text(_HEAD + _FLOOR)


_VARIANT = (
    'variants = {\n string look = "a"\n}\nprepend variantSets = "look"',
    'variantSet "look" = {\n "a" (\n prepend references = @../assets/part.usda@\n ) {\n }\n}',
)
_WAYS = {
    "reference": {"head": "prepend references = @../assets/part.usda@"},
    "payload": {"head": "prepend payload = @../assets/part.usda@"},
    "sublayer": {"sublayers": "@../assets/part.usda@"},
    "variant": {"head": _VARIANT[0], "body": _VARIANT[1]},
}


@pytest.mark.parametrize("way", _WAYS)
def test_files_below_the_root_are_read(way, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    part("show/assets/part.usda")
    file = stage("show/scenes/scene.usda", **_WAYS[way])
    with pytest.raises(BridgeError, match=r"'\.\./assets/part\.usda', which is outside of its folder") as refused:
        import_map(file, "x.yaml")
    root = re.search(r"--root (\S+)", str(refused.value))[1]
    assert Path(root) == (tmp_path / "show").resolve()
    assert import_map(file, "x.yaml", root=root).free_area == _WHOLE
    assert import_map(file, "y.yaml", root="show").free_area == _WHOLE
    with pytest.raises(BridgeError, match="outside of its folder and of the root"):
        import_map(file, "z.yaml", root="show/scenes")


def test_files_outside_of_the_root_are_not_read(tmp_path, monkeypatch) -> None:
    """Neither by a path, nor by a link, nor by an address, nor by another layer."""
    monkeypatch.chdir(tmp_path)
    part("secret/part.usda")
    Path("show/assets").mkdir(parents=True)
    Path("show/assets/link.usda").symlink_to(tmp_path / "secret/part.usda")
    stage("show/assets/chain.usda", head="prepend references = @../../secret/part.usda@")
    for name in ("../../secret/part.usda", "../assets/link.usda", "../assets/chain.usda", "https://127.0.0.1:9/a.usda"):
        file = stage("show/scenes/scene.usda", head=f"prepend references = @{name}@")
        with pytest.raises(BridgeError, match="outside of its folder and of the root"):
            import_map(file, "x.yaml", root="show")
    part("show/assets/part.usda")
    whole = (tmp_path / "show/assets/part.usda").as_posix()
    file = stage("show/scenes/scene.usda", head=f"prepend references = @{whole}@")
    assert import_map(file, "x.yaml", root="show").free_area == _WHOLE


def test_names_that_are_searched_for_lead_nowhere_else(tmp_path, monkeypatch) -> None:
    """A name without ``./`` is looked for beside the stage, too, and what is found there is checked like all."""
    monkeypatch.chdir(tmp_path)
    part("part.usda")
    stage("show/sub/inner.usda", head="prepend references = @beside.usda@")
    stage("show/beside.usda", head="prepend references = @../part.usda@")
    file = stage("show/scene.usda", head="prepend references = @./sub/inner.usda@")
    with pytest.raises(BridgeError, match=r"'\.\./part\.usda', which is outside"):
        import_map(file, "x.yaml")


@pytest.mark.parametrize("kind", ["", "Xform "])
def test_value_clips_are_not_read(kind, tmp_path, monkeypatch) -> None:
    """Also a clip of a prim without a type, which changes the prims below it."""
    monkeypatch.chdir(tmp_path)
    over = 'over "Part"\n{\n    over "Plane"\n    {\n        double width.timeSamples = {0: 8}\n    }\n}\n'
    Path("clip.usda").write_text(_HEAD + over)
    clips = (
        '    clips = {\n dictionary default = {\n asset[] assetPaths = [@./clip.usda@]\n string primPath = "/Part"\n'
        " double2[] active = [(0, 0)]\n double2[] times = [(0, 0)]\n asset manifestAssetPath = @./clip.usda@\n }\n }"
    )
    plane = '    def Plane "Plane"\n    {\n        double length = 3\n    }'
    Path("scene.usda").write_text(f'{_HEAD}def {kind}"World" (\n{clips}\n)\n{{\n{plane}\n}}\n')
    with pytest.raises(BridgeError, match="/World has value clips"):
        import_map("scene.usda", "x.yaml")
    command = [sys.executable, "-c", "from pxr import Usd; Usd.Stage.Open('scene.usda').Export('flat.usdc')"]
    subprocess.run(command, check=True)
    assert import_map("flat.usdc", "x.yaml").free_area == pytest.approx(24, rel=0.03)


def test_the_command_that_flattens_a_stage_works(tmp_path, monkeypatch) -> None:
    """It is run as the advice says, where only pip's usd-core is installed, which has no commands."""
    monkeypatch.chdir(tmp_path)
    part("assets/part.usda")
    file = stage("scenes/scene.usda", head="prepend references = @../assets/part.usda@")
    with pytest.raises(BridgeError) as refused:
        import_map(file, "x.yaml")
    program, *arguments = shlex.split(re.search(r'python -c ".*"', str(refused.value))[0])
    assert program == "python"
    subprocess.run([sys.executable, *arguments], check=True)
    assert import_map("flat.usdc", "x.yaml").free_area == _WHOLE


def test_missing_and_unknown_files_do_not_stop_geometry(tmp_path, monkeypatch) -> None:
    """Materials, textures and layers that are not there, and files of a kind that the library does not read."""
    monkeypatch.chdir(tmp_path)
    part("assets/part.usda")
    Path("assets/fine.mtlx").write_text('<?xml version="1.0"?><materialx version="1.38"></materialx>')
    Path("assets/scan.xyz").write_text("0 0 0")
    names = ("part.usda", "none.usda", "fine.mtlx", "none.mtlx", "../../far.mtlx", "scan.xyz")
    listed = ", ".join(f"@./{name}@" for name in names)
    texture = '    def Shader "s"\n    {\n        asset inputs:file = @./wood.png@\n    }'
    result = import_map(stage("assets/scene.usda", head=f"prepend references = [{listed}]", body=texture), "x.yaml")
    assert result.free_area == _WHOLE
    assert "2 of its layers were not found, such as 'none.mtlx'" in " ".join(result.notes)
    assert any("of a kind that the library does not read" in note and "'scan.xyz'" in note for note in result.notes)
    assert "one of its textures was not found: 'wood.png'" in result.notes


def test_a_damaged_layer_is_named_and_is_no_missing_one(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    part("part.usda")
    Path("cut.usda").write_text('#usda 1.0\ndef Mesh "a" {\n    point3f[] points = [(0,')
    Path("cut.usdc").write_bytes(b"PXR-USDC" + bytes(60))
    for name in ("cut.usda", "cut.usdc"):
        file = stage("scene.usda", head=f"prepend references = [@./part.usda@, @./{name}@]")
        with pytest.raises(BridgeError, match=f"its layer '{name}' is damaged"):
            import_map(file, "x.yaml")
    file = stage("scene.usda", head="prepend references = [@./part.usda@, @./gone.usda@]")
    assert "one of its layers was not found: 'gone.usda'" in import_map(file, "x.yaml").notes
