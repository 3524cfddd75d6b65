"""Pictures show no person who has not come yet or has left: no body, arrow, goal, name, trail or track."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import irsim
from irsim.env import Env
from irsim.graphics.scene.scene import Scene
from irsim.rendering.snapshot import legible_scene
from irsim.runs import open_run
from irsim.runs.replay.data import pack_run
from irsim.runs.resimulation import follow_record, scenario_of
from tests.env.driving import Make
from tests.runs.replay.reading import unpacked

SHOWN = (
    "plot: {show_trajectory: true, show_trail: true, show_goal: true, show_text: true, show_arrow: true, trail_freq: 1}"
)
SCENE = f"""
world: {{width: 10, height: 10, step_time: 0.1, time_limit: 8}}
robot:
  - {{name: robot, kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}}, state: [1, 1], goal: [9, 1],
     behavior: {{name: dash}}}}
  - {{name: late, kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}}, state: [1, 9], goal: [9, 9],
     behavior: {{name: dash}}, appear_time: 1.5, plot: {{show_fov: true}}, fov: 1.5, fov_radius: 2}}
obstacle:
  - {{name: early, kinematics: {{name: omni_angular}}, shape: {{name: circle, radius: 0.2}}, {SHOWN},
     behavior: {{name: replay, times: [0, 1], poses: [[3, 3], [4, 3]]}}}}
  - {{name: later, tags: [pedestrian], kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.2}}, {SHOWN},
     behavior: {{name: replay, times: [2, 4], poses: [[3, 5], [5, 5]]}}}}
  - {{name: walker, tags: [pedestrian], kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.2}}, {SHOWN},
     state: [1, 7], goal: [5, 7], behavior: {{name: dash}}, appear_time: 1.5}}
"""
PRESENT = {0: {"robot", "early"}, 5: {"robot", "early"}, 12: {"robot"}, 30: {"robot", "late", "later", "walker"},
           45: {"robot", "late", "walker"}}  # fmt: skip


def drawn(env: Env, scene: Scene) -> dict[str, set[str]]:
    """Name of each object in a scene -> parts of it that are drawn."""
    names, parts = {view.id: view.name for view in env.objects}, dict[str, set[str]]()
    for item in (*scene.marks, *scene.labels):
        if item.object in names:
            parts.setdefault(names[item.object], set()).add(item.part)
    return parts


@pytest.fixture
def at_step(make: Make) -> Callable[[int], Any]:
    """A function that makes the environment at a step."""

    def made(step: int) -> Any:
        env = make(SCENE)
        for _ in range(step):
            env.step()
        return env

    return made


@pytest.mark.parametrize("step", PRESENT)
def test_pictures_and_windows_show_who_is_there(at_step: Callable[[int], Any], step: int) -> None:
    env = at_step(step)
    assert set(drawn(env, env._env_plot.scene())) == PRESENT[step]
    if step:
        assert set(drawn(env, legible_scene(env.simulation)[0])) == PRESENT[step]


def test_snapshots_of_the_start_show_those_who_come_pale_without_arrows_and_no_recordings(
    at_step: Callable[[int], Any],
) -> None:
    env = at_step(0)
    parts = drawn(env, legible_scene(env.simulation)[0])
    assert set(parts) == {"robot", "early", "late", "walker"}
    assert parts["walker"] == {"body", "name"}
    assert parts["late"] == {"body", "name", "goal"}
    assert {"arrow", "goal", "body"} <= parts["early"]


def test_nothing_is_drawn_by_hand_of_who_is_not_there(at_step: Callable[[int], Any]) -> None:
    env = at_step(12)
    axes = Figure().add_subplot()
    for name, there in (("early", False), ("later", False), ("robot", True)):
        next(item for item in env.objects if item.name == name).plot(axes)
        assert bool(axes.patches or axes.lines or axes.texts) == there, name


@pytest.fixture
def recorded(tmp_path: Path) -> Any:
    irsim.run(text=SCENE, steps=60, record=tmp_path / "run", seed=1)
    return open_run(tmp_path / "run")


def test_pictures_of_recorded_runs_show_who_was_there(recorded: Any) -> None:
    env = Env(scenario_of(recorded, None), seed=1, headless=True, log_level="ERROR")
    move = follow_record(recorded, env)
    for step, names in PRESENT.items():
        if step:
            move(step)
            assert set(drawn(env, legible_scene(env.simulation)[0])) == names


def test_the_replay_page_knows_when_somebody_leaves_and_keeps_its_last_place(recorded: Any) -> None:
    head, columns = unpacked(pack_run(recorded).data)
    objects = {item["name"]: item for item in head["objects"]}
    spans = {name: (item.get("from"), item.get("to")) for name, item in objects.items()}
    assert spans == {
        "robot": (None, None), "late": (15, None), "early": (None, 10), "later": (20, 40), "walker": (15, None),
    }  # fmt: skip
    xs = {name: columns["x"][objects[name]["track"]] * head["quanta"][0] for name in ("early", "later")}
    np.testing.assert_allclose(xs["early"][10:], 4, atol=1e-3)
    np.testing.assert_allclose([xs["later"][0], *xs["later"][40:]], [3, *[5] * len(xs["later"][40:])], atol=1e-3)
