"""Evaluates small expressions over template parameters: arithmetic, comparisons, lists, mappings, some functions.

The syntax tree is walked node by node; ``eval`` is never used.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Mapping
from typing import Any

__all__ = ["evaluate", "names_in"]

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

    return value(ast.parse(expression, mode="eval").body)


def names_in(expression: str) -> set[str]:
    """The parameters that an expression reads."""
    known = {"pi", *_FUNCTIONS}
    tree = ast.parse(expression, mode="eval")
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)} - known


def _index(value: Any) -> int:
    if isinstance(value, int) and value >= 0:
        return value
    raise ValueError(f"an index in a template expression must be a whole number from 0 on, got {value!r}")


def _number(value: Any) -> float:
    if isinstance(value, (int, float)):
        return value
    raise ValueError(f"a template expression can calculate only with numbers, got {value!r}")
