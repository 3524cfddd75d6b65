"""The base of every model of the scenario language."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler, create_model
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, InitErrorDetails, PydanticCustomError, ValidationError

from irsim.common.field_docs import field_docs

if TYPE_CHECKING:
    from typing_extensions import Self

__all__ = ["SCHEMA_PARTS", "Options", "SchemaParts", "open_options", "problem", "problems_at", "shared_schema"]


@dataclass
class SchemaParts:
    """The shared parts of a schema that is being made.

    Attributes:
        makers: Name of each part that the schema refers to -> function that makes the part.
        user_code: Whether the schema includes names that user code has registered in this process.
    """

    makers: dict[str, Callable[[], dict[str, Any]]]
    user_code: bool


SCHEMA_PARTS: ContextVar[SchemaParts | None] = ContextVar("SCHEMA_PARTS", default=None)
"""The parts of the schema that is being made; None if none is being made."""


def shared_schema(name: str, make: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """A reference to a part of the schema that may occur several times; the part itself if none are collected."""
    parts = SCHEMA_PARTS.get()
    if parts is None:
        return make()
    parts.makers[name] = make
    return {"x-shared": name}  # pydantic would look a $ref up among its own definitions


class Options(BaseModel):
    """Keys of one mapping of a scenario.

    Every field is documented by the string below it. These strings are read from the source on request
    (:func:`field_docs`, the JSON Schema), not when the class is made, because a run needs none of them.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True, protected_namespaces=())

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        """The options themselves: they never change, so defaults need no copies."""
        return self

    schema_extra: ClassVar[dict[str, Any]] = {}
    """Additions to the JSON Schema of the mapping, such as examples."""
    also_called: ClassVar[dict[str, str]] = {}
    """Common wrong names of keys of this mapping -> the right key."""
    any_case: ClassVar[bool] = False
    """Whether ``name`` may contain upper-case letters."""

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        produced = handler(schema)
        target = handler.resolve_ref_schema(produced)
        docs = field_docs(cls)
        target.pop("title", None)
        for name, value in target.get("properties", {}).items():
            value.pop("title", None)
            if isinstance(cls.model_fields[name].default, BaseModel):
                value["default"] = {}
            if name == "name" and cls.any_case and "const" in value:
                pattern = "".join(f"[{c}{c.upper()}]" if c.isalpha() else c for c in value["const"])
                value["anyOf"] = [{"const": value.pop("const")}, {"pattern": f"^{pattern}$"}]
            if docs.get(name) and "description" not in value:
                value["description"] = docs[name]
        if cls.__doc__:
            target["description"] = inspect.cleandoc(cls.__doc__)
        target.update(cls.schema_extra)
        return produced


def problem(code: str, message: str, **details: Any) -> PydanticCustomError:
    """A validation error that becomes a diagnostic of that code.

    Args:
        code: From :data:`irsim.diagnostics.codes.CODES`.
        message: One sentence.
        **details: ``allowed`` and ``fix`` of the diagnostic; ``replace``, a better value, or ``rename``, a better key;
            ``tolerated`` if IR-SIM 2.12 continues with the better value, or ``tolerated_as``, the value it uses.
    """
    return PydanticCustomError(code, "{message}", {"message": message, **details})


def problems_at(
    kind: str, errors: Iterable[tuple[tuple[int | str, ...], PydanticCustomError]], given: Any = None
) -> ValidationError:
    """Errors at places below the value that a validator looks at.

    Args:
        kind: Name of what is validated.
        errors: Keys and indices that lead to the place of each error, and the error.
        given: The wrong value.
    """
    return ValidationError.from_exception_data(
        kind, [InitErrorDetails(type=error, loc=place, input=given) for place, error in errors]
    )


@cache
def open_options(model: type[BaseModel]) -> type[BaseModel]:
    """A copy of a model that accepts any other key, for user code that replaces a built-in feature."""
    return create_model(model.__name__, __base__=model, __module__=model.__module__, __cls_kwargs__={"extra": "allow"})
