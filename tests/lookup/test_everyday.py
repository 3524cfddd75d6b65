"""`irsim describe` by the words people use."""

from __future__ import annotations

import pytest

from irsim.lookup import Answer, as_brief_text, as_text, lookup
from irsim.lookup.full_text import words_of
from irsim.lookup.guides import GUIDES
from irsim.lookup.synonyms import EVERYDAY, named
from irsim.options.registry import BEHAVIORS
from irsim.scenario.model.json_schema import json_schema

pytestmark = pytest.mark.one_python

SCHEMA = json_schema()
MEANT = {
    "lidar": "robot.sensors.lidar2d",
    "laser": "robot.sensors.lidar2d",
    "Laser scanner": "robot.sensors.lidar2d",
    "lidar scanner": "robot.sensors.lidar2d",
    "360 degree lidar": "robot.sensors.lidar2d",
    "range finder": "robot.sensors.lidar2d",
    "doppler": "robot.sensors.fmcw_lidar2d",
    "bumper": "robot.sensors.bumper",
    "camera": "camera",
    "car": "robot.kinematics.acker",
    "ackermann": "robot.kinematics.acker",
    "bicycle model": "robot.kinematics.acker",
    "differential drive": "robot.kinematics.diff",
    "unicycle": "robot.kinematics.diff",
    "omnidirectional": "robot.kinematics.omni",
    "holonomic": "robot.kinematics.omni",
    "freeze": "crowd-stops",
    "frozen crowd": "crowd-stops",
    "crowd that does not freeze": "crowd-stops",
    "interrupt": "interrupted",
    "ctrl-c": "interrupted",
    "Ctrl+C": "interrupted",
    "resume": "interrupted",
    "--resume": "interrupted",
    "2.12": "differences",
    "IR-SIM 2.12": "differences",
    "how to cite": "cite",
    "submission": "audit",
    "unknown cells": "unknown-cells",
    "pedestrian": "robot.behavior.sfm",
    "social force": "robot.behavior.sfm",
    "social force model": "robot.behavior.sfm",
    "orca": "robot.behavior.orca",
    "rvo": "robot.behavior.rvo",
    "reciprocal velocity obstacles": "robot.behavior.rvo",
    "collision avoidance": "robot.behavior.orca",
    "controller": "robot.behavior",
    "wander": "robot.behavior.dash.wander",
    "roam": "robot.behavior.dash.wander",
    "patrol": "robot.behavior.dash.loop",
    "goal": "robot.goal",
    "destination": "robot.goal",
    "waypoints": "robot.waypoints",
    "via points": "robot.waypoints",
    "start position": "robot.state",
    "path planning": "robot.behavior.follow.planner",
    "A*": "robot.behavior.follow.planner.astar",
    "RRT*": "robot.behavior.follow.planner.rrt_star",
    "dijkstra": "robot.behavior.follow.planner.astar",
    "wall": "robot.shape.linestring",
    "disc": "robot.shape.circle",
    "triangle": "robot.shape.polygon",
    "box": "robot.shape.rectangle",
    "radius": "robot.shape.circle.radius",
    "map": "world.obstacle_map",
    "occupancy grid": "world.obstacle_map",
    "floor plan": "world.obstacle_map.image",
    "noise": "robot.sensors.lidar2d.noise",
    "motion noise": "robot.kinematics.diff.noise",
    "seed": "world.seed",
    "random seed": "world.seed",
    "collision": "world.collision_mode",
    "crash": "world.collision_mode",
    "speed limit": "robot.vel_max",
    "top speed": "robot.vel_max",
    "time limit": "world.time_limit",
    "duration": "world.time_limit",
    "time step": "world.step_time",
    "dt": "world.step_time",
    "number of robots": "robot.number",
    "random positions": "robot.distribution.random",
    "field of view": "robot.fov",
    "goal_angle_threshold": "robot.arrive_mode",
    "heading tolerance": "robot.arrive_mode",
    "moving obstacle": "obstacle",
}


def led_to(answer: Answer) -> list[str]:
    """The topic of an answer, and the topics that it names."""
    return [answer.topic, *(key.name for keys in answer.groups.values() for key in keys), *answer.see]


@pytest.mark.parametrize("word", MEANT)
def test_an_everyday_word_leads_to_what_it_names(word: str) -> None:
    answer = lookup(word, schema=SCHEMA)
    assert MEANT[word] in led_to(answer)
    assert "Nothing about" not in answer.text


@pytest.mark.parametrize("word", ["lidar", "laser", "laser scanner", "360 degree lidar", "2d lidar", "lidar sensor"])
def test_the_sensor_comes_before_templates_that_have_one(word: str) -> None:
    (hits,) = lookup(word, schema=SCHEMA).groups.values()
    assert hits[0].name == "robot.sensors.lidar2d"
    assert hits[0].text


def test_a_frozen_crowd_is_explained_first() -> None:
    for words in ("freeze", "frozen crowd"):
        best = lookup(words, schema=SCHEMA).best
        assert (words, best and best.topic) == (words, "crowd-stops")


def test_the_law_of_people_says_which_options_it_needs_among_those_who_do_not_yield() -> None:
    assert "force_factor_social: 12, safety_radius: 0.5" in lookup("sfm", schema=SCHEMA).text
    assert "do not give way" not in lookup("orca", schema=SCHEMA).text


def test_the_differences_from_the_old_program_are_listed() -> None:
    (lines,) = lookup("2.12", schema=SCHEMA).groups.values()
    assert {"D1", "D26", "api-26"} <= {line.name for line in lines}


def test_every_topic_that_has_everyday_names_exists() -> None:
    for topic in EVERYDAY:
        assert topic in GUIDES or lookup(topic, schema=SCHEMA).topic == topic


def test_a_name_within_a_longer_one_is_not_meant() -> None:
    assert named("differential drive") == ["robot.kinematics.diff"]
    assert named("drive") == ["robot.kinematics"]
    assert named("nothing of the kind") == []


def test_names_are_given_once_in_lower_case() -> None:
    for topic, names in EVERYDAY.items():
        assert names == names.lower()
        single = [tuple(words_of(name)) for name in names.split(", ")]
        assert len(set(single)) == len(single), topic


def test_words_beside_a_name_that_say_nothing_are_told() -> None:
    answer = lookup("laser qwertz", schema=SCHEMA)
    assert answer.text == "Nothing about 'qwertz'."
    assert "robot.sensors.lidar2d" in led_to(answer)


@pytest.mark.parametrize("word", ["fmcw", "fmcw_lidar", "FMCW lidar"])
def test_the_beginning_of_a_name_that_only_one_component_has_is_that_component(word: str) -> None:
    assert lookup(word, schema=SCHEMA).title == "sensor fmcw_lidar2d"


@pytest.mark.parametrize("words", ["path must exist", "a path must exist", "a path to the goal exists", "reachable"])
def test_whether_a_path_exists_leads_to_the_finding_and_to_the_picture(words: str) -> None:
    answer = lookup(words, schema=SCHEMA)
    assert {"goal-unreachable", "pictures"} <= set(led_to(answer)[1:4])
    assert "overlays: [plan]" in lookup("pictures", schema=SCHEMA).text
    assert answer.best is not None
    assert answer.best.topic == "goal-unreachable"


def test_a_search_says_what_its_first_topic_says() -> None:
    answer = lookup("car avoids with orca", schema=SCHEMA)
    (hits,) = answer.groups.values()
    assert (hits[0].name, "robot.kinematics.acker" in [hit.name for hit in hits]) == ("avoidance", True)
    for text in (as_text(answer), as_brief_text(answer)):
        assert "use follow with local: {name: orca}, for cars too" in text


def test_a_whole_everyday_name_comes_before_texts_that_have_its_words() -> None:
    for words in ("laser scanner", "differential drive", "field of view"):
        (hits,) = lookup(words, schema=SCHEMA).groups.values()
        assert hits[0].name in EVERYDAY


def test_the_guide_to_avoidance_names_each_behavior_that_avoids_others() -> None:
    avoiding = [feature.name for feature in BEHAVIORS.features() if getattr(feature.options, "avoids", False)]
    assert len(avoiding) > 3
    assert {name for name in avoiding if name not in GUIDES["avoidance"].text} == set()
