"""Places of a request: points in brackets and directions, each as start, goal or heading."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from irsim_evals.baselines.reading.lexicon import DIRECTIONS
from irsim_evals.baselines.reading.mentions import Mention, sentence_of
from irsim_evals.baselines.reading.quantities import NUMBER

__all__ = ["Place", "Role", "places_of"]

Role = Literal["start", "goal", "heading", "obstacle", "goal-heading"]

_POINT = re.compile(rf"\(\s*({NUMBER})\s*m?\s*[,|;/]\s*({NUMBER})\s*m?\s*\)")
_CUES: dict[Role, str] = {
    "start": (
        r"de(?= (?:oeste|este|norte|sur|izquierda|derecha))|start\w*|begin\w*|enters?"
        r"|from|initial\w*|spawn\w*|placed|sits|at rest|beginn\w*|von|ab|desde|sale"
        r"|empieza|parte|inicio"
        r"|起点|出发点|从|位于|起始"
    ),
    "goal": (
        r"a(?= (?:oeste|este|norte|sur|la (?:izquierda|derecha)|izquierda|derecha))"
        r"|goals?|target|to|towards?|until|reach\w*|ends?|destination|arriv\w*|ziel\w*"
        r"|nach|bis|zum?|meta|hasta|hacia|destino|llega\w*|va"
        r"|drives?|goes|heads|runs|fährt|终点|目标|到|驶向|前往|去"
    ),
    "heading": (
        r"facing|looking|pointing|oriented|heading|orientation|blick\w*|schau\w*|mirando"
        r"|orientad\w*|朝向?|面向|面朝"
    ),
}
_ANY_CUE = re.compile("|".join(f"(?P<{role}>(?<![a-zà-ÿ])(?:{words})(?![a-zà-ÿ]))" for role, words in _CUES.items()))


@dataclass(frozen=True)
class Place:
    """A point or a direction.

    Attributes:
        role: What it is the place of.
        point: x, y [m]; None for a direction.
        signs: Direction along x and y; (0, 0) for a point.
        position: Where it stands in the text.
    """

    role: Role
    point: tuple[float, float] | None
    signs: tuple[float, float]
    position: int


def places_of(text: str, mentions: list[Mention]) -> list[Place]:
    """The points and directions of a text in their order, with what each is for."""
    found: list[tuple[int, tuple[float, float] | None, tuple[float, float]]] = []
    for match in _POINT.finditer(text):
        found.append((match.start(), (float(match[1]), float(match[2])), (0.0, 0.0)))
    taken: list[tuple[int, int]] = []
    for words, signs in DIRECTIONS:
        for match in re.finditer(words, text):
            if not any(a < match.end() and match.start() < b for a, b in taken):
                taken.append(match.span())
                found.append((match.start(), None, signs))
    places: list[Place] = []
    for position, point, signs in sorted(found, key=lambda item: item[0]):
        role = _role(text, mentions, position, point is not None, places)
        if role is not None:
            places.append(Place(role, point, signs, position))
    return places


def _role(text: str, mentions: list[Mention], position: int, is_point: bool, before: list[Place]) -> Role | None:
    """What a place is for, by the last word before it in the sentence that says so."""
    begin, _ = sentence_of(text, position)
    cues = [(match.start(), match.lastgroup) for match in _ANY_CUE.finditer(text, begin) if match.end() <= position]
    things = [m for m in mentions if begin <= m.start < position and m.kind in ("obstacle", "robot", "person", "wall")]
    last = things[-1] if things else None
    if last is not None and last.kind in ("obstacle", "wall") and not any(at > last.start for at, _ in cues):
        return "obstacle" if is_point else None
    if last is not None and last.kind == "person":
        return None
    if not cues:
        points = [place for place in before if place.point is not None]
        return None if not is_point else "goal" if points and points[-1].role == "start" else "start"
    role = cues[-1][1]
    if role == "heading":
        if is_point:
            return None
        points = [place for place in before if place.role in ("start", "goal") and begin <= place.position]
        return "goal-heading" if points and points[-1].role == "goal" else "heading"
    return "start" if role == "start" else "goal"
