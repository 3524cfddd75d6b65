"""A request: the part of a case that a baseline sees, and what its words say, put in order."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from irsim_evals.baselines.facts import add_facts
from irsim_evals.baselines.language import (
    BEHAVIORS,
    DRIVES,
    LAYOUTS,
    NO_BEHAVIOR,
    NUMBER,
    Language,
    first,
    has,
    language_of,
    plain,
)
from irsim_evals.baselines.mentions import Mention, Place, mentions_of, places_of
from irsim_evals.cases.store import Instance

__all__ = ["Group", "Request", "Task", "request_of", "task_of"]

_NO_REVERSE = (
    r"(?:not|no|never|cannot|can't|without) revers\w+|nicht rückwärts|sin marcha atrás"
    r"|no retrocede|不能倒|不倒车|不可倒"
)
_SQUARE = (
    r"square|box|crate|block|shel|rack|pallet|table|quadrat|kiste|block|regal"
    r"|tisch|caja|cuadrad|estant|mesa|bloque|箱|方|货架"
)
_POLYGON = r"polygon|polígono|多边形"
_COORDINATES = re.compile(rf"\bx ?= ?({NUMBER})(?: ?m\b)?(?:,| and| und| y)? ?y ?= ?({NUMBER})(?: ?m\b)?")
"""A point such as ``x = 3 m, y = 2 m``."""
_IDIOMS = (
    r"(?<=velocity )obstacles?|right angles?|(?:is|are) right\b|right (?:in|too|after|away|now|before)\b"
    r"|right-angled|left (?:out|over|alone|free)\b"
)
"""Phrases whose words have another meaning alone."""
_COLORS = (
    r"different colou?rs?|own colou?r|distinct colou?rs?|verschiedene\w* farbe\w*"
    r"|color(?:es)? distint\w*|不同颜色|不同的颜色"
)


@dataclass(frozen=True)
class Task:
    """A request.

    Attributes:
        prompt: The request to the agent.
        turns: Messages of the user after each reply.
        files: The files that the folder starts with: name → text.
    """

    prompt: str
    turns: tuple[str, ...] = ()
    files: Mapping[str, str] | None = None

    @property
    def requests(self) -> tuple[str, ...]:
        """All that the user says, one text for each turn."""
        return (self.prompt, *self.turns)


def task_of(instance: Instance) -> Task:
    """The part of an instance that an agent sees."""
    return Task(instance.prompt, tuple(instance.case.turns), dict(instance.case.files))


@dataclass
class Group:
    """Bodies of one kind.

    Attributes:
        number: How many; None if the request does not say.
        drive: Name of the drive; None if the request does not say.
        shape: ``circle``, ``rectangle`` or ``polygon``.
        facts: Sizes and limits in m, s and rad.
    """

    number: int | None
    drive: str | None
    shape: str
    facts: dict[str, Any] = field(default_factory=dict)


@dataclass
class Request:
    """A request, understood.

    Attributes:
        text: The request as :func:`.language.plain` leaves it.
        language: Its language.
        size: Width and height of the world [m], if given.
        whole: ``step_time``, ``time_limit``, ``seed``, ``fill``, ``cell``, ``low``.
        robots, people, obstacles: Groups of bodies.
        lidars: Facts of each lidar.
        parts: Facts of ``corridor``, ``doorway``, ``ring``, ``trap``, ``wall``, as far as the request has them.
        layouts: Arrangements that it names.
        behavior: Name of the behavior; None if the request does not say.
        undriven: Whether the user's program drives.
        no_reverse, colors: Whether robots never reverse, and whether each has its own color.
        places: Points and directions.
    """

    text: str
    language: Language
    size: tuple[float, float] | None
    whole: dict[str, float]
    robots: list[Group]
    people: list[Group]
    obstacles: list[Group]
    lidars: list[dict[str, Any]]
    parts: dict[str, dict[str, Any]]
    layouts: set[str]
    behavior: str | None
    undriven: bool
    no_reverse: bool
    colors: bool
    places: list[Place]


def request_of(prompt: str) -> Request:
    """Read a request."""
    text = re.sub(_IDIOMS, lambda match: "-" * len(match[0]), plain(prompt))
    text = _COORDINATES.sub(r"(\1, \2)", text)
    mentions = mentions_of(text)
    whole = add_facts(text, mentions)
    behavior = first(text, {name: words for name, words in BEHAVIORS.items() if name != "dash"})
    return Request(
        text=text,
        language=language_of(prompt),
        size=_size(mentions),
        whole=whole,
        robots=_groups(mentions, "robot", text),
        people=_groups(mentions, "person", text),
        obstacles=_groups(mentions, "obstacle", text),
        lidars=[mention.facts for mention in mentions if mention.kind == "lidar" and _is_new(mention, mentions)],
        parts=_parts(mentions),
        layouts={name for name, words in LAYOUTS.items() if has(text, words)},
        behavior=behavior or ("dash" if has(text, BEHAVIORS["dash"]) else None),
        undriven=has(text, NO_BEHAVIOR),
        no_reverse=has(text, _NO_REVERSE),
        colors=has(text, _COLORS),
        places=places_of(text, mentions),
    )


def _size(mentions: list[Mention]) -> tuple[float, float] | None:
    """Width and height of the world, of the first noun for it that has them."""
    facts: dict[str, Any] = {}
    for mention in mentions:
        if mention.kind == "world":
            facts = {**mention.facts, **facts}
    if "size" in facts:
        return float(facts["size"][0]), float(facts["size"][1])
    if "side" in facts:
        return float(facts["side"]), float(facts["side"])
    width, height = facts.get("width"), facts.get("height", facts.get("length"))
    return (float(width), float(height)) if width and height else None


def _is_new(mention: Mention, mentions: list[Mention]) -> bool:
    """Whether a mention is the first of its kind, or another one."""
    kind = [m for m in mentions if m.kind == mention.kind]
    return mention is kind[0] or has(mention.words, r"\bsecond\b|\banother\b|zweite|segund|otro|第二|另")


def _groups(mentions: list[Mention], kind: str, text: str) -> list[Group]:
    """The bodies of a kind: mentions with another drive or shape are another group."""
    groups: list[Group] = []
    for mention in (m for m in mentions if m.kind == kind):
        drive = first(mention.words, DRIVES) if kind == "robot" else None
        shape = _shape(mention, kind)
        known = next((g for g in reversed(groups) if drive in (None, g.drive) or g.drive is None), None)
        if kind == "obstacle":
            known = next(
                (g for g in reversed(groups) if mention.definite or mention.number is None or g.shape == shape), None
            )
        if known is None:
            groups.append(Group(mention.number, drive, shape, dict(mention.facts)))
            continue
        known.drive = known.drive or drive
        known.facts = {**mention.facts, **known.facts}
        if known.shape == "circle" and kind != "person":
            known.shape = shape
        if mention.number is not None and (known.number is None or mention.number > known.number):
            known.number = mention.number
    if kind == "robot" and groups and all(group.drive is None for group in groups):
        groups[0].drive = first(text, DRIVES)
    if kind == "robot" and has(text, DRIVES["omni_angular"]):
        for group in groups:
            group.drive = "omni_angular" if group.drive == "omni" else group.drive
    return groups


def _shape(mention: Mention, kind: str) -> str:
    facts = mention.facts
    if "radius" in facts or "diameter" in facts:
        return "circle"
    if {"size", "side", "length"} & set(facts):
        return "rectangle"
    if kind == "obstacle" and has(mention.words, _POLYGON):
        return "polygon"
    return "rectangle" if kind == "obstacle" and has(mention.words, _SQUARE) else "circle"


def _parts(mentions: list[Mention]) -> dict[str, dict[str, Any]]:
    parts: dict[str, dict[str, Any]] = {}
    for mention in mentions:
        if mention.kind in ("corridor", "doorway", "ring", "trap", "wall"):
            parts[mention.kind] = {**mention.facts, **parts.get(mention.kind, {})}
            if mention.number is not None:
                parts[mention.kind].setdefault("number", mention.number)
    return parts
