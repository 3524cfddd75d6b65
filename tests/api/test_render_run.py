"""Recorded runs are drawn as they were, whatever moved their objects."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import irsim
from irsim.api.render_run import render_run
from irsim.bundled import templates
from irsim.cli.app import app
from irsim.policies import FunctionPolicy

SCENE = """\
world: {width: 10, height: 10, step_time: 0.1}
robot: {name: rover, kinematics: {name: omni}, state: [1, 1, 0], goal: [9, 1], vel_max: [2, 2]}
"""


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A run in which a policy of Python drives straight up for 30 steps."""
    monkeypatch.chdir(tmp_path)
    Path("scene.yaml").write_text(SCENE)
    up = FunctionPolicy(lambda seen: np.tile([0.0, 2.0], (len(seen), 1)), name="up", output="velocity")
    return str(irsim.run("scene.yaml", policy=up, steps=30, record=True, seed=1).run_id)


def rows_with_robot(picture: str) -> float:
    """How far up in a picture the middle of what is colored is, from 0 to 1."""
    with Image.open(picture) as file:
        shades = np.asarray(file.convert("RGB")).astype(int)
    colored = np.argwhere(np.ptp(shades, axis=2) > 60)
    return 1 - float(colored[:, 0].mean()) / len(shades)


def test_a_picture_shows_what_the_policy_did(run: str) -> None:
    for step in (0, 30):
        done = CliRunner().invoke(
            app, ["render", run, "-o", f"at-{step}.png", "--step", str(step), "--overlays", "goals"]
        )
        assert done.exit_code == 0, done.output
    shown = render_run(run, "end.png")
    assert (shown.steps, shown.frames) == (30, 1)
    assert rows_with_robot("at-30.png") > rows_with_robot("at-0.png") + 0.1
    assert shown.reproduce.startswith(f"irsim render {run} --step 30 ")


def test_a_strip_and_an_animation_end_with_the_run(run: str) -> None:
    assert CliRunner().invoke(app, ["render", "last", "-o", "strip.png", "--strip", "3"]).exit_code == 0
    with Image.open("strip.png") as sheet:
        assert sheet.width > 300
    shown = render_run(run, "all.gif", size=100)
    assert (shown.steps, shown.frames) == (30, 31)
    with Image.open("all.gif") as film:
        assert getattr(film, "n_frames", 1) > 10


def test_what_would_change_a_run_is_refused(run: str) -> None:
    for option in (["--seed", "3"], ["--policy", "orca"], ["--strict"]):
        done = CliRunner().invoke(app, ["render", run, "-o", "a.png", *option])
        assert done.exit_code == 2, done.output
        assert "cannot change the recorded run" in done.output
    done = CliRunner().invoke(app, ["render", run, "-o", "a.png", "--step", "31"])
    assert done.exit_code != 0
    assert "has no step 31" in done.output
    assert not Path("a.png").exists()


def test_people_face_where_they_walked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Records have no velocities, and the drive of people never turns them: their motion says where they look."""
    monkeypatch.chdir(tmp_path)
    scene = templates.scenario_file("crossing")
    run = str(irsim.run(scene, seed=1, record=True, steps=60).run_id)
    render_run(run, "recorded.png", steps=60)
    irsim.render(scene, "live.png", seed=1, steps=60)
    with Image.open("recorded.png") as recorded, Image.open("live.png") as live:
        apart = np.asarray(recorded.convert("RGB")).astype(int) - np.asarray(live.convert("RGB")).astype(int)
    assert np.abs(apart).max() <= 8
