"""Perturbations: starts, speeds and start delays that differ from the scenario, drawn for each seed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any

from pydantic import AfterValidator, Field, GetJsonSchemaHandler, ValidationError
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from irsim.common.arguments import as_given
from irsim.common.text import clean, listed
from irsim.diagnostics.diagnostic import Diagnostic, nearest
from irsim.diagnostics.errors import InputError
from irsim.options.base import Options
from irsim.options.units import Meters, Number, Radians, Seconds
from irsim.scenario.messages.number_text import read_number
from irsim.scenario.messages.translate import option_problems
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario, Spreads
from irsim.scenario.yaml.document import load_text
from irsim.scenario.yaml.rewrite import yaml_flow

__all__ = ["Perturbation", "Perturbations", "perturbation_text", "perturbed", "perturbed_message", "read_perturbations"]

_ROLES = ("robot", "obstacle")
_MAX_NAMED = 3
"""Number of names that a message lists."""
_FIX = "give spreads such as position=0.1,heading=10deg,speed=10%,delay=2, and objects=NAME,… for some objects only"
_MAX_DELAY = 100_000
"""Longest delay of a start, in seconds."""
_DIGITS = 12
"""Significant digits of a spread, so that its text on a command line is exact."""


class _WithUnit:
    """Type metadata of a number that may also be text with a unit: ``10deg``, ``5 cm``, ``10%``."""

    def __init__(self, unit: str) -> None:
        self.unit = unit

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self._number, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {"anyOf": [handler(schema), {"type": "string"}]}

    def _number(self, value: Any) -> Any:
        if not isinstance(value, str):
            return value
        share = value.strip().endswith("%") and self.unit == "1"
        number = read_number(value.strip()[:-1] if share else value, self.unit).value
        if number is None:
            return value
        return number / 100 if share else number


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


class Perturbation(Options):
    """How far objects may differ from the scenario. Each seed draws uniformly within these spreads.

    Starts are drawn again while they overlap another object, leave the world, or lie behind something static. Objects
    that the scenario places at random keep that start. Spreads that are not given stay as they are.
    """

    position: Annotated[Meters, Field(ge=0), _WithUnit("m"), AfterValidator(_rounded)] | None = None
    """Largest change of the start, in x and in y, either way."""
    heading: Annotated[Radians, Field(ge=0, le=3.1416), _WithUnit("rad"), AfterValidator(_rounded)] | None = None
    """Largest change of the initial heading, either way."""
    speed: Annotated[Number, Field(ge=0, lt=1), _WithUnit("1"), AfterValidator(_rounded)] | None = None
    """Largest change of all speeds, either way, as a share: limits of forward and sideways speed, and the speeds in
    the options of behaviors."""
    delay: Annotated[Seconds, Field(ge=0, le=_MAX_DELAY), _WithUnit("s"), AfterValidator(_rounded)] | None = None
    """Longest time for which an object stands still at its start; the shortest is 0. The clock runs meanwhile."""
    objects: Annotated[list[str], Field(min_length=1)] | None = None
    """Names, tags and roles (`robot`, `obstacle`) of the objects; null is all. Objects that never move take part only
    if their name or tag is given."""


Perturbations = str | Mapping[str, Any] | Perturbation | Sequence[str | Mapping[str, Any] | Perturbation]
"""Input of :func:`read_perturbations`."""
_SPREADS = ("position", "heading", "speed", "delay")
_ALLOWED = {
    "position": "a number ≥ 0 [m]",
    "heading": "a number from 0 to 3.1416 [rad]",
    "speed": "a share from 0 to less than 1",
    "delay": f"a number from 0 to {_MAX_DELAY} [s]",
    "objects": "a list of names, tags or roles",
}
_PARTS = {
    "position": "start ±{:g} m in x and in y",
    "heading": "heading ±{:g} rad",
    "speed": "speeds ±{:g} %",
    "delay": "start delayed by 0 to {:g} s",
}


def read_perturbations(given: Perturbations | None) -> tuple[Perturbation, ...]:
    """Read perturbations; of two that give the same spread to an object, the later one counts.

    Args:
        given: None, one perturbation, or several: a :class:`Perturbation`, a mapping with its keys, or text as on the
            command line: ``position=0.1,heading=10deg; delay=2,objects=scout,people``, or a mapping in YAML.

    Raises:
        InputError: ``given`` is none of these; the message has everything that is wrong.
    """
    one = given is None or isinstance(given, (str, Mapping, Perturbation)) or not isinstance(given, Iterable)
    listed_items = [part for item in ([] if given is None else [given] if one else given) for part in _parts(item)]
    perturbations, problems = list[Perturbation](), list[str]()
    for number, item in enumerate(listed_items):
        made, wrong = _read_one(item)
        where = f"perturb[{number}]: " if len(listed_items) > 1 else ""
        problems += [where + text for text in wrong]
        if made is not None:
            perturbations.append(made)
    if problems:
        raise InputError("; ".join(problems), _FIX, "perturb")
    return tuple(perturbations)


def perturbation_text(perturbation: Perturbation) -> str:
    """A perturbation as on the command line: ``position=0.1,objects=scout,people``."""
    given = perturbation.model_dump(exclude_none=True)
    objects: list[str] = given.pop("objects", [])
    spreads = {key: f"{value:.{_DIGITS}g}" for key, value in given.items()}
    if any(not _is_plain(name) for name in objects):
        return (
            "{" + ", ".join(f"{key}: {value}" for key, value in spreads.items()) + f", objects: {yaml_flow(objects)}}}"
        )
    words = [f"{key}={value}" for key, value in spreads.items()]
    return ",".join([*words, *([f"objects={','.join(objects)}"] if objects else [])])


def perturbed(
    scenario: ResolvedScenario, perturbations: Sequence[Perturbation], *, called: str | None = None
) -> ResolvedScenario:
    """The scenario with spreads for its objects; each seed then draws another start of it.

    Args:
        scenario: The scenario, which is not changed.
        perturbations: From :func:`read_perturbations`.
        called: Name of the scenario in errors; default: its own.

    Raises:
        InputError: No object has a name, tag or role that is given, or there is nothing to perturb.
    """
    if not perturbations:
        return scenario
    name = clean(called or scenario.name)
    _check_names(scenario, perturbations, name)
    placed = {number for placement in scenario.placements for number in placement.objects}
    objects = [_with_spreads(record, perturbations, record.id in placed) for record in scenario.objects]
    wanted = any(getattr(item, key) for item in perturbations for key in _SPREADS)
    if wanted and all(record.spreads is None for record in objects):
        why = "the chosen objects have no drive, never move, or are placed at random"
        raise InputError(
            f"there is nothing to perturb in {name!r}: {why}", "choose other spreads or objects", "perturb"
        )
    return replace(scenario, objects=objects)


def perturbed_message(scenario: ResolvedScenario) -> list[str]:
    """The draws of a perturbed scenario, in words; empty if nothing is."""
    groups: dict[Spreads, list[str]] = {}
    for record in scenario.objects:
        if record.spreads is not None:
            groups.setdefault(record.spreads, []).append(record.name)
    sentences = []
    for spreads, names in groups.items():
        values = {key: getattr(spreads, key) * (100 if key == "speed" else 1) for key in _SPREADS}
        parts = [_PARTS[key].format(value) for key, value in values.items() if value]
        sentences.append(f"{', '.join(parts)} of {listed([repr(clean(name, 40)) for name in names], _MAX_NAMED)}")
    return sentences


def _parts(item: Any) -> list[Any]:
    """The perturbations in a text that may hold several; anything else as it is."""
    if not isinstance(item, str) or item.strip().startswith("{"):
        return [item]
    return [part.strip() for part in item.split(";")]


def _read_one(item: Any) -> tuple[Perturbation | None, list[str]]:
    """A perturbation, or what is wrong with it."""
    if isinstance(item, Perturbation):
        return item, []
    keys, problems = _read_text(item) if isinstance(item, str) else (item, [])
    if problems or not isinstance(keys, Mapping):
        return None, problems or [f"{as_given(item)} is not a perturbation"]
    if isinstance(keys.get("objects"), str):
        keys = {**keys, "objects": [keys["objects"]]}
    try:
        made = Perturbation.model_validate(dict(keys))
    except ValidationError as failure:
        return None, list(dict.fromkeys(_problem(item, keys) for item in option_problems(failure, keys, Perturbation)))
    if all(getattr(made, key) is None for key in _SPREADS):
        return None, [f"{as_given(item)} has no spread"]
    return made, []


def _read_text(text: str) -> tuple[dict[str, Any] | None, list[str]]:
    """The keys of ``key=value,…``, or of a mapping in YAML; words without ``=`` continue the list of objects."""
    if text.strip().startswith("{"):
        document = load_text(text)
        data = document.data
        return (None, [f"{as_given(text)} is not a mapping"]) if document.problems else (data, [])
    fields: dict[str, Any] = {}
    problems = []
    last = None
    for word in text.split(","):
        key, sign, value = (part.strip() for part in word.partition("="))
        if not sign and last == "objects" and key:
            fields["objects"].append(key)
        elif not sign or not key or not value:
            problems.append(f"{as_given(word.strip())} is not key=value")
        elif key in fields:
            problems.append(f"{key} is given twice")
        else:
            fields[key] = [value] if key == "objects" else value
            last = key
    return fields, problems


def _problem(item: Diagnostic, keys: Mapping[Any, Any]) -> str:
    key = str(item.path[0]) if item.path else ""
    if item.code == "unknown-key":
        near = nearest(key, _ALLOWED)
        return f"{as_given(key)} is not a key of perturb" + (f", did you mean {near}?" if near else "")
    value = keys.get(key)
    hint = ""
    if key == "heading" and isinstance(item.given, (int, float)) and 3.1416 < item.given <= 180:
        hint = f" ({item.given:g} degrees are {item.given:g}deg)"
    return f"{key} must be {_ALLOWED.get(key, 'something else')}, got {as_given(value)}{hint}"


def _is_plain(name: str) -> bool:
    """Whether a name can be a word of ``objects=…``."""
    return bool(name) and name == name.strip() and not any(mark in name for mark in ",;={") and name.isprintable()


def _check_names(scenario: ResolvedScenario, perturbations: Sequence[Perturbation], called: str) -> None:
    names = [record.name for record in scenario.objects if not record.is_terrain]
    tags = {tag for record in scenario.objects for tag in record.tags}
    known = [*names, *sorted(tags), *_ROLES]
    unknown = [word for item in perturbations for word in item.objects or () if word not in known]
    if not unknown:
        return
    near = nearest(unknown[0], known)
    words = listed([repr(clean(word, 40)) for word in unknown], _MAX_NAMED)
    raise InputError(
        f"no object of {called!r} has the name, tag or role {words}",
        f"did you mean {clean(near, 40)}?"
        if near
        else f"give one of {listed([clean(word, 40) for word in known], 10)}",
        "perturb",
    )


def _with_spreads(record: ObjectRecord, perturbations: Sequence[Perturbation], placed: bool) -> ObjectRecord:
    """The object with the spreads that it gets; spreads without effect on it are left out."""
    values: dict[str, float] = {}
    for item in perturbations:
        if _is_chosen(record, item):
            values |= item.model_dump(include=set(_SPREADS), exclude_none=True)
    if placed:
        values.pop("position", None)
        values.pop("heading", None)
    if record.static or record.kinematics is None:
        values.pop("speed", None)
        values.pop("delay", None)
    values = {key: min(value, math.pi) if key == "heading" else value for key, value in values.items()}
    return replace(record, spreads=Spreads(**values) if any(values.values()) else None)


def _is_chosen(record: ObjectRecord, item: Perturbation) -> bool:
    if record.is_terrain:
        return False
    words = item.objects
    if words is not None and (record.name in words or not set(record.tags).isdisjoint(words)):
        return True
    return not record.static and (words is None or record.role in words)
