"""Unquoted YAML 1.1 scalars → Python values, by the rules PyYAML's safe loader applies."""

from __future__ import annotations

import math
import re
from datetime import date
from typing import Any, Literal, NamedTuple

__all__ = ["Scalar", "resolve", "resolve_tagged"]

Surprise = Literal["sexagesimal", "octal"]


class Scalar(NamedTuple):
    """A resolved scalar and, if YAML 1.1 reads it in a surprising way, which way."""

    value: Any
    surprise: Surprise | None = None


_WORDS: dict[str, Any] = {"": None, "~": None}
for _value, _words in ((None, ("null",)), (True, ("yes", "true", "on")), (False, ("no", "false", "off"))):
    for _word in _words:
        _WORDS.update({_word: _value, _word.capitalize(): _value, _word.upper(): _value})

_INT = re.compile(r"[-+]?(?:0b[01_]+|0x[0-9a-fA-F_]+|0|[1-9][0-9_]*)\Z")
_OCTAL = re.compile(r"[-+]?0[0-7_]+\Z")
_FLOAT = re.compile(r"(?:[-+]?[0-9][0-9_]*\.[0-9_]*|\.[0-9][0-9_]*)(?:[eE][-+][0-9]+)?\Z")
_SPECIAL = re.compile(r"(?:([-+]?)\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))\Z")
_SEXAGESIMAL = re.compile(r"[-+]?[0-9][0-9_]*(?::[0-5]?[0-9])+(?:\.[0-9_]*)?\Z")
_DATE = re.compile(r"(\d{4})-(\d\d)-(\d\d)\Z")
_TIME = re.compile(r"\d{4}-\d\d?-\d\d?(?:[Tt]|[ \t]+)\d\d?:\d\d:\d\d(?:\.\d*)?(?:[ \t]*(?:Z|[-+]\d\d?(?::\d\d)?))?\Z")
_MAX_NUMBER_LENGTH = 400
"""Characters of a number; a double needs fewer, so longer text stays text."""
_NUMBER_START = frozenset("0123456789+-.")


def resolve(text: str) -> Scalar:
    """The value of an unquoted, untagged scalar."""
    if text in _WORDS:
        return Scalar(_WORDS[text])
    if text[0] not in _NUMBER_START or len(text) > _MAX_NUMBER_LENGTH:
        return Scalar(text)
    return _number(text)


def _number(text: str) -> Scalar:
    if _FLOAT.match(text):
        return Scalar(float(text.replace("_", "")))
    if _INT.match(text):
        return Scalar(_integer(text.replace("_", "")))
    if special := _SPECIAL.match(text):
        if special.group(1) is None:
            return Scalar(float("nan"))
        return Scalar(float("-inf" if special.group(1) == "-" else "inf"))
    if _OCTAL.match(text) and text.strip("+-0_"):
        digits = text.replace("_", "").lstrip("+-")
        return Scalar(_bounded(int(digits, 8) * (-1 if text[0] == "-" else 1)), "octal")
    if _OCTAL.match(text):
        return Scalar(0)
    if ":" in text and _SEXAGESIMAL.match(text):
        return Scalar(_base_sixty(text.replace("_", "")), "sexagesimal")
    if stamp := _DATE.match(text):
        try:
            return Scalar(date(*(int(part) for part in stamp.groups())))
        except ValueError:
            return Scalar(text)
    if _TIME.match(text):
        return Scalar(_timestamp(text))
    return Scalar(text)


def _bounded(value: int) -> int | float:
    """An integer as it is, or infinite beyond all doubles, as the same number with a point is."""
    try:
        float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf
    return value


def _integer(text: str) -> int | float:
    digits = text.lstrip("+-")
    base = {"0b": 2, "0x": 16}.get(digits[:2], 10)
    try:
        value = int(digits, base)
    except ValueError:  # only separators after the prefix: 0x_
        return 0
    return _bounded(-value if text[0] == "-" else value)


def _base_sixty(text: str) -> int | float:
    parts = text.lstrip("+-").split(":")
    whole = 0
    for part in parts[:-1]:
        whole = (whole + int(part)) * 60
    last = parts[-1]
    total = _bounded(whole) + (float(last) if "." in last else int(last))
    return -total if text[0] == "-" else total


def _timestamp(text: str) -> Any:
    """The value of a date with a time, read by PyYAML because it is rare; what PyYAML cannot read stays text."""
    import yaml

    try:
        return yaml.constructor.SafeConstructor().construct_yaml_timestamp(
            yaml.ScalarNode("tag:yaml.org,2002:timestamp", text)
        )
    except (ValueError, OverflowError):
        return text


def resolve_tagged(tag: str, text: str) -> Any:
    """The value of a scalar with one of the standard tags.

    Raises:
        ValueError: The text does not fit the tag.
        KeyError: The tag is not one that scenarios may use.
    """
    kind = tag.removeprefix("tag:yaml.org,2002:") if tag.startswith("tag:yaml.org,2002:") else None
    if kind == "str":
        return text
    if kind == "null":
        return None
    if kind not in ("int", "float", "bool"):
        raise KeyError(tag)
    value = resolve(text).value
    if kind == "bool":
        if not isinstance(value, bool):
            raise ValueError(f"{text!r} is not a boolean")
        return value
    if isinstance(value, str) and kind == "float" and len(text) <= _MAX_NUMBER_LENGTH:
        value = float(text)
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        raise ValueError(f"{text!r} is not a number")
    if kind == "int" and not math.isfinite(value):
        raise ValueError(f"{text!r} is not an integer")
    return float(value) if kind == "float" else int(value)
