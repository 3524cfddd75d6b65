"""How alike foretold and recorded walks are: worked by hand, and equal to ordinary runs."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import irsim
from irsim.bridges.base import BridgeError
from irsim.bridges.pedestrians import cases as cutting
from irsim.bridges.pedestrians.cases import FORETOLD, SEEN, Cases, cases_of, read_cases
from irsim.bridges.pedestrians.comparison import compare_pedestrians
from irsim.bridges.pedestrians.imitation import RADIUS, goals_of, imitate, keep_velocity
from irsim.bridges.pedestrians.likeness import (
    contacts,
    displacement_errors,
    earth_movers_distance,
    likeness,
    nearest,
    speeds,
)
from irsim.bridges.pedestrians.tracks import PERIOD
from irsim.cli.bridge import bridge_app
from irsim.common.arrays import Floats
from irsim.diagnostics.errors import ArgumentError
from tests.bridges import crowds

pytestmark = pytest.mark.one_python


def crowd(*ways: tuple[int, Floats]) -> Cases:
    """Cases of people, each given by its first row and (K, 2) places."""
    rows = [
        (first + row, who, *place) for who, (first, way) in enumerate(ways) for row, place in enumerate(way.tolist())
    ]
    table = np.array(rows)
    return cases_of("made up", PERIOD * table[:, 0], table[:, 1], table[:, 2:])


def straight(x: float, y: float, vx: float, vy: float, count: int = 20) -> Floats:
    """(count, 2) places of one who walks straight at constant speed."""
    result: Floats = np.array([x, y]) + PERIOD * np.arange(count)[:, None] * np.array([vx, vy])
    return result


PAIR = ((0, straight(0, 0, 1, 0)), (0, straight(0, 30, 0.5, 0.5)))


def test_constant_velocity_on_a_straight_track_has_no_error() -> None:
    cases = crowd(*PAIR)
    assert len(cases) == 2
    assert displacement_errors(keep_velocity(cases), cases.truth) == pytest.approx((0, 0), abs=1e-9)


@pytest.mark.parametrize("behavior", ["dash", "orca", "sfm"])
@pytest.mark.parametrize("goal", ["recorded", "extrapolated"])
def test_behaviors_without_anybody_near_walk_on_straight(behavior: str, goal: str) -> None:
    cases = crowd((0, straight(0, 0, 1, 0, 30)), (0, straight(0, 300, 0.5, 0.5, 30)))
    walks = imitate(cases, {"name": behavior}, goals_of(cases, goal))  # type: ignore[arg-type]
    early = slice(0, 18)  # later cases come near the recorded end, where they stop
    np.testing.assert_allclose(walks[early], cases.truth[early], atol=1e-6)


def test_one_who_is_at_its_goal_stays() -> None:
    cases = crowd(*PAIR)
    walks = imitate(cases, {"name": "orca"}, cases.start + np.array([0.05, 0.0]))
    assert np.linalg.norm(walks - cases.start[:, None], axis=2).max() < 0.06


def test_an_offset_is_the_error() -> None:
    truth = np.zeros((5, FORETOLD, 2))
    assert displacement_errors(truth + np.array([3.0, 4.0]), truth) == (5.0, 5.0)
    late = truth.copy()
    late[:, -1, 0] = 6.0
    assert displacement_errors(late, truth) == (pytest.approx(0.5), 6.0)


def test_earth_movers_distance_of_shifted_samples_is_the_shift() -> None:
    values = np.random.default_rng(0).normal(size=200)
    assert earth_movers_distance(values, values) == 0
    assert earth_movers_distance(values, values + 0.7) == pytest.approx(0.7)
    assert earth_movers_distance(np.array([0.0, 1.0]), np.array([0.0, 0.0, 1.0, 3.0])) == pytest.approx(0.5)


def test_earth_movers_distance_is_the_mean_way_between_sorted_values() -> None:
    one, other = np.random.default_rng(1).random((2, 60))
    assert earth_movers_distance(one, other) == pytest.approx(np.abs(np.sort(one) - np.sort(other)).mean())
    assert earth_movers_distance(np.repeat(one, 3), other) == pytest.approx(earth_movers_distance(one, other))


def test_speeds_and_distances_of_the_recording_itself() -> None:
    cases = crowd((0, straight(0, 0, 1, 0)), (0, straight(0, 0.3, 1, 0)))
    itself = likeness(cases, cases.truth, radius=0.2)
    assert (itself.ade, itself.fde, itself.speed, itself.nearest, itself.contacts) == (0, 0, 0, 0, 1)
    np.testing.assert_allclose(speeds(cases, cases.truth), 1.0)
    np.testing.assert_allclose(nearest(cases, cases.truth), 0.3)
    assert contacts(cases, cases.truth, radius=0.1) == 0


def test_who_is_a_case() -> None:
    """20 rows without a gap, and another such person in the same rows."""
    long, short = straight(0, 0, 1, 0, 25), straight(0, 5, 1, 0, 19)
    assert len(crowd((0, long), (0, short))) == 0
    assert len(crowd((0, long), (3, straight(0, 5, 1, 0, 21)))) == 4  # rows 3 to 22, and 4 to 23, of both
    assert len(crowd((0, long), (4, straight(0, 5, 1, 0, 40)))) == 4
    gap = np.array(
        [[row, 0, row, 0] for row in range(30) if row != 15] + [[row, 1, row, 5] for row in range(30)], float
    )
    assert len(cases_of("gap", PERIOD * gap[:, 0], gap[:, 1], gap[:, 2:])) == 0


def test_a_case_knows_its_goal_and_those_around() -> None:
    walker, other, guest = straight(0, 0, 1, 0, 23), straight(0, 5, 1, 0, 20), straight(9, 9, -1, 0, 3)
    cases = crowd((0, walker), (0, other), (10, guest))
    assert len(cases) == 2
    np.testing.assert_allclose(cases.goal, [walker[-1], other[-1]])
    np.testing.assert_allclose(cases.seen[0], walker[:SEEN])
    np.testing.assert_allclose(cases.truth[1], other[SEEN:])
    ((_, others),) = cases.parts()
    assert others.shape == (2, 2, FORETOLD + 1, 2)
    np.testing.assert_allclose(others[0, 0], other[SEEN - 1 :])
    np.testing.assert_allclose(others[0, 1, 3:6], guest)
    assert np.isnan(others[0, 1, [0, 1, 2, *range(6, FORETOLD + 1)]]).all()


MEETING = (
    (0, straight(0, 0, 1.2, 0.05, 30)),
    (0, straight(14, 0.3, -1.1, 0, 30)),
    (4, straight(5, -6, 0, 1.0, 14)),
    (9, straight(4, 3, 0.3, -0.6, 12)),
)


@pytest.mark.parametrize("behavior", [{"name": "sfm"}, {"name": "orca", "timeHorizon": 3}, {"name": "dash"}])
def test_it_is_what_an_ordinary_scenario_with_replayed_people_does(behavior: dict[str, object]) -> None:
    cases = crowd(*MEETING)
    walks = imitate(cases, behavior, cases.goal)
    ((_, others),) = cases.parts()
    for case in (0, 5, len(cases) - 1):
        # a replayed person shows the velocity of the last leg at a recorded time, ours of the next
        error = np.linalg.norm(walks[case] - ordinary(cases, case, others[case], behavior), axis=1).max()
        assert error < (1e-9 if behavior["name"] == "dash" else 0.1)


def ordinary(cases: Cases, case: int, others: Floats, behavior: dict[str, object]) -> Floats:
    """(12, 2) places of a case in an ordinary scenario, in which the others are replayed."""
    speed = float(cases.mean_speed[case])
    body = {"kinematics": {"name": "omni"}, "shape": {"name": "circle", "radius": RADIUS}}
    own = {**behavior, **({"vmax": speed} if behavior["name"] == "sfm" else {})}
    state, goal, velocity = cases.start[case].tolist(), cases.goal[case].tolist(), cases.velocity[case].tolist()
    person = {"state": [*state, 0], "goal": goal, "velocity": velocity, "vel_max": [speed] * 2, "vel_min": [-speed] * 2}
    entries: list[dict[str, object]] = [{**body, **person, "behavior": own}]
    for one in others:
        rows = np.flatnonzero(np.isfinite(one[:, 0]))
        if len(rows) > 1:
            replay = {"name": "replay", "times": (PERIOD * rows).tolist(), "poses": one[rows].tolist()}
            entries.append({**body, "behavior": replay})
    world = {"width": 200, "height": 200, "offset": [-100, -100], "step_time": 0.1, "collision_mode": "unobstructed"}
    Path("ordinary.yaml").write_text(json.dumps({"world": world, "obstacle": entries}))
    env = irsim.make("ordinary.yaml", headless=True, log_level="ERROR")
    places = []
    for _ in range(FORETOLD):
        for _ in range(4):
            env.step()
        places.append(env.obstacle_list[0].state[:2, 0].copy())
    return np.array(places)


def test_results_do_not_depend_on_how_many_are_looked_at_together(monkeypatch: pytest.MonkeyPatch) -> None:
    cases = crowd(*MEETING)
    whole = imitate(cases, {"name": "sfm"}, cases.goal), nearest(cases, cases.truth)
    monkeypatch.setattr(cutting, "_PART", 1)
    assert len(list(cases.parts())) == len(cases)
    parts = imitate(cases, {"name": "sfm"}, cases.goal), nearest(cases, cases.truth)
    np.testing.assert_allclose(whole[0], parts[0], atol=1e-12)
    np.testing.assert_array_equal(whole[1], parts[1])


@pytest.mark.parametrize(
    ("behavior", "words"),
    [
        ("sfn", "behavior.name: 'sfn' is not a behavior. Fix: name: sfm"),
        ("replay", "does not lead people to a goal"),
        ("{name: sfm, gama: 3}", "Fix: rename it to 'gamma'"),
        ("{name: sfm, gamma: -3}", "'gamma' must be > 0, got -3"),
    ],
)
def test_behaviors_that_cannot_walk(behavior: str, words: str) -> None:
    Path("walk.txt").write_text(crowds.square())
    with pytest.raises(ArgumentError, match="bad-argument") as error:
        compare_pedestrians(["walk.txt"], [behavior])
    assert words in str(error.value)


def test_recordings_that_cannot_be_foretold() -> None:
    Path("short.txt").write_text(crowds.trajnet())
    with pytest.raises(BridgeError, match="no two people in short"):
        read_cases(Path("short.txt"))
    Path("crowd.vsp").write_text(crowds.vsp())
    with pytest.raises(BridgeError, match="has splines in pixels"):
        read_cases(Path("crowd.vsp"))


def test_the_command() -> None:
    Path("walk.txt").write_text(crowds.square())
    command = ["compare-pedestrians", "walk.txt", "--policies"]
    done = CliRunner().invoke(bridge_app, [*command, "dash,{name: orca, timeHorizon: 2}", "--json"])
    answer = json.loads(done.stdout)
    assert [(row["behavior"], row["goal"]) for row in answer["rows"]] == [
        ("constant velocity", ""),
        ("dash", "recorded"),
        ("dash", "extrapolated"),
        ("{name: orca, timeHorizon: 2}", "recorded"),
        ("{name: orca, timeHorizon: 2}", "extrapolated"),
    ]
    dash, orca = (answer["rows"][index]["likeness"] for index in (1, 3))
    assert answer["rows"][0]["likeness"]["ade"] < 0.01  # made-up people go straight at constant speed, rounded to mm
    assert orca["contacts"] < dash["contacts"]
    table = CliRunner().invoke(bridge_app, [*command, "dash", "--goal", "recorded"]).stdout
    assert "extrapolated" not in table
    assert f"{dash['ade']:.2f}" in table
