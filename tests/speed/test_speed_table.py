"""The command that prints the speed table measures what it says; how fast irsim is, no test asserts."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
import yaml

import irsim
from tests.speed.__main__ import main, measure
from tests.speed.learning import CASES
from tests.speed.learning import main as learning
from tests.speed.scenes import SCENES

pytestmark = pytest.mark.one_python


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_has_the_robots_and_beams_that_are_counted(name: str, tmp_path: Path) -> None:
    scene, file = SCENES[name], tmp_path / "scene.yaml"
    file.write_text(yaml.safe_dump(scene.build()))
    env = irsim.make(file, display=False, log_level="ERROR")
    assert len(env.robot_list) == scene.agents
    assert env.simulation.world.beams_per_world >= scene.rays
    assert all(not robot.collision for robot in env.robot_list)


def test_the_table_compares_with_another_interpreter(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["dash_1", "batch_lidar180", "--peer", sys.executable, "--rounds", "1", "--seconds", "0.01"]) == 0
    head, _, single, batch = capsys.readouterr().out.splitlines()
    cells = [cell.strip() for cell in single.strip("|").split("|")]
    assert dict(zip([cell.strip() for cell in head.strip("|").split("|")], cells, strict=True))["scene"] == "dash_1"
    assert 0.1 < float(cells[5]) < 10  # irsim against itself
    assert "M beams" in batch
    assert batch.strip("|").split("|")[5].strip() == ""


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_the_table_of_learning_times_each_task(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("gymnasium")
    assert learning([name, "--ways", "1/1", "1/2", "--repeats", "1", "--seconds", "0.01"]) == 0
    *_, one, two = capsys.readouterr().out.splitlines()
    for row, workers in ((one, "1"), (two, "2")):
        cells = [cell.strip() for cell in row.strip("|").split("|")]
        assert cells[:4] == [name, f"{CASES[name].slots:,}", "1", workers]
        assert int(cells[4].replace(",", "")) > 0


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["step", "act", "plan", "render", "savefig", "gif"])
def test_each_way_to_measure_works(mode: str, tmp_path: Path) -> None:
    name = next(name for name, scene in SCENES.items() if scene.mode == mode)
    assert measure(name, sys.executable, tmp_path, seconds=0.01)["step_s"] > 0


def test_a_simulator_that_fails_is_named(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="dash_1 failed with"):
        measure("dash_1", "false", tmp_path, seconds=0.01)


def test_an_unknown_scene_is_refused_with_the_known_ones(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["dash_2"])
    assert "dash_100" in capsys.readouterr().err
