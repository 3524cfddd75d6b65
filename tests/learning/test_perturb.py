"""``perturb`` of a task: starts and speeds are drawn for each episode, and goals stay."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from irsim.learning import VectorEnv
from irsim.learning.tasks.files import TaskError
from irsim.learning.worlds import Worlds
from irsim.validation.file_reports import task_report
from tests.learning.tasks import RANDOM, task

STARTS: list[dict[str, Any]] = [{"position": 0.5, "heading": "20deg", "objects": ["robot"]}]
DISTANCE = [{"name": "goal", "features": ["distance", "sin"], "distance_max": 10}]


def test_starts_differ_and_goals_stay() -> None:
    seen = Worlds(task(perturb=STARTS, observation=DISTANCE), 200, seed=1).observe()
    distances = 10 * seen[:, 0]  # the way from (1, 5) to (9, 5)
    assert distances.min() == pytest.approx(7.5, abs=0.05)
    assert distances.max() == pytest.approx(8.5, abs=0.05)
    turned = np.degrees(np.arcsin(seen[:, 1]))
    assert 18 < np.abs(turned).max() < 24


def test_every_episode_draws_again_alone_as_in_a_batch() -> None:
    given = task(perturb=STARTS, observation=DISTANCE, horizon=0.3)
    batch, alone = VectorEnv(given, 3), VectorEnv(given, 1)
    seen, _ = batch.reset(seed=7)
    starts = [seen[2]]
    single, _ = alone.reset(seed=9)
    over = False
    for _ in range(9):
        np.testing.assert_array_equal(single[0], seen[2])
        seen, _, _, cut, _ = batch.step(np.zeros((3, 2)))
        single = alone.step(np.zeros((1, 2)))[0]
        if over:  # this step has begun the next episode
            starts.append(seen[2])
        over = bool(cut[2])
    assert len({tuple(one) for one in starts}) == len(starts) > 1


def test_unknown_objects_are_refused() -> None:
    with pytest.raises(TaskError, match=r"(?s)name, tag or role 'robto'.*did you mean robot"):
        Worlds(task(perturb=[{"position": 0.5, "objects": ["robto"]}]))


def test_what_has_no_effect_in_the_scenario_of_a_task_is_told(tmp_path: Path) -> None:
    path = tmp_path / "task.yaml"
    path.write_text(yaml.safe_dump(task({"distribution": RANDOM})))  # `goal` is written, and drawn all the same
    report = task_report(str(path))
    assert report.valid
    assert report.summary == "valid: task test, 1 learner (diff); 2 warnings"
    findings = {(finding.code, finding.path) for finding in report.findings}
    assert findings == {("ignored-key", f"scenario.robot[0].{key}") for key in ("state", "goal")}
