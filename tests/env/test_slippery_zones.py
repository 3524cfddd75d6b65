"""Zones whose ground lets wheels slip: the way of every drive by hand, one wheel on it, what odometry reports."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.components.kinematics._presets import SKID_STEER, SURFACES
from irsim.graphics.scene.zones import draw_zones
from irsim.runs.audit.audit import audit_runs
from irsim.scenario.model.zones import Zone
from irsim.testing import conformance

Make = Callable[..., Any]
EVERYWHERE = "rectangle: [-50, -50, 50, 50]"
LEFT = "rectangle: [-50, 0, 50, 50]"
"""The side on which the left wheel of a robot is that drives along y = 0."""


def scene(kinematics: str, zone: str, extra: str = "", sensor: str = "name: odometry") -> str:
    zones = f"zones: [{{name: wet, {zone}}}]" if zone else ""
    most = [9] * (3 if "omni_angular" in kinematics else 2)
    return (
        f"world: {{width: 100, height: 100, offset: [-50, -50], step_time: 0.05, integration: exact, {zones}}}\n"
        f"robot: {{kinematics: {{{kinematics}}}, shape: {{name: rectangle, length: 0.8, width: 0.6}}, vel_max: {most}, "
        f"vel_min: {[-one for one in most]}, state: [0, 0, 0], sensors: [{{{sensor}}}], {extra}}}\n"
    )


def drive(env: Any, control: Sequence[float], steps: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """(3,) pose and (3,) pose by odometry after some steps with one control."""
    for _ in range(steps):
        env.step(np.array(control, dtype=float)[:, None])
    robot = env.robot_list[0]
    return robot.state[:3, 0].copy(), robot.sensors[0].data[:3].copy()


STRAIGHT = {
    "name: diff": [1.0, 0.0],
    "name: omni": [1.0, 0.0],
    "name: omni_angular": [1.0, 0.0, 0.0],
    "name: acker, wheelbase: 0.5": [1.0, 0.0],
    "name: tricycle, wheelbase: 0.5": [1.0, 0.0],
    "name: skid_steer": [1.0, 0.0],
}


@pytest.mark.parametrize("kinematics", STRAIGHT)
def test_a_slip_of_a_fifth_leaves_four_fifths_of_the_way_and_odometry_reports_all(make: Make, kinematics: str) -> None:
    there, believed = drive(make(scene(kinematics, f"{EVERYWHERE}, slip: 0.2")), STRAIGHT[kinematics])
    assert there == pytest.approx([1.6, 0.0, 0.0], abs=1e-12)
    assert believed == pytest.approx([2.0, 0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize(
    "kinematics", ["name: single_track, model: kinematic", "name: single_track", "name: diff_dynamic"]
)
def test_drives_that_need_time_lose_a_fifth_of_what_they_would_drive(make: Make, kinematics: str) -> None:
    dry, all_of_it = drive(make(scene(kinematics, "")), [1.0, 0.0])
    wet, believed = drive(make(scene(kinematics, f"{EVERYWHERE}, slip: 0.2")), [1.0, 0.0])
    assert dry[0] > 1.0
    assert wet == pytest.approx(0.8 * dry, abs=1e-9)
    assert all_of_it == pytest.approx(dry, abs=1e-9)
    assert believed == pytest.approx(dry, abs=1e-9)


TURNS = {
    "name: diff": [1.0, 0.5],
    "name: omni_angular": [1.0, 0.4, 0.5],
    "name: acker, wheelbase: 0.5": [1.0, 0.3],
    "name: tricycle, wheelbase: 0.5": [1.0, 0.3],
    "name: skid_steer": [1.0, 0.5],
}


@pytest.mark.parametrize("kinematics", TURNS)
def test_both_wheels_on_it_drive_the_same_curve_and_odometry_reports_its_full_length(
    make: Make, kinematics: str
) -> None:
    dry, _ = drive(make(scene(kinematics, "")), TURNS[kinematics])
    wet, believed = drive(make(scene(kinematics, f"{EVERYWHERE}, slip: 0.2")), TURNS[kinematics], steps=50)
    late = 2 if "acker" in kinematics or "tricycle" in kinematics else 0  # the steering angle acts after the first step
    if not late:
        assert wet == pytest.approx(dry, abs=1e-9), "50 steps with 80 % of the way are 40 steps with all of it"
    else:
        rate = 0.8 * (math.tan(0.3) if "acker" in kinematics else math.sin(0.3)) / 0.5
        assert wet[2] == pytest.approx(rate * 0.05 * 49)
    full, _ = drive(make(scene(kinematics, "")), TURNS[kinematics], steps=50)
    assert believed == pytest.approx(full, abs=1e-6)


@pytest.mark.parametrize(
    ("kinematics", "track"), [("name: diff, track: 0.5", 0.5), ("name: diff", 0.6), ("name: skid_steer", 0.4)]
)
def test_one_wheel_on_it_turns_the_robot_on_a_circle_known_beforehand(
    make: Make, kinematics: str, track: float
) -> None:
    env = make(scene(kinematics, f"{LEFT}, slip: 0.2"))
    there, believed = drive(env, [1.0, 0.0], steps=1)
    turning = SKID_STEER["p3at"].values["believed_track"] if "skid" in kinematics else track
    rate = (1.0 - 0.8) / turning  # the right wheel drives 1 m/s, the left one 0.8 m/s: to the left
    assert there[2] == pytest.approx(0.05 * rate)
    assert math.hypot(there[0], there[1] - 0.9 / rate) == pytest.approx(0.9 / rate)
    assert believed == pytest.approx([0.05, 0.0, 0.0], abs=1e-12)


def test_a_robot_leaves_the_zone_as_it_came(make: Make) -> None:
    env = make(scene("name: diff", "rectangle: [1, -5, 2, 5], slip: 0.5"))
    there, believed = drive(env, [1.0, 0.0], steps=80)
    assert there[0] == pytest.approx(4.0 - 1.0, abs=0.06), "1 m of the way takes twice as long"
    assert believed[0] == pytest.approx(4.0)


def test_the_last_zone_of_a_place_counts(make: Make) -> None:
    text = scene("name: diff", f"{EVERYWHERE}, slip: 0.2}}, {{name: dry patch, {EVERYWHERE}, grip: 0.9")
    assert drive(make(text), [1.0, 0.0])[0][0] == pytest.approx(2.0)


def slips(text: str, steps: int, seed: int = 3) -> np.ndarray:
    """(K,) slip of the whole motion of an omnidirectional robot, from its way in each step."""
    simulation, _ = conformance.simulate(text, steps=0, seed=seed)
    x = []
    for _ in range(steps):
        simulation.impose(0, [0.02, 0.0])
        simulation.step()
        x.append(float(simulation.pose[0, 0]))
    return 1.0 - np.diff(x) / (0.02 * 0.05)


def test_slip_wanders_with_its_standard_deviation_and_its_time(make: Make) -> None:
    seen = slips(scene("name: omni", f"{EVERYWHERE}, slip: 0.5, slip_std: 0.05, slip_time: 0.5"), 60_000)
    assert seen.mean() == pytest.approx(0.5, abs=0.005)
    assert seen.var() == pytest.approx(0.05**2, rel=0.05)
    off = seen - seen.mean()
    after = [float((off[:-lag] * off[lag:]).mean() / off.var()) for lag in (5, 10)]
    assert -0.25 / math.log(after[0]) == pytest.approx(0.5, rel=0.1)
    assert -0.5 / math.log(after[1]) == pytest.approx(0.5, rel=0.1)
    white = slips(scene("name: omni", f"{EVERYWHERE}, slip: 0.5, slip_std: 0.05, slip_time: 0"), 20_000)
    assert abs(np.corrcoef(white[:-1], white[1:])[0, 1]) < 0.03
    assert white.std() == pytest.approx(0.05, rel=0.03)


def test_wheels_slip_on_their_own_and_seeds_repeat_it(make: Make) -> None:
    text = scene("name: diff", f"{EVERYWHERE}, slip: 0.3, slip_std: 0.1, slip_time: 0.2")
    paths = [drive(make(text, seed=seed), [1.0, 0.0])[0] for seed in (1, 1, 2)]
    np.testing.assert_array_equal(paths[0], paths[1])
    assert abs(paths[0][2] - paths[2][2]) > 1e-4
    assert abs(paths[0][2]) > 1e-4


def test_a_new_episode_begins_without_what_slipped_before(make: Make) -> None:
    env = make(scene("name: diff", f"{EVERYWHERE}, slip: 0.2"))
    drive(env, [1.0, 0.0])
    env.reset()
    there, believed = drive(env, [1.0, 0.0])
    assert there[0] == pytest.approx(1.6)
    assert believed[0] == pytest.approx(2.0)


def test_a_snapshot_holds_the_slip(make: Make) -> None:
    env = make(scene("name: diff", f"{EVERYWHERE}, slip: 0.3, slip_std: 0.1"), seed=5)
    drive(env, [1.0, 0.2])
    kept = env.snapshot()
    first = drive(env, [1.0, 0.2])
    env.restore(kept)
    again = drive(env, [1.0, 0.2])
    np.testing.assert_array_equal(first, again)


def test_less_grip_brakes_a_robot_with_motors_over_a_longer_way(make: Make) -> None:
    drive_of = "name: diff_dynamic, friction: 0.8, torque_max: null, voltage: null, drag: 0.0, response: 0.01"
    env = make(scene(drive_of, f"{EVERYWHERE}, grip: 0.25", "acce: [.inf, .inf]"))
    for _ in range(200):
        env.step(np.array([[2.0], [0.0]]))
    start = env.robot_list[0].state[0, 0]
    speed = env.robot_list[0].state[3, 0] * 0.08
    assert speed == pytest.approx(2.0, abs=1e-3)
    for _ in range(60):
        env.step(np.array([[0.0], [0.0]]))
    assert env.robot_list[0].state[0, 0] - start == pytest.approx(speed**2 / (2 * 0.8 * 0.25 * 9.81), rel=0.02)


def test_wheels_that_pull_hard_turn_faster_than_the_body_drives(make: Make) -> None:
    drive_of = "name: diff_dynamic, torque_max: 1.0, voltage: null, drag: 0.0, friction: 0.5, slip_stiffness: 10.0"
    env = make(scene(drive_of, "", "acce: [.inf, .inf]"))
    there, believed = drive(env, [9.0, 0.0], steps=20)
    force, borne = 1.0 / 0.08, 0.5 * 10.0 / 2 * 9.81  # of each wheel [N]
    assert there[0] == pytest.approx(0.5 * 2 * force / 10.0 * 1.0**2, rel=1e-6)
    assert believed[0] == pytest.approx(there[0] / (1 - math.atanh(force / borne) / 10.0), rel=1e-6)
    end, after = drive(env, [0.0, 0.0], steps=10)
    assert after[0] - believed[0] < 0.97 * (end[0] - there[0]), "and wheels that brake turn slower"


def test_a_car_on_ice_cannot_turn_faster_than_its_tyres_hold(make: Make) -> None:
    sideways = []  # acceleration to the side [m/s^2]
    for grip in (1.0, 0.15):
        env = make(scene("name: single_track", f"{EVERYWHERE}, grip: {grip}"))
        drive(env, [3.0, 0.25], steps=80)
        _, _, _, _, speed, yaw_rate, _ = env.robot_list[0].state[:, 0]
        sideways.append(speed * yaw_rate)
    assert sideways[0] > 5
    assert 1.0 < sideways[1] < 1.25 * 0.15 * 1.0489 * 9.81, "its friction times the grip"


def test_a_surface_changes_where_skid_steering_turns(make: Make) -> None:
    dry, believed = drive(make(scene("name: skid_steer", "")), [0.0, 0.5])
    grass, told = drive(make(scene("name: skid_steer", f"{EVERYWHERE}, surface: grass")), [0.0, 0.5])
    values, robot = SURFACES["grass"].values, SKID_STEER["p3at"].values
    assert dry[2] == pytest.approx(1.0)
    assert grass[2] == pytest.approx(values["traction"] * robot["believed_track"] / (robot["track"] * values["spread"]))
    assert believed[2] == pytest.approx(1.0)
    assert told[2] == pytest.approx(1.0), "the wheels turn as before"
    everywhere, _ = drive(make(scene("name: skid_steer, surface: grass", "")), [0.0, 0.5])
    assert everywhere[2] == pytest.approx(grass[2])


def test_a_controller_that_takes_the_wheels_for_wheels_of_diff_reports_too_much_turning(make: Make) -> None:
    there, believed = drive(make(scene("name: skid_steer, believed_track: 0.4, icr_ahead: 0.1", "")), [0.0, 0.5])
    assert believed == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)
    assert believed[2] / there[2] == pytest.approx(1.4662, rel=1e-3)
    assert np.hypot(*there[:2]) > 0.05, "the body slides sideways, which no wheel measures"


def test_no_wheel_measures_the_slide_of_a_car(make: Make) -> None:
    env = make(scene("name: single_track", ""))
    there, believed = drive(env, [3.0, 0.3], steps=60)
    assert believed[2] == pytest.approx(there[2], abs=1e-6)
    assert np.hypot(*(believed - there)[:2]) > 0.03


@pytest.mark.parametrize("name", SURFACES)
def test_numbers_of_grounds_say_their_source(name: str) -> None:
    ground = SURFACES[name]  # type: ignore[index]
    assert ground.unverified != ("read 20" in ground.source)


@pytest.mark.parametrize("kinematics", ["name: diff", "name: skid_steer", "name: single_track"])
def test_a_zone_elsewhere_changes_no_bit(make: Make, kinematics: str) -> None:
    ends = [
        np.concatenate(drive(make(scene(f"{kinematics}, noise: true", zone), seed=9), [1.0, 0.3]))
        for zone in ("", "rectangle: [20, 20, 30, 30], slip: 0.5, slip_std: 0.1, grip: 0.2, surface: sand")
    ]
    np.testing.assert_array_equal(ends[0], ends[1])


def test_messages_tell_how_fast_the_body_is(make: Make) -> None:
    env = make(scene("name: diff", f"{EVERYWHERE}, slip: 0.2"))
    drive(env, [1.0, 0.5])
    twist = env.get_msg().objects[0].odom.twist.twist
    assert (twist.linear.x, twist.angular.z) == pytest.approx((0.8, 0.4))


def test_a_batch_slips_as_single_worlds_do(tmp_path: Path) -> None:
    ground = f"{EVERYWHERE}, slip: 0.3, slip_std: 0.1, slip_time: 0.3"
    text = scene("name: diff", ground, "goal: [20, 5], behavior: {name: dash}")
    (tmp_path / "scenario.yaml").write_text(text, encoding="utf-8")
    alone = [conformance.simulate(text, steps=50, seed=seed)[1][-1, 0] for seed in (4, 5, 6)]
    together = irsim.batch(tmp_path / "scenario.yaml", 3, seeds=[4, 5, 6], threads=2)
    together.advance(50)
    np.testing.assert_array_equal(together.simulation.pose.reshape(3, 3), alone)
    assert len({tuple(pose) for pose in alone}) == 3


def test_an_audit_recomputes_slip_but_for_steps_on_the_edge_of_the_ground(workspace: Path) -> None:
    text = scene("name: diff", "rectangle: [1, -1, 2, 1], slip: 0.2", "goal: [4, 0], behavior: {name: dash}").replace(
        "vel_max: [9, 9]", "vel_max: [1, 1]"
    )
    assert irsim.run(text=text, seed=1, record="kept").outcome == "success"
    audit = audit_runs(["kept"]).runs[0]
    assert audit.equal, audit.findings
    motion = {part.name: part for part in audit.checks}["motion"]
    assert motion.compared > 80
    assert motion.note == "2 steps left out: a wheel is, or was, on the edge of ground on which it slips"


def test_pictures_name_the_ground() -> None:
    zone = Zone(name="wet", rectangle=[0, 0, 1, 1], slip=0.2, grip=0.5, surface="sand")
    assert [one.text for one in draw_zones([zone], "k", (0, 9, 0, 9)).labels] == ["wet: slip 20%, grip 0.5, sand"]
