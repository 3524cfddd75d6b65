"""The text of a request in one spelling: language, full-width characters, decimal commas, numbers in words."""

from __future__ import annotations

import re
import unicodedata
from typing import Literal

__all__ = ["Language", "language_of", "plain"]

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
        text = _DECIMAL_COMMA.sub(lambda found: _decimal(text, found), text)
    else:
        text = _THOUSANDS.sub("", _COMMA_AND_UNIT.sub(r"\1.\2", text))
    if language == "zh":
        text = _ZH_NUMBER.sub(lambda found: f" {_chinese(found[1])} ", text)
    for name in dict.fromkeys(("en", language)):
        text = _in_digits(text, name) if name in _NUMBERS else text
    return re.sub(r"[ \t\n]+", " ", text).strip()


def _decimal(text: str, found: re.Match[str]) -> str:
    """A decimal number; ``(2,3)`` alone in brackets is a place and stays."""
    alone = text[: found.start()].endswith("(") and text[found.end() :].startswith(")")
    return found[0] if alone else f"{found[1]}.{found[2]}"


def _chinese(word: str) -> int:
    if "十" not in word:
        return _ZH_DIGITS[word]
    tens, _, ones = word.partition("十")
    return 10 * (_ZH_DIGITS[tens] if tens else 1) + (_ZH_DIGITS[ones] if ones else 0)


def _in_digits(text: str, language: Language) -> str:
    values = {word: i for i, word in enumerate(_NUMBERS[language].split())} | _TENS[language]
    known = "|".join(sorted(map(re.escape, values), key=len, reverse=True))
    return re.sub(rf"\b({known})\b(?!-)", lambda found: str(values[found[1]]), text)
