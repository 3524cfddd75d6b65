"""One decision of each random scene equals the one recorded from the reference implementation (see record.py)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import irsim
from tests.parity.decisions.decide import decide
from tests.parity.decisions.scenes import FAMILIES, deciders, scene

HERE = Path(__file__).resolve().parent
TOLERANCE = 1e-6
"""Largest absolute difference of an executed command: m/s, rad/s."""
EXCEPTIONS: dict[tuple[str, int], str] = {}
"""(family, scene) whose decisions are not reproduced, and why."""


@pytest.mark.slow(6)
@pytest.mark.parametrize("family", FAMILIES)
def test_decisions_equal_the_recorded_ones(family: str, tmp_path: Path) -> None:
    with np.load(HERE / f"{family}.npz") as file:
        owners, commands = file["scene"], file["command"]
    assert len(commands) >= 500
    wrong = {}
    for index in range(FAMILIES[family]):
        document = scene(family, index)
        ours = decide(irsim, document, deciders(family, document), tmp_path)
        gap = float(np.abs(ours - commands[owners == index]).max())
        if gap > TOLERANCE:
            wrong[family, index] = gap
    assert set(wrong) == {key for key in EXCEPTIONS if key[0] == family}, wrong
    assert len(wrong) <= 0.01 * len(commands)
