"""The line above a picture: name, time, what has come of the episode, and facts; below it, what signs mean."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from irsim.common.text import clean, plural
from irsim.graphics.figure.measuring import TextSizes
from irsim.graphics.scene.scene import Circle, Label, Line, Mark, Region, Stroke
from irsim.graphics.scene.theme import Theme, mix
from irsim.rendering.modern.frame import FRAME, TITLE_Z, label, stroke
from irsim.rendering.modern.layout import Layout
from irsim.rendering.modern.things import Crowd, Thing
from irsim.simulation.outcome import is_over

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["facts_of", "heading_parts", "legend_parts", "outcome_word", "time_text", "title_text"]

_GAP, _PILL_PAD = 9.0, 8.0
_TINT = 0.06
_PILL_EDGE = 1.1
_BASE = 0.36
"""Half the height of capital letters, as a share of the size of a text."""
_ARC_POINTS = 12
_MAX_NAME = 40


def outcome_word(simulation: Simulation, world: int, collided: int) -> str:
    """The state of an episode so far: start, running, arrived, stopped, timeout, or how many robots have collided."""
    first = world * simulation.objects
    arrived = simulation.arrived[first : first + simulation.objects][simulation.robots]
    if collided:
        return "collided" if arrived.size == 1 else f"{collided} collided"
    if arrived.size and arrived.all():
        return "arrived"
    if int(simulation.count[world]) == 0:
        return "start"
    limit = simulation.scenario.world.time_limit
    seconds = int(simulation.count[world]) * float(simulation.scenario.world.step_time)
    if limit is not None and seconds >= limit - 1e-9:
        return "timeout"
    return "stopped" if arrived.size and is_over(simulation, world) else "running"


def title_text(name: str, seconds: float, word: str) -> str:
    """The title as one text, such as ``crossing 9.0 s running``."""
    return f"{name} {time_text(seconds)} {word}".strip()


def time_text(seconds: float) -> str:
    """Simulated time as the title says it."""
    return f"{seconds:.1f} s"


def facts_of(things: Sequence[Thing], crowd: Crowd, word: str, *, short: bool) -> list[str]:
    """Facts beside the title, of which the last ones are left out where there is no room."""
    robots = [thing for thing in things if thing.kind == "robot"]
    arrived = sum(thing.state == "arrived" for thing in robots)
    facts = list[str]()
    if len(robots) > 1 and (arrived or word not in ("start", "running")):
        facts.append(f"{arrived} of {len(robots)} arrived")
    if short and facts:
        return facts
    counts = [plural(len(robots), "robot")] if robots else []
    people = sum(thing.kind == "person" for thing in things)
    counts += [f"{people} {'person' if people == 1 else 'people'}"] if people else []
    return [*facts, ", ".join(counts)] if counts else facts


def heading_parts(
    name: str, seconds: float, word: str, facts: Sequence[str], layout: Layout, theme: Theme, sizes: TextSizes
) -> tuple[list[Mark], list[Label]]:
    """The line above the world.

    Args:
        name: Name of the scenario, or the title that the user has set.
        seconds: Simulated time [s].
        word: The state of the episode; empty leaves the pill out.
        facts: Facts, the most important first.
        layout: The layout.
        theme: The colours.
        sizes: Measures texts.
    """
    size, middle = layout.sizes, layout.height - layout.sizes.head / 2
    left, end = layout.left, layout.width - layout.left
    marks, labels = list[Mark](), list[Label]()
    number = FRAME
    time, facts_size = time_text(seconds), size.facts
    pill = sizes.width(word, facts_size, bold=True) + 2 * _PILL_PAD if word else 0.0
    room = end - left - sizes.width(time, size.title) - pill - 2 * _GAP
    shown = clean(name, _MAX_NAME)
    while len(shown) > 2 and sizes.width(shown, size.title, bold=True) > room:
        shown = shown.removesuffix("…")[:-1] + "…"

    def write(text: str, part: str, points: float, color: str, *, bold: bool = False) -> None:
        nonlocal left
        place = layout.at(left, middle - _BASE * points)
        labels.append(label(number, part, place, text, color, points, bold=bold))
        left += sizes.width(text, points, bold=bold) + _GAP

    if shown:
        write(shown, "title", size.title, theme.ink, bold=True)
    write(time, "time", size.title, theme.ink)
    if word:
        color = _word_color(word, theme)
        tint = theme.paper if color == theme.muted else mix(color, theme.paper, _TINT)
        edge = theme.line if color == theme.muted else color
        shape = _pill(layout, left, middle, pill, facts_size * 1.55)
        marks.append(Mark(number, "foot", shape, tint, stroke(edge, _PILL_EDGE), 1.0, TITLE_Z))
        left += _PILL_PAD
        write(word, "outcome", facts_size, color, bold=True)
        left += _PILL_PAD
    chosen = next(
        (
            text
            for count in range(len(facts), 0, -1)
            if left + sizes.width(text := " · ".join(facts[:count]), facts_size) <= end
        ),
        "",
    )
    if chosen:
        write(chosen, "facts", facts_size, theme.muted)
    return marks, labels


def legend_parts(
    layout: Layout, theme: Theme, sizes: TextSizes, *, beads: bool, velocities: bool, note: str = ""
) -> tuple[list[Mark], list[Label]]:
    """The legend of signs, in the foot at the right."""
    size, marks, labels = layout.sizes.foot_text, list[Mark](), list[Label]()
    middle, right = layout.sizes.foot / 2, layout.width - layout.left
    least = layout.left + 0.16 * layout.width + sizes.width("00 m (grid 00 m)", size) + 2 * _GAP
    entries = [("every 5 s", "bead")] if beads else []
    entries += [("goes away", "away"), ("still", "still"), ("comes nearer", "near")] if velocities else []
    entries += [(note, "")] if note else []
    for number, (text, sign) in enumerate(entries):
        width = sizes.width(text, size)
        room = {"bead": 20.0, "": 0.0}.get(sign, 12.0)
        if right - width - room < least:
            break
        place = layout.at(right - width, middle - _BASE * size)
        labels.append(label(FRAME - number, "legend", place, text, theme.muted, size))
        right -= width + room
        marks += _sign(sign, layout, theme, right, middle)
        right -= _GAP
    return marks, labels


def _sign(sign: str, layout: Layout, theme: Theme, x: float, y: float) -> list[Mark]:
    if not sign:
        return []
    if sign == "bead":
        line = Line(np.array([layout.at(x, y), layout.at(x + 15, y)]))
        spot = Circle(*layout.at(x + 7.5, y), layout.metres(2.3))
        return [
            Mark(FRAME, "foot", line, None, stroke(theme.muted, 1.4), 1.0, TITLE_Z),
            Mark(FRAME, "foot", spot, theme.paper, stroke(theme.muted, 1.1), 1.0, TITLE_Z),
        ]
    fill, edge, size = {
        "near": (theme.near, Stroke(None), 5.0),
        "away": (None, stroke(theme.away, 1.3), 5.0),
        "still": (theme.zero, Stroke(None), 3.0),
    }[sign]
    spot = Circle(*layout.at(x + 4, y), layout.metres(size / 2))
    return [Mark(FRAME, "foot", spot, fill, edge, 1.0, TITLE_Z)]


def _word_color(word: str, theme: Theme) -> str:
    if "collided" in word:
        return theme.danger
    return {"arrived": theme.good, "timeout": theme.warn, "stopped": theme.warn}.get(word, theme.muted)


def _pill(layout: Layout, left: float, middle: float, width: float, height: float) -> Region:
    """A rectangle with round ends; lengths in u."""
    r = height / 2
    angles = np.linspace(-math.pi / 2, math.pi / 2, _ARC_POINTS)
    right = np.stack([left + width - r + r * np.cos(angles), middle + r * np.sin(angles)], axis=1)
    other = np.stack([left + r - r * np.cos(angles[::-1]), middle + r * np.sin(angles[::-1])], axis=1)
    return Region([np.array([layout.at(*point) for point in np.concatenate([right, other]).tolist()])])
