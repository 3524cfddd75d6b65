"""Facts of a request: sizes, limits and sensor values, each given to the mention that it belongs to."""

from __future__ import annotations

import itertools
import math
import re

from irsim_evals.baselines.language import Quantity, quantities
from irsim_evals.baselines.mentions import Mention, owner, sentence_of

__all__ = ["add_facts"]

_BODIES = ("robot", "person", "obstacle")
_KEYS: dict[str, tuple[str, tuple[str, ...]]] = {
    "radius": (r"radius|radii|radio|半径", (*_BODIES, "ring")),
    "diameter": (r"diameter|in diameter|across|durchmesser|diámetro|直径", (*_BODIES, "ring")),
    "wheelbase": (r"wheelbase|radstand|distancia entre ejes|轴距", ("robot",)),
    "side": (
        (
            r"(?:on )?(?:each|every|a|per) side|sides?\b|side length|squares?\b|cubes?\b|seitenlänge|kantenlänge"
            r"|de lado|lado|边长|见方"
        ),
        ("robot", "obstacle", "world"),
    ),
    "width": (
        r"wide|width|broad|breite?|de ancho|ancho|anchura|宽度?",
        ("world", "corridor", "doorway", "trap", "robot", "obstacle"),
    ),
    "height": (r"high|tall|height|hoch|höhe|de alto|alto|altura|高度?", ("world", "obstacle")),
    "length": (
        r"long|length|länge|lang|de largo|largo|longitud|长度?",
        ("corridor", "robot", "obstacle", "wall", "world"),
    ),
    "depth": (r"deep|depth|tiefe?|de fondo|profundidad|深度?", ("trap", "corridor")),
    "range": (r"range|reach(?:ing)?|reichweite|alcance|sees|see|射程|量程|探测距离|范围", ("lidar",)),
    "sideways": (r"sideways|seitwärts|lateral(?:mente)?|横向", ("robot",)),
}
"""Fact → its words, and the nouns that can have it."""
_LARGEST_ROBOT_M = 4.0
"""Robots are smaller than this; what is larger is the size of the world."""
_LINK = r"(?:\s*(?:of|is|=|:|von|de|es|为|是|at most|up to|about|roughly|around|max\.?|a)){0,3}\s*"
_BETWEEN = re.compile(r"\s*(?:x|by|mal|por|乘)\s*")
_BEAMS = re.compile(r"(\d+)[\s-]?(?:beams?|rays?|strahlen|strahl\b|haces|rayos|束|线|条光束)")
_SHARES = {
    "quarter": 0.25,
    "third": 1 / 3,
    "half": 0.5,
    "fifth": 0.2,
    "tenth": 0.1,
    "viertel": 0.25,
    "cuarta parte": 0.25,
}
_SPEED_OF_PERSON = r"walk|pedestrian|people|gehen|caminan|行走"


def add_facts(text: str, mentions: list[Mention]) -> dict[str, float]:
    """Give each number of a text to the mention that it belongs to; returns what belongs to the whole scene."""
    whole: dict[str, float] = {}
    numbers = quantities(text)
    used: set[int] = set()
    for a, b in itertools.pairwise(numbers):
        if a.start not in used and _BETWEEN.fullmatch(text[a.end : b.start]) and b.kind in ("length", "count"):
            used |= {a.start, b.start}
            _add_size(text, mentions, a, b)
    for number in numbers:
        if number.start not in used:
            _add_number(text, mentions, number, whole)
    _add_sensor_words(text, mentions)
    if (
        share := re.search(rf"({'|'.join(_SHARES)})[^.]{{0,24}}(?:occup|cover|filled|belegt|ocupad)", text)
    ) is not None:
        whole.setdefault("fill", _SHARES[share[1]])
    return whole


def _add_size(text: str, mentions: list[Mention], a: Quantity, b: Quantity) -> None:
    """A size such as 12 x 8 m."""
    factor = b.value / _bare(text, b) if a.kind == "count" and b.kind == "length" and b.value else 1.0
    mention = owner(text, mentions, a.start, b.end, ("world", "robot", "obstacle", "corridor"))
    if mention is None or (mention.kind == "robot" and min(a.value * factor, b.value) > _LARGEST_ROBOT_M):
        mention = Mention("world", a.start, b.end, 1, False, False, "")
        mentions.append(mention)
    mention.facts.setdefault("size", (round(a.value * factor, 6), b.value))


def _bare(text: str, number: Quantity) -> float:
    """The number as written, without its unit."""
    match = re.match(r"[-+]?\d+(?:\.\d+)?", text[number.start :])
    return float(match[0]) if match else 1.0


def _add_number(text: str, mentions: list[Mention], number: Quantity, whole: dict[str, float]) -> None:
    before, after = text[max(0, number.start - 40) : number.start], text[number.end : number.end + 40]
    sentence = text[slice(*sentence_of(text, number.start))]
    if number.kind in ("length", "speed", "count"):
        for key, (words, kinds) in _KEYS.items():
            behind = re.match(rf"[\s-]*(?:in |of |de |的)?(?:{words})(?![a-z])", after)
            ahead = re.search(rf"(?<![a-z])(?:{words}){_LINK}$", before)
            if (behind or ahead) and (key == "sideways") == (number.kind == "speed"):
                end = number.end + (behind.end() if behind else 0)
                start = ahead.start() + number.start - len(before) if ahead and not behind else number.start
                _give(text, mentions, start, end, kinds, key, number.value)
                return
    if number.kind == "length":
        if re.match(r"\s*apart", after):
            _give(text, mentions, number.start, number.end, ("robot",), "apart", number.value)
        elif re.search(r"cells?|resolution|zellen|celdas|栅格|网格", after[:16] + before[-24:]):
            whole.setdefault("cell", number.value)
        elif _last_kind(text, mentions, number.start) == "lidar":
            _give(text, mentions, number.start, number.end, ("lidar",), "range", number.value)
    elif number.kind == "speed":
        if "nois" in after + before[-12:]:
            _give(text, mentions, number.start, number.end, ("lidar",), "velocity_noise", number.value)
        else:
            walking = re.search(_SPEED_OF_PERSON, before[-24:]) is not None
            _give(
                text, mentions, number.start, number.end, ("person",) if walking else ("robot",), "speed", number.value
            )
    elif number.kind == "turn":
        _give(text, mentions, number.start, number.end, ("robot",), "turn", number.value)
    elif number.kind == "angle":
        if re.search(r"steer|lenk|dirección|转向", sentence) and re.search(
            r"steer|lenk|dirección|转向", before + after[:16]
        ):
            _give(text, mentions, number.start, number.end, ("robot",), "steer", number.value)
        elif "lidar" in {m.kind for m in mentions if m.start < number.end + 24}:
            _give(text, mentions, number.start, number.end, ("lidar",), "angle", number.value)
    elif number.kind == "rate":
        whole.setdefault("step_time", round(1 / number.value, 6) if number.value else 0.1)
    elif number.kind == "time":
        key = "step_time" if number.value < 1 or re.search(r"step|dt|schritt|paso|步长", before[-20:]) else "time_limit"
        whole.setdefault(key, number.value)
    elif number.kind == "share" and re.search(r"occup|filled|cover|belegt|ocupad|占", before + after):
        whole.setdefault("fill", number.value)
    elif number.kind == "count":
        if re.search(r"(?:map )?seed\s*(?:=|:|of)?\s*$", before):
            whole.setdefault("seed", number.value)
        elif (ends := re.search(r"from (-?\d+(?:\.\d+)?) to $", before)) is not None:
            whole.setdefault("low", float(ends[1]))


def _last_kind(text: str, mentions: list[Mention], position: int) -> str | None:
    begin, _ = sentence_of(text, position)
    before = [m for m in mentions if begin <= m.start < position and not (m.oblique and m.definite)]
    return before[-1].kind if before else None


def _give(
    text: str, mentions: list[Mention], start: int, end: int, kinds: tuple[str, ...], key: str, value: float
) -> None:
    mention = owner(text, mentions, start, end, kinds)
    if mention is not None:
        mention.facts.setdefault(key, value)


def _add_sensor_words(text: str, mentions: list[Mention]) -> None:
    """Beams, full circles and halves, doppler, mounting of lidars."""
    lidars = [mention for mention in mentions if mention.kind == "lidar"]
    for match in _BEAMS.finditer(text):
        if re.match(r" per degree", text[match.end() :]):
            continue
        _give(text, mentions, match.start(), match.end(), ("lidar",), "beams", int(match[1]))
    for lidar in lidars:
        begin, end = sentence_of(text, lidar.start)
        around = text[begin:end]
        if re.search(r"all[- ]round|full circle|in all directions|rundum|全向扫描|全方位|alrededor", around):
            lidar.facts.setdefault("angle", 2 * math.pi)
        if re.search(r"half[- ]plane|half[- ]circle|front half", around):
            lidar.facts.setdefault("angle", math.pi)
        if re.search(r"1 (?:beam|ray) per degree|a beam per degree|je grad|por grado|每度", around):
            lidar.facts.setdefault("per_degree", 1)
        if re.search(r"backwards?|rear|behind|nach hinten|atrás|trasero|向后|后方", around):
            lidar.facts.setdefault("mount", math.pi)
        if re.search(r"fmcw|doppler|radial", around):
            lidar.facts.setdefault("name", "fmcw_lidar2d")
        if re.search(r"ego[- ]motion compensat|motion[- ]compensat", around):
            lidar.facts.setdefault("motion_compensate", True)
