"""Vectors of the scenario language, and values that may be given once or per object."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import Field, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from irsim.options.units import MAX_METERS

__all__ = [
    "LIST",
    "MAPPING",
    "ONE",
    "UNION_TAGS",
    "Offset",
    "OrNull",
    "PerObject",
    "Point",
    "Pose",
    "Range",
    "any_of",
    "is_vector",
    "vector",
]

ONE, PER_OBJECT, MAPPING, LIST = "<one>", "<per object>", "<mapping>", "<list>"
UNION_TAGS = frozenset({ONE, PER_OBJECT, MAPPING, LIST})
"""Tags in the location of a validation error; they name no part of the document."""


def vector(units: Sequence[str], low: int, high: int | None = None) -> Any:
    """Field metadata of a list of ``low`` to ``high`` numbers with these units."""
    most = low if high is None else high
    return Field(min_length=low, max_length=most, json_schema_extra={"x-units": list(units)})


Component = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-MAX_METERS, le=MAX_METERS)]
"""A number of a vector; the vector states the units."""
Point = Annotated[list[Component], vector(("m", "m"), 2)]
Offset = Annotated[list[Component], vector(("m", "m", "rad"), 3)]
Pose = Annotated[list[Component], vector(("m", "m", "rad"), 2, 3)]
Range = Annotated[list[Component], vector(("rad", "rad"), 2)]


def is_vector(value: Any) -> bool:
    """Whether a value is one vector by the spreading rule: a list of only numbers, or an empty list."""
    return isinstance(value, (list, tuple)) and all(isinstance(item, (int, float)) for item in value)


def _tag(value: Any) -> str:
    return PER_OBJECT if isinstance(value, (list, tuple)) and not is_vector(value) else ONE


def _tag_numbers(value: Any) -> str:
    return PER_OBJECT if isinstance(value, (list, tuple)) else ONE


def _tag_lists(value: Any) -> str:
    """Tag for keys that take a list of items: ``[[a], [b]]`` is one list per object, ``[a, b]`` one for all."""
    return PER_OBJECT if _holds_list(value) else ONE


def _tag_paths(value: Any) -> str:
    """Tag for keys that take a list of vectors: ``[[[x, y]], [[x, y]]]`` is one per object."""
    return PER_OBJECT if isinstance(value, (list, tuple)) and any(_holds_list(item) for item in value) else ONE


def _holds_list(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and any(isinstance(item, (list, tuple)) for item in value)


def _tag_vectors(value: Any) -> str:
    """Tag for keys that take a vector: text among the numbers is a wrong number, not the value of one object."""
    per_object = isinstance(value, (list, tuple)) and any(
        item is None or isinstance(item, (list, tuple)) for item in value
    )
    return PER_OBJECT if per_object else ONE


_DISCRIMINATORS = {
    "value": _tag,
    "vector": _tag_vectors,
    "number": _tag_numbers,
    "list": _tag_lists,
    "path": _tag_paths,
}


_CONTAINED = {"list": {"type": "array"}, "path": {"type": "array", "contains": {"type": "array"}}}
"""Schema of the elements that distinguish one list per object from a single list."""


class PerObject:
    """Type metadata of a key that takes one value for all objects of an entry, or a list with one per object.

    Args:
        item: Type of one value.
        kind: Kind of one value. ``value``: a single value or a vector. ``vector``: always a vector. ``number``: a
            number, so a list of numbers is one number per object. ``list``: a list of items. ``path``: a list of
            vectors.
        per: The things of which a list has one value each: each object of the entry, or each control.
    """

    def __init__(
        self,
        item: Any,
        kind: Literal["value", "vector", "number", "list", "path"] = "value",
        per: Literal["object", "control"] = "object",
    ) -> None:
        self.item = item
        self.kind = kind
        self.per = per
        self._discriminate = _DISCRIMINATORS[kind]

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        item = handler.generate_schema(self.item)
        many = core_schema.list_schema(item, min_length=1)
        return core_schema.tagged_union_schema({ONE: item, PER_OBJECT: many}, self._discriminate)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        union = any_of(handler(schema))
        if self.kind in _CONTAINED:
            union["anyOf"][-1]["contains"] = _CONTAINED[self.kind]
        if self.per != "object":
            union["anyOf"][-1]["x-per"] = self.per
        return union


def any_of(union: JsonSchemaValue) -> JsonSchemaValue:
    """A tagged union's schema without the claim that exactly one choice matches; unions inside it are flattened."""
    options: list[JsonSchemaValue] = []
    for option in union.pop("oneOf"):
        options += option["anyOf"] if set(option) == {"anyOf"} else [option]
    return {**union, "anyOf": options}


class OrNull:
    """Type metadata of a key for which null is accepted and means ``default``."""

    def __init__(self, default: Any) -> None:
        self.default = default

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return core_schema.no_info_before_validator_function(
            lambda value: self.default if value is None else value, handler(source)
        )

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        inner = handler(schema)
        options = inner["anyOf"] if set(inner) == {"anyOf"} else [inner]
        return {"anyOf": [*options, {"type": "null"}]}
