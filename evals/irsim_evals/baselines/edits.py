"""Small edits of a given scenario: the lines that a request is about change, all others stay."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any

import yaml

from irsim.bundled.templates.fill import format_value, replace_values
from irsim.common.text import plural
from irsim.diagnostics.diagnostic import Path
from irsim.scenario.model.lookup import at
from irsim.scenario.yaml.entries import add_entry
from irsim_evals.baselines.language import BEHAVIORS, DRIVES, NOUNS, first, has, plain, quantities
from irsim_evals.baselines.layouts import lidar
from irsim_evals.baselines.request import request_of

__all__ = ["Edited", "add", "edit", "entries", "is_correction", "is_unclear", "replace"]

replace = replace_values
Edited = tuple[str, list[str]]
"""The new text, and what was changed in words."""
_VERB = (
    r"add|remove|delete|set|change|make|double|halve|triple|increase|reduce|raise"
    r"|lower|swap|replace|give|turn|use|switch|put"
    r"|füge|setze|ändere|mache?|verdopple|verdoppel\w*|halbiere|erhöhe|ersetze"
    r"|gib|tausche"
    r"|añade|agrega|pon|cambia|haz|duplica|reduce|aumenta|sustituye|reemplaza"
)
_PARTS = re.compile(rf"(?:[.;]\s+|,\s+(?:and |und |y |then )?|\s(?:and|und|y|then)\s)(?=(?:{_VERB})\b)|。|；")
_ATTRIBUTES: dict[str, str] = {
    "range": r"\brange\b|reichweite|alcance|量程|射程|探测距离",
    "beams": r"\bbeams?\b|\brays?\b|strahlen|haces|光束|线数",
    "speed": r"\bspeed\b|\bfast(?:er)?\b|\bslow(?:er)?\b|geschwindigkeit|schneller|langsamer|velocidad|速度",
    "radius": r"\bradius\b|\bradio\b|半径",
    "step_time": r"time step|step time|zeitschritt|paso de tiempo|步长",
    "width": r"\bwidth\b|\bwider\b|\bbreite\b|ancho|anchura|宽",
    "height": r"\bheight\b|\bhöhe\b|\balto\b|altura|高",
    "size": (
        r"\bbigger\b|\blarger\b|\bsmaller\b|\bgrößer\b|\bkleiner\b|más grande|más pequeñ"
        r"|变大|放大|缩小|\bworld\b|\bwelt\b|mundo|世界"
    ),
}
_FACTORS: list[tuple[str, float]] = [
    (r"\bdoubl\w+|\btwice\b|verdopp\w+|duplica\w*|\bdoble\b|加倍|翻倍|两倍", 2.0),
    (r"\bhalv\w+|\bhalf\b|halbier\w*|\bmitad\b|减半|一半", 0.5),
    (r"\btripl\w+|verdreifach\w*|triplica\w*|三倍", 3.0),
]
_LESS = (
    r"\b(?:small|slow|short|narrow|less|reduc|lower|decreas|kleiner|langsamer|verringer|weniger|menos|reduc|减|小|慢)"
)
_WORLD = r"\bworlds?\b|\bwelt\b|\bmundo\b|世界|场景|\barena\b|\broom\b|\bhall\b"
_CORRECTION = r"^(?:no\b|nein\b|not that|i meant|i mean|sorry|ich meinte|quería decir|me refería|不)"
_NOT = r",?\s*\b(?:not|nicht|no)\b (?:the|der|die|das|den|el|la|los|las)\b[^.;]*"


def entries(data: Any, section: str) -> Iterator[tuple[Path, dict[str, Any]]]:
    """The entries of ``robot`` or ``obstacle`` with their paths, whether they are a list or a single one."""
    value = data.get(section) if isinstance(data, dict) else None
    if isinstance(value, dict):
        yield (section,), value
    for i, entry in enumerate(value if isinstance(value, list) else []):
        if isinstance(entry, dict):
            yield (section, i), entry


def add(text: str, path: Path, key: str, value: Any) -> str:
    """Add an item to the list under a key of a mapping; the list is made if it does not exist yet.

    Args:
        text: The file.
        path: Where the mapping is.
        key: Its key.
        value: The item.

    Raises:
        KeyError: Nothing can be added there.
    """
    added = add_entry(text, key, [format_value(value)], prefix=path)
    if added is None:
        raise KeyError(key)
    return added


def is_unclear(request: str) -> bool:
    """Whether a request changes a size without saying of what."""
    text = plain(request)
    bigger = re.search(r"\b(?:bigger|larger|smaller|größer|kleiner|más grande|más pequeñ\w)", text) is not None
    return bigger and not any(
        has(text, words) for words in (_WORLD, NOUNS["robot"], NOUNS["obstacle"], NOUNS["person"])
    )


def is_correction(request: str) -> bool:
    """Whether a message corrects how the one before was understood."""
    return has(plain(request), _CORRECTION)


def edit(source: str, request: str) -> Edited:
    """The text of a scenario after the changes that a request asks for."""
    done: list[str] = []
    for part in _PARTS.split(re.sub(_NOT, "", plain(request))):
        try:
            source, words = _one(source, part)
        except (KeyError, IndexError, TypeError, ValueError, yaml.YAMLError):
            continue
        done += words
    return source, done


def _one(source: str, part: str) -> Edited:
    """The text after one change."""
    data = yaml.safe_load(source)
    if has(part, r"\b(?:add|another|second|more|füge|weitere|zweite\w*|añade|agrega|otro|segundo)\b|添加|增加|再|第二"):
        if has(part, NOUNS["lidar"]):
            return _add_lidar(source, data, part)
        if has(part, NOUNS["obstacle"]):
            return _add_obstacles(source, data, part)
    drive = first(part, DRIVES)
    if drive is not None and has(part, rf"\b(?:{_VERB})\b|换成|改成"):
        changes: dict[Path, Any] = {(*path, "kinematics", "name"): drive for path, _ in entries(data, "robot")}
        return replace(source, changes), [f"the drive is {drive}"]
    behavior = first(part, BEHAVIORS)
    if behavior is not None:
        changes = {(*path, "behavior", "name"): behavior for path, _ in entries(data, "robot")}
        return replace(source, changes), [f"the behavior is {behavior}"]
    return _set_or_scale(source, data, part)


def _set_or_scale(source: str, data: Any, part: str) -> Edited:
    attribute = first(part, _ATTRIBUTES)
    if attribute is None:
        return source, []
    paths = list(_paths(data, attribute, part))
    factor = _factor(part)
    changes: dict[Path, Any] = {}
    if factor is not None:
        for path in paths:
            old = at(data, path)
            new = round(old * factor, 6)
            changes[path] = int(new) if isinstance(old, int) and new == int(new) else new
    else:
        numbers = [number.value for number in quantities(part) if number.kind not in ("share", "time")]
        numbers = numbers or [number.value for number in quantities(part)]
        if attribute == "size" and len(numbers) >= 2:
            changes = dict(zip(paths, numbers[-2:], strict=False))
        elif numbers and attribute != "size":
            value = numbers[-1]
            changes = dict.fromkeys(paths, int(value) if value == int(value) else value)
    words = [f"{'.'.join(map(str, path))} is {value:g}" for path, value in changes.items()]
    return replace(source, changes), words


def _paths(data: Any, attribute: str, part: str) -> list[Path]:
    """The values that an attribute names."""
    robots = list(entries(data, "robot"))
    if attribute in ("range", "beams"):
        key = "range_max" if attribute == "range" else "number"
        candidates: list[Path] = [
            (*path, "sensors", j, key) for path, entry in robots for j in range(len(entry.get("sensors") or []))
        ]
    elif attribute == "speed":
        candidates = [(*path, "vel_max", 0) for path, _ in robots]
    elif attribute == "radius":
        section = "obstacle" if has(part, NOUNS["obstacle"]) else "robot"
        candidates = [(*path, "shape", "radius") for path, _ in entries(data, section)]
    elif attribute == "size" and has(part, NOUNS["robot"]) and not has(part, _WORLD):
        candidates = [(*path, "shape", key) for path, _ in robots for key in ("radius", "length", "width")]
    elif attribute == "size" and has(part, NOUNS["obstacle"]) and not has(part, _WORLD):
        candidates = [
            (*path, "shape", key) for path, _ in entries(data, "obstacle") for key in ("radius", "length", "width")
        ]
    elif attribute == "size":
        candidates = [("world", "width"), ("world", "height")]
    else:
        candidates = [("world", attribute)]
    return [path for path in candidates if isinstance(at(data, path), (int, float))]


def _factor(part: str) -> float | None:
    """The factor that a part of a request speaks of; None without one."""
    for words, factor in _FACTORS:
        if has(part, words):
            return factor
    share = next((number.value for number in quantities(part) if number.kind == "share"), None)
    if share is not None:
        to = has(part, r"\bto \d+(?:\.\d+)? ?%|\bauf \d+|\bal \d+")
        return share if to else 1 - share if has(part, _LESS) else 1 + share
    times = re.search(r"(\d+(?:\.\d+)?) times (?:as|the|larger|bigger|faster)", part)
    return float(times[1]) if times else None


def _add_lidar(source: str, data: Any, part: str) -> Edited:
    facts = next(iter(request_of(part).lidars), {})
    path, _ = next(entries(data, "robot"))
    sensor = lidar(facts)
    return add(source, path, "sensors", sensor), [f"another lidar, {sensor['range_max']:g} m, {sensor['number']} beams"]


def _add_obstacles(source: str, data: Any, part: str) -> Edited:
    group = next(iter(request_of(part).obstacles))
    known = [entry for _, entry in entries(data, "obstacle")]
    shape = dict(known[-1]["shape"]) if known else {"name": "circle", "radius": group.facts.get("radius", 0.5)}
    number = group.number or 1
    size = float(shape.get("radius") or shape.get("length") or 1.0)
    for spot in _free_spots(data, number, size):
        source = add(source, (), "obstacle", {"shape": shape, "state": [*spot, 0]})
    return source, [plural(number, "more obstacle")]


def _free_spots(data: Any, number: int, size: float) -> list[tuple[float, float]]:
    """Places that are far from the ways of all robots and from other obstacles, on a grid of half metres."""
    world = data["world"]
    x0, y0 = world.get("offset", (0, 0))
    ways = [(entry["state"][:2], entry["goal"][:2]) for _, entry in entries(data, "robot") if "goal" in entry]
    taken = [tuple(entry["state"][:2]) for _, entry in entries(data, "obstacle") if "state" in entry]
    grid = [
        (x0 + 0.5 * i, y0 + 0.5 * j)
        for i in range(1, int(2 * world["width"]))
        for j in range(1, int(2 * world["height"]))
        if size <= 0.5 * i <= world["width"] - size and size <= 0.5 * j <= world["height"] - size
    ]
    spots: list[tuple[float, float]] = []
    for _ in range(number):
        others = [*taken, *spots]
        best = max(
            grid, key=lambda p: min([_to_way(p, *way) for way in ways] + [math.dist(p, q) for q in others] + [9.0])
        )
        spots.append(best)
    return spots


def _to_way(point: tuple[float, float], start: Any, goal: Any) -> float:
    """Distance of a point from a straight way."""
    length = math.dist(start, goal) ** 2
    along = 0.0 if length == 0 else sum((p - a) * (b - a) for p, a, b in zip(point, start, goal, strict=True)) / length
    along = min(1.0, max(0.0, along))
    return math.dist(point, [a + along * (b - a) for a, b in zip(start, goal, strict=True)])
