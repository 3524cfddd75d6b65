"""Mappings whose ``name`` selects their model: ``kinematics: {name: diff, ...}`` becomes the options of ``diff``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_origin

from pydantic import BaseModel, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from irsim.common.lazy import call_home
from irsim.diagnostics.diagnostic import is_slip_of, nearest
from irsim.options.base import SCHEMA_PARTS, open_options, problem, problems_at, shared_schema
from irsim.options.registry import CustomBehaviors, Registry

__all__ = ["Choices", "Select", "component_meant", "page_about"]

_NAME_WORDS = ("type", "kind")
"""Common wrong names of the key ``name``."""


@dataclass(frozen=True)
class Choice:
    """One of a fixed set of models."""

    name: str
    options: type[BaseModel]


class Choices:
    """A fixed set of models with the interface of a registry, for keys that accept only these.

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
        """All names, sorted: nothing can be registered here."""
        return self.names()

    def get(self, name: str) -> Choice | None:
        """The choice of that name."""
        return Choice(name, self.models[name]) if name in self.models else None


def component_meant(word: Any, names: Sequence[str]) -> str | None:
    """The component that has an everyday name, such as ``diff`` for ``unicycle``; None without one."""
    meant: str | None = call_home("irsim.lookup.meant:component_meant", str(word), names)
    return meant


def page_about(word: Any) -> str | None:
    """Where to read what takes the place of a thing that the language lacks, such as a camera; None if nowhere."""
    page: str | None = call_home("irsim.lookup.meant:page_about", str(word))
    return None if page is None else f"see: irsim describe {page}"


class Select:
    """Type metadata: a mapping validated by the options model that a registry has under its ``name``.

    Args:
        registry: Registry of the names; a feature is imported when a scenario names it.
        default: Name if a mapping gives none; None if the name is required.
        folded: Whether names are compared in lower case.
        alias: Another key that may hold the name.
        custom: Names registered by user code. Their mappings become ``fallback``; if the name is built in as well, they
            become its model with any additional key.
        fallback: Model of custom and unknown names; without it unknown names are errors.
        accepts: Class attribute that is false for the models of the registry that are refused here; None: no model is.
        null: Whether null is accepted; it stays None.
        empty: Whether an empty mapping is accepted; it becomes None.
        short: Meaning of a text instead of a mapping: (name, key) makes ``{name: name, key: text}``; if the name is
            None, ``{key: text}``.
        trait: Class attribute that is true for the models that the schema offers; the checks report others.
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
        accepts: str | None = None,
        null: bool = False,
        empty: bool = False,
        short: tuple[str | None, str] | None = None,
        trait: str | None = None,
    ) -> None:
        self.registry, self.default, self.folded, self.alias = registry, default, folded, alias
        self.custom, self.fallback, self.accepts = custom, fallback, accepts
        self.null, self.empty, self.short, self.trait = null, empty, short, trait

    def names(self) -> list[str]:
        """Every name accepted here, with names of user code."""
        custom = self.custom.names() if self.custom is not None else []
        return sorted({*filter(self._is_accepted, self.registry.names()), *custom})

    def _is_accepted(self, name: Any) -> bool:
        if self.accepts is None or not isinstance(name, str) or (feature := self.registry.get(name)) is None:
            return True
        return bool(getattr(feature.options, self.accepts, True))

    def name_of(self, value: Mapping[str, Any]) -> Any:
        """The name that selects the model of a mapping."""
        name = value.get("name")
        if name is None and self.alias is not None:
            name = value.get(self.alias)
        if name is None:
            name = self.default
        if self.folded and isinstance(name, str) and self.registry.get(name) is None:
            return name.lower()
        return name

    def model_for(self, value: Mapping[str, Any]) -> type[BaseModel] | None:
        """The model that validates ``value``; None if its name is unknown."""
        name = self.name_of(value)
        if not isinstance(name, str) or not self._is_accepted(name):
            return None
        feature = self.registry.get(name)
        if feature is not None and self.custom is not None and name in self.custom.names():
            return open_options(feature.options)
        return feature.options if feature is not None else self.fallback

    def validate(self, value: Any) -> BaseModel | None:
        """The options model for ``value``; None for null or ``{}`` if these are accepted.

        Raises:
            PydanticCustomError: ``value`` is not a mapping.
            ValidationError: The name is missing or unknown, or a key is wrong.
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
            message = f"'{kind}' must be a mapping with a name"
            raise problem("not-a-mapping", message, allowed=f"{{name: <{kind}>, ...}}")
        if self.default is not None and "name" in value and value["name"] is None:
            empty = problem(
                "wrong-type",
                "null is not a name",
                allowed=self.names(),
                fix=f"name: {self.default}, or no name at all",
                replace=self.default,
                tolerated=True,
            )
            raise problems_at(kind, [(("name",), empty)])
        for other in _NAME_WORDS:
            if self.alias is None and "name" not in value and isinstance(value.get(other), str):
                wrong = problem(
                    "unknown-key",
                    f"'{other}' is not a key of '{kind}': its kind is given under 'name'",
                    allowed=self.names(),
                    fix="rename it to 'name'",
                    rename="name",
                )
                raise problems_at(kind, [((other,), wrong)], other)
        name = self.name_of(value)
        if name is None:
            missing = problem("missing-key", "'name' is missing", allowed=self.names(), fix="add 'name: ...'")
            raise problems_at(kind, [(("name",), missing)], value)
        model = self.model_for(value)
        if model is None:
            place = (self.alias,) if where and "name" not in value and self.alias is not None else where
            raise problems_at(kind, [(place, self._unknown(name, alone=not where))], name)
        return model.model_validate(self._prepared(value, name))

    def _prepared(self, value: Mapping[str, Any], name: str) -> dict[str, Any]:
        return {**value, "name": name}

    def _name_alone(self, word: str) -> PydanticCustomError:
        """The error for a word instead of a mapping; its fix uses the most similar name."""
        kind, names = self.registry.kind, self.names()
        known = word in names or self.name_of({"name": word}) in names
        near = word if known else component_meant(word, names) or nearest(word, names)
        message = f"'{kind}' must be a mapping with a name, not the name alone"
        field = None if self.fallback is None else self.fallback.model_fields.get(word)
        if near is None and field is not None and field.default is False:
            fix = f"write {{name: <{kind}>, {word}: true}}: '{word}' is a key of every {kind}"
            return problem("not-a-mapping", message, allowed=names, fix=fix)
        if near is None and self.fallback is None:
            return problem("not-a-mapping", message, allowed=names, fix=page_about(word) or f"write {{name: <{kind}>}}")
        meant = near or word
        sure = known or near is None or is_slip_of(word, meant)
        return problem(
            "not-a-mapping", message, fix=f"write {{name: {meant}}}", replace={"name": meant} if sure else None
        )

    def _unknown(self, name: Any, *, alone: bool) -> PydanticCustomError:
        """The error for an unknown name; ``alone`` if the name is given instead of a mapping."""
        names, kind = self.names(), self.registry.kind
        near = component_meant(name, names) or nearest(name, names)
        page = None if near else page_about(name)
        message = f"'{name}' is not {'one of the kinematics' if kind == 'kinematics' else f'a {kind}'}"
        if not self._is_accepted(name):
            message = f"'{name}' is a {kind}, but it cannot be used here"
        return problem(
            f"unknown-{kind}",
            message,
            allowed=names,
            fix=(f"write {near}" if alone else f"name: {near}") if near else page,
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
            if feature is None or not self._is_accepted(name):
                continue
            if self.trait is None or getattr(feature.options, self.trait, False):
                names.append(name)
        return names

    def _model_schema(self, model: type[BaseModel]) -> JsonSchemaValue:
        return shared_schema(model.__name__, model.model_json_schema)

    def _option_schema(self, name: str) -> JsonSchemaValue:
        """The schema of one model, with the condition that a mapping has its name."""
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
