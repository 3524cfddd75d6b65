"""Pictures of the style `modern`: scenes and pixels of templates and of small worlds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.api.look import with_look
from irsim.api.read_input import read_scenario
from irsim.bundled import templates
from irsim.graphics.scene.scene import Label, Mark, Scene
from irsim.rendering.modern.layout import Layout, fit
from irsim.rendering.modern.still import StillPicture
from irsim.rendering.modern.style import Request

Shown = tuple[Scene, Layout]
Opened = Callable[..., Any]


@pytest.fixture
def opened() -> Opened:
    """``opened(template or text, theme="light")``: an environment whose pictures have the style `modern`."""

    def open_it(what: str, theme: str = "light", **options: Any) -> Any:
        given = {"text": what} if "\n" in what else {"path": templates.scenario_file(what)}
        scenario, _ = read_scenario(**given, strict=True)
        scenario = with_look(scenario, "modern", theme)
        return irsim.Env(scenario, headless=True, log_level="ERROR", **{"seed": 0, **options})

    return open_it


def picture_of(env: Any, side: float = 480.0, *, printed: bool = False, **request: Any) -> Shown:
    """The scene of a picture and its layout."""
    picture = StillPicture(env.simulation)
    layout = fit(picture.world_shown, 302.0 if printed else side, printed=printed, ratio=3.125 if printed else 1.0)
    return picture._picture.draw(picture.scene, picture._builder, layout, Request(**request)), layout


def pixels_of(env: Any, side: float = 480.0, ratio: float = 1.0) -> tuple[np.ndarray, Layout]:
    """(H, W, 3) pixels of a picture, and its layout."""
    picture = StillPicture(env.simulation)
    layout = fit(picture.world_shown, side, ratio=ratio)
    pixels, _ = picture.draw(layout, Request())
    return np.asarray(pixels)[..., :3].copy(), layout


def take(env: Any, steps: int) -> None:
    for _ in range(steps):
        env.step()


def parts_of(scene: Scene, number: int) -> list[str]:
    """The parts that an object consists of."""
    return sorted(mark.part for mark in scene.all_marks() if mark.object == number)


def words_of(scene: Scene) -> dict[str, str]:
    """Part of the line above the world -> its text."""
    return {label.part: label.text for label in scene.labels if label.part in ("title", "time", "outcome", "facts")}


def title_of(scene: Scene) -> str:
    words = words_of(scene)
    return " ".join(words.get(part, "") for part in ("title", "time", "outcome"))


def marks_of(scene: Scene, part: str) -> list[Mark]:
    return [mark for mark in scene.all_marks() if mark.part == part]


def labels_of(scene: Scene, part: str) -> list[Label]:
    return [label for label in scene.labels if label.part == part]
