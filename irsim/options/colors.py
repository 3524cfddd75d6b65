"""Colors as a scenario writes them, checked and read without loading a drawing library; the default palette."""

from __future__ import annotations

import re
from typing import Annotated, Any

from pydantic import GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from irsim.common.arguments import is_number
from irsim.diagnostics.diagnostic import nearest
from irsim.options.base import problem, shared_schema

__all__ = ["ACKER_COLOR", "CYCLE", "OBSTACLE_COLOR", "PUSHABLE_COLOR", "ROBOT_COLOR", "Color", "cycle_color", "rgb"]

ROBOT_COLOR = "#009E73"
ACKER_COLOR = "#117733"
OBSTACLE_COLOR = "k"
PUSHABLE_COLOR = "#E69F00"

CYCLE = ("#009E73", "#0072B2", "#E69F00", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#117733")
"""Colors that ``color: cycle`` hands out, distinguishable with color-blind eyes.

Okabe, Ito: Color Universal Design (2008), with the dark green of Paul Tol's muted scheme.
"""

_LETTERS = "b g r c m y k w"
_CSS = """aliceblue antiquewhite aqua aquamarine azure beige bisque black blanchedalmond blue blueviolet brown burlywood
cadetblue chartreuse chocolate coral cornflowerblue cornsilk crimson cyan darkblue darkcyan darkgoldenrod darkgray
darkgreen darkgrey darkkhaki darkmagenta darkolivegreen darkorange darkorchid darkred darksalmon darkseagreen
darkslateblue darkslategray darkslategrey darkturquoise darkviolet deeppink deepskyblue dimgray dimgrey dodgerblue
firebrick floralwhite forestgreen fuchsia gainsboro ghostwhite gold goldenrod gray green greenyellow grey honeydew
hotpink indianred indigo ivory khaki lavender lavenderblush lawngreen lemonchiffon lightblue lightcoral lightcyan
lightgoldenrodyellow lightgray lightgreen lightgrey lightpink lightsalmon lightseagreen lightskyblue lightslategray
lightslategrey lightsteelblue lightyellow lime limegreen linen magenta maroon mediumaquamarine mediumblue
mediumorchid mediumpurple mediumseagreen mediumslateblue mediumspringgreen mediumturquoise mediumvioletred
midnightblue mintcream mistyrose moccasin navajowhite navy oldlace olive olivedrab orange orangered orchid
palegoldenrod palegreen paleturquoise palevioletred papayawhip peachpuff peru pink plum powderblue purple
rebeccapurple red rosybrown royalblue saddlebrown salmon sandybrown seagreen seashell sienna silver skyblue slateblue
slategray slategrey snow springgreen steelblue tan teal thistle tomato turquoise violet wheat white whitesmoke yellow
yellowgreen"""
_TABLEAU = {
    "blue": "#1f77b4", "orange": "#ff7f0e", "green": "#2ca02c", "red": "#d62728", "purple": "#9467bd",
    "brown": "#8c564b", "pink": "#e377c2", "gray": "#7f7f7f", "grey": "#7f7f7f", "olive": "#bcbd22", "cyan": "#17becf",
}  # fmt: skip
NAMES = (*_LETTERS.split(), *_CSS.split(), *(f"tab:{name}" for name in _TABLEAU), "none")
_KNOWN = frozenset(NAMES)
_HEX = r"#(?:[0-9a-fA-F]{3,4}|[0-9a-fA-F]{6}|[0-9a-fA-F]{8})"
_CYCLE_NAME = r"C[0-9]+"
_XKCD = r"[xX][kK][cC][dD]:.+"
_GRAY = r"(?:0|1|[01]?\.[0-9]+|[01]\.)"
_PATTERN = re.compile(rf"(?:{_HEX}|{_CYCLE_NAME}|{_XKCD}|{_GRAY})\Z")
_EXPECTED = "a name such as 'red' or 'tab:blue', '#RRGGBB', or [r, g, b] with numbers from 0 to 1"


def _text(value: str) -> str:
    if value in _KNOWN or _PATTERN.match(value) or value.lower() in _KNOWN:
        return value
    near = nearest(value, _KNOWN)
    raise problem(
        "unknown-color",
        f"'{value}' is not a color",
        allowed=_EXPECTED,
        fix=f"write {near}" if near else None,
        replace=near,
    )


def _validate(value: Any) -> str | tuple[float, ...]:
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, (list, tuple)) and len(value) in (3, 4):
        numbers = [v for v in value if is_number(v) and 0 <= v <= 1]
        if len(numbers) == len(value):
            return tuple(float(v) for v in numbers)
    raise problem("unknown-color", "this is not a color", allowed=_EXPECTED)


def _validate_object(value: Any) -> str | tuple[float, ...]:
    return "cycle" if value == "cycle" else _validate(value)


class _ColorSchema:
    def __init__(self, cycle: bool) -> None:
        self.cycle = cycle

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(_validate_object if self.cycle else _validate)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return shared_schema("ObjectColor" if self.cycle else "Color", self._schema)

    def _schema(self) -> JsonSchemaValue:
        words = [*(["cycle"] if self.cycle else []), *NAMES]
        any_case = "|".join(f"[{name[0]}{name[0].upper()}]{name[1:]}" for name in _CSS.split())
        return {
            "description": "A color: a name, '#RRGGBB', a grey level as text, or [r, g, b] with numbers from 0 to 1.",
            "anyOf": [
                {"type": "string", "enum": words},
                {"type": "string", "pattern": f"^({_HEX}|{_CYCLE_NAME}|{_XKCD}|{_GRAY}|{any_case})$"},
                {
                    "type": "array",
                    "items": {"type": "number", "minimum": 0, "maximum": 1},
                    "minItems": 3,
                    "maxItems": 4,
                },
            ],
        }


Color = Annotated[Any, _ColorSchema(cycle=False)]
"""A color: name, ``#RRGGBB``, grey level as text, or 3 to 4 numbers; str or tuple of floats after validation."""

ObjectColor = Annotated[Any, _ColorSchema(cycle=True)]
"""Like :data:`Color`, or ``cycle``: one palette color after the other."""


def cycle_color(index: int) -> str:
    """The palette color of the ``index``-th object of an entry."""
    return CYCLE[index % len(CYCLE)]


_NAMED = {
    "b": (0.0, 0.0, 1.0), "g": (0.0, 0.5, 0.0), "r": (1.0, 0.0, 0.0), "c": (0.0, 0.75, 0.75), "m": (0.75, 0.0, 0.75),
    "y": (0.75, 0.75, 0.0), "k": (0.0, 0.0, 0.0), "w": (1.0, 1.0, 1.0), "none": (0.0, 0.0, 0.0),
}  # fmt: skip
_CYCLED = tuple(color for name, color in _TABLEAU.items() if name != "grey")
"""The colors ``C0`` to ``C9``."""


def rgb(color: Any) -> tuple[float, float, float]:
    """Red, green and blue, 0 to 1, of a color as scenarios write it.

    Args:
        color: A name, ``#RRGGBB``, a grey level as text, or three or four numbers.

    Raises:
        ValueError: The text does not name a color.
    """
    if not isinstance(color, str):
        red, green, blue, *_ = (float(value) for value in color)
        return red, green, blue
    if color in _NAMED:
        return _NAMED[color]
    if color.startswith("#"):
        return _of_digits(color[1:])
    if color.startswith("tab:") and color[4:] in _TABLEAU:
        return _of_digits(_TABLEAU[color[4:]][1:])
    if color[:1] == "C" and color[1:].isdecimal():
        return _of_digits(_CYCLED[int(color[1:]) % len(_CYCLED)][1:])
    if color[:1] in "01.":
        return (float(color),) * 3
    from PIL.ImageColor import colormap, getrgb

    if (name := color.lower()) in colormap:
        red, green, blue, *_ = (value / 255 for value in getrgb(name))
        return red, green, blue
    from matplotlib.colors import to_rgb  # knows the many names of xkcd, and takes half a second to load

    red, green, blue = to_rgb(color)
    return float(red), float(green), float(blue)


def _of_digits(digits: str) -> tuple[float, float, float]:
    width = 1 if len(digits) in (3, 4) else 2
    most = 16**width - 1
    red, green, blue = (int(digits[width * k : width * (k + 1)], 16) / most for k in range(3))
    return red, green, blue
