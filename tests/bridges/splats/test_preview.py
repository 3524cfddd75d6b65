"""Pictures and films of a run among splats."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import irsim
from irsim.bridges.base import BridgeError
from irsim.bridges.splats.preview import PreviewOptions, write_preview
from irsim.cli.app import app
from irsim.common.files import TargetError
from irsim.runs.files import RunError
from tests.bridges.splats.conftest import Site

SMALL = {"width": 120, "rows": 80, "fov": 80.0}


def blue(pixels: np.ndarray) -> np.ndarray:
    """Pixels with the color of the robot and its path, lit from any side."""
    red, green, other = np.moveaxis(pixels.astype(int), -1, 0)
    return (other > 110) & (red < 60) & (green < 60)


def drawn(site: Site, tmp_path: Path, step: int, **options: object) -> np.ndarray:
    target = tmp_path / "picture.png"
    write_preview(site.scene, site.run, target, options=PreviewOptions(**SMALL, **options), step=step)  # type: ignore[arg-type]
    with Image.open(target) as opened:
        return np.asarray(opened.convert("RGB"))


def test_the_robot_is_in_the_middle_of_the_view_from_behind(site: Site, tmp_path: Path) -> None:
    shown = drawn(site, tmp_path, 20)
    assert shown.shape == (80, 120, 3)
    robot = blue(shown)[45:62, 50:70]
    assert robot.mean() > 0.4
    assert (shown != 255).any(axis=2).mean() > 0.6  # the scene is there


def test_the_view_from_above_follows_the_robot(site: Site, tmp_path: Path) -> None:
    columns = [np.flatnonzero(blue(drawn(site, tmp_path, step, view="above")).sum(axis=0) > 4) for step in (0, 30)]
    moved = columns[1].mean() - columns[0].mean()
    assert moved > 20  # it drives along x, which is to the right


def test_the_robot_does_not_see_itself(site: Site, tmp_path: Path) -> None:
    shown = drawn(site, tmp_path, 0, view="robot", height=1.0)
    path = blue(shown)
    assert path[45:, 50:70].any()
    assert path.mean() < 0.1


def test_six_steps_and_a_film(site: Site, tmp_path: Path) -> None:
    sheet = write_preview(site.scene, site.run, tmp_path / "sheet.png", options=PreviewOptions(**SMALL))  # type: ignore[arg-type]
    assert (sheet.frames, sheet.steps) == (6, (0, site.run.last_step))
    with Image.open(tmp_path / "sheet.png") as opened:
        assert opened.size == (3 * 128 + 8, 2 * 108 + 8)
    film = write_preview(
        site.scene,
        site.run,
        tmp_path / "film.gif",
        options=PreviewOptions(**SMALL, every=15),  # type: ignore[arg-type]
    )
    with Image.open(tmp_path / "film.gif") as opened:
        assert opened.n_frames == film.frames == site.run.last_step // 15 + 1


def test_mistakes_leave_no_file(site: Site, tmp_path: Path) -> None:
    target = tmp_path / "a.png"
    with pytest.raises(RunError, match="there is no step 9999; it has the steps 0 to"):
        write_preview(site.scene, site.run, target, step=9999)
    with pytest.raises(BridgeError, match=r"has no robot 'walker'.*its robots are rover"):
        write_preview(site.scene, site.run, target, robot="walker")
    with pytest.raises(TargetError, match="suffixes"):
        write_preview(site.scene, site.run, tmp_path / "a.bmp")
    with pytest.raises(BridgeError, match="cannot be read"):
        write_preview(tmp_path / "none.ply", site.run, target)
    with pytest.raises(RunError, match="no single step"):
        write_preview(site.scene, site.run, tmp_path / "a.gif", step=1)
    assert not list(tmp_path.iterdir())


def test_the_command(site: Site, tmp_path: Path) -> None:
    target = tmp_path / "a.png"
    common = ["bridge", "preview", str(site.scene), "--run", str(site.run.folder), "-o", str(target)]
    done = CliRunner().invoke(app, [*common, "--step", "3", "--set", "width=40", "--set", "rows=30", "--view", "above"])
    assert done.exit_code == 0, done.output
    with Image.open(target) as opened:
        assert opened.size == (40, 30)
    done = CliRunner().invoke(app, [*common, "--set", "widht=40"])
    assert done.exit_code == 2
    assert "did you mean width" in done.output


def test_a_run_without_robots_has_nobody_to_follow(site: Site, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    run = irsim.run(text="world: {width: 9, height: 9}", seed=1, steps=2, record=True)
    with pytest.raises(BridgeError, match=r"has no robot\. Fix: record one with a robot"):
        write_preview(site.scene, str(run.run_id), tmp_path / "picture.png")
