"""How drives turn toward a wanted velocity when their turn rate can only change slowly."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import irsim._core as core
from irsim.common.angles import wrap
from tests.core.test_avocado import options as avocado
from tests.core.test_orca import options as orca
from tests.core.test_sfm import sfm
from tests.core.worlds import DRIVES, PI, robot, scene

FAR = 1e6
"""Distance of the goal [m], so that its direction does not change."""
BEHAVIORS: dict[str, Any] = {"orca": orca(), "avocado": avocado(), "sfm": sfm()}


def can_stop(rate: float, error: float, acce: float, dt: float) -> bool:
    """Whether some turn that starts at this rate does not go beyond the wanted heading."""
    toward = math.copysign(1, error) * rate
    slowest = max(0.0, abs(toward) - acce * dt)  # in the first period
    turns = float(np.arange(slowest, 0.0, -acce * dt).sum()) * dt
    return turns <= abs(error) - 1e-9 if toward > 0 else abs(error) + turns < PI - 1e-9


@given(
    error=st.floats(-PI + 0.01, PI - 0.01),
    share=st.floats(-1, 1),
    acce=st.floats(0.05, 50),
    top=st.floats(0.05, 10),
    dt=st.sampled_from([0.01, 0.05, 0.1, 0.2, 0.5, 1.0]),
    guarantee_time=st.sampled_from([0.01, 0.2, 1.0]),
)
def test_a_turn_never_goes_beyond_the_wanted_heading(
    error: float, share: float, acce: float, top: float, dt: float, guarantee_time: float
) -> None:
    rate, theta = share * top, -error
    assume(can_stop(rate, error, acce, dt))
    for _ in range(400):
        before = wrap(-theta)
        [_, wanted, _] = core.drive_follow(
            DRIVES["diff"], [0, 0, theta], [1, 0], tolerance=0.0, guarantee_time=guarantee_time, max_rate=top,
            acce=acce, dt=dt,
        )  # fmt: skip
        rate = min(max(wanted, rate - acce * dt), rate + acce * dt)
        theta += rate * dt
        after = wrap(-theta)
        if abs(before) < 1 and abs(after) < 1:
            assert before * after > -1e-12, "it crossed the heading"


@given(error=st.floats(-PI, PI), dt=st.sampled_from([0.01, 0.1, 0.5]), time=st.sampled_from([0.1, 0.2]))
def test_without_a_limit_the_law_is_as_ever(error: float, dt: float, time: float) -> None:
    turn = {"tolerance": 0.0, "guarantee_time": time, "max_rate": 3.0}
    plain = core.drive_follow(DRIVES["diff"], [0, 0, -error], [1, 0], **turn)
    assert core.drive_follow(DRIVES["diff"], [0, 0, -error], [1, 0], **turn, acce=math.inf, dt=dt) == plain


@pytest.mark.parametrize("name", BEHAVIORS)
@pytest.mark.parametrize("dt", [0.05, 0.1, 0.2])
def test_a_robot_under_each_behavior_turns_without_swinging(name: str, dt: float) -> None:
    turner = robot(
        drive=DRIVES["diff"],
        pose=[0.0, 0.0, -2.0],
        goals=[[FAR, 0.0]],
        vel_max=[1.0, 10.0, 0.0],
        vel_min=[-1.0, -10.0, 0.0],
        acce=[math.inf, 4.0, math.inf],
        behavior=BEHAVIORS[name],
    )
    world, state = scene(turner, step_time=dt)
    headings = []
    for _ in range(round(4 / dt)):
        core.advance(world, state, 1)
        headings.append(float(state.pose[0, 2]))
    fastest = 2 * math.sqrt(2.0 / 4.0)  # half the angle faster and faster, then half of it slower and slower
    assert abs(headings[math.ceil((fastest + 0.5) / dt)]) < 0.13, "errors below 0.1 rad are not corrected"
    assert max(headings) < 4.0 * dt**2 / 8 + 1e-3
    assert np.ptp(headings[-5:]) < 1e-3
