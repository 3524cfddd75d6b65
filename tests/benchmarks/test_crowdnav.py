"""The suite crowdnav_circle_v1: its facts, and episodes that must stay as they are."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from irsim.benchmarks.suite import load_suite
from irsim.benchmarks.suite_plan import suite_plan
from irsim.env import Env
from irsim.scenario.open import read_scenario
from tests.benchmarks.crowdnav.write import FILE, rows

LINES = FILE.read_text(encoding="utf-8").splitlines()[1:]
SUITE = "crowdnav_circle_v1"
ROOT = Path(__file__).resolve().parents[2]


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
    page = ROOT / "skills" / "irsim-benchmark" / "results" / "crowdnav.md"
    text = page.read_text(encoding="utf-8")
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
