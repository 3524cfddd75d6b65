"""Puts parameter values into the text of a template and keeps every other character.

Values follow from small expressions over the parameters: arithmetic, comparisons, lists, mappings, some functions. The
syntax tree is walked node by node; ``eval`` is never used.
"""

from __future__ import annotations

import ast
import functools
import math
import operator
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import yaml

from irsim.bundled.templates.store import Template, TemplateError
from irsim.common.text import decimal
from irsim.common.yaml.tree import LOADER, node_at, same_data
from irsim.diagnostics.diagnostic import Path

__all__ = ["evaluate", "fill", "format_value", "parse_path", "parse_settings", "replace_values"]

_BINARY: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
}
_COMPARE: dict[type[ast.cmpop], Callable[[Any, Any], bool]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "min": min,
    "max": max,
    "round": round,
    "abs": abs,
    "sqrt": math.sqrt,
    "sin": math.sin,
    "cos": math.cos,
}
_NEAR = 1e-6
"""Difference of numbers that their spelling in a template does not show."""


def evaluate(expression: str, values: Mapping[str, Any]) -> Any:
    """The value of an expression.

    Args:
        expression: For example ``[width - 1.5, height / 2, 0]`` or ``3 if lanes > 2 else 1.5``.
        values: Parameter values by name; ``pi`` is known as well.

    Raises:
        ValueError: The expression uses a name or a construct that is not allowed.
    """
    names = {"pi": math.pi, **values}

    def value(node: ast.expr) -> Any:
        match node:
            case ast.Constant(value=bool() | int() | float() | str() as constant):
                return constant
            case ast.Name(id=name) if name in names:
                return names[name]
            case ast.List(elts=items):
                return [value(item) for item in items]
            case ast.Dict(keys=keys, values=items) if all(keys):
                return {value(key): value(item) for key, item in zip(keys, items, strict=True) if key is not None}
            case ast.Subscript(value=ast.List() as items, slice=index):
                return value(items)[_index(value(index))]
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -value(operand)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
                return _BINARY[type(op)](_number(value(left)), _number(value(right)))
            case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _COMPARE:
                return _COMPARE[type(op)](value(left), value(right))
            case ast.IfExp(test=test, body=body, orelse=orelse):
                return value(body) if value(test) else value(orelse)
            case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) if name in _FUNCTIONS:
                return _FUNCTIONS[name](*(value(argument) for argument in arguments))
        raise ValueError(f"a template expression cannot contain {ast.unparse(node)}")

    return value(_parsed(expression))


@functools.lru_cache(maxsize=4096)
def _parsed(expression: str) -> ast.expr:
    """The syntax of an expression; many are evaluated again and again with other values."""
    return ast.parse(expression, mode="eval").body


def _index(value: Any) -> int:
    if isinstance(value, int) and value >= 0:
        return value
    raise ValueError(f"an index in a template expression must be a whole number from 0 on, got {value!r}")


def _number(value: Any) -> float:
    if isinstance(value, (int, float)):
        return value
    raise ValueError(f"a template expression can calculate only with numbers, got {value!r}")


def fill(template: Template, given: Mapping[str, Any] | None = None) -> str:
    """The scenario text of a template with the given parameters.

    Args:
        template: From :func:`irsim.bundled.templates.load`.
        given: Values of some or all parameters; text is converted.

    Raises:
        TemplateError: A parameter is unknown or out of range.
    """
    values = template.values(dict(given or {}))
    changes = {parse_path(path): evaluate(expression, values) for path, expression in template.sets.items()}
    return replace_values(template.text, changes)


def replace_values(text: str, changes: Mapping[Path, Any]) -> str:
    """Replace the values at some paths of a YAML text; a value that equals the new one keeps its spelling.

    Raises:
        KeyError: A path does not exist.
    """
    root = yaml.compose(text, Loader=LOADER)
    pieces: list[tuple[int, int, str]] = []
    for path, value in changes.items():
        node = node_at(root, path)
        if not same_data(_plain(node), value, near=_NEAR):
            pieces.append((node.start_mark.index, node.end_mark.index, format_value(value)))
    for start, end, new in sorted(pieces, reverse=True):
        text = _splice(text, start, end, new)
    return text


def parse_settings(settings: Iterable[str]) -> dict[str, str]:
    """``["width=1.6"]`` as ``{"width": "1.6"}``.

    Raises:
        TemplateError: A setting does not have the form ``KEY=VALUE``.
    """
    given = {}
    for setting in settings:
        key, equals, value = setting.partition("=")
        if not (key.strip() and equals and value.strip()):
            raise TemplateError("bad-parameter", f"{setting!r} is not a setting.", "write KEY=VALUE, as in width=1.6.")
        given[key.strip()] = value.strip()
    return given


def parse_path(path: str) -> Path:
    """``robot[0].state[1]`` as ``("robot", 0, "state", 1)``."""
    return tuple(int(index) if index else name for name, index in re.findall(r"([^.\[\]]+)|\[(\d+)\]", path))


def format_value(value: Any) -> str:
    """A value as YAML flow text; numbers to 6 decimals, without trailing zeros."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return decimal(value, 6)
    if isinstance(value, list):
        return "[" + ", ".join(format_value(item) for item in value) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {format_value(item)}" for key, item in value.items()) + "}"
    return str(value)


def _splice(text: str, start: int, end: int, new: str) -> str:
    """Replace a span of text; a comment behind it stays in its column if there is enough space."""
    grown = len(new) - (end - start)
    tail = re.match(r"([^\n#]*?)( +)(?=#)", text[end:])
    if tail and (grown < 0 or len(tail[2]) > grown + 1):
        rest = tail[1] + " " * (len(tail[2]) - grown) + text[end + tail.end() :]
    else:
        rest = text[end:]
    return text[:start] + new + rest


def _plain(node: yaml.Node) -> Any:
    constructor = yaml.SafeLoader("")
    try:
        return constructor.construct_document(node)
    finally:
        constructor.dispose()
