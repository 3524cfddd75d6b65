"""Shapes and sizes of the signs of the style `modern`, for pictures and for the replay page.

This is the only table of them: pictures are made of its shapes, and the style sheet of the page holds it. Lengths are
in radii of the body or the sign, unless they are in u, which is 1/96 inch.
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass

from irsim.graphics.scene.sizes import NORMAL

__all__ = [
    "ARRIVED_SHARE",
    "BADGES",
    "BADGE_LINE",
    "CROWD",
    "DART",
    "EDGES",
    "FOOTPRINT",
    "GLOW",
    "GOAL",
    "NAME",
    "PEOPLE",
    "RIM_U",
    "RINGS",
    "SMALLER",
    "SMALL_PERSON_U",
    "STAR",
    "STARS",
    "People",
    "glyph_table",
    "long_dart",
]

Points = list[tuple[float, float]]

DART: Points = [(0.86, 0.0), (-0.52, 0.58), (-0.24, 0.0), (-0.52, -0.58)]
"""A kite along body x whose tip is in front, in a body with a radius of 1."""
LONG_TIP = {"of_half_length": 0.84, "of_half_width": 1.1}
"""Greatest distance of the tip in a long body, as shares of half its length and of half its width."""


@dataclass(frozen=True)
class People:
    """Head and shoulders as seen from above.

    Attributes:
        along, across: Half axes of the ellipse of the shoulders.
        behind: How far its middle is behind the middle of the body.
        head: Radius of the head.
        ahead: How far it is ahead of the middle of the body.
        rims: Width of the rim of the shoulders and of the head [u].
        own: Share of the fill in the colour of the shoulders; the rest has the colour of the head.
    """

    along: float
    across: float
    behind: float
    head: float
    ahead: float
    rims: tuple[float, float]
    own: float


PEOPLE = {
    "large": People(0.525, 0.99, 0.12, 0.50, 0.18, (1.0, 1.0), 1.0),
    "small": People(0.575, 1.05, 0.12, 0.56, 0.18, (0.5, 0.7), 0.75),
}
SMALL_PERSON_U = 8.0
"""A person with a smaller radius is drawn as a small one [u]."""
FOOTPRINT = {"fill": 0.13, "rim": 0.45}
"""Opacities of the footprint of a person."""
CROWD: dict[str, int] = {"few": 12, "many": 50, "timed": 8}
"""Numbers of robots up to which everything and most things are drawn, and of contacts up to which each has its time."""
SMALLER = (1.0, 0.85, 0.62)
"""Factor of the least radius of robots: of few, of some and of many."""
GOAL = {"dot": 0.36, "fill": 0.12, "dart": 0.8, "open": 6.0}
"""The dot in a goal, the opacity of its fill, the radius of its dart where the heading counts, and the diameter of the
open dot that is a goal where there are more than a few robots [u]."""
NAME = {"halo": 2.6, "gap": 4.0}
"""Width of the halo of names, and their distance from the thing that they name [u]."""
BADGES: dict[str, list[Points]] = {
    "arrived": [[(-0.45, 0.0), (-0.12, -0.36), (0.48, 0.34)]],
    "collided": [[(-0.36, -0.36), (0.36, 0.36)], [(-0.36, 0.36), (0.36, -0.36)]],
    "stopped": [[(-0.22, -0.4), (-0.22, 0.4)], [(0.22, -0.4), (0.22, 0.4)]],
}
"""Lines of the signs in badges."""
BADGE_LINE = 0.24
"""Width of these lines."""
RINGS = {
    "collided": {"width": 2.2, "gap": 3.2},
    "picked": {"width": 2.0, "gap": 5.0},
    "crowded": {"width": 1.2, "gap": 0.0},
}
"""Rings around robots [u]; where there are many, a ring stands for the badge."""
STARS = {"others": 5.0, "crowded": 4.0}
"""Radius of the star of a contact between others, and of all stars where there are many robots [u]."""
RIM_U = 1.1
"""Width of the rim of badges and stars, in the colour of the paper [u]."""
ARRIVED_SHARE = 0.45
"""Share of its colour that the body of a robot keeps that has arrived; the rest is paper."""
GLOW = {"light": 0.17, "dark": 0.30, "fall": 0.62, "soft": 0.1}
"""The area that a lidar finds free: its opacity at the lidar by theme, how much of that is lost towards the end of the
range, and the last share of the range, over which it fades to nothing."""
EDGES = {"robot": 1.4, "still": 1.2, "person": 1.0, "round_halo": 1.2, "other_halo": 1.7, "line": 2.0}
"""Widths of edges and halos of bodies [u]."""


def _star(tips: int, hollow: float) -> Points:
    lengths = [1.0, hollow] * tips
    angles = [math.pi / tips * k + math.pi / 2 for k in range(2 * tips)]
    return [(length * math.cos(a), length * math.sin(a)) for length, a in zip(lengths, angles, strict=True)]


STAR = _star(8, 0.45)
"""The star at a contact."""


def long_dart(half_width: float, half_length: float) -> Points:
    """The dart in a body that is not a disc [m]."""
    tip = min(LONG_TIP["of_half_length"] * half_length, LONG_TIP["of_half_width"] * half_width)
    flat = 1.0 if half_length >= half_width else half_length / half_width
    return [(tip * flat, 0.0), *((x * half_width * flat, y * half_width * flat) for x, y in DART[1:])]


def glyph_table() -> str:
    """The table as JSON, with the sizes of the normal layout."""
    table = {
        "dart": DART,
        "longTip": LONG_TIP,
        "people": {name: asdict(one) for name, one in PEOPLE.items()},
        "smallPerson": SMALL_PERSON_U,
        "footprint": FOOTPRINT,
        "goal": GOAL,
        "crowd": CROWD,
        "smaller": SMALLER,
        "name": NAME,
        "stars": STARS,
        "badges": BADGES,
        "badgeLine": BADGE_LINE,
        "rings": RINGS,
        "rim": RIM_U,
        "arrived": ARRIVED_SHARE,
        "edges": EDGES,
        "glow": GLOW,
        "star": [[round(x, 4), round(y, 4)] for x, y in STAR],
        "sizes": asdict(NORMAL),
    }
    return json.dumps(table, separators=(",", ":"))
