"""Checks the files that a scenario names: images, maps, and whether files are inside the workspace, if any."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path as FilePath
from typing import Any

from irsim.diagnostics.diagnostic import Edit, Path, nearest
from irsim.scenario.checks._context import Context
from irsim.scenario.locate import BUNDLED, image_places, why_outside
from irsim.scenario.messages.findings import Finding, error, warning
from irsim.scenario.yaml.formatting import quote_value


def check(context: Context) -> Iterator[Finding]:
    """Report missing images, files outside the workspace if there is one, and what is wrong with the map."""
    yield from _named_files(context)
    yield from context.map_findings


def _named_files(context: Context) -> Iterator[Finding]:
    source = context.document.path
    yield from _missing_images(context, FilePath(source).resolve().parent if source is not None else None)
    root = context.document.limits.root
    if root is None:
        return
    bases = [FilePath(source).resolve().parent] if source is not None else []
    seen: set[Path] = set()
    for path, name in named_files(context):
        wrong = why_outside(name, FilePath(root), bases) if path not in seen else None
        seen.add(path)
        if wrong is not None:
            yield error(
                "path-outside-workspace",
                path,
                f"{quote_value(name)} {wrong}",
                given=name,
                allowed="files inside the workspace",
                fix="put the file into the workspace and give its path relative to it or to the scenario",
            )


def _missing_images(context: Context, folder: FilePath | None) -> Iterator[Finding]:
    seen: set[Path] = set()
    for path, name in named_files(context):
        if path[0] == "world" or path in seen:
            continue
        seen.add(path)
        if any(_is_file(place) for place in image_places(name, folder)):
            continue
        near = nearest(name, BUNDLED)
        yield warning(
            "image-not-found",
            path,
            f"there is no image {quote_value(name)}: the shape is drawn instead",
            given=name,
            allowed=f"an image file beside the scenario, or one of {', '.join(BUNDLED)}",
            fix=f"description: {near}" if near else "use a file name; text belongs in 'world.description' or a comment",
            edit=Edit("replace", path, near, safe=False) if near else None,
        )


def _is_file(path: FilePath) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def named_files(context: Context) -> Iterator[tuple[Path, str]]:
    """The files that a scenario names, each with the path of its name."""
    grid: Any = context.scenario.world.obstacle_map
    name = getattr(grid, "path", None)
    if isinstance(name, str):
        written = context.data["world"]["obstacle_map"]
        yield ("world", "obstacle_map") if isinstance(written, str) else ("world", "obstacle_map", "path"), name
    for record in context.entry_objects:
        if record.description and context.is_given(record, "description"):
            yield context.entry_path(record, "description"), record.description
