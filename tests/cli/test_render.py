"""``irsim render`` and ``irsim demo``."""

from __future__ import annotations

import re
from pathlib import Path

import imageio_ffmpeg
import pytest
from PIL import Image

from irsim.api import snapshot
from tests.cli.conftest import Run, parsed


@pytest.mark.parametrize(("suffix", "kind"), [("png", "PNG"), ("gif", "GIF")])
def test_draws_pictures_and_animations(irsim: Run, room: Path, suffix: str, kind: str) -> None:
    result = irsim("render", "room.yaml", "-o", f"room.{suffix}", "--step", "5", "--seed", "3", code=0)
    with Image.open(f"room.{suffix}") as picture:
        assert picture.format == kind
        assert getattr(picture, "n_frames", 1) == (6 if kind == "GIF" else 1)
    assert f"wrote room.{suffix}" in result.stdout.replace(str(Path.cwd()) + "/", "")
    assert result.stdout.rstrip().endswith(f"irsim render room.yaml --seed 3 --step 5 -o room.{suffix}")


def test_size_is_the_longer_side(irsim: Run, room: Path) -> None:
    data = parsed(irsim("render", "room.yaml", "-o", "room.png", "--size", "400", "--json"))
    with Image.open("room.png") as picture:
        assert 380 <= max(picture.size) <= 400  # empty margins are cut off
        assert list(picture.size) == data["size"]
    assert "--size 400" in data["reproduce"]


@pytest.mark.parametrize("suffix", ["png", "gif"])
def test_a_part_of_the_world(irsim: Run, room: Path, suffix: str) -> None:
    region = ["--region", "-1", "0.5", "1", "1.5", "--size", "400", "--step", "2"]
    data = parsed(irsim("render", "room.yaml", "-o", f"part.{suffix}", *region, "--json"))
    width, height = data["size"]
    assert width == 400
    assert height < 300
    assert "--region -1 0.5 1 1.5" in data["reproduce"]


def test_no_part_of_any_world(irsim: Run, room: Path) -> None:
    result = irsim("render", "room.yaml", "-o", "part.png", "--region", "1", "0", "1", "5", code=2)
    assert "bad-argument" in result.output
    assert "x_min, y_min, x_max, y_max" in result.output


def test_films_need_no_display_and_no_ffmpeg_of_the_system(irsim: Run, room: Path, tmp_path: Path) -> None:
    assert irsim("render", "room.yaml", "-o", "room.mp4", "--step", "5").exit_code == 0
    assert (tmp_path / "room.mp4").read_bytes()[4:8] == b"ftyp"


def test_without_the_extra_the_ffmpeg_of_the_system_writes_films(
    irsim: Run, room: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    installed = Path(imageio_ffmpeg.get_ffmpeg_exe())
    monkeypatch.setattr("irsim.graphics.encoding.video.find_spec", lambda name: None)
    monkeypatch.setenv("PATH", str(tmp_path))
    refused = irsim("render", "room.yaml", "-o", "room.mp4", "--step", "5", code=2)
    assert "missing-extra" in refused.output
    assert "pip install 'irsim-mcp[video]'" in refused.output
    assert not (tmp_path / "room.mp4").exists()
    (tmp_path / "ffmpeg").symlink_to(installed)
    assert irsim("render", "room.yaml", "-o", "room.mp4", "--step", "5").exit_code == 0
    assert (tmp_path / "room.mp4").read_bytes()[4:8] == b"ftyp"


@pytest.mark.slow
def test_demo_leaves_a_gif_and_says_where(irsim: Run, tmp_path: Path) -> None:
    result = irsim("demo", code=0)
    assert "success" in result.stdout
    assert "irsim-demo.gif" in result.stdout
    assert "irsim demo --seed" in result.stdout
    with Image.open(tmp_path / "irsim-demo.gif") as picture:
        assert getattr(picture, "n_frames", 1) > 20


def test_a_strip_is_the_picture_of_the_tool(irsim: Run, room: Path, tmp_path: Path) -> None:
    data = parsed(irsim("render", "room.yaml", "-o", "strip.png", "--strip", "3", "--step", "4", "--json"))
    assert (data["frames"], data["steps"]) == (3, 4)
    assert "--strip 3" in data["reproduce"]
    assert (tmp_path / "strip.png").read_bytes() == snapshot("room.yaml", strip=3, steps=4).png
    refused = irsim("render", "room.yaml", "-o", "strip.gif", "--strip", "3")
    assert refused.exit_code != 0
    assert "unknown-format" in refused.output


def test_overlays_are_those_of_the_tool(irsim: Run, room: Path, tmp_path: Path) -> None:
    data = parsed(irsim("render", "room.yaml", "-o", "plan.png", "--overlays", "plan, goals", "--step", "3", "--json"))
    assert "--overlays plan,goals" in data["reproduce"]
    assert (tmp_path / "plan.png").read_bytes() == snapshot("room.yaml", steps=3, overlays=["plan", "goals"]).png
    irsim("render", "room.yaml", "-o", "bare.png", "--overlays", "", "--seed", "0", code=0)
    assert (tmp_path / "bare.png").read_bytes() == snapshot("room.yaml", overlays=[], seed=0).png


def test_an_unknown_overlay_names_the_nearest(irsim: Run, room: Path, tmp_path: Path) -> None:
    refused = irsim("render", "room.yaml", "-o", "plan.png", "--overlays", "plann", code=2)
    assert "'plann' is not a valid overlay" in refused.output
    assert "write 'plan'" in refused.output
    assert not (tmp_path / "plan.png").exists()
    as_pdf = irsim("render", "room.yaml", "-o", "plan.pdf", "--overlays", "plan", code=2)
    assert "unknown-format" in as_pdf.output


PLACES = """\
world: {width: 10, height: 10}
robot: {name: scout, state: [1, 1, 0], goal: [4, 1], kinematics: {name: diff}, shape: {name: circle, radius: 0.2},
        behavior: {name: dash}}
"""


def test_render_prints_what_the_file_becomes_and_validate_does_when_asked(irsim: Run, tmp_path: Path) -> None:
    (tmp_path / "places.yaml").write_text(PLACES)
    line = "- diff, circle r 0.2, dash, vel_max [1, 1]: 'scout' at (1.00, 1.00) heading 0.00 goal (4.00, 1.00)"
    assert line in irsim("render", "places.yaml", "-v", "-o", "places.png").stdout
    data = parsed(irsim("render", "places.yaml", "-o", "places.png", "--json"))
    assert data["table"]["rows"][0]["names"] == ["scout"]
    assert line not in irsim("validate", "places.yaml").stdout
    assert line in irsim("validate", "places.yaml", "--table").stdout
    assert irsim("validate", "places.yaml", "--table", "--json").exit_code == 2
    assert "belongs to scenario files" in irsim("validate", "maps_v1", "--table").output


@pytest.mark.parametrize("more", [[], ["--strip", "2"]])
def test_a_picture_does_not_replace_the_map_or_an_image_of_its_scenario(
    irsim: Run, tmp_path: Path, more: list[str]
) -> None:
    for name in ("hall.png", "rover.png"):
        Image.new("L", (40, 40), 255).save(tmp_path / name)
    kept = {name: (tmp_path / name).read_bytes() for name in ("hall.png", "rover.png")}
    robot = "{kinematics: {name: diff}, state: [1, 1, 0], goal: [3, 3, 0], description: rover.png}"
    text = f"world: {{width: 4, height: 4, obstacle_map: hall.png}}\nrobot: {robot}\n"
    (tmp_path / "hall.yaml").write_text(text)
    for name in kept:
        refused = irsim("render", "hall.yaml", "-o", name, *more, code=2)
        assert f"the scenario reads '{name}'. Fix: name another file with -o." in refused.output
    assert {name: (tmp_path / name).read_bytes() for name in kept} == kept
    irsim("render", "hall.yaml", "-o", "drawn.png", *more, code=0)


@pytest.mark.parametrize("more", [[], ["--strip", "2"]])
def test_a_view_that_is_moved_is_said(irsim: Run, tmp_path: Path, more: list[str]) -> None:
    (tmp_path / "places.yaml").write_text(PLACES.replace("world: {", "world: {plot: {viewpoint: scout}, "))
    drawn = ["render", "places.yaml", "-o", "places.png", "--step", "1", *more]
    out = irsim(*drawn).stdout
    assert "note: the picture shows only x " in out
    assert "as plot.viewpoint centres the view" in out
    region = re.search(r"--region (\S+) (\S+) (\S+) (\S+) shows the world", out)
    assert region is not None
    assert "note:" not in irsim(*drawn, "--region", *region.groups()).stdout
    (tmp_path / "places.yaml").write_text(PLACES)
    assert "note:" not in irsim(*drawn).stdout


@pytest.mark.parametrize("more", [[], ["--strip", "3"]])
def test_a_picture_after_the_arrival_says_when_the_episode_ended(irsim: Run, tmp_path: Path, more: list[str]) -> None:
    (tmp_path / "places.yaml").write_text(PLACES)
    late = irsim("render", "places.yaml", "-o", "places.png", "--step", "80", *more)
    assert "step 80 is beyond the end of the episode, which is step 29" in late.stdout
    soon = irsim("render", "places.yaml", "-o", "places.png", "--step", "20", *more)
    assert "beyond the end" not in soon.stdout


def test_a_suite_from_standard_input_is_told_to_come_as_a_file(irsim: Run, tmp_path: Path) -> None:
    result = irsim("validate", "-", input="suite: mine\nversion: 1\n", code=2)
    assert "give the name of its file" in result.output
