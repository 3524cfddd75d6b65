"""Saved figures: names, formats, options, and never half a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.env.driving import Make, take_steps
from tests.rendering.conftest import Files

SCENE = "{world}\nrobot: {{kinematics: {{name: diff}}, behavior: {{name: dash}}, shape: {{name: circle}}}}"


def scene(world: str = "") -> str:
    return SCENE.format(world=f"world: {{{world}}}" if world else "")


def test_files_are_named_after_the_scenario_or_as_said(make: Make, tmp_path: Path) -> None:
    env = make(scene())
    take_steps(env, 7)
    absolute = tmp_path / "elsewhere" / "v1.5 final.jpg"
    for arguments, keys, path in (
        ([], {}, "figure/scenario.png"),
        (["start"], {}, "figure/start.png"),
        (["deep/er/start.png"], {}, "figure/deep/er/start.png"),
        (["now.png"], {"include_index": True}, "figure/now_0007.png"),
        ([], {"save_gif": True}, "animation_buffer/scenario_0007.png"),
        ([absolute], {}, absolute),
    ):
        assert env.save_figure(*arguments, **keys) == tmp_path / path
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
    names = [env.save_figure().name, env.save_figure("other").name, env.save_figure("third.png").name]
    assert names == ["scenario.svg", "other.svg", "third.png"]
    assert env.save_figure("fourth.png", format="pdf").name == "fourth.pdf"
    assert env.save_figure("fifth").name == "fifth.svg"


def test_an_unknown_format_is_refused(make: Make, files: Files) -> None:
    with pytest.raises(ValueError, match=r"'docx'.*png.*pdf"):
        make(scene()).save_figure("picture.docx")
    assert files() == ["scenario.yaml"]


def test_options_of_savefig_work_and_hold(make: Make) -> None:
    env = make(scene("plot: {figure_pixels: [200, 200]}"))
    for name, options in (("a", {"dpi": 300, "bbox_inches": None}), ("b", {})):
        with Image.open(env.save_figure(name, **options)) as image:
            assert image.size == (600, 600)
    with Image.open(env.save_figure("c", transparent=True)) as image:
        assert image.convert("RGBA").getpixel((0, 0))[3] == 0


def test_quick_png_and_savefig_agree(make: Make) -> None:
    env = make(scene("plot: {saved_figure: {bbox_inches: null}}"))
    with Image.open(env.save_figure("quick")) as a, Image.open(env.save_figure("slow", facecolor="white")) as b:
        assert (np.asarray(a) == np.asarray(b.convert("RGB"))).all()
        assert round(a.info["dpi"][0]) == 100


def test_tight_boxes_agree_with_those_of_savefig(make: Make) -> None:
    env = make(scene("width: 20, height: 6"))
    with Image.open(env.save_figure("quick")) as a, Image.open(env.save_figure("slow", facecolor="white")) as b:
        assert np.abs(np.subtract(a.size, b.size)).max() <= 2


def test_nothing_is_left_behind_when_saving_fails(make: Make, files: Files) -> None:
    env = make(scene())
    good = env.save_figure("picture.svg")
    before = good.read_bytes()
    with pytest.raises(TypeError):
        env.save_figure("picture.svg", no_such_option=1)
    assert (files(), good.read_bytes()) == (["figure/picture.svg", "scenario.yaml"], before)


def test_headless_environments_draw_nothing(make: Make, files: Files) -> None:
    env = make(scene(), headless=True, save_ani=True)
    env.step()
    env.render()
    env.draw_points([[1, 1]])
    assert env.save_figure() is None
    env.end()
    assert files() == ["scenario.yaml"]
