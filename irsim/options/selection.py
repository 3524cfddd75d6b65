"""Mappings that pick their model by name: ``kinematics: {name: diff, ...}`` becomes the options model of ``diff``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_origin

from pydantic import BaseModel, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, InitErrorDetails, PydanticCustomError, ValidationError, core_schema

from irsim.diagnostics.diagnostic import nearest, surely
from irsim.options.base import SCHEMA_PARTS, open_options, problem, shared_schema
from irsim.options.registry import CustomBehaviors, Registry

__all__ = ["Choices", "Select"]

_NAME_WORDS = ("type", "kind")
"""What people write for the key ``name``."""


@dataclass(frozen=True)
class Choice:
    """One of a fixed set of models."""

    name: str
    options: type[BaseModel]


class Choices:
    """A fixed set of models with the interface of a registry, for places that take only these.

    Args:
        kind: Singular word for messages: ``part``.
        models: Model by name.
    """

    def __init__(self, kind: str, models: Mapping[str, type[BaseModel]]) -> None:
        self.kind, self.models = kind, dict(models)

    def names(self) -> list[str]:
        """All names, sorted."""
        return sorted(self.models)

    def installed(self) -> list[str]:
        """The same: nobody registers anything here."""
        return self.names()

    def get(self, name: str) -> Choice | None:
        """The choice of that name."""
        return Choice(name, self.models[name]) if name in self.models else None


class Select:
    """Type metadata: a mapping validated by the options model that a registry has under its ``name``.

    Args:
        registry: Where names come from; a feature is imported when a scenario names it.
        default: Name of a mapping without one; None if the name is required.
        folded: Names are compared in lower case.
        alias: Another key that may hold the name.
        custom: Names registered by user code; their mappings become ``fallback``, or take any key where it is built in.
        fallback: Model of custom and unknown names, which are accepted where it is given.
        exclude: Names of the registry that are not accepted here.
        null: null is accepted and stays None.
        empty: An empty mapping is accepted and becomes None.
        short: A text alone stands for a mapping with this name (None: the text is the name) and the text under this
            key.
        trait: Class attribute that must be true of the models the schema offers; the checks say so of others.
    """

    def __init__(
        self,
        registry: Registry | Choices,
        *,
        default: str | None = None,
        folded: bool = False,
        alias: str | None = None,
        custom: CustomBehaviors | None = None,
        fallback: type[BaseModel] | None = None,
        exclude: tuple[str, ...] = (),
        null: bool = False,
        empty: bool = False,
        short: tuple[str | None, str] | None = None,
        trait: str | None = None,
    ) -> None:
        self.registry, self.default, self.folded, self.alias = registry, default, folded, alias
        self.custom, self.fallback, self.exclude = custom, fallback, exclude
        self.null, self.empty, self.short, self.trait = null, empty, short, trait

    def names(self) -> list[str]:
        """Every name accepted here, user code's included."""
        custom = self.custom.names() if self.custom is not None else []
        return sorted({*(n for n in self.registry.names() if n not in self.exclude), *custom})

    def name_of(self, value: Mapping[str, Any]) -> Any:
        """The name a mapping goes by."""
        name = value.get("name")
        if name is None and self.alias is not None:
            name = value.get(self.alias)
        if name is None:
            name = self.default
        if self.folded and isinstance(name, str) and self.registry.get(name) is None:
            return name.lower()
        return name

    def model_for(self, value: Mapping[str, Any]) -> type[BaseModel] | None:
        """The model that validates ``value``, or None if its name is unknown."""
        name = self.name_of(value)
        if not isinstance(name, str) or name in self.exclude:
            return None
        feature = self.registry.get(name)
        if feature is not None and self.custom is not None and name in self.custom.names():
            return open_options(feature.options)
        return feature.options if feature is not None else self.fallback

    def validate(self, value: Any) -> BaseModel | None:
        """The options model for ``value``; None for null or ``{}`` where these are accepted.

        Raises:
            PydanticCustomError, ValidationError: Not a mapping, no or an unknown name, or wrong keys.
        """
        if isinstance(value, BaseModel) or (value is None and self.null):
            return value
        if self.empty and isinstance(value, Mapping) and not value:
            return None
        kind = self.registry.kind
        where: tuple[str, ...] = ("name",)
        if self.short is not None and isinstance(value, str):
            name, key = self.short
            where = ()
            value = {"name": name, key: value} if name is not None else {key: value}
        if isinstance(value, str):
            raise self._name_alone(value)
        if not isinstance(value, Mapping):
            raise problem("not-a-mapping", f"'{kind}' is a mapping with a name", allowed=f"{{name: <{kind}>, ...}}")
        if self.default is not None and "name" in value and value["name"] is None:
            empty = problem(
                "wrong-type",
                "null is not a name",
                allowed=self.names(),
                fix=f"name: {self.default}, or no name at all",
                replace=self.default,
                tolerated=True,
            )
            raise _at(kind, empty, None, "name")
        for other in _NAME_WORDS:
            if self.alias is None and "name" not in value and isinstance(value.get(other), str):
                wrong = problem(
                    "unknown-key",
                    f"'{other}' is not a key of '{kind}': which one it is stands under 'name'",
                    allowed=self.names(),
                    fix="rename it to 'name'",
                    rename="name",
                )
                raise _at(kind, wrong, other, other)
        name = self.name_of(value)
        if name is None:
            missing = problem("missing-key", "'name' is missing", allowed=self.names(), fix="add 'name: ...'")
            raise _at(kind, missing, value, "name")
        model = self.model_for(value)
        if model is None:
            at_alias = where and "name" not in value and self.alias is not None
            raise _at(kind, self._unknown(name, alone=not where), name, *((self.alias,) if at_alias else where))
        return model.model_validate(self._prepared(value, name))

    def _prepared(self, value: Mapping[str, Any], name: str) -> dict[str, Any]:
        return {**value, "name": name}

    def _name_alone(self, word: str) -> PydanticCustomError:
        """A word where a mapping belongs; an unknown one becomes the name most like it."""
        kind, names = self.registry.kind, self.names()
        known = word in names or self.name_of({"name": word}) in names
        near = word if known else nearest(word, names)
        message = f"'{kind}' is a mapping with a name, not the name alone"
        field = None if self.fallback is None else self.fallback.model_fields.get(word)
        if near is None and field is not None and field.default is False:
            fix = f"write {{name: <{kind}>, {word}: true}}: '{word}' is a key of every {kind}"
            return problem("not-a-mapping", message, allowed=names, fix=fix)
        if near is None and self.fallback is None:
            return problem("not-a-mapping", message, allowed=names, fix=f"write {{name: <{kind}>}}")
        meant = near or word
        sure = known or near is None or surely(word, meant)
        return problem(
            "not-a-mapping", message, fix=f"write {{name: {meant}}}", replace={"name": meant} if sure else None
        )

    def _unknown(self, name: Any, *, alone: bool) -> PydanticCustomError:
        """What to say of a name that nobody knows; ``alone``: it stands where its mapping might."""
        names, kind = self.names(), self.registry.kind
        near = nearest(name, names)
        message = f"'{name}' is not {'one of the kinematics' if kind == 'kinematics' else f'a {kind}'}"
        if name in self.exclude:
            message = f"'{name}' is a {kind}, but not one that can stand here"
        return problem(
            f"unknown-{kind}",
            message,
            allowed=names,
            fix=(f"write {near}" if alone else f"name: {near}") if near else None,
            replace=near,
        )

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(
            self.validate,
            serialization=core_schema.plain_serializer_function_ser_schema(
                lambda value: value.model_dump() if isinstance(value, BaseModel) else value
            ),
        )

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        options = [self._option_schema(name) for name in self._schema_names()]
        parts = SCHEMA_PARTS.get()
        user_code = parts is None or parts.user_code
        if user_code and self.custom is not None and self.fallback is not None and (names := self.custom.names()):
            option = self._model_schema(self.fallback)
            options.append({**option, "properties": {"name": {"enum": names}}, "required": ["name"]})
        if self.short is not None:
            name = self.short[0]
            options.append({"type": "string"} if name is not None else {"enum": self._schema_names()})
        if self.empty:
            options.append({"type": "object", "maxProperties": 0})
        if self.null:
            options.append({"type": "null"})
        return {"anyOf": options}

    def _schema_names(self) -> list[str]:
        names = []
        parts = SCHEMA_PARTS.get()
        registered = parts is None or parts.user_code
        for name in self.registry.names() if registered else self.registry.installed():
            feature = self.registry.get(name)
            if feature is None or name in self.exclude:
                continue
            if self.trait is None or getattr(feature.options, self.trait, False):
                names.append(name)
        return names

    def _model_schema(self, model: type[BaseModel]) -> JsonSchemaValue:
        return shared_schema(model.__name__, model.model_json_schema)

    def _option_schema(self, name: str) -> JsonSchemaValue:
        """The model of one name, with what makes a mapping be of that name."""
        feature = self.registry.get(name)
        assert feature is not None
        reference = self._model_schema(feature.options)
        fields = feature.options.model_fields
        required = [key for key, field in fields.items() if field.is_required() and key != "name"]
        is_default = name == self.default
        if get_origin(fields["name"].annotation) is not Literal:  # one model for several names
            reference = {**reference, "properties": {"name": {"const": name}}}
        if self.alias is None:
            return reference if is_default else {**reference, "required": [*required, "name"]}
        by_alias: JsonSchemaValue = {"properties": {self.alias: {"enum": [name, None] if is_default else [name]}}}
        if not is_default:
            by_alias["required"] = [self.alias]
        return {**reference, "if": {"required": ["name"]}, "else": by_alias}


def _at(kind: str, error: PydanticCustomError, given: Any, *location: str) -> ValidationError:
    return ValidationError.from_exception_data(kind, [InitErrorDetails(type=error, loc=location, input=given)])
