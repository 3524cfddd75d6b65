"""Turns one pydantic error into a finding in the words of the scenario language."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

from irsim.diagnostics.codes import CODES
from irsim.diagnostics.diagnostic import Edit, Path, format_path, is_slip_of, nearest
from irsim.options.units import MAX_TOLD
from irsim.options.vectors import is_vector
from irsim.scenario.messages.advice import advice_on_key, split_poses, split_waypoints, vector_of
from irsim.scenario.messages.findings import Finding, error, key_path
from irsim.scenario.messages.leniency import carry_on_group, carry_on_type, carry_on_unknown_key, carry_on_value
from irsim.scenario.messages.number_text import decimal_commas, read_number
from irsim.scenario.model.lookup import at, field_at, lengths_of, literals, model_at, unit_of
from irsim.scenario.model.scenario import Scenario
from irsim.scenario.yaml.document import Document
from irsim.scenario.yaml.formatting import flow, number, quote_value

__all__ = ["Explainer"]

_EXPECTED = {
    "float_type": "a number",
    "float_parsing": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "int_parsing": "a whole number",
    "int_parsing_size": "a smaller number",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "string_type": "text",
    "list_type": "a list",
    "tuple_type": "a list",
    "dict_type": "a mapping (key: value)",
    "model_type": "a mapping (key: value)",
    "model_attributes_type": "a mapping (key: value)",
    "mapping_type": "a mapping (key: value)",
}
_NUMBERS = ("float_type", "float_parsing", "int_type", "int_from_float", "int_parsing")
_BOOLEANS = {"1": True, "0": False, "yes": True, "no": False, "true": True, "false": False, "on": True, "off": False}
_CONTROLS = ("entry.vel_min", "entry.vel_max", "entry.acce", "entry.velocity")
_MAX_WHOLE = 1e9
"""Largest float that is suggested as a whole number."""
_BOUNDS = {
    "greater_than": ("gt", ">"),
    "greater_than_equal": ("ge", "≥"),
    "less_than": ("lt", "<"),
    "less_than_equal": ("le", "≤"),
}


def _bounds_of(part: Any) -> dict[str, Any]:
    """The bounds in a piece of field metadata."""
    return {name: getattr(part, name, None) for name, _ in _BOUNDS.values()}


class Explainer:
    """Turns one error into a finding.

    Args:
        path: Path of the error in the data.
        item: The error as pydantic lists it.
        data: The data that were validated.
        document: The document of the data, to look up how values were written.
        root: Model of the whole document.
    """

    def __init__(self, path: Path, item: Any, data: Any, document: Document, root: type[BaseModel] = Scenario) -> None:
        self.path, self.data, self.document, self.root = path, data, document, root
        self.kind: str = item["type"]
        self.value = item.get("input")
        self.context: dict[str, Any] = item.get("ctx") or {}
        self.message: str = item["msg"]
        self.field = field_at(root, path, data)

    def finding(self) -> Finding:
        """The finding for this error."""
        if self.kind in CODES:
            return self._own()
        if self.kind in ("extra_forbidden", "invalid_key"):
            return self._unknown_key()
        if self.kind == "missing":
            key = self.path[-1]
            return error("missing-key", self.path, f"'{key}' is missing", fix=f"add '{key}: ...' here")
        if self.kind == "literal_error":
            return self._choice()
        if self.kind in _BOUNDS:
            return self._bound()
        if self.kind == "finite_number":
            return self._not_finite()
        if self.kind in ("too_short", "too_long"):
            return self._length()
        if self.kind in _EXPECTED:
            return self._type()
        if self.kind == "string_pattern_mismatch":
            return self._pattern()
        message = self.message.removeprefix("Value error, ")
        allowed, fix = self.context.get("allowed"), self.context.get("fix")
        return self._error("invalid-value", message, allowed=allowed, fix=fix)

    def _own(self) -> Finding:
        """An error of the language's own validators, which bring message, allowed values and fix."""
        context = self.context
        meant = context.get("replace")
        sure = not isinstance(meant, str) or is_slip_of(self.value, meant)
        edit = Edit("replace", self.path, meant, safe=sure) if meant is not None else None
        carry_on = edit if context.get("tolerated") else self._carry_on()
        if "tolerated_as" in context:
            carry_on = Edit("replace", self.path, context["tolerated_as"])
        if "rename" in context:
            edit = Edit("rename", self.path, context["rename"])
            carry_on = carry_on_group((*self.path[:-1], context["rename"]), self.data)
        return error(
            self.kind,
            self.path,
            context["message"],
            given=self.value if not isinstance(self.value, Mapping) else None,
            allowed=context.get("allowed"),
            fix=context.get("fix"),
            edit=edit,
            carry_on=carry_on,
        )

    def _unknown_key(self) -> Finding:
        key, parent = self.path[-1], self.path[:-1]
        if self.kind == "invalid_key":  # a number or a YAML 1.1 boolean, which the location holds as text
            raw = next((k for k in at(self.data, parent) or () if not isinstance(k, str) and k == key), key)
            key = str(raw)
            self.path = (*parent, key)
        model = model_at(self.root, parent, self.data)
        allowed = [field.alias or name for name, field in model.model_fields.items()] if model is not None else []
        meant = getattr(model, "also_called", {}).get(str(key).lower())
        near = meant or nearest(key, allowed)
        title = self.root.model_config.get("title") or self.root.__name__
        where = f"'{format_path(parent)}'" if parent else f"a {title.lower()}"
        written = at(self.data, parent)
        other, like = (None, None) if meant else advice_on_key(self.path, self.data, allowed)
        edit, fix = None, other
        if (meant_number := self._after_comma(key, written)) is not None:
            fix = f"a decimal comma? write {meant_number}"
        elif like is not None:
            edit = Edit("rename", self.path, like, safe=False)
        elif other is None and near is not None and isinstance(written, Mapping) and near in written:
            fix = f"the key is called '{near}', which is given here too: keep one of them"
        elif other is None and near is not None:
            fix, edit = (
                f"rename it to '{near}'",
                Edit("rename", self.path, near, safe=bool(meant) or is_slip_of(key, near)),
            )
        elif other is None and not parent and is_shared(written, str(key)):
            fix = f"put it below 'custom', which irsim does not read: custom: {{{key}: &NAME ...}}"
        elif other is None:
            fix, edit = "remove it", Edit("remove", self.path, safe=False)
        return error(
            "unknown-key",
            self.path,
            f"'{key}' is not a key of {where}",
            given=key,
            allowed=sorted(allowed),
            fix=fix,
            edit=edit,
            carry_on=carry_on_unknown_key(self.path, written),
        )

    def _after_comma(self, key: Any, written: Any) -> str | None:
        """The fix for ``{radius: 0,3}``, which YAML reads as ``{radius: 0, 3: null}``."""
        keys = list(written) if isinstance(written, Mapping) else []
        position = next((i for i, other in enumerate(keys) if str(other) == key), 0)
        if not str(key).isdigit() or position == 0 or written[keys[position]] is not None:
            return None
        before = written[keys[position - 1]]
        return (
            f"{keys[position - 1]}: {before}.{key}"
            if isinstance(before, int) and not isinstance(before, bool)
            else None
        )

    def _choice(self) -> Finding:
        allowed = literals(self.field) if self.field is not None else []
        near = nearest(self.value, allowed)
        return self._error(
            "unknown-value",
            f"{quote_value(self.value)} is not a valid value of '{self._key()}'",
            allowed=allowed,
            fix=f"{self._key()}: {near}" if near else None,
            edit=Edit("replace", self.path, near, safe=is_slip_of(self.value, near)) if near else None,
            carry_on=carry_on_value("unknown-value", self.path, self.value),
        )

    def _pattern(self) -> Finding:
        """A text that has other letters than it may have; the fix has an example, or else the default."""
        key, pattern = self._key(), self.context.get("pattern")
        examples = [*(getattr(self.field, "examples", None) or ()), getattr(self.field, "default", None)]
        example = next((one for one in examples if isinstance(one, str) and re.search(str(pattern), one)), None)
        return self._error(
            "invalid-value",
            f"{quote_value(self.value)} is not a valid value of '{key}'",
            allowed=f"what matches {pattern}",
            fix=None if example is None else f"something like '{key}: {example}'",
        )

    def _bound(self) -> Finding:
        sources = [_bounds_of(part) for part in (self.field.metadata if self.field else ())]
        limits = {}
        for name, sign in _BOUNDS.values():
            inner = max if name in ("gt", "ge") else min
            given = [source[name] for source in sources if source[name] is not None]
            limit = self.context.get(name, inner(given) if given else None)
            if limit is not None and (name in self.context or abs(limit) <= MAX_TOLD):
                limits[name] = f"{sign} {number(limit)}"
        allowed = " and ".join(limits.values()) + self._unit()
        return self._error(
            "out-of-range",
            f"{self._subject()} must be {allowed}, got {quote_value(self.value)}",
            allowed=allowed,
            carry_on=self._carry_on(),
        )

    def _not_finite(self) -> Finding:
        if isinstance(self.value, float) and math.isnan(self.value):
            return error("not-a-number", self.path, "NaN is not a number", allowed="a number" + self._unit())
        return self._error(
            "infinite-number", f"'{self._key()}' must be finite", allowed="a finite number" + self._unit()
        )

    def _length(self) -> Finding:
        least, most = lengths_of(self.field, self.context.get("min_length"), self.context.get("max_length"))
        count = len(self.value) if isinstance(self.value, (list, tuple)) else 0
        numbers = count > 0 and all(isinstance(v, (int, float)) for v in self.value)
        wanted = f"at least {least}" if most is None else f"{most}" if least == most else f"{least or 0} to {most}"
        if not numbers:
            elements = f"{wanted} element{'s' if wanted[-2:] not in ('1', ' 1') else ''}"
            message = f"{self._subject()} must have {elements}, got {count}"
            return error("wrong-length", self.path, message, allowed=elements)
        fix, edit = self._shorter(most)
        return self._error(
            "wrong-length",
            f"{self._subject()} must have {wanted} number{'s' if wanted != '1' else ''}, got {count}",
            allowed=f"{wanted} numbers",
            fix=fix,
            edit=edit,
            carry_on=carry_on_value(self.kind, self.path, self.value, most),
        )

    def _shorter(self, most: int | None) -> tuple[str | None, Edit | None]:
        """Fix and edit for a vector that is too long."""
        value, several = self.value, key_path(self.path) == "entry.waypoints"
        if most is None or not isinstance(value, (list, tuple)) or len(value) <= most:
            return None, None
        text = self.document.source_text((*self.document.prefix, *self.path))
        meant = decimal_commas(value, most, text, apart=several)
        if meant is not None:
            return f"decimal commas? write {meant}", None
        if not several:
            return None, None
        poses = split_waypoints(self.path, self.data)
        if poses is None:
            return "write each waypoint as [x, y] or [x, y, theta]", None
        edit = Edit("replace", self.path[:-1], poses.value, safe=poses.sure)
        own = split_poses(value)
        return f"write one list per waypoint: {quote_value(own.value if own else None)[1:-1]}", edit

    def _type(self) -> Finding:
        expected = _EXPECTED[self.kind]
        if self.kind == "float_type" and isinstance(self.value, int) and not isinstance(self.value, bool):
            return error("out-of-range", self.path, "this number is too large", allowed="a number" + self._unit())
        if self.kind in _NUMBERS and isinstance(self.value, str):
            return self._number_as_text(expected)
        if self.kind in _NUMBERS and isinstance(self.value, (list, tuple)):
            return self._list_for_number(expected)
        if self.kind == "string_type" and isinstance(self.value, bool):
            return self._boolean_as_text()
        if self.kind == "bool_type" and isinstance(self.value, (list, tuple)):
            return self._list_for_boolean()
        fix, edit = self._repair(expected)
        return self._error(
            "wrong-type",
            f"{quote_value(self.value)} is not {expected}",
            allowed=expected + (self._unit() if self.kind in _NUMBERS else ""),
            fix=fix,
            edit=edit,
            carry_on=carry_on_group(self.path, self.data) or carry_on_type(self.kind, self.path, self.value),
        )

    def _repair(self, expected: str) -> tuple[str | None, Edit | None]:
        value, path = self.value, self.path
        if expected == "text" and isinstance(value, (int, float)):
            return f"quote it: '{value}'", Edit("replace", path, str(value))
        if expected == "a whole number" and isinstance(value, float) and value.is_integer() and abs(value) < _MAX_WHOLE:
            return f"{self._key()}: {int(value)}", Edit("replace", path, int(value))
        if expected == "a list" and (vector := vector_of(value)) is not None:
            return f"write {flow(vector)}", Edit("replace", path, vector)
        if expected == "a list" and isinstance(value, Mapping) and value and is_vector(list(value.values())):
            return f"write the numbers alone, in a list: {flow(list(value.values()))}", None
        points = at(self.data, path[:-1])
        if expected == "a list" and key_path(path) == "entry.waypoints" and is_vector(points):
            poses = split_poses(points)
            if poses is None:
                return "write one list per waypoint: waypoints: [[x, y], [x, y]]", None
            edit = Edit("replace", path[:-1], poses.value, safe=poses.sure)
            return f"write one list per waypoint: waypoints: {quote_value(poses.value, 200)}", edit
        if expected == "a list" and isinstance(value, Mapping):
            return "put it into a list: [{...}], or start it with '- '", Edit("replace", path, [value])
        if value is None:
            return "give a value or remove the key", Edit("remove", path, safe=False)
        if expected == "true or false" and str(value).strip().lower() in _BOOLEANS:
            meant = _BOOLEANS[str(value).strip().lower()]
            return f"write {str(meant).lower()}", Edit("replace", path, meant)
        if expected == "a list" and isinstance(value, (int, float)) and key_path(path) in _CONTROLS:
            return f"write one number per control component: [{value}, {value}]", None
        return None, None

    def _number_as_text(self, expected: str) -> Finding:
        parsed = read_number(self.value, unit_of(self.field) if self.field is not None else None)
        written = self.document.source_text((*self.document.prefix, *self.path))
        plain_float = parsed.is_number and written is not None and written[:1] not in "'\""
        code = "yaml-number-text" if plain_float else "wrong-type"
        why = "text, by the rules of YAML 1.1" if plain_float else f"text, not {expected}"
        value: float | int | None = parsed.value
        if expected == "a whole number" and value is not None:
            value = int(value) if float(value).is_integer() and abs(value) < _MAX_WHOLE else None
        # a plain 1e+308 would be text again
        text = repr(value) if value is None or "e" not in repr(value) else number(value)
        fix = None if value is None else f"write {text}{parsed.note}"
        return self._error(
            code,
            f"{str(self.value)[:60] if plain_float else quote_value(self.value)} is {why}",
            allowed=expected + self._unit(),
            fix=fix or parsed.note or None,
            edit=Edit("replace", self.path, value) if value is not None else None,
        )

    def _list_for_number(self, expected: str) -> Finding:
        if key_path(self.path) in ("entry.state", "entry.goal", "entry.waypoints"):
            message, fix = "the brackets are nested too deeply here", "write one vector as [x, y, theta]"
        else:
            message = f"'{self._key()}' must be {expected} for all objects of the entry, got a list"
            fix = "write one entry per value, each with its own 'number'"
        return self._error("scalar-list", message, allowed=expected + self._unit(), fix=fix)

    def _list_for_boolean(self) -> Finding:
        return self._error(
            "scalar-list",
            f"'{self._key()}' must be true or false for all objects of the entry; a list counts as true",
            allowed="true or false",
            fix="write one entry per value, each with its own 'number'",
            carry_on=carry_on_type(self.kind, self.path, self.value),
        )

    def _boolean_as_text(self) -> Finding:
        written = self.document.source_text((*self.document.prefix, *self.path)) or str(self.value).lower()
        return self._error(
            "yaml-boolean",
            f"YAML 1.1 reads {written} as {str(self.value).lower()}, not as text",
            allowed="text",
            fix=f"quote it: '{written}'",
            edit=Edit("replace", self.path, written),
            carry_on=carry_on_type(self.kind, self.path, written),
        )

    def _error(self, code: str, message: str, **details: Any) -> Finding:
        """An error about the value."""
        return error(code, self.path, message, given=self.value, **details)

    def _carry_on(self) -> Edit | None:
        return carry_on_group(self.path, self.data) or carry_on_value(self.kind, self.path, self.value)

    def _key(self) -> str:
        return next((part for part in reversed(self.path) if isinstance(part, str)), "value")

    def _subject(self) -> str:
        """The value at fault, as the beginning of a message."""
        key = f"'{self._key()}'"
        return f"each element of {key}" if self.path and isinstance(self.path[-1], int) else key

    def _unit(self) -> str:
        unit = unit_of(self.field) if self.field is not None else None
        return f" [{unit}]" if unit else ""


def is_shared(document: Any, key: str) -> bool:
    """Whether other parts of a document take over the value of a key, by an alias or by a merge of its mapping."""
    value = document.get(key) if isinstance(document, Mapping) else None
    if not isinstance(value, (Mapping, list)) or not value:
        return False
    waiting = [part for name, part in document.items() if name != key]
    while waiting:
        part = waiting.pop()
        if isinstance(part, Mapping):
            if isinstance(value, Mapping) and all(name in part and part[name] is one for name, one in value.items()):
                return True
            waiting += part.values()
        elif isinstance(part, list):
            waiting += part
    return False
