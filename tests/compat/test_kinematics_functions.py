"""The functions that move a column by one period: numbers that IR-SIM 2.12.0 gives, and refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irsim.lib import ackermann_kinematics, differential_kinematics, kinematics_factory, omni_kinematics
from irsim.lib.algorithm import omni_angular_kinematics

STATE = np.array([[0.0], [0.0], [3.1]])
CAR = np.array([[0.0], [0.0], [3.1], [0.2]])
TWO, THREE = np.array([[1.0], [0.5]]), np.ones((3, 1))


@pytest.mark.parametrize(
    ("function", "arguments", "expected"),
    [
        (differential_kinematics, (STATE, TWO, 0.1), [-0.09991351502732795, 0.004158066243329049, -3.133185307179586]),
        (differential_kinematics, (CAR, TWO, 0.1), [-0.09991351502732795, 0.004158066243329049, -3.133185307179586]),
        (ackermann_kinematics, (CAR, TWO, 0.1), [-0.09991351502732795, 0.004158066243329049, 3.120271003550867, 0.5]),
        (
            ackermann_kinematics,
            (CAR, TWO, 0.1, False, None, "angular", 2),
            [-0.09991351502732795, 0.004158066243329049, 3.1101355017754333, 0.25],
        ),
        (omni_kinematics, (STATE, TWO, 0.1), [-0.10199254814899249, -0.045798691270334924, 3.1]),
        (omni_angular_kinematics, (STATE, THREE, 0.1), [-0.104071581270657, -0.0957554487839989, -3.083185307179586]),
    ],
)
def test_known_numbers(function: Any, arguments: tuple[Any, ...], expected: list[float]) -> None:
    out = function(*arguments)
    assert out.shape == (len(expected), 1)
    assert out[:, 0] == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize(
    ("function", "arguments", "error"),
    [
        (differential_kinematics, (STATE[:2], TWO, 0.1), ValueError),
        (differential_kinematics, (STATE, TWO[:1], 0.1), ValueError),
        (differential_kinematics, ([0, 0, 0], TWO, 0.1), TypeError),
        (differential_kinematics, (STATE, TWO, 0.1, True, [0, 0]), ValueError),
        (ackermann_kinematics, (STATE, TWO, 0.1), ValueError),
        (ackermann_kinematics, (CAR, TWO, 0.1, False, None, "sideways"), ValueError),
        (omni_angular_kinematics, (STATE, TWO, 0.1), ValueError),
        (differential_kinematics, (STATE, TWO, 0.1, False, None, "rk4"), ValueError),
    ],
)
def test_wrong_shapes_are_refused(function: Any, arguments: tuple[Any, ...], error: type[Exception]) -> None:
    with pytest.raises(error):
        function(*arguments)


def test_noise_has_the_stated_deviation() -> None:
    alpha = [0.04, 0.0, 0.0, 0.09]
    outs = np.array([differential_kinematics(STATE * 0, TWO, 1.0, True, alpha)[:, 0] for _ in range(4000)])
    assert outs[:, 0].std() == pytest.approx(0.2, rel=0.1)
    assert outs[:, 2].std() == pytest.approx(0.15, rel=0.1)


def test_functions_by_drive() -> None:
    assert kinematics_factory == {
        "diff": differential_kinematics,
        "acker": ackermann_kinematics,
        "omni": omni_kinematics,
    }
