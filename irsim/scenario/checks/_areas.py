"""Checks the outlines of areas of the world that are written as a rectangle or as a polygon."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from irsim.diagnostics.diagnostic import Edit, Path
from irsim.scenario.checks._outline import crosses_itself, distinct_corners, repair_outline
from irsim.scenario.messages.findings import Finding, error
from irsim.scenario.yaml.formatting import flow

__all__ = ["check_polygon", "check_rectangle"]


def check_rectangle(path: Path, rectangle: Sequence[float]) -> Iterator[Finding]:
    """Report a rectangle without an area, or with its bounds in the wrong order."""
    x0, y0, x1, y1 = rectangle
    if x0 < x1 and y0 < y1:
        return
    ordered = [min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)]
    turned = ordered[0] < ordered[2] and ordered[1] < ordered[3]
    yield error(
        "range-order",
        path,
        "a rectangle is [x_min, y_min, x_max, y_max], with each minimum below its maximum",
        given=rectangle,
        fix=f"rectangle: {flow(ordered)}" if turned else None,
        edit=Edit("replace", path, ordered) if turned else None,
    )


def check_polygon(path: Path, vertices: Sequence[Sequence[float]]) -> Iterator[Finding]:
    """Report a polygon with too few corners, or one that crosses itself."""
    corners = distinct_corners(vertices)
    if len(corners) < 3:
        message = f"a polygon must have at least 3 different corners, got {len(corners)}"
        yield error("too-few-vertices", path, message, given=vertices)
        return
    if not crosses_itself(corners):
        return
    areas = repair_outline(vertices)
    if areas is None:
        yield error("invalid-polygon", path, "this outline encloses no area", given=vertices)
        return
    single = len(areas) == 1
    yield error(
        "invalid-polygon",
        path,
        "this outline crosses or touches itself",
        given=vertices,
        allowed="corners in order around the polygon",
        fix=f"polygon: {flow(areas[0])}" if single else "write one for each area that it encloses",
        edit=Edit("replace", path, areas[0]) if single else None,
    )
