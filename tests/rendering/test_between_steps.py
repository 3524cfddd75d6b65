"""Contacts within a step are marked in snapshots and strips, from the moment on at which they happen."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from irsim.api import snapshot
from tests.api.test_between_steps import scene

PLACE = [7.4, 2.4, 8.7, 3.6]
"""Part of the world round the place where a robot passes through a board."""
RED = np.array([0xCC, 0x33, 0x11])


def reds(png: bytes) -> int:
    """Number of pixels in the colour of the marks."""
    pixels = np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=int)
    return int((np.abs(pixels - RED).max(axis=2) < 70).sum())


@pytest.mark.parametrize("overlays", [None, ["names"]])
def test_a_snapshot_marks_the_place_after_the_passage(overlays: list[str] | None) -> None:
    before, after = (
        snapshot(text=scene(), steps=steps, region=PLACE, overlays=overlays, size=600).png for steps in (20, 30)
    )
    assert reds(before) == 0
    assert reds(after) > 20


def test_a_strip_marks_it_in_the_moments_after_it() -> None:
    early = snapshot(text=scene(), steps=20, strip=2, region=PLACE, overlays=["names"], size=600).png
    late = snapshot(text=scene(), steps=30, strip=2, region=PLACE, overlays=["names"], size=600).png
    assert reds(early) == 0
    assert reds(late) > 10


def test_what_others_pass_through_has_no_mark() -> None:
    text = scene(post=", unobstructed: true", board=", unobstructed: true")
    assert reds(snapshot(text=text, steps=30, region=PLACE, overlays=["names"], size=600).png) == 0


@pytest.mark.parametrize(("steps", "said"), [(20, False), (30, True)])
def test_a_strip_says_what_the_marks_mean(steps: int, said: bool) -> None:
    png = snapshot(text=scene(), steps=steps, strip=2, region=PLACE, overlays=["names"], size=600).png
    pixels = np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=int)
    captions = pixels[len(pixels) // 2 :][:20]  # of the second of two tiles, one above the other
    assert bool((np.abs(captions - RED).max(axis=2) < 70).any()) == said
