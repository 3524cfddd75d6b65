"""Problems of the ranges of a task: each is named with its line and its repair."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from irsim.learning.tasks.files import TaskError, open_task
from irsim.learning.worlds import Worlds
from irsim.validation.file_reports import task_report
from tests.learning.tasks import corridor, lidar_among_boxes, task


@pytest.mark.parametrize(
    ("randomize", "message"),
    [
        ({"numbr": {}}, r"(?s)randomize.numbr.*Did you mean 'number'"),
        ({"count": {}}, r"(?s)count.*'number'"),
        ({"number": {"obstacle[0]": [3, 1]}}, r"(?s)randomize.number.*begins at 3.*write \[1, 3\]"),
        ({"number": {"obstacle[0]": [1]}}, r"randomize.number"),
        ({"number": {"obstacle[0]": [-1, 2]}}, r"randomize.number"),
        ({"speed": {"learners": [0, 1]}}, r"randomize.speed"),
        ({"latency": {"learners": [0.5, 1]}}, r"randomize.latency"),
        ({"same": ["sped"]}, r"(?s)randomize.same.*speed"),
    ],
)
def test_ranges_are_checked_with_their_places(randomize: dict[str, Any], message: str, tmp_path: Path) -> None:
    path = tmp_path / "task.yaml"
    path.write_text(yaml.safe_dump(lidar_among_boxes(randomize=randomize)))
    with pytest.raises(TaskError, match=message) as caught:
        open_task(path)
    assert all(item.line for item in caught.value.diagnostics)


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
        (
            {"size": {"obstacles": [1, 2], "obstacle[0]": [1, 2]}},
            "belongs to 'obstacle.0.' as well",
            "different objects",
        ),
        ({"observed": ["latency"]}, "'latency' is not drawn", "leave it out"),
    ],
)
def test_what_would_have_no_effect_is_an_error_with_its_line(
    randomize: dict[str, Any], message: str, fix: str, tmp_path: Path
) -> None:
    path = tmp_path / "task.yaml"
    path.write_text(yaml.safe_dump(lidar_among_boxes(randomize=randomize)))
    report = task_report(str(path))
    assert not report.valid
    [finding] = report.findings
    assert finding.line
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


def test_only_templates_have_parameters() -> None:
    with pytest.raises(TaskError, match="only a template has parameters"):
        open_task(task(randomize={"parameters": {"width": [1, 2]}}))


def test_a_valid_task_is_summarized(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(yaml.safe_dump(corridor(curriculum={"levels": [{"horizon": 3}, {}]})))
    assert task_report(str(tmp_path / "a.yaml")).summary == "valid: task test, 2 learners (diff), 10 variants, 2 levels"
