"""Small numbers in words."""

from __future__ import annotations

__all__ = ["in_words"]

_WORDS = {
    "en": "zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen",
    "de": "null ein zwei drei vier fünf sechs sieben acht neun zehn elf zwölf dreizehn vierzehn fünfzehn sechzehn",
    "es": "cero un dos tres cuatro cinco seis siete ocho nueve diez once doce trece catorce quince dieciséis",
    "zh": "零 一 两 三 四 五 六 七 八 九 十 十一 十二 十三 十四 十五 十六",
}


def in_words(number: int, language: str = "en") -> str:
    """A number from 0 to 16 in words, a greater one in digits."""
    words = _WORDS.get(language, _WORDS["en"]).split()
    return words[number] if 0 <= number < len(words) else str(number)
