"""The nouns of a request with their numbers, and its places with their roles."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any, Literal

from irsim_evals.baselines.language import DIRECTIONS, DRIVES, NOUNS, NUMBER, first

__all__ = ["Mention", "Place", "Role", "mentions_of", "owner", "places_of", "sentence_of"]

_REACH = 60
"""Number of characters before a noun in which its number and its adjectives are looked for."""
_PREPOSITIONS = (
    r"of|in|on|at|with|to|towards?|from|by|between|around|before|behind|past|for|and|or|that|which|m|has|have|is|are"
    r"|von|mit|zu|im|in|um|auf|und|de|del|con|en|por|hacia|y|al"
)
_NUMBERED = re.compile(rf"(?:^|[\s(])(\d+)(?:\s|-)(?:(?!(?:{_PREPOSITIONS})\s)[^\s\d]+\s){{0,4}}$")
_COUNTED_ZH = re.compile(r"(\d+)\s*[台个名位辆只根块条张堵面人](?:[^,.;:]|(?<=\d)\.(?=\d)){0,24}$")
_SINGLE = re.compile(
    r"(?:^|[\s(])(?:an?|another|second|one|single|1|ein\w{0,2}|una?|uno)\s(?:[^\s\d]+\s){0,4}$|(?:^|[^\d])一[台个名位辆][^,.;]{0,20}$"
)
_DEFINITE = re.compile(
    r"(?:^|[\s(])(?:the|each|every|all|its|his|their|this|that|der|die|das|den|dem|des|jede\w*|el|la|los|las|cada|su)\s"
    r"(?:[^\s\d]+\s){0,2}$|[其每各该这]\S{0,4}$"
)
_OBLIQUE = re.compile(rf"(?:^|\s)(?:{_PREPOSITIONS})\s(?:the|a|an|its|den|dem|der|el|la|los|las)?\s?(?:[^\s\d]+\s)?$")
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


@dataclass
class Mention:
    """A noun of a request.

    Attributes:
        kind: Key of :data:`.language.NOUNS`.
        start, end: Where the noun stands in the text.
        number: How many; None if the text does not say.
        definite: Whether it points back to something that was mentioned.
        oblique: Whether a preposition stands before it, so that what follows is rather about something else.
        words: The noun with its adjectives.
        facts: Everything that the text says about it, added by :mod:`.facts`.
    """

    kind: str
    start: int
    end: int
    number: int | None
    definite: bool
    oblique: bool
    words: str
    facts: dict[str, Any] = field(default_factory=dict)


def mentions_of(text: str) -> list[Mention]:
    """The nouns of a text in their order."""
    nouns: list[tuple[int, int, str]] = []
    for kind, words in NOUNS.items():
        for match in re.finditer(rf"(?<![a-zà-ÿ_])(?:{words})(?![a-zà-ÿ_])", text):
            if not any(start < match.end() and match.start() < end for start, end, _ in nouns):
                nouns.append((match.start(), match.end(), kind))
    merged: list[tuple[int, int, str]] = []
    for start, end, kind in sorted(nouns):
        if merged and merged[-1][2] == kind and text[merged[-1][1] : start] in ("", " ", "-", " ("):
            merged[-1] = (merged[-1][0], end, kind)
        else:
            merged.append((start, end, kind))
    mentions = [_mention(text, *item) for item in merged]
    return [m for m in mentions if text[m.start : m.end] != "ones" or first(m.words, DRIVES) is not None]


def _mention(text: str, start: int, end: int, kind: str) -> Mention:
    before = re.split(r"[.;:()\n](?=\s|$)|, ", text[max(0, start - _REACH) : start])[-1]
    numbered = _NUMBERED.search(before) or _COUNTED_ZH.search(before)
    single = _SINGLE.search(before)
    definite = numbered is None and single is None and _DEFINITE.search(before) is not None
    none = numbered is None and re.search(
        r"(?:^|\s)(?:no|without|keine?n?|ohne|sin|ning[uú]n)\s(?:[^\s\d]+\s)?$|没有$|无$", before
    )
    number = 0 if none else int(numbered[1]) if numbered else 1 if single else None
    return Mention(kind, start, end, number, definite, _OBLIQUE.search(before) is not None, before + text[start:end])


def sentence_of(text: str, position: int) -> tuple[int, int]:
    """Start and end of the sentence around a position."""
    begin = max((match.end() for match in re.finditer(r"[.;!?](?=\s|$)", text[:position])), default=0)
    after = re.search(r"[.;!?](?=\s|$)", text[position:])
    return begin, position + after.start() if after else len(text)


def owner(text: str, mentions: list[Mention], start: int, end: int, kinds: tuple[str, ...]) -> Mention | None:
    """Which mention a fact belongs to.

    A noun that follows at once comes first, then the last one before in the sentence, then the next one in it, then the
    last one before.

    Args:
        text: The request.
        mentions: Its nouns.
        start, end: Where the fact stands.
        kinds: Kinds of nouns that can have such a fact.
    """
    able = [mention for mention in mentions if mention.kind in kinds]
    for mention in able:
        between = text[end : mention.start]
        if 0 <= mention.start - end <= 32 and not re.search(rf"[.,;:()]|\b(?:{_PREPOSITIONS})\b", between):
            return mention
    begin, stop = sentence_of(text, start)
    before = [mention for mention in able if begin <= mention.start <= start]
    direct = [mention for mention in before if not (mention.oblique and mention.definite)]
    if direct or before:
        return (direct or before)[-1]
    after = [mention for mention in able if end <= mention.start < stop]
    if after:
        return after[0]
    earlier = [mention for mention in able if mention.start < start]
    return earlier[-1] if earlier else able[0] if able else None


@dataclass(frozen=True)
class Place:
    """A point or a direction.

    Attributes:
        role: Start, goal, heading or obstacle.
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
    words_of_places: list[tuple[int, tuple[float, float] | None, tuple[float, float]]] = []
    for match in _POINT.finditer(text):
        words_of_places.append((match.start(), (float(match[1]), float(match[2])), (0.0, 0.0)))
    taken: list[tuple[int, int]] = []
    for words, signs in DIRECTIONS:
        for match in re.finditer(words, text):
            if not any(a < match.end() and match.start() < b for a, b in taken):
                taken.append(match.span())
                words_of_places.append((match.start(), None, signs))
    places: list[Place] = []
    for position, point, signs in sorted(words_of_places, key=lambda item: item[0]):
        role = _role(text, mentions, position, point is not None, places)
        if role is not None:
            places.append(Place(role, point, signs, position))
    return places


def _role(text: str, mentions: list[Mention], position: int, is_point: bool, before: list[Place]) -> Role | None:
    """The role of a place, by the last word before it in the sentence that says so."""
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
