"""The intended differences that touch a scenario, and how the trace is compared where one applies.

A scenario names ids of the published list, `irsim.compat.DIFFERENCES`, under `custom.differs`. Without an
id every field of every step must equal the trace.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

Trace = dict[str, np.ndarray]
SAGITTA = math.cos(math.pi / 64)
"""Inner over outer radius of a regular 64-gon."""
TURN = 2 * math.pi


@dataclass(frozen=True)
class Difference:
    """One intended difference and the fields that are compared in its own way."""

    about: str
    fields: tuple[str, ...]


DIFFERENCES = {
    "D2": Difference(
        "Circles are circles, in the reference inscribed 64-gons. Ranges lie between the ranges of a run with the full "
        "circles and of a run with circles smaller by cos(pi/64), that is within r(1 - cos(pi/64)) of depth; flags, "
        "hits and status agree with one of these two runs.",
        ("ranges", "valid", "hit_velocity", "collision", "stop", "status", "done"),
    ),
    "D12": Difference(
        "make() and reset() evaluate arrival and collisions at once. The trace was recorded with a reset() after "
        "make(), which evaluates them in the reference too; only the status before the first step is left out.",
        ("status",),
    ),
    "D18": Difference(
        "An object is seen when any part of it lies in the field of view; the reference looks at where its bounding "
        "circle ends and can miss a large one straight ahead. Everything that the reference sees is seen.",
        ("in_view", "detected"),
    ),
    "format-17": Difference(
        "Headings of the circle distribution are wrapped into [-pi, pi). They are compared modulo a full turn.",
        ("state", "goal", "heading"),
    ),
    "dynamics-18": Difference(
        "State rows beyond the rows of the drive keep their value; in the reference each step overwrites them with the "
        "last component. Here they are compared with their initial values.",
        ("state",),
    ),
}


def shrink_circles(node: Any, key: str = "") -> Any:
    """A scenario document with every circle replaced by the circle inscribed in its 64-gon."""
    if isinstance(node, list):
        return [shrink_circles(item, key) for item in node]
    if not isinstance(node, dict):
        return node
    copy = {name: shrink_circles(value, name) for name, value in node.items()}
    if key in ("shape", "parts") and node.get("name", "circle") == "circle":
        copy["radius"] = node.get("radius", 0.2) * SAGITTA
    return copy


def turned(ours: np.ndarray, trace: np.ndarray) -> np.ndarray:
    """Our headings moved by full turns next to the recorded ones."""
    return ours + TURN * np.round((np.nan_to_num(trace) - np.nan_to_num(ours)) / TURN)


def apply(ids: list[str], field: str, ours: np.ndarray, trace: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both arrays of a field, changed as the ids say (D2 apart, which needs a second run)."""
    ours = ours.copy()
    if "D12" in ids and field == "status":
        ours, trace = ours[1:], trace[1:]
    if "D18" in ids and field.startswith(("in_view", "detected")):
        ours[~trace] = False
    if "format-17" in ids and field == "heading":
        ours = turned(ours, trace)
    elif "format-17" in ids and field in ("state", "goal"):
        ours[..., 2] = turned(ours[..., 2], trace[..., 2])
    if "dynamics-18" in ids and field == "state":
        trace = trace.copy()
        trace[:, :, 3:] = trace[:1, :, 3:]
    return ours, trace
