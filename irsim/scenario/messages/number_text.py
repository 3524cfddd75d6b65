"""Finds the number that was meant by text in its place, such as ``2 m``, ``pi/2`` or ``1,5``."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any, NamedTuple

__all__ = ["ParsedNumber", "decimal_commas", "read_number"]


class ParsedNumber(NamedTuple):
    """The number that a text means.

    Attributes:
        value: The number; None if it is not clear.
        note: Remark to add to "write <value>".
        is_number: Whether the text is a number in most languages, but not in YAML 1.1.
    """

    value: float | None
    note: str = ""
    is_number: bool = False


def decimal_commas(values: Sequence[Any], most: int, written: str | None, *, apart: bool = False) -> str | None:
    """The list that was meant if ``[1,5, 2,5, 0]`` has decimal commas; None if it has not, or is not too long.

    Args:
        values: The numbers as read.
        most: Largest number of values that the key takes.
        written: Text of the numbers; a comma followed by a space is not a decimal comma.
        apart: Require a space between one number and the next.
    """
    count = (len(values) + 1) // 2
    whole = all(isinstance(value, int) and not isinstance(value, bool) for value in values)
    if not whole or not count <= most < len(values) or any(value < 0 for value in values[1::2]):
        return None
    spaces = [bool(space) for space in re.findall(r",(\s*)(?=[-+.\d])", written or "")]
    if len(spaces) != len(values) - 1 or any(spaces[::2]) or (apart and not all(spaces[1::2])):
        return None
    pairs = [values[i : i + 2] for i in range(0, len(values), 2)]
    return "[" + ", ".join(".".join(str(part) for part in pair) for pair in pairs) + "]"


_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_QUANTITY = re.compile(rf"({_NUMBER})\s*([a-zA-Zµ°/²^0-9]+|%)\Z")
_PI = re.compile(
    r"([-+]?)\s*(?:(\d+\.?\d*|\.\d+)\s*\*?\s*)?(?:np\.|numpy\.|math\.)?(?:pi|PI|Pi|π)\s*(?:/\s*(\d+\.?\d*))?"
    r"(?:\s*\*\s*(\d+\.?\d*))?\Z"
)
_FRACTION = re.compile(rf"({_NUMBER})\s*/\s*({_NUMBER})\Z")
_INFINITE = {"inf": math.inf, "infinity": math.inf, "-inf": -math.inf, "+inf": math.inf}
_FACTORS = {
    ("m", "m"): 1.0,
    ("cm", "m"): 0.01,
    ("mm", "m"): 0.001,
    ("km", "m"): 1000.0,
    ("s", "s"): 1.0,
    ("sec", "s"): 1.0,
    ("ms", "s"): 0.001,
    ("min", "s"): 60.0,
    ("rad", "rad"): 1.0,
    ("deg", "rad"): math.pi / 180,
    ("degrees", "rad"): math.pi / 180,
    ("°", "rad"): math.pi / 180,
    ("m/s", "m/s"): 1.0,
    ("km/h", "m/s"): 1 / 3.6,
    ("kmh", "m/s"): 1 / 3.6,
    ("rad/s", "rad/s"): 1.0,
    ("deg/s", "rad/s"): math.pi / 180,
    ("kg", "kg"): 1.0,
    ("g", "kg"): 0.001,
}


def read_number(text: str, unit: str | None) -> ParsedNumber:
    """The number that a text means.

    Args:
        text: The text as written.
        unit: Unit of the key, as in the schema.
    """
    text = text.strip()[:200]
    if text.lower() in _INFINITE:
        return ParsedNumber(None, "infinity is .inf in YAML")
    if re.fullmatch(_NUMBER, text):
        value = float(text)
        return (
            ParsedNumber(value, is_number=True)
            if math.isfinite(value)
            else ParsedNumber(None, "this number is too large")
        )
    if pi := _PI.match(text):
        sign, before, divisor, after = pi.groups()
        value = math.pi * float(before or 1) * float(after or 1) * (-1 if sign == "-" else 1)
        if divisor is None or float(divisor) != 0:
            return ParsedNumber(value / float(divisor or 1), " (YAML has no pi)")
    if (fraction := _FRACTION.match(text)) and float(fraction.group(2)) != 0:
        return ParsedNumber(float(fraction.group(1)) / float(fraction.group(2)), " (YAML does not calculate)")
    if quantity := _QUANTITY.match(text):
        number, given = quantity.groups()
        factor = _FACTORS.get((given.lower(), unit or ""))
        if factor is not None:
            return ParsedNumber(float(f"{float(number) * factor:.12g}"), f" (in {unit}, without the unit)")
        return ParsedNumber(None, f"write the number alone{f', in {unit}' if unit else ''}")
    return ParsedNumber(None)
