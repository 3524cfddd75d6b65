"""Task files: what they say, and what is wrong with them, each problem with its line and its repair."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from irsim.learning import Worlds
from irsim.learning.rewards._options import REWARDS
from irsim.learning.tasks.files import TASKS, TaskError, open_task
from irsim.options.registry import Feature
from irsim.testing import conformance
from irsim.validation.file_reports import task_report
from tests.learning.tasks import RANDOM, corridor, lidar_among_boxes, task


def written(folder: Path, made: dict[str, Any]) -> Path:
    """The file of a task."""
    path = folder / "task.yaml"
    path.write_text(yaml.safe_dump(made))
    return path


@pytest.mark.parametrize("feature", REWARDS.features(), ids=lambda feature: feature.name)
def test_reward_terms_are_documented(feature: Feature) -> None:
    conformance.check_documented(feature)
    conformance.check_units(feature)
    conformance.check_defaults(feature)


def test_scenarios_come_from_files_and_templates(tmp_path: Path) -> None:
    data = task()
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(data.pop("scenario")))
    assert Worlds(written(tmp_path, {**data, "file": "scene.yaml"})).names == ("robot_0",)
    assert Worlds({**data, "template": "doorway"}).learners == 4


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
        ({"randomize": {"numbr": {}}}, r"(?s)randomize.numbr.*Did you mean 'number'"),
        ({"randomize": {"count": {}}}, r"(?s)count.*'number'"),
        ({"randomize": {"number": {"obstacle[0]": [3, 1]}}}, r"(?s)randomize.number.*begins at 3.*write \[1, 3\]"),
        ({"randomize": {"number": {"obstacle[0]": [1]}}}, r"randomize.number"),
        ({"randomize": {"number": {"obstacle[0]": [-1, 2]}}}, r"randomize.number"),
        ({"randomize": {"speed": {"learners": [0, 1]}}}, r"randomize.speed"),
        ({"randomize": {"latency": {"learners": [0.5, 1]}}}, r"randomize.latency"),
        ({"randomize": {"same": ["sped"]}}, r"(?s)randomize.same.*speed"),
        ({"randomize": {"parameters": {"width": [1, 2]}}}, "only a template has parameters"),
        ({"curriculum": {"levels": []}}, "curriculum.levels"),
        ({"curriculum": {"levels": [{}], "start": 1}}, "the last of the 1 levels is 0"),
        ({"curriculum": {"levels": [{}, {}], "up": 0.5, "down": 0.6}}, "must be less than 'up'"),
        ({"curriculum": {"stages": [{}]}}, r"(?s)stages.*'levels'"),
        ({"curriculum": {"levels": [{"randomise": {}}]}}, r"(?s)levels\[0\].*Did you mean 'randomize'"),
    ],
)
def test_every_problem_is_named_with_its_place(change: dict[str, Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(TaskError, match=message) as caught:
        open_task(written(tmp_path, {**task(), **change}))
    assert all(item.line for item in caught.value.diagnostics if item.path)
    assert caught.value.code == "bad-task"


def test_all_problems_come_at_once(tmp_path: Path) -> None:
    path = tmp_path / "task.yaml"
    path.write_text("task: a\nhorizon: -1\nreward: [{name: time, weight: x}]\nobservation: []\nscenario: {}\n")
    with pytest.raises(TaskError) as caught:
        open_task(path)
    assert len(caught.value.diagnostics) >= 3


def test_a_missing_file_and_an_unknown_template_are_said() -> None:
    template = {**task(), "template": "coridor"}
    del template["scenario"]
    for source, message in (
        ("nowhere.yaml", "there is no task file"),
        ("goal_lida", "goal_lidar"),
        (template, "coridor"),
    ):
        with pytest.raises(TaskError, match=message):
            Worlds(source)
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


def test_a_scenario_is_told_from_a_task(tmp_path: Path) -> None:
    file = tmp_path / "hall.yaml"
    file.write_text("world: {width: 5, height: 5}\nrobot: {state: [1, 1, 0], goal: [4, 4]}\n", encoding="utf-8")
    with pytest.raises(TaskError, match=r"hall.yaml is a scenario.*'file: .*hall.yaml'.* describe task.goal_lidar"):
        open_task(str(file))


def test_an_unknown_key_is_marked_itself(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(TASKS.bundled(TASKS.names()[0]).read_text(encoding="utf-8") + "\nnumbr: 5\n")
    with pytest.raises(TaskError) as refused:
        open_task(path)
    [diagnostic] = refused.value.diagnostics
    assert (diagnostic.code, diagnostic.column, diagnostic.length) == ("unknown-key", 1, len("numbr"))


@pytest.mark.parametrize(
    ("randomize", "message", "fix"),
    [
        ({"number": {"obstacle[1]": [0, 1]}}, "no object has the name", "obstacle\\[0\\]"),
        ({"number": {"obstacels": [0, 1]}}, "no object has the name", "obstacles"),
        ({"number": {"people": [0, 1]}}, "the scenario has no people", "obstacle\\[0\\]"),
        ({"number": {"obstacle[0]": [0, 5]}}, "up to 5 take part, and .* names 4 objects", "at most 4"),
        ({"number": {"learners": [0, 1]}}, "no robot that learns", "at least one"),
        ({"speed": {"obstacle[0]": [1, 2]}}, "cannot move", "with a drive"),
        ({"acceleration": {"learners": [1, 2]}}, "not limited", "acce"),
        ({"sensor_noise": {"learners": [1, 2]}}, "no sensor .* is noisy", "noise: true"),
        ({"latency": {"obstacles": [1, 2]}}, "only robots that learn", "learners"),
        ({"size": {"obstacles": [1, 2], "obstacle[0]": [1, 2]}}, "belongs to 'obstacle.0.' as", "different objects"),
        ({"observed": ["latency"]}, "'latency' is not drawn", "leave it out"),
    ],
)
def test_what_would_have_no_effect_is_an_error_with_its_line(
    randomize: dict[str, Any], message: str, fix: str, tmp_path: Path
) -> None:
    path = written(tmp_path, lidar_among_boxes(randomize=randomize))
    report = task_report(str(path))
    [finding] = report.findings
    assert (report.valid, finding.line is None) == (False, False)
    with pytest.raises(TaskError, match=message) as caught:
        Worlds(path)
    assert re.search(fix, str(caught.value)), str(caught.value)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"widht": [1, 2]}, r"(?s)has no parameter 'widht'.*did you mean width"),
        ({"width": [1, 9]}, "out of range"),
        ({"width": [2]}, r"\[low, high\]"),
        ({"speed": [0.5, 1]}, r"(?s)'vel_m..' of 'eastbound' differs.*randomize: \{speed"),
    ],
)
def test_parameters_are_checked(parameters: dict[str, Any], message: str) -> None:
    with pytest.raises(TaskError, match=message):
        Worlds(corridor(randomize={"parameters": parameters}))


def test_a_valid_task_is_summarized_with_what_has_no_effect(tmp_path: Path) -> None:
    levels = written(tmp_path, corridor(curriculum={"levels": [{"horizon": 3}, {}]}))
    assert task_report(str(levels)).summary == "valid: task test, 2 learners (diff), 10 variants, 2 levels"
    report = task_report(str(written(tmp_path, task({"distribution": RANDOM}))))  # `goal` is drawn all the same
    assert (report.valid, report.summary) == (True, "valid: task test, 1 learner (diff); 2 warnings")
    findings = {(finding.code, finding.path) for finding in report.findings}
    assert findings == {("ignored-key", f"scenario.robot[0].{key}") for key in ("state", "goal")}


@pytest.mark.parametrize(
    ("level", "message"),
    [
        ({"values": {"robot[0].distribution.goal_distanc": 5}}, r"(?s)levels\[1\].*no 'robot.*mean goal_distance"),
        ({"values": {"robot[0].vel_max": [2, 2]}}, r"(?s)levels\[1\].*'vel_max'.*randomize: \{speed"),
        ({"values": {"obstacle[0].number": 9}}, r"(?s)levels\[1\].*randomize: \{number"),
        ({"randomize": {"number": {"obstacle[0]": [0, 9]}}}, r"levels\[1\].randomize.number"),
    ],
)
def test_levels_are_checked_against_the_scenario(level: dict[str, Any], message: str) -> None:
    with pytest.raises(TaskError, match=message):
        Worlds(lidar_among_boxes(curriculum={"levels": [{}, level]}))
