"""Controls on their way to motors: drives, latency, slip, noise."""

from __future__ import annotations

import math

import numpy as np
import pytest

from irsim.bridges.mujoco.rays import LidarComparison
from irsim.bridges.mujoco.robots import Driver, rig_of, steering_of
from irsim.components.bridges.mujoco import Mujoco
from tests.bridges.scenes import gallery, motion_of, state_of

NAMES = ("rover", "slider", "turner", "car")


def driver(**options: float) -> Driver:
    scene = gallery()
    rigs = tuple(rig_of(scene.agent(name)) for name in NAMES)
    return Driver(NAMES, (0, 1, 2, 3), rigs, Mujoco(**options), np.random.default_rng(0))  # type: ignore[arg-type]


def test_targets_of_each_drive() -> None:
    drive, scene = driver(), gallery()
    wanted = {"rover": (0.8, 0.5), "slider": (0.3, -0.2), "turner": (0.1, 0.2, 0.3), "car": (1.0, 0.4)}
    drive.command(motion_of(scene, state_of(scene), **wanted))
    targets = drive.targets(0.0)
    rig, car = drive.rigs[0], drive.rigs[3]
    assert targets[0] == pytest.approx((0.8 - 0.5 * rig.half_track) / rig.wheel_radius)
    assert targets[1] == pytest.approx((0.8 + 0.5 * rig.half_track) / rig.wheel_radius)
    assert targets[2:7] == pytest.approx([0.3, -0.2, 0.1, 0.2, 0.3])
    rate = math.tan(0.4) / 3
    assert targets[7:9] * car.wheel_radius == pytest.approx([1 - rate * car.half_track, 1 + rate * car.half_track])
    assert targets[9:] == pytest.approx(steering_of(car, 0.4))


def test_the_inner_wheel_of_a_car_turns_more_and_both_point_at_one_center() -> None:
    rig = rig_of(gallery().agent("car"))
    for angle in (0.2, -0.7, 1.2):
        left, right = steering_of(rig, angle)
        assert (abs(left) > abs(right)) == (angle > 0)
        center = 3.0 / math.tan(angle)
        assert math.tan(left) * (center - rig.half_track) == pytest.approx(3.0)
        assert math.tan(right) * (center + rig.half_track) == pytest.approx(3.0)
    assert steering_of(rig, 0.0) == (0.0, 0.0)


def test_a_car_keeps_its_steering_while_it_stands() -> None:
    drive, scene = driver(), gallery()
    drive.command(motion_of(scene, state_of(scene), car=(1.0, 0.4)))
    turned = drive.targets(0.0)[-2:].copy()
    drive.command(motion_of(scene, state_of(scene, step=1), car=(0.0, 0.4)))
    assert drive.targets(0.1)[-2:] == pytest.approx(turned)


def test_commands_arrive_after_the_latency() -> None:
    drive, scene = driver(latency=0.25), gallery()
    for step in range(4):
        drive.command(motion_of(scene, state_of(scene, step=step), slider=(0.1 * (step + 1), 0.0)))
    speeds = [float(drive.targets(time)[2]) for time in (0.0, 0.24, 0.25, 0.34, 0.35, 0.55)]
    assert speeds == pytest.approx([0.0, 0.0, 0.1, 0.1, 0.2, 0.4])
    drive.forget()
    assert not drive.targets(9.0).any()


def test_slip_takes_a_share_of_the_speed_of_each_wheel() -> None:
    drive, scene = driver(slip=0.4), gallery()
    shares = []
    for step in range(200):
        drive.command(motion_of(scene, state_of(scene, step=step), rover=(1.0, 0.0)))
        shares.append(drive.targets(step * 0.1)[:2] * drive.rigs[0].wheel_radius)
    ratios = np.array(shares)
    assert ((ratios >= 0.6) & (ratios <= 1)).all()
    assert ratios.mean() == pytest.approx(0.8, abs=0.02)
    assert abs(np.corrcoef(ratios.T)[0, 1]) < 0.2


def test_comparison_of_lidars_counts_what_only_one_has_hit() -> None:
    comparison = LidarComparison()
    ours = {"a/0": np.array([1.0, 2.0, np.inf, np.inf], dtype=np.float32), "b/0": np.ones(3, dtype=np.float32)}
    theirs = {"a/0": np.array([1.004, 2.0, 3.0, np.inf], dtype=np.float32)}
    comparison.add(ours, theirs)
    assert (comparison.beams, comparison.one_sided) == (2, 1)
    assert comparison.largest == pytest.approx(0.004, rel=1e-3)
    assert comparison.quantile(0.5) == 0.0
    assert comparison.quantile(1.0) == pytest.approx(0.004, rel=1e-3)


def test_without_mujoco_the_error_names_the_command(monkeypatch: pytest.MonkeyPatch) -> None:
    from irsim.bridges.mujoco.bridge import make
    from irsim.common import extras

    monkeypatch.setattr(extras, "find_spec", lambda name: None)
    with pytest.raises(extras.ExtraError, match=r"pip install 'irsim-mcp\[mujoco\]'"):
        make(Mujoco())
