"""Every step of every scenario equals the trace recorded from the reference implementation (README.md)."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import irsim
from tests.parity.differences import DIFFERENCES, Trace, apply, shrink_circles
from tests.parity.play import play

HERE = Path(__file__).resolve().parent
SCENARIOS = sorted((HERE / "scenarios").glob("*.yaml"))
TOLERANCE = 1e-9
"""Largest absolute difference: m, rad, m/s, s."""


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
