"""A run among splats: the page as a file (tests/interop/test_splats.py opens it in a browser), pictures and films."""

from __future__ import annotations

import base64
import json
import re
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import irsim
from irsim.bridges.base import BridgeError
from irsim.bridges.splats.page import write_page
from irsim.bridges.splats.preview import PreviewOptions, write_preview
from irsim.bridges.splats.reading import read_splats
from irsim.cli.app import app
from irsim.common.files import TargetError
from irsim.runs.files import RunError
from tests.bridges.splats.conftest import Site


def content(page: Path) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Head and arrays of a page."""
    match = re.search(r'id="data">([^<]*)<', page.read_text(encoding="utf-8"))
    assert match
    block = zlib.decompress(base64.b64decode(match[1]))
    (length,) = struct.unpack_from("<I", block)
    head = json.loads(block[4 : 4 + length])
    columns = head["columns"]
    return head, {c["name"]: np.frombuffer(block, f"<{c['kind']}", c["count"], c["begin"]) for c in columns}


def test_a_page_has_the_scene_in_the_frame_of_the_run(site: Site, tmp_path: Path) -> None:
    target = tmp_path / "room.html"
    result = write_page(site.scene, site.run, target)
    head, arrays = content(target)
    splats = read_splats(site.scene)
    assert (result.splats, result.of, result.bytes) == (len(splats), len(splats), target.stat().st_size)
    assert result.notes == []
    center = arrays["center"].reshape(-1, 3)
    np.testing.assert_allclose(center[:, 0], splats.center[:, 2], atol=1e-4)  # forward
    np.testing.assert_allclose(center[:, 2], 1.2 - splats.center[:, 1], atol=0.02)  # above the floor
    low, step = head["scales"]
    np.testing.assert_allclose(np.exp(low + step * arrays["scale"]), splats.scale.ravel(), rtol=0.03)
    np.testing.assert_allclose(arrays["color"].reshape(-1, 4)[:, 3] / 255, splats.opacity, atol=0.003)
    pose = arrays["pose"].reshape(head["rows"], len(head["objects"]), 3)
    assert [item["name"] for item in head["objects"]] == ["rover", "walker"]
    np.testing.assert_allclose(pose, site.run.trace().pose[:, :2], atol=1e-5)
    assert len(head["times"]) == head["rows"] == site.run.last_step + 1


def test_a_page_asks_for_nothing(site: Site, tmp_path: Path) -> None:
    write_page(site.scene, site.run, tmp_path / "room.html")
    text = (tmp_path / "room.html").read_text(encoding="utf-8")
    assert not re.search(r"https?://|import\s.*from|src=|{{", text)
    assert "default-src 'none'" in text


def test_a_page_keeps_what_is_seen_most(site: Site, tmp_path: Path) -> None:
    result = write_page(site.scene, site.run, tmp_path / "room.html", max_splats=1000)
    _, arrays = content(tmp_path / "room.html")
    assert result.splats == len(arrays["center"]) / 3 == 1000
    assert result.notes == [f"the page has 1,000 of {result.of:,} splats; --max-splats changes that"]
    assert arrays["color"].reshape(-1, 4)[:, 3].min() > 200  # no fog


def test_names_are_not_read_as_html(site: Site, tmp_path: Path) -> None:
    scene = tmp_path / "<script>alert(1)<.ply"
    scene.write_bytes(site.scene.read_bytes())
    write_page(scene, site.run, tmp_path / "a.html", max_splats=10)
    assert "<script>alert" not in (tmp_path / "a.html").read_text(encoding="utf-8")


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
    assert blue(shown)[45:62, 50:70].mean() > 0.4
    assert (shown != 255).any(axis=2).mean() > 0.6  # the scene is there


def test_the_view_from_above_follows_the_robot(site: Site, tmp_path: Path) -> None:
    columns = [np.flatnonzero(blue(drawn(site, tmp_path, step, view="above")).sum(axis=0) > 4) for step in (0, 30)]
    assert columns[1].mean() - columns[0].mean() > 20  # it drives along x, which is to the right


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
    options = PreviewOptions(**SMALL, every=40)  # type: ignore[arg-type]
    film = write_preview(site.scene, site.run, tmp_path / "film.gif", options=options)
    with Image.open(tmp_path / "film.gif") as opened:
        assert opened.n_frames == film.frames == site.run.last_step // 40 + 1


def test_mistakes_leave_no_file(site: Site, tmp_path: Path) -> None:
    with pytest.raises(TargetError):
        write_page(site.scene, site.run, tmp_path / "a.png")
    with pytest.raises(RunError):
        write_page(site.scene, "none", tmp_path / "a.html", workspace=tmp_path)
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


def test_the_commands(site: Site, tmp_path: Path) -> None:
    target, page = tmp_path / "a.png", tmp_path / "a.html"
    arguments = ["bridge", "page", str(site.scene), "--run", str(site.run.folder), "-o", str(page)]
    done = CliRunner().invoke(app, [*arguments, "--max-splats", "50", "--json"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.output)["splats"] == 50
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
