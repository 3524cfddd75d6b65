"""Makes the reference pages of the skills about programs, benchmarks and contributing from the docstrings."""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from irsim.bridges.export.registry import format_names
from irsim.common import data_files as resources
from irsim.common.field_docs import field_docs
from irsim.common.lazy import PUBLIC_HOMES
from irsim.compat.objects.view import ScriptObject
from irsim.env import Env
from irsim.env.batch import Batch
from irsim.lookup.answer import plain_table
from irsim.lookup.pages import components
from irsim.lookup.protocols import protocol_pages
from irsim.metrics.definitions import EPISODE_METRICS, METRICS
from irsim.objects.behavior import ObjectBehavior
from irsim.objects.body import Body
from irsim.objects.drawing.drawing import Drawing
from irsim.objects.surroundings import Surroundings
from irsim.objects.view import ObjectView
from irsim.options.registry import REGISTRIES
from irsim.results import benchmark

__all__ = ["PACKS", "make_page"]

Pages = dict[str, str]
NOTE = "<!-- Written by `python -m irsim.lookup.reference`: do not edit. -->"
_FOLDERS = {
    "behavior": "behaviors",
    "bridge": "bridges",
    "distribution": "distributions",
    "kinematics": "kinematics",
    "map": "maps",
    "planner": "planners",
    "sensor": "sensors",
    "shape": "shapes",
}


def make_page(title: str, *parts: str) -> str:
    """Return a page with a title, the note that it is generated, and its parts."""
    return "\n\n".join((f"# {title}", NOTE, *(part.strip() for part in parts if part))) + "\n"


def runner() -> Pages:
    """Return the pages of the skill ``irsim-runner``."""
    parts = {"body": Body, "drawing": Drawing, "behavior": ObjectBehavior, "surroundings": Surroundings}

    functions = (
        *("make", "run", "render", "validate", "benchmark", "batch", "export_run", "diff_runs", "connect"),
        *("register_behavior", "irsim.lib.register_behavior_class"),
        *("irsim.lib.register_group_behavior", "irsim.lib.register_group_behavior_class"),
    )
    return {
        "functions": make_page(
            "Functions",
            "The functions that a program calls first.",
            *(_function(*_find(name)) for name in functions),
            _options(Env),
        ),
        "environment": make_page(
            "The environment", "`irsim.make` returns it. `x ->` marks a property.", _members(Env), _attributes(Env)
        ),
        "objects": make_page(
            "Objects",
            "`env.robot`, `env.robot_list`, `env.get_object_by_name(…)` and the arguments of your behaviors are such "
            "objects. Arrays are columns, (n, 1), unless stated otherwise, and read-only: use `set_…` to change an "
            "object.",
            _members(ObjectView),
            *(f"## `x.{name}`\n\n{_one_line(part.__doc__)}\n\n{_members(part)}" for name, part in parts.items()),
            "## Names of IR-SIM 2.12",
            _members(ScriptObject, but=ObjectView),
        ),
        "exports": make_page(
            "Formats of recorded runs",
            "Files that `irsim export` and `irsim.export_run` write.",
            *map(_format, format_names()),
        ),
        "bridges": make_page(
            "Bridges",
            "`bridges: [{name: …}, …]` in a scenario, or `irsim run SCENARIO --bridge NAME`. `irsim bridge doctor` "
            "says which of them work on this machine.",
            components("bridge"),
        ),
        "batch": make_page("Batches", "`irsim.batch` returns a batch of worlds.", _attributes(Batch), _members(Batch)),
    }


def comparisons() -> Pages:
    """Return the pages of the skill ``irsim-benchmark``."""
    canonical = [metric for metric in METRICS if metric.canonical]
    extra = [metric for metric in METRICS if not metric.canonical]
    heads = ("key", "unit", "meaning, per robot", "over robots", "better")

    def table(metrics: list[Any]) -> str:
        return plain_table(heads, [(f"`{m.key}`", m.unit, m.text, m.robots, m.better or "") for m in metrics])

    protocols = {f"protocol_{name}": make_page(f"Protocol of {name}", text) for name, text in protocol_pages().items()}
    return protocols | {
        "metrics": make_page(
            "Metrics",
            "Each robot has a value. The column `over robots` says how the values of the robots are combined to the "
            "value of an episode: `mean`, `min`, `max`, or `all` (1 if all have 1). A benchmark gives mean, spread and "
            "a 95 % interval over episodes. An episode in which a value has no meaning (time to goal if no robot "
            "arrived, distance to humans without humans) is left out, and `n` is the number of episodes that count.",
            "## Canonical",
            table(canonical),
            "## Widely used extras",
            table(extra),
            "## Metrics of whole episodes",
            table(list(EPISODE_METRICS)),
        ),
        "result": make_page(
            "The result",
            "`irsim benchmark --json`, `irsim.benchmark` and the tools `benchmark` and `get_job` return this result.",
            *(
                f"## {name}\n\n{_one_line(model.__doc__)}\n\n{_fields(model)}"
                for name, model in (
                    ("BenchmarkResult", benchmark.BenchmarkResult),
                    ("BenchmarkRow", benchmark.BenchmarkRow),
                    ("Proportion", benchmark.Proportion),
                    ("Estimate", benchmark.Estimate),
                    ("EpisodeRow", benchmark.EpisodeRow),
                )
            ),
        ),
    }


def contributing() -> Pages:
    """Return the pages of the skill ``irsim-dev``."""
    rows, root = [], resources.checkout() or Path()
    for kind, registry in sorted(REGISTRIES.items()):
        for feature in registry.features():
            if feature.origin == "built-in":
                model = f"irsim/components/{_FOLDERS[kind]}/{feature.options.__module__.rpartition('.')[2]}.py"
                header = ""
                if feature.kernel is not None:
                    stem = re.sub(r"(?<!^)(?=[A-Z])", "_", feature.kernel.__name__.removesuffix("Options")).lower()
                    path = f"irsim/core/{_FOLDERS[kind]}/{stem}.hpp"
                    header = f"`{path}`" if (root / path).is_file() else ""
                rows.append((kind, f"`{feature.name}`", f"`{model}`", header))
    return {
        "features": make_page(
            "Features and their files",
            "Each feature is declared in one file. A header of the core computes it, or a Python function in the same "
            "file.",
            plain_table(("kind", "name", "declaration", "computation"), rows),
        )
    }


PACKS: dict[str, Callable[[], Pages]] = {
    "irsim-runner": runner,
    "irsim-benchmark": comparisons,
    "irsim-dev": contributing,
}
"""Skill -> function that returns its pages; ``irsim-scenario`` is made from the schema of the language."""


def _find(name: str) -> tuple[str, Any]:
    """Return full name and function for a public name of ``irsim`` or a full name."""
    if not name.startswith("irsim."):
        return f"irsim.{name}", getattr(importlib.import_module(PUBLIC_HOMES[name]), name)
    module, _, name_there = name.rpartition(".")
    return name, getattr(importlib.import_module(module), name_there)


def _signature(member: Any) -> str:
    """Return the parameters with their defaults, without types and ``self``."""
    shown = []
    starred = False
    for parameter in inspect.signature(member).parameters.values():
        if parameter.name in ("self", "env"):
            continue
        if parameter.kind is parameter.KEYWORD_ONLY and not starred:
            shown.append("*")
            starred = True
        variadic = parameter.kind is parameter.VAR_POSITIONAL
        mark = "*" if variadic else "**" if parameter.kind is parameter.VAR_KEYWORD else ""
        starred = starred or variadic
        default = "" if parameter.default is parameter.empty else f"={parameter.default!r}"
        shown.append(f"{mark}{parameter.name}{default}")
    return f"({', '.join(shown)})"


def _function(name: str, function: Any) -> str:
    text, arguments = _docstring(function)
    listed = "\n".join(f"- `{key}`: {about}" for key, about in arguments)
    return f"## {name}\n\n`{name}{_signature(function)}`\n\n{text}\n\n{listed}"


def _format(name: str) -> str:
    """Return what the module of an export format says about it."""
    doc = inspect.cleandoc(importlib.import_module(f"irsim.bridges.export.formats.{name}").__doc__ or "")
    text = _markup(doc.removeprefix(f"``{name}``: "))
    return f"## {name}\n\n{text[0].upper()}{text[1:]}"


def _options(cls: type) -> str:
    _, arguments = _docstring(cls)
    listed = "\n".join(f"- `{key}`: {about}" for key, about in arguments)
    return f"## Keywords of irsim.make\n\n{listed}"


def _docstring(thing: Any) -> tuple[str, list[tuple[str, str]]]:
    """Return the text of a docstring before its sections, and the entries of ``Args``."""
    doc = inspect.cleandoc(thing.__doc__ or "")
    text = re.split(r"\n\n(?:Args|Returns|Raises|Yields|Attributes):", doc)[0]
    return _markup(" ".join(text.split())), _section(doc, "Args")


def _section(doc: str, name: str) -> list[tuple[str, str]]:
    match = re.search(rf"(?:^|\n){name}:\n(.*?)(?=\n\S|\Z)", doc, re.DOTALL)
    if not match:
        return []
    entries: list[tuple[str, str]] = []
    for line in inspect.cleandoc(match[1]).splitlines():
        start = re.match(r"(\*{0,2}[\w, ]+?): (.*)", line)
        if start and not line.startswith(" "):
            entries.append((start[1], _markup(start[2])))
        elif entries and line.strip():
            entries[-1] = (entries[-1][0], f"{entries[-1][1]} {_markup(line.strip())}")
    return entries


def _markup(text: str) -> str:
    text = re.sub(r":\w+:`[.~]*([^`]*)`", r"`\1`", text)
    return text.replace("``", "`")


def _one_line(doc: str | None) -> str:
    return _markup(" ".join((doc or "").partition("\n\n")[0].split()))


def _members(cls: type, but: type = object) -> str:
    rows = []
    for name, member in sorted(_public(cls), key=lambda pair: pair[0]):
        if hasattr(but, name):
            continue
        if isinstance(member, property):
            rows.append((f"`{name}` ->", _one_line(member.__doc__)))
        else:
            rows.append((f"`{name}{_signature(member)}`", _one_line(member.__doc__)))
    return plain_table(("name", "meaning"), [row for row in rows if row[1]])


def _public(cls: type) -> Iterator[tuple[str, Any]]:
    names = {name for base in cls.__mro__ if base.__module__.startswith("irsim") for name in vars(base)}
    for name in names:
        member = inspect.getattr_static(cls, name)
        if not name.startswith("_") and (isinstance(member, property) or inspect.isfunction(member)):
            yield name, member


def _attributes(cls: type) -> str:
    rows = [(f"`{name}`", about) for name, about in _section(inspect.cleandoc(cls.__doc__ or ""), "Attributes")]
    return plain_table(("attribute", "meaning"), rows) if rows else ""


def _fields(model: type[BaseModel]) -> str:
    docs = field_docs(model)
    rows = [(f"`{name}`", _markup(" ".join(docs.get(name, "").split()))) for name in model.model_fields]
    return plain_table(("field", "meaning"), rows)
