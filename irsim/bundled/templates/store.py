"""The bundled templates: where they are, and the content of ``template.yaml``.

::

    title: Corridor passing
    purpose: Two robots meet head-on between two walls and each keeps to its right.
    tags: [corridor, hallway, head-on]
    outcomes: [success]                 # how a run with the default parameters may end
    parameters:
      width: {type: number, default: 1.6, min: 1.2, max: 3, unit: m, description: Free width between the walls.}
    sets:                               # path in scenario.yaml: expression over the parameters
      obstacle[0].state[1]: 2.5 + width / 2 + 0.15
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from irsim.common import data_files as resources
from irsim.common.arguments import is_number
from irsim.diagnostics.diagnostic import SLIP_SIMILARITY, nearest, suggestion
from irsim.diagnostics.errors import CodedError
from irsim.options.units import Value

__all__ = [
    "Outcome",
    "Parameter",
    "Template",
    "TemplateError",
    "find",
    "load",
    "load_all",
    "meant",
    "names",
    "picture_file",
    "scenario_file",
]

Outcome = Literal["success", "collision", "timeout"]


class TemplateError(CodedError, ValueError):
    """A template or one of its parameters cannot be used."""


class _Metadata(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Parameter(_Metadata):
    """One named parameter of a template."""

    type: Literal["number", "integer", "boolean", "choice"]
    default: Value
    description: str
    unit: str | None = None
    min: float | None = None
    max: float | None = None
    choices: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _consistent(self) -> Parameter:
        if (self.type == "choice") != bool(self.choices):
            raise ValueError("choices belong to parameters of type choice, and those need them")
        self.check("default", self.default)
        return self

    def allowed(self) -> str:
        """The accepted values, in words: ``a number from 0.5 to 3 m``."""
        if self.type == "choice":
            return ", ".join(self.choices)
        if self.type == "boolean":
            return "true, false"
        unit = f" {self.unit}" if self.unit and self.unit != "1" else ""
        kind = "an integer" if self.type == "integer" else "a number"
        if self.min is not None and self.max is not None:
            return f"{kind} from {self.min:g} to {self.max:g}{unit}"
        if self.min is not None:
            return f"{kind}, at least {self.min:g}{unit}"
        if self.max is not None:
            return f"{kind}, at most {self.max:g}{unit}"
        return kind + unit

    def check(self, name: str, value: object) -> Value:
        """The value in the parameter's own type; text is read as YAML would read it.

        Raises:
            TemplateError: The value has another type or is out of range.
        """
        converted = self._convert(value)
        if converted is None:
            raise TemplateError("bad-parameter", f"{name} cannot be {value!r}.", f"give {self.allowed()}.")
        if is_number(converted):
            low, high = -math.inf if self.min is None else self.min, math.inf if self.max is None else self.max
            if not low <= converted <= high:
                raise TemplateError(
                    "bad-parameter", f"{name} = {converted:g} is out of range.", f"give {self.allowed()}."
                )
        return converted

    def _convert(self, value: object) -> Value | None:
        if self.type == "choice":
            return str(value) if str(value) in self.choices else None
        if self.type == "boolean":
            words = {"true": True, "yes": True, "on": True, "false": False, "no": False, "off": False}
            return value if isinstance(value, bool) else words.get(str(value).lower())
        if isinstance(value, bool):
            return None
        try:
            number = float(str(value))
        except ValueError:
            return None
        if not math.isfinite(number):
            return None
        whole = int(number)
        if self.type == "integer":
            return whole if whole == number else None
        return number


class Template(_Metadata):
    """A template and its default text."""

    name: str
    title: str
    purpose: str
    tags: tuple[str, ...]
    outcomes: Annotated[tuple[Outcome, ...], Field(min_length=1)]
    parameters: dict[str, Parameter] = {}
    sets: dict[str, str] = {}
    text: str = Field(repr=False)

    def prospect(self, given: Mapping[str, Any] | None = None) -> str:
        """Say how a run with some parameters ends, as far as it is known: for the default parameters.

        Raises:
            TemplateError: A name is unknown or a value is not allowed.
        """
        values = self.values(dict(given or {}))
        changed = [
            f"{name}={value:g}" if isinstance(value, float) else f"{name}={value}"
            for name, value in values.items()
            if value != self.parameters[name].default
        ]
        tried = f"With the default parameters it ends in {' or '.join(self.outcomes)}"
        return f"{tried}; with {', '.join(changed)} it may end otherwise: run it." if changed else f"{tried}."

    def values(self, given: dict[str, Any]) -> dict[str, Value]:
        """All parameters: the given ones checked, the others at their defaults.

        Raises:
            TemplateError: A name is unknown or a value is not allowed.
        """
        for name in given:
            if name not in self.parameters:
                known = ", ".join(self.parameters) or "none"
                raise TemplateError(
                    "unknown-parameter",
                    f"{self.name} has no parameter {name!r}; it has {known}.",
                    suggestion(name, self.parameters, None),
                    allowed=list(self.parameters),
                )
        return {
            name: parameter.check(name, given.get(name, parameter.default))
            for name, parameter in self.parameters.items()
        }


def names() -> list[str]:
    """Names of all templates, sorted."""
    return sorted(path.parent.name for path in resources.templates_directory().glob("*/template.yaml"))


def meant(path: str) -> str | None:
    """Name of the template that the path of a missing file means: ``doorway``, ``doorway.yaml``, ``templates/dorway``.

    Args:
        path: The path as the user wrote it.
    """
    parts = PurePosixPath(path.replace("\\", "/")).parts
    if len(parts) > 1 and parts[-1] == "scenario.yaml":
        parts = parts[:-1]
    name = parts[-1].removesuffix(".yaml").removesuffix(".yml").lower() if parts else ""
    return nearest(name, names(), SLIP_SIMILARITY)


def load(name: str) -> Template:
    """One template.

    Raises:
        TemplateError: No template has that name.
    """
    known = names()
    if name not in known:
        message, near = f"there is no template {name!r}", suggestion(name, known, None)
        fix = None if near is None else f"{near} irsim templates lists all {len(known)}"
        every = f"; choose one of {', '.join(known)}." if near is None else ""
        raise TemplateError("unknown-template", f"{message}{every}", fix, allowed=known)
    return _read(name)


def _read(name: str) -> Template:
    file = scenario_file(name)
    described = resources.read_yaml(file.with_name("template.yaml").read_text(encoding="utf-8"))
    text = file.read_text(encoding="utf-8")
    return Template.model_validate({"name": name, "text": text, **described})


def load_all() -> list[Template]:
    """All templates, by name."""
    return [_read(name) for name in names()]


def find(words: Iterable[str], *, every: bool = False) -> list[Template]:
    """The templates whose name, title, purpose and tags contain the most of some words.

    Args:
        words: Words to look for; without words all templates are found.
        every: Find only templates that contain every word.
    """
    wanted = [word.lower() for phrase in words for word in phrase.split()]
    templates = load_all()
    if not wanted:
        return templates
    scores = {}
    for template in templates:
        text = " ".join((template.name, template.title, template.purpose, *template.tags)).lower()
        scores[template.name] = sum(word in text for word in wanted)
    best = len(wanted) if every else max(scores.values(), default=0)
    return [template for template in templates if best and scores[template.name] == best]


def scenario_file(name: str) -> Path:
    """Path of a template's scenario."""
    return resources.templates_directory() / name / "scenario.yaml"


def picture_file(name: str) -> Path:
    """Path of the picture of a template's start."""
    return resources.templates_directory() / name / "picture.png"
