"""The text of a request in one spelling, and the quantities in it in m, s, rad and kg."""

from __future__ import annotations

import math
import re
import unicodedata
from dataclasses import dataclass
from typing import Literal

__all__ = ["NUMBER", "Kind", "Language", "Quantity", "language_of", "plain", "quantities"]

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
"""A number as :func:`.language.plain` leaves it."""
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
    """All numbers of a text that :func:`.language.plain` made, in their order."""
    numbers = []
    for match in _QUANTITY.finditer(text):
        unit = next((i for i in range(len(_UNITS)) if match[f"u{i}"] is not None), None)
        kind: Kind = "count" if unit is None else _UNITS[unit][1]
        factor = 1.0 if unit is None else _UNITS[unit][2]
        numbers.append(Quantity(round(float(match[1]) * factor, 9), kind, match.start(), match.end()))
    return numbers
