"""Without their libraries, exports to OpenUSD and CommonRoad say what to install, and write nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

import irsim
from irsim.bridges.export.export import export_run
from irsim.bridges.export.registry import find_format
from irsim.bridges.usd.files import export_scene
from irsim.common.extras import ExtraError
from irsim.common.files import TargetError

TEXT = """
world: {width: 5, height: 5, time_limit: 0.5}
robot:
  - {state: [1, 1, 0], goal: [4, 4], kinematics: {name: diff}, behavior: {name: dash},
     shape: {name: circle, radius: 0.2}}
"""


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "scene.yaml").write_text(TEXT)
    irsim.run(str(tmp_path / "scene.yaml"), record=tmp_path / "run")
    monkeypatch.setattr("irsim.common.extras.find_spec", lambda module: None)
    return tmp_path


@pytest.mark.parametrize(("name", "extra"), [("x.usda", "usd"), ("x.usdz", "usd"), ("x.xml", "scenarios")])
def test_a_run(scene: Path, name: str, extra: str) -> None:
    to = "commonroad" if name.endswith("xml") else None
    with pytest.raises(ExtraError, match=rf"pip install 'irsim-mcp\[{extra}\]'"):
        export_run(scene / "run", scene / name, to=to)
    assert not (scene / name).exists()


def test_a_scenario(scene: Path) -> None:
    with pytest.raises(ExtraError, match=r"irsim-mcp\[usd\]"):
        export_scene(scene / "scene.yaml", scene / "x.usda")


def test_suffixes(scene: Path) -> None:
    for suffix in (".usda", ".usdc", ".usdz", ".USDA"):
        assert find_format(None, Path(f"run{suffix}")).name == "usd"
    with pytest.raises((TargetError, ExtraError)):
        export_run(scene / "run", scene / "x.glb", to="usd")
