"""A text while it is being written: its findings, the scene that it describes, and where each object stands in it."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import Any

from irsim.common.yaml.nodes import Node
from irsim.diagnostics.diagnostic import Path
from irsim.diagnostics.errors import PlacementError
from irsim.runs.replay.growing import GrowingRun
from irsim.scenario.limits import Limits
from irsim.scenario.model.lookup import at
from irsim.scenario.read import read
from irsim.scenario.resolve.resolved import ObjectRecord, random_parts
from irsim.scenario.yaml.document import Document, load_text
from irsim.simulation.simulation import Simulation
from irsim.validation.feasibility.check import feasibility_findings
from irsim.validation.validate import report_of

__all__ = ["check"]


def check(text: str, path: str | None, seed: int | None, limits: Limits) -> dict[str, Any]:
    """Check a text as ``irsim validate`` does, and place its objects.

    Args:
        text: The text.
        path: Path of the file that it is or was, beside which its maps are; None: a new text.
        seed: Seed of the places; None: the scenario's own, else 0.
        limits: Limits of the reader.

    Returns:
        ``summary`` and ``findings`` as in a report; if it can run ``scene``, a packed run without steps (base64), with
        its ``seed``, whether something in it is ``random``, and ``objects``: of each its path in the text, its lines
        there, and what can be dragged.
    """
    document = load_text(text, path=path, limits=limits)
    reading = read(document, strict=True, limits=limits, feasibility=feasibility_findings)
    report = report_of(reading, path or "(text)")
    answer: dict[str, Any] = {"summary": report.summary, "findings": [one.model_dump() for one in report.findings]}
    if (scenario := reading.scenario) is None:
        return answer
    chosen = next(one for one in (seed, scenario.world.seed, 0) if one is not None)
    try:
        simulation = Simulation(scenario, [chosen])
    except PlacementError as error:
        return answer | {"summary": str(error)}
    return answer | {
        "seed": chosen,
        "random": bool(random_parts(scenario)),
        "scene": base64.b64encode(GrowingRun(simulation, 1, growing=False, status="written").head).decode(),
        "objects": [_places(document, record) for record in scenario.objects],
    }


def _places(document: Document, record: ObjectRecord) -> dict[str, Any]:
    """Where an object is written, and what of it can be dragged: ``pose`` and ``goals``, by path, or ``why`` not."""
    entry = at(document.data, record.path)
    place: dict[str, Any] = {"path": list(record.path), "lines": _lines(document, record.path)}
    if record.is_terrain or not isinstance(entry, Mapping):
        return place | {"why": "a key of the world makes it"}
    state, number = entry.get("state"), entry.get("number", 1)
    if number != 1:
        if isinstance(state, list) and len(state) == number and all(isinstance(one, list) for one in state):
            return place | {"pose": [*record.path, "state", record.index], "goals": []}
        return place | {"why": f"it is one of {number} that one entry makes"}
    if "distribution" in entry:
        return place | {"why": "a distribution places it"}
    goals = []
    goal = entry.get("goal")
    if isinstance(goal, list) and goal:
        nested = isinstance(goal[0], list)
        goals = [[*record.path, "goal", k] for k in range(len(goal))] if nested else [[*record.path, "goal"]]
    return place | {"pose": [*record.path, "state"], "goals": goals}


def _lines(document: Document, path: Path) -> list[int]:
    """The first and the last line of a value, counted from 1."""
    node = document.tree()
    for part in (*document.prefix, *path):
        children = node.children if node is not None else {}
        node = children.get(part, node)
    mark = document.mark((*document.prefix, *path), key=isinstance(path[-1], str))
    first = 1 if mark is None else mark.line
    return [first, first if node is None else max(first, _last_line(node))]


def _last_line(node: Node) -> int:
    return max([node.mark.line, *map(_last_line, node.children.values())])
