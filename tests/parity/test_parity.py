"""Every step of every scenario equals the trace recorded from the reference implementation.

Where a scenario names ids of the published list, `irsim.compat.DIFFERENCES`, under `custom.differs`, the comparison
follows them (README.md).
"""

from __future__ import annotations

import functools
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import irsim
from tests.parity.play import play

pytestmark = pytest.mark.one_python

HERE = Path(__file__).resolve().parent
SCENARIOS = sorted((HERE / "scenarios").glob("*.yaml"))
TOLERANCE = 1e-9
"""Largest absolute difference: m, rad, m/s, s."""
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


@functools.cache
def custom_of(path: Path) -> dict[str, Any]:
    return dict(yaml.safe_load(path.read_text(encoding="utf-8"))["custom"])


def ours_of(path: Path, custom: dict[str, Any]) -> Trace:
    return play(irsim, path, custom, reset=custom.get("reset", False))


def family(field: str) -> str:
    """A field without the number of its robot or object: ranges_0 → ranges."""
    return re.sub(r"_\d+$", "", field)


def mismatch(ours: np.ndarray, trace: np.ndarray) -> np.ndarray:
    """Elements that differ: by more than the tolerance for numbers, at all for flags and words."""
    if trace.dtype.kind == "f":
        return ~np.isclose(ours, trace, rtol=0.0, atol=TOLERANCE, equal_nan=True)
    return np.asarray(ours != trace)


def report(field: str, ours: np.ndarray, trace: np.ndarray, wrong: np.ndarray) -> str:
    """First differing element of a field, with its index (step, object or beam, component) and both values."""
    first = tuple(int(i) for i in np.argwhere(wrong)[0]) if wrong.ndim else ()
    return (
        f"{field}{list(first)}: {ours[first]!r}, recorded {trace[first]!r}, {int(wrong.sum())} of {wrong.size} differ"
    )


def between(field: str, full: np.ndarray, small: np.ndarray, trace: np.ndarray) -> np.ndarray:
    """D2: elements outside what the runs with full and with inscribed circles allow."""
    if family(field) == "ranges":
        return (trace < full - TOLERANCE) | (trace > small + TOLERANCE)
    return mismatch(full, trace) & mismatch(small, trace)


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_every_step_equals_the_recorded_trace(path: Path, tmp_path: Path) -> None:
    custom = custom_of(path)
    ids = custom.get("differs", [])
    with np.load(HERE / "traces" / f"{path.stem}.npz") as file:
        recorded = {field: file[field] for field in file.files}
    full = ours_of(path, custom)
    small: Trace = {}
    if "D2" in ids:
        document = shrink_circles(yaml.safe_load(path.read_text(encoding="utf-8")))
        shrunk = tmp_path / path.name
        shrunk.write_text(yaml.safe_dump(document), encoding="utf-8")
        small = ours_of(shrunk, custom)

    assert set(full) == set(recorded)
    problems = []
    for field, trace in recorded.items():
        ours = full[field]
        if ours.shape != trace.shape:
            problems.append(f"{field}: shape {ours.shape}, recorded {trace.shape}")
            continue
        ours, trace = apply(ids, field, ours, trace)
        if "D2" in ids and family(field) in DIFFERENCES["D2"].fields:
            inscribed, _ = apply(ids, field, small[field], recorded[field])
            wrong = between(field, ours, inscribed, trace)
        else:
            wrong = mismatch(ours, trace)
        if wrong.any():
            problems.append(report(field, ours, trace, wrong))
    assert not problems, "\n".join([path.stem, *problems])


def test_every_scenario_has_a_trace_and_known_ids() -> None:
    assert {path.stem for path in SCENARIOS} == {path.stem for path in (HERE / "traces").glob("*.npz")}
    used = {name for path in SCENARIOS for name in custom_of(path).get("differs", [])}
    assert used == set(DIFFERENCES)


def test_readme_names_every_difference() -> None:
    text = (HERE / "README.md").read_text(encoding="utf-8")
    for name, difference in DIFFERENCES.items():
        assert f"`{name}`" in text
        assert difference.about
    for path in SCENARIOS:
        for name in custom_of(path).get("differs", []):
            assert re.search(rf"\| `{name}` \|.*`{path.stem}`", text), f"{path.stem} missing in the row of {name}"
