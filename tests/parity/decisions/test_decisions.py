"""One decision of each random scene equals the one recorded from the reference implementation (../record.py)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from tests.parity.decisions.scenes import FAMILIES, decide, deciders, scene

HERE = Path(__file__).resolve().parent
TOLERANCE = 1e-6
"""Largest absolute difference of an executed command: m/s, rad/s."""
EXCEPTIONS: dict[tuple[str, int], str] = {}
"""(family, scene) whose decisions are not reproduced, and why."""
MIN_COMPARED = 20
"""Scenes of each family that no intended difference concerns, at least."""


def is_decided_otherwise(document: dict[str, Any], rows: list[int]) -> bool:
    """Whether static lines (D6) or limited accelerations (D28) let behaviors of the scene choose otherwise."""
    lines = any(entry["shape"]["name"] == "linestring" for entry in document.get("obstacle", ()))
    return lines or any("acce" in document["robot"][row] for row in rows if row < len(document["robot"]))


def with_laws_of_2_12(document: dict[str, Any]) -> dict[str, Any]:
    """The scene with ``turning: fixed`` (D27) and ``keep_gap: false`` (D29), so that robots move as there."""
    for entry in document["robot"]:
        for options in (entry.get("behavior", {}), entry.get("group_behavior", {})):
            if options.get("name") == "rvo":
                options["turning"] = "fixed"
            if options.get("name") in ("rvo", "sfm"):
                options["keep_gap"] = False
    return document


@pytest.mark.slow(6)
@pytest.mark.parametrize("family", FAMILIES)
def test_decisions_equal_the_recorded_ones(family: str, tmp_path: Path) -> None:
    with np.load(HERE / f"{family}.npz") as file:
        owners, commands = file["scene"], file["command"]
    assert len(commands) >= 500
    wrong, compared = {}, 0
    for index in range(FAMILIES[family]):
        document = with_laws_of_2_12(scene(family, index))
        if is_decided_otherwise(document, deciders(family, document)):
            continue
        compared += 1
        ours = decide(irsim, document, deciders(family, document), tmp_path)
        gap = float(np.abs(ours - commands[owners == index]).max())
        if gap > TOLERANCE:
            wrong[family, index] = gap
    assert set(wrong) == {key for key in EXCEPTIONS if key[0] == family}, wrong
    assert compared >= MIN_COMPARED
    assert len(wrong) <= 0.01 * compared
