"""Skid steering: the motion by hand, where the ground turns it otherwise than its controller thinks, its limits."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import irsim
import irsim._core as core
from irsim.components.kinematics._presets import SKID_STEER
from irsim.testing import conformance
from tests.core.driving import EULER, driven
from tests.core.worlds import assert_success, robot, scene


def skid(**options: Any) -> core.SkidSteerOptions:
    usual: dict[str, Any] = {
        "noise": False, "alpha": [0.03, 0.0, 0.0, 0.03], "believed_track": 0.6, "icr_left": 0.3, "icr_right": -0.3,
        "icr_ahead": 0.0, "traction_left": 1.0, "traction_right": 1.0, "speed_max": math.inf,
        "track": 0.4,
    }  # fmt: skip
    return core.SkidSteerOptions(**{**usual, **options})


def test_one_step_by_hand() -> None:
    drive = skid(icr_left=0.5, icr_right=-0.4, icr_ahead=0.1, traction_left=0.8)
    state, twist = core.drive_step(drive, [1, 2, 0, 0, 0], [1.0, 0.5], 0.1, EULER)
    left, right = 1 - 0.3 * 0.5, 1 + 0.3 * 0.5
    rate = (right - 0.8 * left) / 0.9
    forward = (right * 0.5 + 0.8 * left * 0.4) / 0.9
    assert twist == pytest.approx([forward, -0.1 * rate, rate])
    assert state == pytest.approx([1 + 0.1 * forward, 2 - 0.01 * rate, 0.1 * rate, left, right])


def test_on_the_ground_it_is_calibrated_for_it_moves_as_diff() -> None:
    controls = [[math.sin(0.1 * k), math.cos(0.2 * k)] for k in range(100)]
    diff = core.DiffOptions(noise=False, alpha=[0.0] * 4, track=0.3)
    ours = driven(skid(), [0, 0, 0, 0, 0], controls)[:, :3]
    np.testing.assert_allclose(ours, driven(diff, [0, 0, 0], controls), atol=1e-12)


def test_it_turns_about_a_point_ahead_and_less_than_it_thinks() -> None:
    path = driven(skid(icr_left=0.45, icr_right=-0.45, icr_ahead=0.2), [0, 0, 0, 0, 0], [[0.0, 0.9]] * 40)
    assert np.diff(np.unwrap(path[:, 2])) == pytest.approx(0.1 * 0.9 * 0.6 / 0.9)
    still = path[:, :2] + 0.2 * np.column_stack([np.cos(path[:, 2]), np.sin(path[:, 2])])
    np.testing.assert_allclose(still, [[0.2, 0.0]] * 41, atol=1e-12)


def test_less_traction_on_one_side_bends_a_straight_way_into_a_circle() -> None:
    path = driven(skid(traction_right=0.5), [0, 0, 0, 0, 0], [[1.0, 0.0]] * 60)
    radius = -0.3 * (1 + 0.5) / (1 - 0.5)  # the left side at 1 m/s, the right one at 0.5 m/s, 0.6 m apart
    np.testing.assert_allclose(np.hypot(path[:, 0], path[:, 1] - radius), abs(radius), atol=1e-6)


def test_a_side_keeps_its_limit_and_the_curve_its_radius() -> None:
    limited = driven(skid(speed_max=0.7), [0, 0, 0, 0, 0], [[1.0, 1.0]] * 5)
    assert limited[-1, 3:] == pytest.approx([0.7 * 0.7 / 1.3, 0.7])
    free, slow = (driven(drive, [0, 0, 0, 0, 0], [[1.0, 1.0]])[-1] for drive in (skid(), skid(speed_max=0.7)))
    assert slow[2] / free[2] == pytest.approx(0.7 / 1.3)
    for x, y, _, *_ in (free, slow):
        assert math.hypot(x, y - 1.0) == pytest.approx(1.0), "both are on the circle of 1 m"


@pytest.mark.parametrize("preset", SKID_STEER)
def test_presets_say_their_source_and_are_calibrated(preset: str) -> None:
    values = SKID_STEER[preset]
    assert "read 20" in values.source
    numbers = values.values
    assert numbers["believed_track"] == pytest.approx(numbers["icr_left"] - numbers["icr_right"])
    result = irsim.run(text=ROOM.replace("SKID", f"preset: {preset}"), seed=1)
    assert result.outcome == "success"


def test_keys_win_over_the_preset() -> None:
    simulation, _ = conformance.simulate(ROOM.replace("SKID", "preset: husky, icr_left: 0.7"), steps=1)
    drive: Any = simulation.scenario.objects[0].kinematics
    assert (drive.icr_left, drive.icr_right) == (0.7, SKID_STEER["husky"].values["icr_right"])


ROOM = """
world: {width: 8, height: 8, integration: exact, time_limit: 40}
robot: {kinematics: {name: skid_steer, SKID}, state: [1, 1, 2], goal: [7, 6], behavior: {name: orca}}
obstacle: {shape: {name: circle, radius: 0.5}, state: [4, 3.6, 0]}
"""


@pytest.mark.parametrize("local", ["dash", "orca", "footprint_orca"])
def test_it_follows_a_path_on_a_ground_it_is_not_calibrated_for(local: str) -> None:
    assert_success(
        ROOM.replace("SKID", "preset: jackal, traction_left: 0.8, icr_ahead: 0.05").replace(
            "{name: orca}", f"{{name: follow, local: {{name: {local}}}}}"
        ),
        seed=1,
    )


def test_a_state_that_is_too_short_is_filled_up() -> None:
    """Inner states have rows of their own, whatever `state_dim` says."""
    world, state = scene(robot(drive=skid(), extra=[]))
    core.advance(world, state, 3)
    assert state.extra.shape == (1, 2)
    after, _ = core.drive_step(skid(), [0, 0, 0], [1.0, 0.0], 0.1)
    assert after == pytest.approx([0.1, 0, 0])
