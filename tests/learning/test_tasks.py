"""Task files: what they say, and what is wrong with them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from irsim.learning import Worlds
from irsim.learning.rewards._options import REWARDS
from irsim.learning.tasks.files import TASKS, TaskError, open_task
from irsim.options.registry import Feature
from irsim.testing import conformance
from tests.learning.tasks import task


@pytest.mark.parametrize("feature", REWARDS.features(), ids=lambda feature: feature.name)
def test_reward_terms_are_documented(feature: Feature) -> None:
    conformance.check_documented(feature)
    conformance.check_units(feature)
    conformance.check_defaults(feature)


@pytest.mark.parametrize("name", TASKS.names())
def test_bundled_tasks_are_named_like_their_files_and_step(name: str) -> None:
    made, _ = open_task(TASKS.bundled(name))
    assert made.task == name
    assert made.title
    assert made.about
    worlds = Worlds(TASKS.bundled(name), 2)
    assert worlds.observe().shape == (2 * worlds.learners, worlds.eyes.size)


def test_scenarios_come_from_files_and_templates(tmp_path: Path) -> None:
    data = task()
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(data.pop("scenario")))
    (tmp_path / "task.yaml").write_text(yaml.safe_dump({**data, "file": "scene.yaml"}))
    assert Worlds(tmp_path / "task.yaml").names == ("robot_0",)
    template = {**data, "template": "doorway"}
    assert Worlds(template).learners == 4


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"rewards": []}, r"(?s)rewards.*the key is called 'reward'"),
        ({"reward": [{"name": "progres"}]}, r"(?s)reward\[0\].*Did you mean 'progress'"),
        ({"reward": [{"name": "clearance", "margin": -1}]}, r"reward\[0\].margin"),
        ({"observation": [{"name": "goal", "features": ["distanc"]}]}, r"(?s)observation\[0\].features.*distance"),
        ({"horizon": "long"}, r"horizon"),
        ({"template": "doorway"}, r"exactly one of template, scenario and file"),
        ({"ends": {"world": "first"}}, r"ends.world"),
        ({"protocol": "stay"}, r"protocol"),
    ],
)
def test_every_problem_is_named_with_its_place(change: dict[str, Any], message: str, tmp_path: Path) -> None:
    path = tmp_path / "task.yaml"
    path.write_text(yaml.safe_dump({**task(), **change}))
    with pytest.raises(TaskError, match=message) as caught:
        open_task(path)
    assert all(item.line for item in caught.value.diagnostics if item.path)
    assert caught.value.code == "bad-task"


def test_all_problems_come_at_once(tmp_path: Path) -> None:
    path = tmp_path / "task.yaml"
    path.write_text("task: a\nhorizon: -1\nreward: [{name: time, weight: x}]\nobservation: []\nscenario: {}\n")
    with pytest.raises(TaskError) as caught:
        open_task(path)
    assert len(caught.value.diagnostics) >= 3


def test_a_missing_file_and_an_unknown_template_are_said() -> None:
    with pytest.raises(TaskError, match="there is no task file"):
        open_task("nowhere.yaml")
    with pytest.raises(TaskError, match="goal_lidar"):
        open_task("goal_lida")
    data = task()
    del data["scenario"]
    with pytest.raises(TaskError, match="coridor"):
        Worlds({**data, "template": "coridor"})


def test_bundled_tasks_are_opened_by_their_name() -> None:
    assert open_task("goal_lidar") == open_task(TASKS.bundled("goal_lidar"))


def test_a_file_of_the_current_folder_comes_before_a_bundled_task_of_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = TASKS.names()[0]
    own = yaml.safe_load(TASKS.bundled(name).read_text(encoding="utf-8")) | {"version": 77}
    (tmp_path / name).write_text(yaml.safe_dump(own))
    assert open_task(name)[0].version != 77
    monkeypatch.chdir(tmp_path)
    assert open_task(name)[0].version == 77


def test_an_unknown_key_is_marked_itself(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(TASKS.bundled(TASKS.names()[0]).read_text(encoding="utf-8") + "\nnumbr: 5\n")
    with pytest.raises(TaskError) as refused:
        open_task(path)
    [diagnostic] = refused.value.diagnostics
    assert (diagnostic.code, diagnostic.column, diagnostic.length) == ("unknown-key", 1, len("numbr"))
