"""Opens the scenario of a task, and the variants of it that its levels draw."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from irsim.bundled.templates.fill import fill, parse_path
from irsim.bundled.templates.store import Template, TemplateError, load
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic, suggestion
from irsim.diagnostics.errors import InputError
from irsim.episodes.opening import unopened_bridges
from irsim.learning.tasks.files import TaskError, task_error
from irsim.learning.tasks.task import Task
from irsim.learning.tasks.variation import LevelDraws, drawn_values, level_draws, randomize_path
from irsim.options.units import Value
from irsim.scenario.perturbation import perturbed
from irsim.scenario.read import or_raise, read
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario, Variation, VariedLevel
from irsim.scenario.yaml.document import Document, load_path, load_text

__all__ = ["TaskScene", "open_scene", "scenario_text", "task_scenario"]

_MAY_VARY = {"state", "goals", "shape", "range_low", "range_high", "plot", "color", "description"}
"""Fields in which an object may differ between variants."""
_WORLD_MAY_VARY = {"width", "height", "time_limit", "name", "description"}
_FIXES = {
    "vel_max": "draw it with `randomize: {speed: …}`",
    "vel_min": "draw it with `randomize: {speed: …}`",
    "acce": "draw it with `randomize: {acceleration: …}`",
}


@dataclass(frozen=True)
class TaskScene:
    """The scenario of a task.

    Attributes:
        scenario: The scenario, with what is drawn for each episode.
        levels: The draws at each level.
        parameters: Name of each drawn parameter -> its value in each variant.
        warnings: Entries of the scenario without effect, or perhaps not meant; paths are paths in the scenario.
    """

    scenario: ResolvedScenario
    levels: tuple[LevelDraws, ...]
    parameters: dict[str, list[Value]]
    warnings: tuple[Diagnostic, ...] = ()


def task_scenario(task: Task, folder: Path) -> ResolvedScenario:
    """The scenario of a task under its protocol, with what is drawn for each episode.

    Args:
        task: The task.
        folder: Where the file of its scenario is found.

    Raises:
        TaskError: The template does not exist or does not take these parameters, or something cannot be drawn.
        ScenarioError: The scenario cannot be used.
    """
    return open_scene(task, folder).scenario


def open_scene(task: Task, folder: Path) -> TaskScene:
    """The scenario of a task, and what is drawn in it. See :func:`task_scenario`."""
    base, warnings = _resolved(task, folder, task.parameters, {})
    draws = level_draws(task, base)
    if task.curriculum is None and not any(one.drawn or one.parameters for one in draws):
        return TaskScene(base, draws, {}, warnings)
    names = dict.fromkeys(name for one in draws for name in one.parameters)
    table: dict[str, list[Value]] = {name: [] for name in names}
    variants: list[ResolvedScenario] = []
    counts = []
    for level, draw in enumerate(draws):
        values = _values_of(task, level, draw)
        counts.append(len(values))
        for drawn in values:
            changed = {**task.parameters, **task.levels[level].parameters, **drawn}
            variant, _ = _resolved(task, folder, changed, task.levels[level].values, level)
            _check_alike(base, variant, (*_where(task, level), "parameters" if drawn else "values"))
            variants.append(variant)
            for name in names:
                table[name].append(changed[name] if name in changed else _template(task).parameters[name].default)
    if all(count == 1 for count in counts) and all(_is_plain(task, level) for level in range(len(draws))):
        variants, counts, table = [], [0] * len(draws), {}
    firsts = np.cumsum([0, *counts[:-1]]).tolist()
    levels = [VariedLevel(one.drawn, first, n) for one, first, n in zip(draws, firsts, counts, strict=True)]
    base.world = _roomy(base, variants)
    base.variation = Variation(levels, variants)
    return TaskScene(base, draws, table, warnings)


def _is_plain(task: Task, level: int) -> bool:
    """Whether a level leaves the geometry of the task as it is."""
    own = task.levels[level]
    return not (own.parameters or own.values or own.randomize.parameters or task.randomize.parameters)


def _where(task: Task, level: int | None) -> tuple[str | int, ...]:
    """Path of the key `randomize` of a task, or of the level."""
    return ("randomize",) if task.curriculum is None or level is None else ("curriculum", "levels", level)


def _values_of(task: Task, level: int, draw: LevelDraws) -> list[dict[str, Value]]:
    """The drawn parameters of each variant of a level."""
    if not draw.parameters:
        return [{}]
    template = _template(task)
    columns = {}
    for name, given in draw.parameters.items():
        path = (*randomize_path(task, level), "parameters", name)
        if name not in template.parameters:
            known = ", ".join(template.parameters) or "none"
            what = f"the template {template.name!r} has no parameter {clean(name)!r}; it has {known}"
            raise task_error(path, what, suggestion(name, template.parameters, "name one of them"))
        parameter = template.parameters[name]
        try:
            values = [parameter.check(name, value) for value in given]
        except TemplateError as error:
            raise task_error(path, error.message, error.fix or "") from None
        numeric = parameter.type in ("number", "integer")
        if numeric and (len(values) != 2 or values[0] > values[1]):  # type: ignore[operator] # both are numbers
            raise task_error(path, "a number is drawn from a range", "write [low, high]")
        columns[name] = drawn_values(name, values, parameter.type, draw.variants)
    return [{name: column[k] for name, column in columns.items()} for k in range(draw.variants)]


def _template(task: Task) -> Template:
    assert task.template is not None, "the task says so"
    try:
        return load(task.template)
    except TemplateError as error:
        raise TaskError(f"task {task.task!r}: {error.message}", error.fix or "") from None


def _resolved(
    task: Task, folder: Path, parameters: Mapping[str, Value], values: Mapping[str, Any], level: int | None = None
) -> tuple[ResolvedScenario, tuple[Diagnostic, ...]]:
    """The scenario with some parameters and values, and its warnings."""
    document = _changed(task, folder, parameters, values, level)
    scenario, diagnostics = or_raise(read(document, strict=True))
    try:
        scenario = perturbed(scenario, task.perturb, called=task.task)
    except InputError as error:
        raise task_error(("perturb",), error.message, error.fix or "") from None
    diagnostics = [*diagnostics, *unopened_bridges(scenario, "training")]
    return scenario, tuple(item for item in diagnostics if item.severity == "warning")


def scenario_text(task: Task, folder: Path) -> str:
    """The scenario of a task as text of a scenario file; what ``perturb`` and ``randomize`` draw is not in it.

    Args:
        task: The task.
        folder: Where the file of its scenario is found.

    Raises:
        TaskError: The template does not exist or does not take these parameters.
    """
    text = _changed(task, folder, task.parameters, {}).text
    assert text is not None, "only documents of data have no text"
    return text


def _changed(
    task: Task, folder: Path, parameters: Mapping[str, Value], values: Mapping[str, Any], level: int | None = None
) -> Document:
    """The scenario file under the protocol of the task, with some parameters and values."""
    document = _document(task, folder, parameters)
    data = document.data
    if (task.protocol != "as-written" or values) and isinstance(data, Mapping):
        changed = deepcopy(dict(data))
        if task.protocol != "as-written":
            changed["world"] = {**(changed.get("world") or {}), "after_arrival": task.protocol}
        for path, value in values.items():
            _set(changed, path, value, (*_where(task, level), "values", path))
        document = load_text(yaml.safe_dump(changed, sort_keys=False), name=task.task, path=str(folder / "scene.yaml"))
    return document


def _set(data: Any, path: str, value: Any, where: tuple[str | int, ...]) -> None:
    """Replace a value of a scenario."""
    parts = parse_path(path)
    for k, part in enumerate(parts):
        known = isinstance(data, list) and isinstance(part, int) and part < len(data)
        known = known or (isinstance(data, dict) and part in data)
        if not known:
            names = [str(key) for key in data] if isinstance(data, dict) else [f"[{i}]" for i in range(len(data or []))]
            what = f"the scenario has no {clean(path)!r}"
            raise task_error(
                where, what, suggestion(str(part), names, f"there is {', '.join(names) or 'nothing'} here")
            )
        if k == len(parts) - 1:
            data[part] = value
        else:
            data = data[part]


def _document(task: Task, folder: Path, parameters: Mapping[str, Value]) -> Document:
    if task.file is not None:
        return load_path(folder / task.file)
    if task.template is not None:
        try:
            text = fill(_template(task), parameters)
        except TemplateError as error:
            raise TaskError(f"task {task.task!r}: {error.message}", error.fix or "") from None
    else:
        text = yaml.safe_dump(deepcopy(task.scenario), sort_keys=False)
    return load_text(text, name=task.task, path=str(folder / "scenario.yaml"))


# variants -------------------------------------------------------------------------------------------------------------
def _check_alike(base: ResolvedScenario, variant: ResolvedScenario, where: tuple[str | int, ...]) -> None:
    """Refuse a variant that differs in more than places, goals and shapes.

    Raises:
        TaskError: It does.
    """
    if len(base.objects) != len(variant.objects):
        what = f"variants have {len(base.objects)} and {len(variant.objects)} objects"
        raise task_error(where, what, "draw the number with `randomize: {number: …}`")
    for one, other in zip(base.objects, variant.objects, strict=True):
        for key in _differences(one, other):
            what = (
                f"{key!r} of {one.name!r} differs between variants, which may differ in places, goals and shapes only"
            )
            raise task_error(where, what, _FIXES.get(key, "leave it as it is"))
    ours, others = base.world.model_dump(exclude=_WORLD_MAY_VARY), variant.world.model_dump(exclude=_WORLD_MAY_VARY)
    for key, value in ours.items():
        if value != others.get(key):
            what = f"'world.{key}' differs between variants, which may differ in places, goals and shapes only"
            raise task_error(where, what, "leave it as it is")


def _differences(one: ObjectRecord, other: ObjectRecord) -> list[str]:
    keys = [field.name for field in fields(one) if field.name not in _MAY_VARY]
    return [key for key in keys if getattr(one, key) != getattr(other, key)]


def _roomy(base: ResolvedScenario, variants: list[ResolvedScenario]) -> Any:
    """The world of a scenario, as large as the largest variant."""
    if not variants:
        return base.world
    size = {side: max(getattr(one.world, side) for one in variants) for side in ("width", "height")}
    return base.world.model_copy(update=size)
