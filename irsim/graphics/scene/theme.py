"""Colours of pictures and of the replay page, in two themes, and how colours of a scenario are made visible on them.

This is the only table of these colours: the style `modern` draws with it, and the variables in the style sheet of the
page are written from it.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property, lru_cache
from typing import Any, Literal

from irsim.graphics.scene.glyphs import glyph_table
from irsim.options.colors import rgb

__all__ = ["DARK", "LIGHT", "THEMES", "Kind", "Shades", "Theme", "contrast", "css_variables", "hex_of", "mix", "seen"]

RGB = tuple[float, float, float]
Kind = Literal["robot", "person", "thing", "still"]
"""The kind as which an object is drawn; a thing moves, but is neither robot nor person."""
_STEPS = 40
"""Number of steps in which a colour is mixed with black or white until it is seen."""
_KNOWN = 4096
"""Number of mixed colours that are remembered."""
_BLACK, _WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
_QUIET_SHARE = 0.22
"""Share of its own colour that the fill of a static body has."""
_BLACK_LEVEL = 24 / 255
"""A colour whose channels are all below this level counts as black, so as a colour that was not chosen."""
_CSS_NAMES = {"near": "accent", "on": "on-accent"}
"""Names that variables of the page have instead of the names in the table."""


@dataclass(frozen=True, eq=False)  # compared by identity, as caches ask for the same few again and again
class Theme:
    """The colours of one theme.

    Attributes:
        name: ``light`` or ``dark``.
        page: Around the world, and behind title and foot.
        card: Panels of the page.
        outside: Beyond the world, in the page.
        paper: The world.
        grid: Lines of the grid, which are felt rather than read.
        line: Edge of a world without walls.
        ink: Title and time.
        muted: Facts, foot, ticks and trails of people.
        still, still_edge: Fill and edge of static bodies.
        wall: Walls round the world, and lines that stand.
        rock: Occupied cells of maps.
        person, person_head: Shoulders and head of a person.
        danger: Contacts; nothing else has this colour.
        good: Robots that have arrived.
        warn: Robots that were stopped, and time limits.
        near, zero, away: Doppler hits that approach, keep their distance, recede; ``near`` also marks a picked robot.
        zone: Zones.
        fog: Fog, on which lines lie.
        on: Signs in badges.
        least_fill, least_edge, least_name: Least contrast of robots, thin things and names with the paper.
        least_dart: Least contrast of a dart in the colour of the paper with the body that it lies in.
        dart: Colour of the dart where the colour of the paper is too close to the body.
    """

    name: str
    page: str
    card: str
    outside: str
    paper: str
    grid: str
    line: str
    ink: str
    muted: str
    still: str
    still_edge: str
    wall: str
    rock: str
    person: str
    person_head: str
    danger: str
    good: str
    warn: str
    near: str
    zero: str
    away: str
    zone: str
    fog: str
    on: str
    least_fill: float
    least_edge: float
    least_name: float
    least_dart: float
    dart: str

    @cached_property
    def tokens(self) -> dict[str, str]:
        """Name -> colour of all colours."""
        values = {entry.name: getattr(self, entry.name) for entry in fields(self) if entry.name != "name"}
        return {name: value for name, value in values.items() if isinstance(value, str)}

    @lru_cache(maxsize=_KNOWN)  # noqa: B019 - there are two themes
    def shades(self, kind: Kind, color: Any) -> Shades:
        """The shades in which the things of one object are drawn.

        Args:
            kind: Its kind.
            color: Its colour; black counts as not chosen, except for robots.
        """
        if kind == "robot":
            fill = seen(color, self.paper, self.least_fill)
            dart = self.paper if contrast(self.paper, fill) >= self.least_dart else self.dart
            edge, name = seen(color, self.paper, self.least_edge), seen(color, self.paper, self.least_name)
            return Shades(fill, edge, name, dart)
        chosen = max(rgb(color)) >= _BLACK_LEVEL
        if kind == "still":
            own = mix(seen(color, self.paper, self.least_edge), self.still_edge, 0.5) if chosen else self.still_edge
            return Shades(mix(color, self.still, _QUIET_SHARE) if chosen else self.still, own, self.muted, self.paper)
        fill = seen(color, self.paper, self.least_fill) if chosen else self.person
        return Shades(fill, self.muted, self.muted, self.person_head)


@dataclass(frozen=True, eq=False)
class Shades:
    """Fill of a body, thin things such as edges and trails, name, and the dart or the head in the body."""

    fill: str
    edge: str
    name: str
    dart: str


LIGHT = Theme(
    name="light",
    page="#f4f6f8",
    card="#ffffff",
    outside="#e9edf1",
    paper="#ffffff",
    grid="#eceff3",
    line="#c9d1d9",
    ink="#17212b",
    muted="#5b6976",
    still="#dbe1e7",
    still_edge="#6b7885",
    wall="#3a4651",
    rock="#8f9aa5",
    person="#75828f",
    person_head="#1f2a34",
    danger="#c2271c",
    good="#0a7a4b",
    warn="#96600a",
    near="#0b62c4",
    zero="#7d8894",
    away="#c8501a",
    zone="#7a2b6a",
    fog="#d3d9e0",
    on="#ffffff",
    least_fill=1.8,
    least_edge=3.0,
    least_name=4.5,
    least_dart=3.0,
    dart="#17212b",
)
DARK = Theme(
    name="dark",
    page="#10151b",
    card="#181f27",
    outside="#0c1116",
    paper="#171e26",
    grid="#222c36",
    line="#33404c",
    ink="#e6edf3",
    muted="#98a6b3",
    still="#3a4653",
    still_edge="#8694a2",
    wall="#aebbc7",
    rock="#5d6a77",
    person="#8695a3",
    person_head="#f3f7fa",
    danger="#ff7b6e",
    good="#4fd39a",
    warn="#f0b75a",
    near="#6cb2ff",
    zero="#8c98a4",
    away="#ff9a5c",
    zone="#d99fd0",
    fog="#0a0e13",
    on="#0b1219",
    least_fill=3.5,
    least_edge=4.2,
    least_name=4.5,
    least_dart=4.0,
    dart="#ffffff",
)
THEMES = {theme.name: theme for theme in (LIGHT, DARK)}


@lru_cache(maxsize=_KNOWN)
def seen(color: Any, paper: Any, least: float) -> str:
    """Return a colour that has at least this contrast with a paper, and is the colour itself where it has.

    Args:
        color: The colour, as a scenario writes it.
        paper: The colour behind it.
        least: Least contrast, from 1 to what black or white has on the paper.

    Returns:
        The colour as ``#rrggbb``, mixed with as little as possible of black (on bright paper) or white (on dark).
    """
    own = rgb(color)
    goal = _BLACK if contrast(_BLACK, paper) >= contrast(_WHITE, paper) else _WHITE
    mixed = (hex_of(_between(own, goal, step / _STEPS)) for step in range(_STEPS + 1))
    return next((one for one in mixed if contrast(one, paper) >= least), hex_of(goal))


def contrast(one: Any, other: Any) -> float:
    """Contrast of two colours as in WCAG 2.2, from 1 to 21."""
    dark, bright = sorted((_luminance(rgb(one)), _luminance(rgb(other))))
    return (bright + 0.05) / (dark + 0.05)


@lru_cache(maxsize=_KNOWN)
def mix(color: Any, other: Any, share: float) -> str:
    """Return ``#rrggbb`` with this share of the first colour, the rest of the second."""
    return hex_of(_between(rgb(other), rgb(color), share))


def hex_of(color: Any) -> str:
    """A colour of a scenario as ``#rrggbb``."""
    return "#" + "".join(f"{round(255 * level):02x}" for level in rgb(color))


def css_variables() -> str:
    """Rules of a style sheet with the colours as variables: light by default, dark where ``data-theme`` says so.

    The variable ``--glyphs`` is a string with the table of signs (:func:`irsim.graphics.scene.glyphs.glyph_table`).
    """
    rules = [f":root {{ --glyphs: '{glyph_table()}'; }}\n"]
    for theme, selector in ((LIGHT, ":root"), (DARK, ':root[data-theme="dark"]')):
        values = ((_CSS_NAMES.get(name, name).replace("_", "-"), color) for name, color in theme.tokens.items())
        variables = " ".join(f"--{name}: {color};" for name, color in values)
        rules.append(f"{selector} {{ color-scheme: {theme.name}; {variables} }}\n")
    return "".join(rules)


def _between(start: RGB, end: RGB, share: float) -> RGB:
    red, green, blue = (a + share * (b - a) for a, b in zip(start, end, strict=True))
    return red, green, blue


def _luminance(color: RGB) -> float:
    red, green, blue = (v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in color)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue
