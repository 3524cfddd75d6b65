"""Saved figures: names, formats, options, and never half a file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

Make = Callable[..., Any]
SCENE = "{world}\nrobot: {{kinematics: {{name: diff}}, behavior: {{name: dash}}, shape: {{name: circle}}}}"


def scene(world: str = "") -> str:
    return SCENE.format(world=f"world: {{{world}}}" if world else "")


def files(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def test_names(make: Make, tmp_path: Path) -> None:
    env = make(scene())
    assert env.save_figure() == tmp_path / "figure" / "scenario.png"
    assert env.save_figure("start") == tmp_path / "figure" / "start.png"
    assert env.save_figure("deep/er/start.png") == tmp_path / "figure" / "deep" / "er" / "start.png"
    for _ in range(7):
        env.step()
    assert env.save_figure("now.png", include_index=True).name == "now_0007.png"
    assert env.save_figure(save_gif=True) == tmp_path / "animation_buffer" / "scenario_0007.png"
    absolute = tmp_path / "elsewhere" / "v1.5 final.jpg"
    assert env.save_figure(absolute) == absolute
    with Image.open(absolute) as image:
        assert image.format == "JPEG"


@pytest.mark.parametrize(
    ("suffix", "starts"),
    [("pdf", b"%PDF"), ("svg", b"<?xml"), ("jpg", b"\xff\xd8"), ("webp", b"RIFF"), ("eps", b"%!PS")],
)
def test_formats(make: Make, suffix: str, starts: bytes) -> None:
    path = make(scene()).save_figure(f"picture.{suffix}")
    assert path.read_bytes().startswith(starts)


def test_a_format_may_be_said_in_the_scenario_or_the_call(make: Make) -> None:
    env = make(scene("plot: {saved_figure: {format: svg}}"))
    assert env.save_figure().name == "scenario.svg"
    assert env.save_figure("other").name == "other.svg"
    assert env.save_figure("third.png").name == "third.png"
    assert env.save_figure("fourth.png", format="pdf").name == "fourth.pdf"
    assert env.save_figure("fifth").name == "fifth.svg"


def test_an_unknown_format_is_refused(make: Make, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"'docx'.*png.*pdf"):
        make(scene()).save_figure("picture.docx")
    assert files(tmp_path) == ["scenario.yaml"]


def test_options_of_savefig_work_and_hold(make: Make) -> None:
    env = make(scene("plot: {figure_pixels: [200, 200]}"))
    with Image.open(env.save_figure("a", dpi=300, bbox_inches=None)) as image:
        assert image.size == (600, 600)
    with Image.open(env.save_figure("b")) as image:
        assert image.size == (600, 600)
    with Image.open(env.save_figure("c", transparent=True)) as image:
        assert image.convert("RGBA").getpixel((0, 0))[3] == 0


def test_quick_png_and_savefig_agree(make: Make) -> None:
    env = make(scene("plot: {saved_figure: {bbox_inches: null}}"))
    quick = env.save_figure("quick")
    slow = env.save_figure("slow", facecolor="white")
    with Image.open(quick) as a, Image.open(slow) as b:
        assert (np.asarray(a) == np.asarray(b.convert("RGB"))).all()
        assert round(a.info["dpi"][0]) == 100


def test_tight_boxes_agree_with_those_of_savefig(make: Make) -> None:
    env = make(scene("width: 20, height: 6"))
    with Image.open(env.save_figure("quick")) as a, Image.open(env.save_figure("slow", facecolor="white")) as b:
        assert np.abs(np.subtract(a.size, b.size)).max() <= 2


def test_nothing_is_left_behind_when_saving_fails(make: Make, tmp_path: Path) -> None:
    env = make(scene())
    good = env.save_figure("picture.svg")
    before = good.read_bytes()
    with pytest.raises(TypeError):
        env.save_figure("picture.svg", no_such_option=1)
    assert files(tmp_path) == ["figure/picture.svg", "scenario.yaml"]
    assert good.read_bytes() == before


def test_headless_environments_draw_nothing(make: Make, tmp_path: Path) -> None:
    env = make(scene(), headless=True, save_ani=True)
    env.step()
    env.render()
    env.draw_points([[1, 1]])
    assert env.save_figure() is None
    env.end()
    assert files(tmp_path) == ["scenario.yaml"]
