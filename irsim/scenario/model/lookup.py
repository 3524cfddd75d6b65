"""Finds the model and the field of the language that a path of a document belongs to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from irsim.diagnostics.diagnostic import Path
from irsim.options.selection import Select
from irsim.options.vectors import PerObject

__all__ = ["at", "field_at", "lengths_of", "literals", "model_at", "unit_of"]


def at(data: Any, path: Path) -> Any:
    """The value at a path; None if the path does not exist."""
    for part in path:
        try:
            data = data[part]
        except (KeyError, IndexError, TypeError):
            return None
    return data


def model_at(root: type[BaseModel], path: Path, data: Any) -> type[BaseModel] | None:
    """The model that validates the mapping at ``path`` of a document; None if the path leads out of the language."""
    model: type[BaseModel] | None = root
    target: Select | type[BaseModel] | None = root
    keyed = False  # whether the next part is a key of the user's own
    for part in path:
        if isinstance(part, str):
            if keyed:
                keyed, data = False, at(data, (part,))
                continue
            field = _field(model, part) if model is not None else None
            if field is None:
                return None
            target, keyed = _target(field), get_origin(field.annotation) is dict
        data = at(data, (part,))
        if isinstance(target, Select):
            model = target.model_for(data) if isinstance(data, Mapping) else None
        else:
            model = target
    return model


def field_at(root: type[BaseModel], path: Path, data: Any) -> FieldInfo | None:
    """The field that the value at ``path`` belongs to (the list's own field for an element of a list)."""
    while path and not isinstance(path[-1], str):
        path = path[:-1]
    if not path:
        return None
    model = model_at(root, path[:-1], data)
    return _field(model, str(path[-1])) if model is not None else None


def _field(model: type[BaseModel], key: str) -> FieldInfo | None:
    """The field of a model that has a key."""
    field = model.model_fields.get(key)
    return field or next((field for field in model.model_fields.values() if field.alias == key), None)


def lengths_of(field: FieldInfo | None, least: int | None, most: int | None) -> tuple[int | None, int | None]:
    """Both bounds of a list's length; a failed validation reports only one of them."""
    pairs = []
    for part in _all_parts(field) if field is not None else ():
        bounds = [*getattr(part, "metadata", ()), part]
        low = next((b.min_length for b in bounds if getattr(b, "min_length", None) is not None), None)
        high = next((b.max_length for b in bounds if getattr(b, "max_length", None) is not None), None)
        pairs.append((low, high))
    if field is not None:
        own = [*field.metadata]
        low = next((b.min_length for b in own if getattr(b, "min_length", None) is not None), None)
        high = next((b.max_length for b in own if getattr(b, "max_length", None) is not None), None)
        pairs.insert(0, (low, high))
    for low, high in pairs:
        if (least is not None and low == least) or (most is not None and high == most):
            return low, high
    return least, most


def literals(field: FieldInfo) -> list[str]:
    """The words that a field accepts; empty if it is not a choice of words."""
    return [str(word) for part in _all_parts(field) if get_origin(part) is Literal for word in get_args(part)]


def unit_of(field: FieldInfo) -> str | None:
    """The unit of a field's number, as the schema has it; None without one."""
    for extra in (field.json_schema_extra, *(getattr(p, "json_schema_extra", None) for p in _all_parts(field))):
        if isinstance(extra, Mapping) and "x-unit" in extra:
            unit = str(extra["x-unit"])
            return None if unit == "1" else unit
    return None


def _target(field: FieldInfo) -> Select | type[BaseModel] | None:
    selection = next((part for part in _all_parts(field) if isinstance(part, Select)), None)
    if selection is not None:
        return selection
    for part in _all_parts(field):
        model = getattr(part, "model", part)
        if isinstance(model, type) and issubclass(model, BaseModel):
            return model
    return None


def _all_parts(field: FieldInfo) -> Iterator[Any]:
    for start in (field.annotation, *field.metadata):
        yield from _parts(start)


def _parts(annotation: Any) -> Iterator[Any]:
    """An annotation, all its parts, and their metadata."""
    yield annotation
    for part in (*get_args(annotation), *([annotation.item] if isinstance(annotation, PerObject) else [])):
        yield from _parts(part)
