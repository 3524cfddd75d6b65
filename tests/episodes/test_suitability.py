"""Which policy suits a scene, why another one does not, and the warning where one is used outside of its card."""

from __future__ import annotations

from pathlib import Path

import pytest

import irsim
from irsim import api
from irsim.bundled import templates
from irsim.episodes.suitability import Suited, suited_policies
from irsim.options.registry import BEHAVIORS
from irsim.policies.scene_cards import SCENE_CARDS
from irsim.policies.trained import trained_policies
from irsim.scenario.read import read

PILLARS = """\
obstacle:
  - number: 14
    shape: {name: circle, radius: 0.3}
    distribution: {name: random, range_low: [3, 1, 0], range_high: [17, 11, 0], min_distance: 1.5}
"""
WALL = "obstacle:\n  - {shape: {name: rectangle, length: 0.3, width: 6}, state: [6, 6, 0]}\n"
WALKER = """\
obstacle:
  - {kinematics: {name: omni}, state: [5, 1, 0], goal: [5, 11], behavior: {name: dash}}
"""


def scene(more: str = "", behavior: str = "orca", length: float = 11, number: str = "") -> str:
    return f"""\
world: {{width: 20, height: 12}}
robot:
  - kinematics: {{name: diff}}
    shape: {{name: circle, radius: 0.25}}
    state: [1, 6, 0]
    goal: [{1 + length}, 6]
    vel_max: [1, 2]
    vel_min: [-1, -2]
    behavior: {{name: {behavior}}}
    sensors: [{{name: lidar2d, range_max: 4, angle_range: 4.712389, number: 180}}]
{more}"""


def ranked(text: str) -> dict[str, Suited]:
    scenario = read(text).scenario
    assert scenario is not None
    return {one.policy: one for one in suited_policies(scenario)}


def test_every_policy_has_a_card() -> None:
    assert set(SCENE_CARDS) == {*trained_policies(), *BEHAVIORS.installed()} - {"replay"}


def test_a_policy_trained_without_obstacles_does_not_suit_a_hall_with_pillars() -> None:
    policies = ranked(scene(PILLARS))
    assert next(iter(policies)) == "orca"
    assert policies["orca"].fits == "yes"
    assert policies["multi_robot"].fits == "no"
    assert "was trained without static obstacles; this scene has 14 static obstacles" in policies["multi_robot"].reason
    assert policies["goal_lidar"].fits == "yes"  # it has learned with obstacles and a lidar
    assert policies["dash"].fits == "no"


def test_dash_suits_a_scene_whose_obstacles_leave_its_straight_way_free() -> None:
    """The verdict is what an episode shows."""
    post = "obstacle:\n  - {{shape: {{name: circle, radius: 0.3}}, state: [6, {}, 0]}}\n"
    aside, ahead = (scene(post.format(y), "dash") for y in (7, 6))
    assert (ranked(aside)["dash"].fits, irsim.run(text=aside).outcome) == ("yes", "success")
    assert (ranked(ahead)["dash"].fits, irsim.run(text=ahead).outcome) == ("no", "collision")
    assert ranked(ahead)["dash"].reason == "avoids nothing; this scene has 1 static obstacle on its straight ways"
    assert "14 static obstacles at places that each seed draws" in ranked(scene(PILLARS))["dash"].reason


def test_walls_on_the_way_ask_for_a_plan() -> None:
    policies = ranked(scene(WALL))
    best = next(iter(policies.values()))
    assert best.line == "behavior: {name: follow, local: orca}"
    assert "1 wall between a start and its goal" in policies["orca"].reason


def test_a_drive_or_a_lidar_that_is_missing_comes_last() -> None:
    policies = ranked(scene().replace("name: diff", "name: omni").replace("vel_max: [1, 2]", "vel_max: [1, 1]"))
    assert policies["goal_lidar"].fits == "cannot"
    assert "drives diff; this scene has omni" in policies["goal_lidar"].reason
    assert [one.fits for one in policies.values()] == sorted(
        (one.fits for one in policies.values()), key=["yes", "partly", "no", "cannot"].index
    )
    assert "needs a lidar" in ranked(scene().partition("    sensors")[0])["goal_lidar"].reason


def test_numbers_out_of_range_are_named_with_both_values() -> None:
    assert "straight ways of at most 13 m; this scene has 18 m" in ranked(scene(length=18))["goal_lidar"].reason


def test_the_line_of_the_best_policy_is_valid() -> None:
    for more in ("", PILLARS, WALL, WALKER):
        line = next(iter(ranked(scene(more)).values())).line
        assert not api.validate(text=scene(more).replace("behavior: {name: orca}", line)).errors


def test_sfm_among_people_who_do_not_give_way_gets_options_that_were_measured(tmp_path: Path) -> None:
    (item,) = [one for one in api.validate(text=scene(WALKER, "sfm")).findings if one.code == "policy-unsuited"]
    assert (item.severity, item.path, item.line, item.given) == ("warning", "robot[0].behavior", 9, 1)
    assert item.fix is not None
    assert item.fix.startswith("force_factor_social: 12, safety_radius: 0.5 ")
    advised = ranked(scene(WALKER, "sfm"))["sfm"].line
    mended = scene(WALKER, "sfm").replace("behavior: {name: sfm}", advised)
    assert not [one for one in api.validate(text=mended).findings if one.code == "policy-unsuited"]
    path = tmp_path / "crossing.yaml"
    path.write_text(templates.fill(templates.load("crossing-pedestrians")), encoding="utf-8")
    rows = irsim.benchmark(path, ["sfm", advised.removeprefix("behavior: ")], seeds=20, perturb="position=0.3").rows
    plain, better = (row.success.rate for row in rows)
    assert better == 1.0
    assert plain < 0.5


def test_a_trained_policy_outside_of_its_card_is_a_warning_wherever_it_is_chosen(tmp_path: Path) -> None:
    file = tmp_path / "hall.yaml"
    file.write_text(scene(PILLARS), encoding="utf-8")
    (item,) = [one for one in api.validate(file, policy="multi_robot").findings if one.code == "policy-unsuited"]
    assert (item.path, item.line, item.severity) == ("robot[0]", 3, "warning")
    assert "14 static obstacles" in item.message
    assert item.allowed == "no static obstacles"
    assert item.fix is not None
    assert "orca suits it better" in item.fix
    run = irsim.run(file, policy="multi_robot", seed=1, steps=1)
    assert "policy-unsuited" in [one.code for one in run.warnings]
    compared = irsim.benchmark(file, ["orca", "multi_robot"], seeds=1, steps=1)
    assert [one.message for one in compared.warnings[str(file)]] == [item.message]
    assert not [one for one in irsim.run(file, policy="goal_lidar", seed=1, steps=1).warnings if "policy" in one.code]


@pytest.mark.parametrize("name", templates.names())
def test_no_template_gets_the_warning(name: str) -> None:
    report = api.validate(text=templates.load(name).text)
    assert not [one for one in report.findings if one.code == "policy-unsuited"]
