"""The colours of pictures and of the replay page: contrast, vision without one kind of cones, one table for both."""

from __future__ import annotations

import itertools
import re

import numpy as np
import pytest

from irsim.graphics.scene.theme import DARK, LIGHT, THEMES, Theme, contrast, css_variables, mix, seen
from irsim.options.colors import CYCLE, rgb
from irsim.runs.replay.page import page

FIRST_SIX = CYCLE[:6]
VISIONS = {
    "normal": np.eye(3),
    "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritan": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}
"""Machado, Oliveira, Fernandes (2009), full severity, on linear red, green and blue."""
BOTH = pytest.mark.parametrize("theme", THEMES.values(), ids=list(THEMES))


@BOTH
def test_text_and_signs_can_be_read(theme: Theme) -> None:
    for name in ("ink", "muted", "danger", "good", "warn"):
        color = theme.tokens[name]
        assert contrast(color, theme.page) >= 4.5, name
        assert contrast(color, theme.paper) >= 4.5, name
        assert contrast(color, mix(color, theme.paper, 0.06)) >= 4.5, name
    for name in ("good", "danger", "warn"):
        assert contrast(theme.on, theme.tokens[name]) >= 4.5, name
    for name in ("still_edge", "person", "zone", "near", "away", "zero"):
        assert contrast(theme.tokens[name], theme.paper) >= 3, name
    assert 1.1 <= contrast(theme.grid, theme.paper) <= 1.3


@BOTH
def test_the_heading_is_seen_in_a_robot_of_any_colour(theme: Theme) -> None:
    for color in CYCLE:
        shades = theme.shades("robot", color)
        assert contrast(shades.dart, shades.fill) >= 3, color
        assert contrast(shades.edge, theme.paper) >= theme.least_edge
        assert contrast(shades.name, theme.paper) >= 4.5


@BOTH
def test_any_colour_is_made_visible_and_a_visible_one_is_kept(theme: Theme) -> None:
    levels = np.linspace(0, 1, 16)
    for color in itertools.product(levels, levels, levels):
        for least in (theme.least_fill, theme.least_edge, theme.least_name):
            shown = seen(color, theme.paper, least)
            assert contrast(shown, theme.paper) >= least, color
    for color in CYCLE:
        kept = color if contrast(color, theme.paper) >= 1.8 else None
        assert kept is None or seen(color, theme.paper, 1.8) == color.lower()


@pytest.mark.parametrize(("theme", "least"), [(LIGHT, 15), (DARK, 14)], ids=["light", "dark"])
@pytest.mark.parametrize("vision", VISIONS)
def test_six_robots_differ_in_every_vision_and_from_people(theme: Theme, least: float, vision: str) -> None:
    fills = [theme.shades("robot", color).fill for color in FIRST_SIX]
    for one, other in itertools.combinations(fills, 2):
        assert distance(one, other, vision) >= least, (one, other)
    for one in fills:
        assert distance(one, theme.person_head, vision) >= 34, one


@BOTH
def test_static_bodies_recede_and_black_counts_as_not_chosen(theme: Theme) -> None:
    assert theme.shades("still", "k").fill == theme.still
    assert theme.shades("person", "black").fill == theme.person
    brown = theme.shades("still", "#8c6d46")
    assert contrast(brown.fill, theme.paper) < 2.2
    assert contrast(brown.edge, theme.paper) >= 3


def test_the_page_has_the_colours_of_the_table() -> None:
    text = page()
    assert css_variables() in text
    sheet = text.replace(css_variables(), "")
    for name in re.findall(r"var\(--([a-z-]+)\)", sheet):
        assert f"--{name}: #" in css_variables(), name
    assert "--accent: #0b62c4" in text
    assert "--accent: #6cb2ff" in text


def distance(one: str, other: str, vision: str) -> float:
    """Euclidean distance of two colours in CIELAB as such eyes see them."""
    a, b = (lab(color, np.asarray(VISIONS[vision])) for color in (one, other))
    return float(np.linalg.norm(a - b))


def lab(color: str, vision: np.ndarray) -> np.ndarray:
    levels = np.array(rgb(color))
    linear = np.where(levels <= 0.04045, levels / 12.92, ((levels + 0.055) / 1.055) ** 2.4)
    linear = np.clip(vision @ linear, 0, 1)
    to_xyz = np.array(
        [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
    )
    x, y, z = to_xyz @ linear / (0.95047, 1.0, 1.08883)
    fx, fy, fz = (t ** (1 / 3) if t > 216 / 24389 else (24389 / 27 * t + 16) / 116 for t in (x, y, z))
    return np.array([116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)])
