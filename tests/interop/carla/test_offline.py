"""The frame, by maps that the official client reads without a server, and the page about CARLA, with a stand-in."""

from __future__ import annotations

import json
import math
import re
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from irsim.bridges.carla.places import Places
from irsim.bridges.doctor import LEFT_CURVE, examine
from irsim.cli.app import app
from tests.interop.carla.conftest import ROOT, StartTown

pytestmark = pytest.mark.interop


@pytest.fixture
def carla() -> Any:
    return pytest.importorskip("carla")


def test_a_left_curve_has_negative_y_and_negative_yaw_in_carla(carla: Any) -> None:
    road = carla.Map("curve", LEFT_CURVE)
    at = [road.get_waypoint_xodr(1, -1, float(s)).transform for s in range(1, 20)]
    yaw = np.array([math.remainder(one.rotation.yaw, 360) for one in at])
    assert (yaw < 0).all()
    assert (np.diff(yaw) < 0).all()
    assert at[-1].location.y < -5
    places = Places()
    poses = places.to_irsim(np.array([[one.location.x, one.location.y, one.rotation.yaw] for one in at]))
    s = np.arange(1, 20)
    radius = 21.75  # an arc with the radius 20 m, whose right lane is 3.5 m wide
    np.testing.assert_allclose(poses[:, 0], radius * np.sin(s / 20), atol=0.02)
    np.testing.assert_allclose(poses[:, 1], 20 - radius * np.cos(s / 20), atol=0.02)
    np.testing.assert_allclose(poses[:, 2], s / 20, atol=0.01)


def test_transforms_of_the_client_turn_as_ours(carla: Any) -> None:
    places = Places(12.0, -7.0, 140.0)
    for pose in ([0.0, 0.0, 0.0], [3.0, -2.0, 1.0], [-5.0, 4.0, -2.5]):
        x, y, yaw = places.to_carla(np.array(pose))
        transform = carla.Transform(carla.Location(x=x, y=y), carla.Rotation(yaw=yaw))
        ahead = transform.transform(carla.Location(x=2.0))
        left = transform.transform(carla.Location(y=-1.0))
        cosine, sine = math.cos(pose[2]), math.sin(pose[2])
        steps = np.array([[2 * cosine, 2 * sine, 0], [-sine, cosine, 0]])
        wanted = places.to_carla(np.array([*pose[:2], 0]) + steps)
        assert (ahead.x, ahead.y) == pytest.approx(wanted[0, :2].tolist(), abs=1e-4)
        assert (left.x, left.y) == pytest.approx(wanted[1, :2].tolist(), abs=1e-4)


def test_the_doctor_tries_the_client(carla: Any) -> None:
    (health,) = examine(["carla"])
    assert health.state == "ready"
    assert health.version.startswith("0.9.")


PAGE = (ROOT / "skills" / "irsim-runner" / "bridges" / "carla.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["crossing.yaml", "drive.yaml"])
def test_scenarios_run(stand_in: StartTown, name: str) -> None:
    town = stand_in(ground=0.1)
    (text,) = [one for one in re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL) if f"# {name}" in one]
    Path(name).write_text(text.replace("{name: carla", f"{{name: carla, port: {town.port}"))
    done = CliRunner().invoke(app, ["run", name, "--steps", "150", "--json", "--export", "run.xosc"])
    assert done.exit_code == 0, done.output
    result = json.loads(done.stdout)
    assert result["steps"] > 50
    if name == "drive.yaml":
        assert result["outcome"] == "success", "point 3 of the checklist: the car stops at the end"
    town.check_clean()
    assert Path("run.xosc").read_text().startswith("<?xml")
    spawned = [event["blueprint"].split(".")[0] for event in town.events("spawn")]
    assert spawned == (["walker"] * 4 if name == "crossing.yaml" else ["vehicle", "sensor"])
    if name == "crossing.yaml":
        first = town.path_of("obstacle_0")
        assert first[-1, 1] < first[0, 1] - 5  # point 2 of the checklist


def test_recorded_runs_are_exported() -> None:
    (text,) = [one for one in re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL) if "# crossing.yaml" in one]
    Path("crossing.yaml").write_text(text.split("bridges:")[0])
    (block,) = [one for one in re.findall(r"```bash\n(.*?)```", PAGE, re.DOTALL) if "openscenario" in one]
    for command in block.splitlines():
        done = CliRunner().invoke(app, shlex.split(command.split("#")[0])[1:])
        assert done.exit_code == 0, done.output
    (file,) = Path().glob("*.xosc")
    assert '<LogicFile filepath="Town03"/>' in file.read_text()
