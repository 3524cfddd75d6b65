"""Reports features of the language that this version does not simulate yet, before anything runs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from irsim.components.options import CustomOptions
from irsim.diagnostics.diagnostic import Path
from irsim.options.registry import (
    BEHAVIORS,
    CUSTOM_BEHAVIORS,
    CUSTOM_GROUP_BEHAVIORS,
    KINEMATICS,
    MAPS,
    SENSORS,
    SHAPES,
    Registry,
)
from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, error
from irsim.scenario.model.actuation import MOST_CONTROLS


def check(context: Context) -> Iterator[Finding]:
    """Report features without a kernel or function."""
    world = context.scenario.world
    name = getattr(world.obstacle_map, "name", None)
    if name is not None and not _is_simulated(MAPS, name):
        yield _not_yet(("world", "obstacle_map"), f"maps of the kind '{name}'")
    seen: set[tuple[Any, ...]] = set()
    for path, feature in _unsimulated_features(context):
        if (path, feature) not in seen:
            seen.add((path, feature))
            yield _not_yet(path, feature)


def _unsimulated_features(context: Context) -> Iterator[tuple[Path, str]]:
    """The used features that are part of the language only, each with its path."""
    for record in context.entry_objects:
        for key, registry in (("kinematics", KINEMATICS), ("shape", SHAPES)):
            options: Any = getattr(record, key)
            if options is not None and not _is_simulated(registry, options.name):
                yield (*context.entry_path(record, key), "name"), f"the {registry.kind} '{options.name}'"
        for key, own in (("behavior", CUSTOM_BEHAVIORS), ("group_behavior", CUSTOM_GROUP_BEHAVIORS)):
            options = getattr(record, key)
            drive = getattr(record.kinematics, "name", None)
            if options is None or drive is None or isinstance(options, CustomOptions) or own.has(drive, options.name):
                continue
            if not _is_simulated(BEHAVIORS, options.name):
                yield (*context.entry_path(record, key), "name"), f"the behavior '{options.name}'"
            local: Any = getattr(options, "local", None)
            if options.name == "follow" and not _has_kernel(local):
                yield (*context.entry_path(record, key), "local"), f"following a path with '{local.name}'"
        if record.actuation is not None and record.vel_dim > MOST_CONTROLS:
            yield context.entry_path(record, "actuation"), f"actuation of more than {MOST_CONTROLS} controls"
        for index, sensor in enumerate(record.sensors):
            name: str = getattr(sensor, "name", "")
            if not _is_simulated(SENSORS, name):
                yield (*context.entry_path(record, "sensors"), index), f"the sensor '{name}'"
        if record.shape.name == "compound":
            yield from _posed_random_parts(context.entry_path(record, "shape"), record.shape)


def _posed_random_parts(path: Path, shape: Any) -> Iterator[tuple[Path, str]]:
    for index, part in enumerate(shape.parts):
        if part.name == "polygon" and part.random_shape and any(part.pose):
            yield (*path, "parts", index, "pose"), "a pose of a random part"


def _is_simulated(registry: Registry, name: str) -> bool:
    feature = registry.get(name)
    return feature is not None and feature.simulated


def _has_kernel(options: Any) -> bool:
    feature = BEHAVIORS.get(options.name)
    return feature is not None and feature.kernel is not None


def _not_yet(path: Path, what: str) -> Finding:
    return error(
        "not-yet-simulated",
        path,
        f"this version does not simulate {what} yet",
        fix="keep it and report this to the user, or try a labelled copy without it",
    )
