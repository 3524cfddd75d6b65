"""A thing that irsim does not have leads to the limits, and to what comes nearest."""

from __future__ import annotations

import pytest

from irsim.diagnostics.errors import ScenarioNotFoundError
from irsim.learning.tasks.files import TaskError, open_task
from irsim.lookup import lookup
from irsim.scenario.locate import locate


@pytest.mark.parametrize(
    ("asked", "nearest"),
    [
        ("camera", "fov"),
        ("webcam", "depth_scan"),
        ("compass", "robot.state"),
        ("legs", "omni_angular"),
        ("gripper", "world.collision_mode: contact"),
        ("drone", "omni"),
        ("stairs", "zone"),
    ],
)
def test_what_irsim_lacks_leads_to_the_limits_and_the_nearest_thing(asked: str, nearest: str) -> None:
    answer = lookup(asked)
    assert answer.kind == "guide"
    assert "irsim has no" in answer.text
    assert nearest in answer.text
    assert "limits" in answer.see


@pytest.mark.parametrize(
    ("asked", "sensor"),
    [
        ("wheel encoder", "odometry"),
        ("odometry", "odometry"),
        ("IMU", "imu"),
        ("GPS", "gnss"),
        ("amcl", "localization"),
        ("depth camera", "depth_scan"),
        ("ultrasonic", "sonar"),
        ("infrared", "ir_range"),
        ("bumper", "bumper"),
        ("cliff sensor", "cliff"),
        ("ultra-wideband", "uwb"),
    ],
)
def test_what_irsim_has_by_now_leads_to_it(asked: str, sensor: str) -> None:
    answer = lookup(asked)
    assert f"robot.sensors.{sensor}" in (
        answer.topic,
        *(key.name for keys in answer.groups.values() for key in keys),
        *answer.see,
    )


def test_space_is_a_limit() -> None:
    assert lookup("3D").topic == lookup("limits").topic == "limits"


@pytest.mark.parametrize("asked", ["suite", "suites"])
def test_a_suite_leads_to_the_suites(asked: str) -> None:
    assert lookup(asked).title.startswith("Suites")


def test_names_of_files_lead_to_the_right_neighbour(workspace: object) -> None:
    with pytest.raises(ScenarioNotFoundError, match="irsim templates"):
        locate("nope.yaml")
    with open("task.yaml", "w", encoding="utf-8") as file:
        file.write("task: mine\n")
    with pytest.raises(TaskError, match=r"did you mean task\.yaml\?"):
        open_task("tsk.yaml")
    with open("old.yaml", "w", encoding="utf-8") as file:
        file.write("task: mine\n")
    with pytest.raises(TaskError, match=r"did you mean goal_lidar\?"):
        open_task("goal_lidr")


def test_an_unknown_sensor_says_how_one_of_ones_own_is_found() -> None:
    assert "--import MODULE" in lookup("unknown-sensor").text


@pytest.mark.parametrize(
    ("asked", "title"),
    [
        ("lidr", "sensor lidar2d"),
        ("lidr range", "scan keys: keys of env.get_lidar_scan()"),
        ("orka", "behavior orca"),
        ("behavior rov", "behavior rvo"),
        ("sensor lidr2d", "sensor lidar2d"),
        ("robot.sensors.lidr2d", "sensor lidar2d"),
        ("step_tme", "world.step_time"),
        ("policy crwd", "trained policy crowd"),
    ],
)
def test_a_misspelt_word_leads_to_the_text_of_its_neighbour(asked: str, title: str) -> None:
    answer = lookup(asked)
    assert answer.title == title
    assert answer.read_as is not None
    assert answer.text


def test_a_word_without_a_neighbour_is_not_guessed() -> None:
    with pytest.raises(LookupError, match="is not a topic"):
        lookup("wifi")
    assert lookup("laser qwertz").read_as is None
