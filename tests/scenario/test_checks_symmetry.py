"""Starts that are too symmetric, and cars whose steps are longer than their goals are wide."""

from __future__ import annotations

import pytest

import irsim
from irsim.results.findings import Finding


def reports(text: str, code: str = "exact-symmetry") -> list[Finding]:
    return [finding for finding in irsim.validate(text=text).findings if finding.code == code]


def pair(behavior: str, starts: str, goals: str, tops: tuple[float, float] = (1.0, 1.0)) -> str:
    entries = "".join(
        f"  - {{kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.2}}, state: {start}, goal: {goal}, "
        f"vel_max: [{top}, {top}], vel_min: [{-top}, {-top}], behavior: {{{behavior}}}}}\n"
        for start, goal, top in zip(starts.split(";"), goals.split(";"), tops, strict=True)
    )
    return f"world: {{width: 20, height: 10}}\nrobot:\n{entries}"


HEAD_ON = "[1, 5, 0];[12, 5, 3.14]", "[12, 5];[1, 5]"
BEHIND = "[1, 5, 0];[3, 5, 0]", "[15, 5];[18, 5]"
DRAWN = "robot: {number: 6, distribution: {name: random}, kinematics: {name: omni}, behavior: {name: orca}}"


@pytest.mark.parametrize(
    "behavior", ["name: orca%s", "name: rvo%s", "name: sfm%s", "name: follow, local: {name: orca%s}"]
)
@pytest.mark.parametrize(("sidestep", "reported"), [("", False), (", sidestep: 10", False), (", sidestep: 0", True)])
def test_head_on_is_reported_only_where_ties_are_left(behavior: str, sidestep: str, reported: bool) -> None:
    assert bool(reports(pair(behavior % sidestep, *HEAD_ON))) == reported


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        (pair("name: avocado, sidestep: 0", *HEAD_ON), False),  # its noise chooses a side
        (pair("name: avocado, noise: 0, sidestep: 0", *HEAD_ON), True),
        (pair("name: orca", "[1, 5, 0];[12, 5.2, 3.14]", "[12, 5];[1, 5.2]"), False),  # they pass beside each other
        (pair("name: orca", *BEHIND, tops=(1.0, 0.4)), True),  # it catches up with a slower one
        (pair("name: orca", *BEHIND, tops=(1.0, 1.0)), False),
        (pair("name: orca", *BEHIND, tops=(1.0, 0.95)), False),
        (DRAWN, False),
    ],
)
def test_only_starts_that_stay_symmetric_are_reported(text: str, reported: bool) -> None:
    assert bool(reports(text)) == reported


@pytest.mark.parametrize("law", ["rvo", "sfm"])
def test_cars_that_would_not_pass_are_told_of_the_behavior_that_does(law: str) -> None:
    text = pair(f"name: {law}", *HEAD_ON).replace("omni", "acker")
    [finding] = reports(text)
    assert "'follow' with 'local: {name: footprint_orca}'" in (finding.fix or "")
    cured = text.replace(f"name: {law}", "name: follow, local: {name: footprint_orca}")
    assert not reports(cured)
    assert irsim.run(text=cured, seed=0).outcome == "success"


RING = (
    "world: {{width: 26, height: 26, time_limit: 100}}\nrobot:\n  - {{number: {count}, kinematics: {{{drive}}}, "
    "distribution: {{name: circle, center: [13, 13], radius: 9}}, vel_max: [1, 1], vel_min: [-1, -1], "
    "shape: {{name: circle, radius: 0.2}}, goal_threshold: 0.3, behavior: {{{behavior}}}}}\n"
)


@pytest.mark.parametrize("law", ["rvo", "sfm"])
@pytest.mark.parametrize("count", [3, 4, 8])
def test_what_is_said_to_rings_of_cars_lets_them_pass(law: str, count: int) -> None:
    """Under ``orca`` four of these cars stand for ever."""
    drive, cure = "name: acker, wheelbase: 1", "name: follow, local: {name: footprint_orca}"
    text = RING.format(count=count, drive=drive, behavior=f"name: {law}")
    [finding] = reports(text)
    assert "footprint_orca" in (finding.fix or "")
    assert irsim.run(text=RING.format(count=count, drive=drive, behavior=cure), seed=0).outcome == "success"


@pytest.mark.parametrize("drive", ["name: diff", "name: omni"])
@pytest.mark.parametrize("count", [8, 9, 16, 20])
def test_rings_under_social_forces_are_reported_where_they_stand(drive: str, count: int) -> None:
    text = RING.format(count=count, drive=drive, behavior="name: sfm")
    stands = irsim.run(text=text, seed=0).outcome != "success"
    assert bool(reports(text)) == stands == (count > 9)
    cured = text.replace("name: sfm", "name: footprint_orca")
    assert not reports(cured)
    assert irsim.run(text=cured, seed=0).outcome == "success"


@pytest.mark.parametrize(
    ("behavior", "words", "end"),
    [
        ("name: orca", "trails it", "trails"),
        ("name: follow, local: {name: orca}", "trails it", "trails"),
        ("name: follow, local: {name: sfm}", None, "passes"),
        ("name: sfm", None, "passes"),
        ("name: sfm, sidestep: 0", "trails it", "trails"),
        ("name: sfm, sidestep: 0, keep_gap: false", "drives into it", "collides"),
        ("name: rvo", None, "passes"),
        ("name: follow, local: {name: rvo}", None, "passes"),
    ],
)
def test_what_is_said_of_one_behind_a_slower_one_is_what_it_does(behavior: str, words: str | None, end: str) -> None:
    text = pair(behavior, *BEHIND, tops=(1.0, 0.4))
    messages = [finding.message for finding in reports(text)]
    assert len(messages) == (words is not None)
    assert words is None or words in messages[0]
    first = irsim.run(text=text, seed=0).robots[0]
    slow_time = 12 / 0.4  # the one ahead needs this long to the goal of the one behind
    arrived = first.time_to_goal
    passes = arrived is not None and arrived < 0.8 * slow_time
    assert ("collides" if first.outcome == "collision" else "passes" if passes else "trails") == end


def car(threshold: float, reverse: bool) -> str:
    return (
        "world: {width: 80, height: 60, time_limit: 60}\nrobot:\n  - kinematics: {name: acker, wheelbase: 2.6}\n"
        "    shape: {name: rectangle, length: 4.4, width: 1.8, wheelbase: 2.6}\n    state: [10, 10, 0.3]\n"
        f"    goal: [52.3, 17.4]\n    vel_max: [4, 0.5]\n    vel_min: [{-4 if reverse else 0}, -0.5]\n"
        f"    goal_threshold: {threshold}\n    behavior: {{name: follow, local: {{name: orca}}}}\n"
        "obstacle: {shape: {name: rectangle, length: 1, width: 20}, state: [30, 10, 0]}\n"
    )


def test_a_car_on_a_route_is_warned_of_a_goal_narrower_than_its_step() -> None:
    for reverse, words in ((True, "shunt"), (False, "never get to its goal")):
        [overshoot] = reports(car(0.1, reverse), "goal-overshoot")
        assert overshoot.severity == "warning"
        assert words in overshoot.message
    [overshoot] = reports(car(0.39, True), "goal-overshoot")
    assert (overshoot.severity, overshoot.fix) == (
        "warning",
        "goal_threshold: 0.4 or more, a smaller step_time, or a lower vel_max",
    )
    assert not reports(car(0.4, True), "goal-overshoot")


def test_the_summary_says_how_long_a_car_shunted_at_its_goal() -> None:
    assert "to and fro at the goal" in irsim.run(text=car(0.1, True), seed=0).summary
    assert "no nearer than" in irsim.run(text=car(0.1, False), seed=0).summary
    assert "to and fro" not in irsim.run(text=car(0.3, True), seed=0).summary


def test_a_tour_past_its_last_goal_is_no_shunting() -> None:
    tour = car(0.3, True).replace("goal: [52.3, 17.4]", "waypoints: [[25, 16], [18, 24], [10.5, 10.5]]")
    result = irsim.run(text=tour.replace("threshold: 0.3", "threshold: 1"), seed=0)
    assert result.outcome == "success"
    assert result.sim_time > 8
    assert "to and fro" not in result.summary


@pytest.mark.parametrize("count", [3, 4, 5])
@pytest.mark.parametrize("behavior", ["name: orca", "name: rvo", "name: sfm"])
def test_a_ring_whose_ties_are_left_is_reported_once(behavior: str, count: int) -> None:
    text = (
        f"world: {{width: 12, height: 12}}\nrobot:\n  - {{number: {count}, kinematics: {{name: omni}}, "
        "distribution: {name: circle, center: [6, 6], radius: 4}, vel_max: [1, 1], vel_min: [-1, -1], "
        "shape: {name: circle, radius: 0.25}, behavior: {BEHAVIOR}}\n"
    )
    counts = [
        len(reports(text.replace("BEHAVIOR", behavior + more))) for more in ("", ", sidestep: 0", ", sidestep: 10")
    ]
    assert counts == [0, 1, 0]
