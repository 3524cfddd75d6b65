"""The page about CARLA: its scenarios run as written, with a stand-in (not CARLA)."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from irsim.cli.app import app
from tests.interop.carla.conftest import ROOT, StandIn

pytestmark = pytest.mark.interop
PAGE = (ROOT / "skills" / "irsim-runner" / "bridges" / "carla.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["crossing.yaml", "drive.yaml"])
def test_scenarios_run(stand_in: Callable[..., StandIn], tmp_path: Path, name: str) -> None:
    town = stand_in(ground=0.1)
    (text,) = [one for one in re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL) if f"# {name}" in one]
    path, out = tmp_path / name, tmp_path / "run.xosc"
    path.write_text(text.replace("{name: carla", f"{{name: carla, port: {town.port}"))
    done = CliRunner().invoke(app, ["run", str(path), "--steps", "150", "--json", "--export", str(out)])
    assert done.exit_code == 0, done.output
    result = json.loads(done.stdout)
    assert result["steps"] > 50
    if name == "drive.yaml":
        assert result["outcome"] == "success", "point 3 of the checklist: the car stops at the end"
    town.check_clean()
    assert out.read_text().startswith("<?xml")
    spawned = [event["blueprint"].split(".")[0] for event in town.events("spawn")]
    assert spawned == (["walker"] * 4 if name == "crossing.yaml" else ["vehicle", "sensor"])
    if name == "crossing.yaml":
        first = town.path_of("obstacle_0")
        assert first[-1, 1] < first[0, 1] - 5  # point 2 of the checklist


def test_recorded_runs_are_exported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (text,) = [one for one in re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL) if "# crossing.yaml" in one]
    Path("crossing.yaml").write_text(text.split("bridges:")[0])
    (block,) = [one for one in re.findall(r"```bash\n(.*?)```", PAGE, re.DOTALL) if "openscenario" in one]
    for command in block.splitlines():
        done = CliRunner().invoke(app, shlex.split(command.split("#")[0])[1:])
        assert done.exit_code == 0, done.output
    (file,) = Path().glob("*.xosc")
    assert '<LogicFile filepath="Town03"/>' in file.read_text()
