"""An action beyond the limits of a drive is cut, and that is said once."""

from pathlib import Path

import numpy as np
import pytest

import irsim

YAML = """
world: {height: 10, width: 10}
robot:
  - {kinematics: {name: diff}, state: [1, 1, 0], shape: {name: circle, radius: 0.2}}
  - {kinematics: {name: diff}, state: [1, 5, 0], shape: {name: circle, radius: 0.2}, acce: [1, .inf]}
  - {kinematics: {name: acker}, state: [5, 5, 0], shape: {name: rectangle, length: 1, width: 0.5, wheelbase: 0.6}}
  - {kinematics: {name: acker, wheelbase: 0.4}, state: [5, 8, 0],
     shape: {name: rectangle, length: 1, width: 0.5, wheelbase: 0.6}}
"""


@pytest.fixture
def env(tmp_path: Path):
    path = tmp_path / "limits.yaml"
    path.write_text(YAML)
    env = irsim.make(path, headless=True)
    yield env
    env.end()


def test_it_is_said_once_per_object(env, capsys):
    env.step([1, 1])
    env.step(np.array([[0.1], [0.2]]), "robot_1")
    assert "cut" not in capsys.readouterr().out
    for _ in range(3):
        env.step([5, -5])
    told = capsys.readouterr().out
    assert told.count("is cut") == 1
    assert "robot_0: action [5, -5] is cut to the limits of its drive, now [-1, -1] to [1, 1]" in told
    assert env.robot.velocity.ravel().tolist() == [1, -1]


def test_acceleration_counts(env, capsys):
    env.step([0.1, 0], 1)
    assert "cut" not in capsys.readouterr().out
    env.step([1, 0], 1)
    assert "robot_1: action [1, 0] is cut" in capsys.readouterr().out
    assert env.robot_list[1].velocity[0, 0] == pytest.approx(0.2)


def test_the_wheelbase_of_an_object_is_that_of_its_shape(env):
    assert [robot.wheelbase for robot in env.robot_list] == [None, None, 0.6, 0.6]
    assert env.robot_list[3].kf.wheelbase == 0.4
    assert env.robot_list[3].info.wheelbase == 0.6


def test_the_resolution_of_a_map_is_a_number(env):
    with pytest.raises(TypeError, match=r"resolution of a map must be a number \[m\], got 'a'"):
        env.get_map("a")
