"""The words of a request in one spelling, and what they mean in English, German, Spanish and Chinese."""

from __future__ import annotations

import math
import re
import unicodedata
from dataclasses import dataclass
from typing import Literal

__all__ = [
    "BEHAVIORS",
    "DIRECTIONS",
    "DRIVES",
    "LAYOUTS",
    "NOT_FLAT",
    "NOUNS",
    "NO_BEHAVIOR",
    "NUMBER",
    "UNKNOWN_REFERENCE",
    "Kind",
    "Language",
    "Quantity",
    "first",
    "has",
    "language_of",
    "plain",
    "quantities",
]  # fmt: skip

Language = Literal["en", "zh", "es", "de"]

_FUNCTION_WORDS: dict[Language, str] = {
    "en": "the a an of and with to in is it from one",
    "de": "der die das ein eine einen einem und mit von zu im ist es den dem auf",
    "es": "el la los las un una y con de del en es que por se al hacia para",
}
_CHINESE = re.compile(r"[\u4e00-\u9fff]")
_DECIMAL_COMMA = re.compile(r"(?<!\d)(\d+),(\d+)(?!\d*[,\d])")
_COMMA_AND_UNIT = re.compile(r"(?<![\d,.])(\d+),(\d{1,2})(?=\s?(?:m|cm|mm|km|s|%|°|grad|rad|met|hz|kg)(?![a-z]))")
"""A decimal comma in a text of another language: two digits at most and a unit follow."""
_THOUSANDS = re.compile(r"(?<=\d),(?=\d{3}\b)")
_NUMBERS: dict[Language, str] = {
    "en": "zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen "
    "seventeen eighteen nineteen twenty",
    "de": "null eins zwei drei vier fünf sechs sieben acht neun zehn elf zwölf dreizehn vierzehn fünfzehn sechzehn "
    "siebzehn achtzehn neunzehn zwanzig",
    "es": "cero uno dos tres cuatro cinco seis siete ocho nueve diez once doce trece catorce quince dieciséis "
    "diecisiete dieciocho diecinueve veinte",
}
_TENS: dict[Language, dict[str, int]] = {
    "en": {"thirty": 30, "forty": 40, "fifty": 50, "sixty": 60, "a dozen": 12, "half a dozen": 6},
    "de": {"dreißig": 30, "vierzig": 40, "fünfzig": 50, "sechzig": 60, "ein dutzend": 12},
    "es": {"treinta": 30, "cuarenta": 40, "cincuenta": 50, "sesenta": 60, "una docena de": 12},
}
_ZH_DIGITS = {c: i for i, c in enumerate("零一二三四五六七八九")} | {"两": 2}
_ZH_NUMBER = re.compile(
    r"([一二两三四五六七八九]?十[一二三四五六七八九]?|[二两三四五六七八九])(?=\s*[台个名位辆只根块条张堵面人])"
)
Kind = Literal["length", "speed", "angle", "turn", "time", "rate", "share", "mass", "count"]
NUMBER = r"[-+]?\d+(?:\.\d+)?"
"""A number as :func:`plain` leaves it."""
_UNITS: list[tuple[str, Kind, float]] = [
    (r"km/h|kph|kmh|kilomet\w+ per hour|km por hora|公里/小时|公里每小时|千米每小时|千米/小时", "speed", 1 / 3.6),
    (r"cm/s|厘米/秒", "speed", 0.01),
    (r"m/s|met(?:re|er)s? per second|meter pro sekunde|metros por segundo|米/秒|米每秒", "speed", 1.0),
    (r"mph", "speed", 0.44704),
    (
        r"(?:°|deg(?:rees?)?|grad|grados)\s?(?:/\s?s|per second|pro sekunde|por segundo)|度/秒|度每秒",
        "turn",
        math.pi / 180,
    ),
    (r"rad(?:ians?)?\s?(?:/\s?s|per second)|弧度/秒", "turn", 1.0),
    (r"°|deg(?:rees?)?\b|grad\b|grados?\b|度", "angle", math.pi / 180),
    (r"rad(?:ians?)?\b|弧度", "angle", 1.0),
    (r"hz\b|hertz\b|赫兹", "rate", 1.0),
    (r"ms\b|milliseconds?\b|毫秒", "time", 0.001),
    (r"min(?:ut\w+)?\b|分钟", "time", 60.0),
    (r"s\b|sec(?:onds?)?\b|sekunden?\b|segundos?\b|秒", "time", 1.0),
    (r"cm\b|centimet\w+\b|zentimetern?\b|centímetros?\b|厘米", "length", 0.01),
    (r"mm\b|millimet\w+\b|milímetros?\b|毫米", "length", 0.001),
    (r"km\b|kilomet\w+\b|公里|千米", "length", 1000.0),
    (r"ft\b|feet\b|foot\b", "length", 0.3048),
    (r"inch(?:es)?\b|in\.(?=\s)", "length", 0.0254),
    (r"yd\b|yards?\b", "length", 0.9144),
    (r"m\b|met(?:re|er)n?s?\b|metros?\b|米", "length", 1.0),
    (r"%|percent\b|per cent\b|prozent\b|por ciento\b", "share", 0.01),
    (r"kg\b|kilogram\w*\b|千克|公斤", "mass", 1.0),
]  # fmt: skip
_ANY_UNIT = "|".join(f"(?P<u{i}>{unit})" for i, (unit, _, _) in enumerate(_UNITS))
_QUANTITY = re.compile(rf"(?<![a-zà-ÿ\d_.])({NUMBER})(?:[\s-]?(?:{_ANY_UNIT}))?")


def language_of(text: str) -> Language:
    """The language of a text, by its characters and its short words."""
    if len(_CHINESE.findall(text)) >= 4:
        return "zh"
    words = re.findall(r"[^\W\d_]+", text.lower())
    return max(_FUNCTION_WORDS, key=lambda name: sum(word in _FUNCTION_WORDS[name].split() for word in words))


def plain(text: str) -> str:
    """A text in lower case with one spelling of characters and numbers.

    Full-width characters become ordinary ones, decimal commas points, numbers in words digits.
    """
    language = language_of(text)
    text = unicodedata.normalize("NFKC", text).lower()
    text = re.sub(r"[−–—‐‑]", "-", text).replace("×", "x").replace("，", ", ").replace("、", ", ").replace("。", ". ")
    text = re.sub(r"(?<=[\d )])\*(?=[\d ])", "x", text)
    if language in ("de", "es"):
        text = _DECIMAL_COMMA.sub(lambda match: _decimal(text, match), text)
    else:
        text = _THOUSANDS.sub("", _COMMA_AND_UNIT.sub(r"\1.\2", text))
    if language == "zh":
        text = _ZH_NUMBER.sub(lambda match: f" {_chinese(match[1])} ", text)
    for name in dict.fromkeys(("en", language)):
        text = _in_digits(text, name) if name in _NUMBERS else text
    return re.sub(r"[ \t\n]+", " ", text).strip()


def _decimal(text: str, match: re.Match[str]) -> str:
    """A decimal number; ``(2,3)`` alone in brackets is a place and stays."""
    alone = text[: match.start()].endswith("(") and text[match.end() :].startswith(")")
    return match[0] if alone else f"{match[1]}.{match[2]}"


def _chinese(word: str) -> int:
    if "十" not in word:
        return _ZH_DIGITS[word]
    tens, _, ones = word.partition("十")
    return 10 * (_ZH_DIGITS[tens] if tens else 1) + (_ZH_DIGITS[ones] if ones else 0)


def _in_digits(text: str, language: Language) -> str:
    values = {word: i for i, word in enumerate(_NUMBERS[language].split())} | _TENS[language]
    known = "|".join(sorted(map(re.escape, values), key=len, reverse=True))
    return re.sub(rf"\b({known})\b(?!-)", lambda match: str(values[match[1]]), text)


@dataclass(frozen=True)
class Quantity:
    """A number of a text.

    Attributes:
        value: In m, s, rad or kg and quotients of them; a share as a fraction.
        kind: The quantity that its unit measures; ``count`` without a unit.
        start, end: Where it stands in the text.
    """

    value: float
    kind: Kind
    start: int
    end: int


def quantities(text: str) -> list[Quantity]:
    """All numbers of a text that :func:`plain` made, in their order."""
    numbers = []
    for match in _QUANTITY.finditer(text):
        unit = next((i for i in range(len(_UNITS)) if match[f"u{i}"] is not None), None)
        kind: Kind = "count" if unit is None else _UNITS[unit][1]
        factor = 1.0 if unit is None else _UNITS[unit][2]
        numbers.append(Quantity(round(float(match[1]) * factor, 9), kind, match.start(), match.end()))
    return numbers


NOUNS: dict[str, str] = {
    "person": r"pedestrians?|people|persons?|humans?|walkers?|bystanders?|visitors?|shoppers?|passers-?by|strollers?"
    r"|fußgänger\w*|person(?:en|as?)|passanten?|menschen|leute|peat(?:ón|ones)|peatones|transeúntes?|gente|行人|路人",
    "lidar": r"lidars?|laser ?scanners?|scanners?|激光雷达|雷达",
    "wall": r"walls?|wände?n?|wand|mauern?|pared(?:es)?|muros?|墙壁?",
    "corridor": r"corridors?|hallways?|passageway|korridors?|flur|gang|pasillos?|corredor(?:es)?|走廊|通道",
    "doorway": r"doorways?|doors?|opening|gap|tür(?:en|öffnung)?|durchgang|puertas?|abertura|门洞|门口|门",
    "ring": r"circle of radius|on an? circle|around an? circle|in an? circle|kreis|círculo|圆周|圆圈|圆上",
    "world": (
        r"worlds?|arenas?|rooms?|halls?|fields?|plazas?|maps?|yard|hangar"
        r"|welt|halle|raum|feld|platz|karte|fläche|mundo|sala|campo|plaza|mapa|salón"
        r"|nave|世界|场景|场地|房间|大厅|地图|广场"
    ),
    "robot": r"robots?|vehicles?|cars?|trucks?|agv|agvs|bases?|platforms?|forklifts?|rovers?|ones"
    r"|\w*roboters?n?|\w*fahrzeuge?n?s?|autos?|plattform(?:en)?|vehículos?|coches?|carros?|机器人|小车|车辆|汽车|车",
    "obstacle": (
        r"obstacles?|box(?:es)?|crates?|posts?|pillars?|columns?|blocks?|barrels?"
        r"|shel(?:f|ves)|racks?|tables?"
        r"|pallets?|polygons?|hindernisse?n?|säulen?|kisten?|pfosten|blöcke?|regale?"
        r"|pfeiler|tische?"
        r"|obstáculos?|cajas?|columnas?|pilares?|postes?|bloques?|estanter\w+|mesas?"
        r"|障碍物|柱子|箱子|方块|正方形|货架|立柱"
    ),
    "trap": r"u-shaped trap|u-shaped|u-trap|u-förmig\w*|en forma de u|u ?形",
}
"""Things that a request speaks of. The order decides which wins where two match at one place."""

DRIVES: dict[str, str] = {
    "omni_angular": (
        r"(?:omnidirectional|holonomic|omni|mecanum)[^.;]{0,40}"
        r"(?:also (?:rotate|turn)|and (?:can )?(?:rotate|turn)|yaw)"
    ),
    "diff": (
        r"diff(?:erential)?[- ]?(?:drive|wheel\w*)?|two-wheeled|turtlebot|roomba|differential\w*"
        r"|zweirädrig\w*|diferencial(?:es)?|差速"
    ),
    "acker": r"ackermann?|car-like|cars?|truck|bicycle model|autos?|coches?|阿克曼|汽车",
    "omni": r"holonom\w*|omnidirec\w*|omni\b|mecanum|omnidirektional\w*|全向",
}
"""Drive → words."""

BEHAVIORS: dict[str, str] = {
    "rvo": r"\brvo\b|reciprocal velocity|velocidad recíproca|互惠速度",
    "orca": r"\borca\b",
    "sfm": r"\bsfm\b|social[- ]force|sozialkraft\w*|soziale\w* kr[aä]ft\w*|fuerzas? social(?:es)?|社会力",
    "follow": (
        r"plan(?:s|ned)? (?:a|its|the) (?:path|route|way)|path planner|a\*|global planner"
        r"|geplante\w* (?:pfad|weg)|规划"
    ),
    "dash": (
        r"\bdash\b|greedy|go-straight|straight (?:to|towards?|at)|drives? directly"
        r"|directly to|geradewegs|directo a|直线"
    ),
}
"""Behavior → words."""
NO_BEHAVIOR = (
    r"without (?:a |any |built-in )*behaviou?rs?|no (?:built-in )?behaviou?rs?|leave .{0,30}without a behaviou?r"
    r"|my (?:own )?(?:policy|controller|planner)[^.]{0,40}(?:supplies|drives|controls|plugs?|acts)|plug in my own"
    r"|ohne verhalten|sin comportamiento|不要行为|没有行为"
)
"""Words that say that the user's program drives."""

DIRECTIONS: list[tuple[str, tuple[float, float]]] = [
    (
        (
            r"(?:north-?|top[- ]|upper[- ])east|(?:top|upper)[- ]right|nordost\w*|oben rechts"
            r"|noreste|arriba a la derecha|东北|右上"
        ),
        (1, 1),
    ),
    (r"(?:north-?)west|(?:top|upper)[- ]left|nordwest\w*|oben links|noroeste|西北|左上", (-1, 1)),
    (r"(?:south-?)east|(?:bottom|lower)[- ]right|südost\w*|unten rechts|sureste|东南|右下", (1, -1)),
    (r"(?:south-?)west|(?:bottom|lower)[- ]left|südwest\w*|unten links|suroeste|西南|左下", (-1, -1)),
    (r"\bleft\b|\bwest(?:ern)?\b|westen|westlich\w*|\blinks\b|linke\w*|oeste|izquierd\w*|左|西", (-1, 0)),
    (r"\bright\b|\beast(?:ern)?\b|osten|östlich\w*|\brechts\b|rechte\w*|\beste\b|derech\w*|右|东", (1, 0)),
    (
        (
            r"\bnorth(?:ern)?\b|\btop\b|straight up|\bup\b|upwards|norden|nördlich\w*"
            r"|\boben\b|\bnorte\b|arriba|\+ ?y\b|上方|上侧|北"
        ),
        (0, 1),
    ),
    (r"\bsouth(?:ern)?\b|\bbottom\b|downwards?|süden|südlich\w*|\bunten\b|\bsur\b|abajo|- ?y\b|下方|下侧|南", (0, -1)),
]
"""Words of a direction → its signs along x and y."""

LAYOUTS: dict[str, str] = {
    "talking": (
        r"(?:talk|chat|convers|stand)\w*[^.]{0,40}(?:circle|ring|each other)|unterhalten sich"
        r"|conversa\w*|charla\w*|交谈|聊天"
    ),
    "wander": r"wander\w*|stroll\w*|new random destination|umher|spazieren|pasea\w*|闲逛|漫步|游荡",
    "crossing": (
        r"(?:cross|walk)\w* (?:in front of|the (?:way|path) of|before)|cross\w*[^.]{0,60}(?:right|left)"
        r"|quert?\w*|cruza\w*|横穿|横过"
    ),
    "both-ways": r"both (?:ways|directions)|beide\w* richtungen|ambos sentidos|双向|两个方向",
    "opposite": r"diametrically opposite|opposite (?:point|side)|antipod\w*|gegenüberliegend\w*|opuest\w*|对面",
    "random": r"\brandom\w*|zufällig\w*|aleatori\w*|al azar|随机",
    "perlin": r"perlin",
    "fog": r"\bfog\b|nebel|niebla|迷雾|uncover\w*|reveal\w*",
    "swap": r"pass(?:ing)? each other|head-on|meet|swap|einander|se cruzan|交会|相向",
    "crowd": r"crowd\w*|busy|dense|menschenmenge|multitud|abarrotad\w*|拥挤",
    "parked": r"parked|stationary|stands? still|does not move|geparkt\w*|stehend\w*|aparcad\w*|estacionad\w*|静止|停着",
    "walls": (
        r"(?:walls|boundary|fence)[^.]{0,25}(?:around|all sides|at the edge)|closed by walls"
        r"|enclosed|walled|umzäunt"
    ),
}
"""Arrangement → words."""

NOT_FLAT = (
    r"\baltitude|\bfly\w*\b|\bflight\b|\bdrones?\b|\bstairs?\b|\bstaircase|\bupstairs"
    r"|\belevators?\b|\bceiling|\bheights? of \d"
    r"|\bramps?\b|\bflughöhe|\bfliegen|\bdrohnen?\b|\btreppen?\b|\bescaleras?\b"
    r"|\bvolar\b|\bdron(?:es)?\b|无人机|飞行|楼梯"
)
"""Words of a third dimension, which a flat world lacks."""
UNKNOWN_REFERENCE = (
    r"\bthe usual\b|\bour (?:standard|usual|lab|office)\b|\bas (?:always|last time|before)\b"
    r"|wie immer|de siempre|老样子"
)
"""Words that point to something that only the user knows."""


def has(text: str, pattern: str) -> bool:
    """Whether a pattern occurs in a text."""
    return re.search(pattern, text) is not None


def first(text: str, table: dict[str, str]) -> str | None:
    """The name whose words come first in a text; the earlier name where two begin at one place."""
    matches = [
        (match.start(), i, name) for i, (name, words) in enumerate(table.items()) if (match := re.search(words, text))
    ]
    return min(matches)[2] if matches else None
