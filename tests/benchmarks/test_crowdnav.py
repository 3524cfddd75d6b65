"""The suite crowdnav_circle_v1: its facts, and episodes that must stay as they are."""

from __future__ import annotations

import csv
import math
from itertools import islice
from pathlib import Path

import pytest
import yaml

from irsim.benchmarks.suite import load_suite
from irsim.benchmarks.suite_plan import suite_plan
from irsim.env import Env
from irsim.scenario.open import read_scenario
from tests.benchmarks.crowdnav import changes, same_scenes, with_rvo2
from tests.benchmarks.crowdnav.write import FILE, rows

LINES = FILE.read_text(encoding="utf-8").splitlines()[1:]
EPISODES_OF_RVO2 = list(csv.DictReader((with_rvo2.FOLDER / "rvo2.csv").read_text(encoding="utf-8").splitlines()))
SUITE = "crowdnav_circle_v1"
PAGE = Path(__file__).resolve().parents[2] / "skills" / "irsim-benchmark" / "results" / "crowdnav.md"


def recorded(seeds: range) -> list[str]:
    return [line for line in LINES if int(line.split(",")[1]) in seeds]


def test_the_first_episodes_of_every_scenario_are_those_on_record() -> None:
    assert rows(seeds=2) == recorded(range(1000, 1002))


@pytest.mark.slow
def test_all_episodes_on_record_are_repeated() -> None:
    assert rows() == LINES


def test_the_record_has_every_outcome() -> None:
    """So that the test above notices changes in each of them."""
    outcomes = {line.split(",")[2] for line in LINES}
    assert outcomes == {"success", "collision", "timeout", "placement-crowded"}


def test_the_page_of_results_is_about_this_suite() -> None:
    text = PAGE.read_text(encoding="utf-8")
    plan = suite_plan(SUITE, full=True)
    assert f"hash {plan.hash} " in text
    assert [name.name for name in plan.scenarios if f"| {name.name} | " not in text] == []


def test_its_scenes_are_those_of_crowdnav() -> None:
    suite, _ = load_suite(SUITE)
    assert (suite.seeds.full, suite.until, suite.steps) == (500, "first_collision", 100)
    plan = suite_plan(SUITE, full=True)
    assert len(plan.scenarios) == 16
    for scenario in plan.scenarios:
        data = yaml.safe_load(scenario.text)
        (robot,), (people,) = data["robot"], data["obstacle"]
        assert (data["world"]["step_time"], data["world"]["time_limit"]) == (0.25, 25)
        assert (robot["state"][:2], robot["goal"], robot["goal_threshold"]) == ([0, -4], [0, 4], 0.3)
        assert robot["shape"] == people["shape"] == {"name": "circle", "radius": 0.3}
        assert robot["vel_max"] == people["vel_max"] == [1, 1]
        shape, sight = scenario.family.split("-")
        assert people["distribution"]["name"] == f"{shape}_crossing"
        assert people["number"] == int(scenario.name.rpartition("-")[2])
        own = yaml.safe_load(plan.policies["orca"])
        assert people["behavior"] == own | ({"target_roles": "obstacle"} if sight == "invisible" else {})


def test_people_who_do_not_see_the_robot_walk_as_if_it_were_not_there() -> None:
    """People make room for the robot in the visible scenes only, whatever it does."""

    def paths(name: str, behavior: str) -> list[list[float]]:
        (one,) = suite_plan(SUITE, scenarios=[name]).scenarios
        data = yaml.safe_load(one.text)
        data["robot"][0]["behavior"] = {"name": behavior}
        scenario, _ = read_scenario(text=yaml.safe_dump(data), strict=True)
        env = Env(scenario, seed=1000, display=False, log_level="ERROR")
        for _ in range(30):
            env.step()
        places = [one.state[:2, 0].tolist() for one in env.obstacle_list]
        env.end()
        return places

    assert paths("circle-invisible-5", "dash") == paths("circle-invisible-5", "orca")
    assert paths("circle-visible-5", "dash") != paths("circle-visible-5", "orca")


def test_the_page_has_what_the_program_with_rvo2_printed() -> None:
    """The program itself runs in an environment of its own, with a library that irsim does not need."""
    page = PAGE.read_text(encoding="utf-8")
    within, ends = [[row[f"outcome_{key}"] for row in EPISODES_OF_RVO2] for key in with_rvo2.LIMITS]
    times = [[float(row[f"time_{key}"]) for row in EPISODES_OF_RVO2] for key in with_rvo2.LIMITS]
    rows = {
        "rules of CrowdNav with RVO2, the 500 scenes of CrowdNav": (within, times[0]),
        "the same, contacts looked for at the end of each step only, limit 25 s": (ends, times[1]),
    }
    for name, (outcomes, seconds) in rows.items():
        success, collision, timeout, time = with_rvo2.summary(list(zip(outcomes, seconds, strict=True)))
        assert f"| {name} | {success:.3f} | {collision:.3f} | {timeout:.3f} | {time:.2f} s |" in page
    with (with_rvo2.FOLDER / "rvo2_scenarios.csv").open(encoding="utf-8") as file:
        kept = [row for row in csv.DictReader(file) if row["contacts"] == "within"]
    assert {row["scenario"] for row in kept} == {*with_rvo2.SCENARIOS}
    for row in kept:
        [line] = [line for line in page.splitlines() if line.startswith(f"| {row['scenario']} | ")]
        shown = [float(word) for word in line.rstrip(" |").rsplit("|", 1)[1].split("/")]
        exact = [float(row[key]) for key in ("success", "collision", "time")]
        assert shown == [pytest.approx(value, abs=0.00501) for value in exact], row["scenario"]


def test_irsim_has_the_outcomes_of_rvo2_in_the_scenes_of_crowdnav() -> None:
    seeds = range(with_rvo2.FIRST_SEED, with_rvo2.FIRST_SEED + 20)
    assert [one for one, _ in same_scenes.episodes(seeds)] == [same_scenes.kept()[seed][0] for seed in seeds]


@pytest.mark.slow
def test_irsim_has_the_outcome_of_rvo2_in_each_of_the_500_scenes(capsys: pytest.CaptureFixture[str]) -> None:
    same_scenes.main()
    row, compared = capsys.readouterr().out.splitlines()
    assert f"| irsim, the 500 scenes of CrowdNav {row}" in PAGE.read_text(encoding="utf-8")
    assert compared.startswith("same outcome as RVO2 in 500 of 500 episodes, same time in 216 of the 226")


def test_the_page_has_a_row_for_each_change() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert [name for name in changes.CHANGES if f"\n| {name} | " not in page] == []
    unchanged, _, wide = (line.rsplit(" | ", 3)[1:] for line in islice(changes.rows(seeds=8), 3))
    assert float(wide[0]) > float(unchanged[0])  # 0.2 m more distance


@pytest.mark.slow(60)
def test_the_rows_of_the_changes_are_derived_again() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert [line for line in changes.rows() if line not in page] == []


def test_a_person_keeps_its_velocity_within_a_step_and_takes_the_new_one_at_its_end() -> None:
    robot = with_rvo2.Disc((0.0, 0.0), (4.0, 0.0))
    person = with_rvo2.Disc((1.0, 0.7), (0.0, -4.0), velocity=(0.0, -1.0))
    # Relative to the robot at 1 m/s the person goes from (1, 0.7) to (0.75, 0.45), straight towards it.
    assert with_rvo2.between(robot, person, (1.0, 0.0)) == pytest.approx((0.75**2 + 0.45**2) ** 0.5)
    # It passes the origin between the ends: from (0.1, -0.1) by (-0.25, 0.25).
    near = with_rvo2.Disc((0.1, -0.1), (0.0, 0.0), velocity=(0.0, 1.0))
    assert with_rvo2.between(robot, near, (1.0, 0.0)) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("shape", ["circle", "square"])
def test_scenes_with_rvo2_keep_starts_and_goals_apart(shape: str) -> None:
    for seed in range(1000, 1010):
        discs = with_rvo2.scene(seed, 5, shape)
        assert len(discs) == 6
        for ends in ([one.place for one in discs], [one.goal for one in discs]):
            gaps = [math.dist(ends[i], ends[j]) for i in range(6) for j in range(i)]
            assert min(gaps) >= 0.8
        if shape == "circle":
            radii = [math.hypot(*one.place) for one in discs[1:]]
            assert all(abs(radius - 4) <= 0.5 * 2**0.5 for radius in radii)
            assert all(one.goal == (-one.place[0], -one.place[1]) for one in discs[1:])
