"""Checks shapes: invalid outlines, empty ranges and surprising defaults."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from irsim.diagnostics.diagnostic import Edit, Path
from irsim.scenario.checks._context import Context
from irsim.scenario.checks._outlines import crosses_itself, distinct_corners, repair_outline
from irsim.scenario.messages.findings import Finding, error, hint
from irsim.scenario.resolve.expand import DEFAULT_RADIUS
from irsim.scenario.yaml.formatting import flow

_MAX_DRAWN = 2_000_000
"""Most vertices of all random outlines of a scenario."""
_RANGES = ("radius_range", "avg_radius_range", "irregularity_range", "spikeyness_range", "num_vertices_range")


def check(context: Context) -> Iterator[Finding]:
    """Check each written shape once."""
    yield from _vertices(context)
    seen: set[Path] = set()
    for record in context.entry_objects:
        if not context.is_given(record, "shape"):
            if record.path not in seen:
                seen.add(record.path)
                yield hint(
                    "default-shape",
                    record.path,
                    f"without 'shape' the object is a circle of radius {DEFAULT_RADIUS:g} m",
                    fix="add 'shape: {name: circle, radius: 0.2}'",
                )
            continue
        path = context.entry_path(record, "shape")
        if path not in seen:
            seen.add(path)
            yield from _shape(path, record.shape)


def _vertices(context: Context) -> Iterator[Finding]:
    """Random outlines of all objects together have a limit: their memory grows with objects times vertices."""
    drawn = [record for record in context.entry_objects if getattr(record.shape, "random_shape", False)]
    drawn = [record for record in drawn if hasattr(record.shape, "num_vertices_range")]
    total = sum(record.shape.num_vertices_range[1] for record in drawn)
    if total > _MAX_DRAWN:
        most = max(drawn, key=lambda record: int(record.shape.num_vertices_range[1]))
        yield error(
            "too-many-objects",
            (*context.entry_path(most, "shape"), "num_vertices_range"),
            f"{len(drawn):,} random outlines of all objects have up to {total:,} vertices",
            allowed=f"at most {_MAX_DRAWN:,} vertices of all random outlines",
            fix="reduce 'number' or 'num_vertices_range'",
        )


def _shape(path: Path, shape: Any) -> Iterator[Finding]:
    for key in _RANGES:
        values = getattr(shape, key, None)
        if values is not None and values[0] > values[1]:
            yield error(
                "range-order",
                (*path, key),
                f"the lower bound must not exceed the upper bound, got {values[0]:g} and {values[1]:g}",
                given=values,
                fix=f"{key}: {flow([values[1], values[0]])}",
                edit=Edit("replace", (*path, key), [values[1], values[0]]),
            )
    if shape.name == "polygon":
        yield from _polygon(path, shape)
    elif shape.name == "linestring":
        yield from _linestring(path, shape)
    elif shape.name == "compound":
        for index, part in enumerate(shape.parts):
            yield from _shape((*path, "parts", index), part)
    if getattr(shape, "num_vertices_range", [0, 1])[0] == getattr(shape, "num_vertices_range", [0, 1])[1]:
        yield error(
            "range-order",
            (*path, "num_vertices_range"),
            "the upper bound is exclusive, so this range contains no number",
            given=shape.num_vertices_range,
            fix=f"[{shape.num_vertices_range[0]}, {shape.num_vertices_range[0] + 1}]",
        )


def _polygon(path: Path, shape: Any) -> Iterator[Finding]:
    if shape.random_shape:
        return
    if shape.vertices is None:
        yield hint("default-vertices", path, "without 'vertices' the polygon is a square of 2 m")
        return
    corners = distinct_corners(shape.vertices)
    where = (*path, "vertices")
    if len(corners) < 3:
        yield error(
            "too-few-vertices",
            where,
            f"a polygon must have at least 3 different corners, got {len(corners)}",
            given=shape.vertices,
        )
        return
    if not crosses_itself(corners):
        return
    better = repair_outline(shape.vertices)
    if better is None:
        yield error("invalid-polygon", where, "this outline encloses no area", given=shape.vertices)
    elif len(better) == 1:
        edit = Edit("replace", where, better[0])
        yield _invalid(where, shape.vertices, f"vertices: {flow(better[0])}", edit)
    else:
        parts = [{"name": "polygon", "vertices": vertices} for vertices in better]
        edit = Edit("replace", path, {"name": "compound", "parts": parts})
        yield _invalid(where, shape.vertices, f"shape: {flow(edit.value)}", edit)


def _invalid(path: Path, vertices: Sequence[Sequence[float]], fix: str, edit: Edit) -> Finding:
    fix = fix if len(fix) < 400 else "see the edit: the area it encloses, as valid polygons"
    return error(
        "invalid-polygon",
        path,
        "this outline crosses or touches itself",
        given=vertices,
        allowed="corners in order around the polygon",
        fix=fix,
        edit=edit,
        carry_on=edit,
    )


def _linestring(path: Path, shape: Any) -> Iterator[Finding]:
    if shape.random_shape:
        return
    if shape.vertices is None:
        yield error(
            "missing-key",
            (*path, "vertices"),
            "'vertices' is missing",
            fix="add 'vertices: [[0, 0], [3, 0]]', or 'random_shape: true'",
        )
    elif len({tuple(point) for point in shape.vertices}) < 2:
        yield error(
            "too-few-vertices",
            (*path, "vertices"),
            "a linestring must have at least 2 different points",
            given=shape.vertices,
        )
