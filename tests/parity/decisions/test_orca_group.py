"""Groups of `orca` take their first step as in IR-SIM 2.12: what they prefer, how fast, and their drives."""

from __future__ import annotations

import numpy as np

from irsim.scenario.read import or_raise, read
from irsim.simulation.simulation import Simulation
from tests.parity.decisions.orca_group_record import FILE, scenario

RECORDED = dict(np.load(FILE))


EXCEPTIONS = {(44, 2), (93, 3), (115, 4)}
"""(snapshot, robot) that overlap others so much that nothing is free: single precision finds another of the least bad
velocities, up to 0.005 m/s away. 3 of 720."""
TOLERANCE = 1e-4


def test_first_steps() -> None:
    far = set()
    corrected = 0
    for index, velocity in enumerate(RECORDED["velocity"].astype(float)):
        place, goal, options = (RECORDED[name][index].astype(float) for name in ("place", "goal", "options"))
        drive = "omni" if index % 2 else "diff"
        resolved, _ = or_raise(read(scenario(place, goal, options, drive), strict=True))
        simulation = Simulation(resolved, [0])
        simulation.step()
        gap = np.abs(simulation.control[:, :2] - velocity)
        if drive == "diff":
            # 2.12 leaves headings alone that are less than 0.1 rad off, and stops below 0.02 m/s; robots that avoid
            # an object do neither (D11)
            stops = (velocity == 0.0).all(axis=1) & (np.abs(simulation.control[:, 0]) <= 0.02)
            small = ((velocity[:, 1] == 0.0) & (np.abs(simulation.control[:, 1]) <= 0.1 / 0.1)) | stops
            gap[stops, 0] = 0.0
            corrected += int((small & (gap[:, 1] > TOLERANCE)).sum())
            # the direction of a slow velocity in single precision is uncertain, and is corrected within 0.1 s
            slow = 1e-6 / np.maximum(np.abs(velocity[:, 0]), 1e-2) / 0.1
            gap[:, 1] = np.where(small, 0.0, np.maximum(gap[:, 1] - slow, 0.0))
        far |= {(index, int(k)) for k in np.flatnonzero(gap.max(axis=1) > TOLERANCE)}
    assert far == EXCEPTIONS
    assert corrected < 0.2 * RECORDED["velocity"][::2, :, 0].size
