"""Learners whose robots have actuators: what they see, batches, snapshots, and delays that are given twice."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from irsim.learning import Worlds
from irsim.learning.tasks.files import TaskError
from irsim.validation.file_reports import task_report
from tests.learning.tasks import RANDOM, task

LATE = {"delay": [0.25, 0.1], "lag": 0.2, "jerk": 20.0, "noise": 0.02}


def test_a_learner_sees_its_executed_control() -> None:
    worlds = Worlds(task({"actuation": {"delay": 0.2}}), 2, seed=0)
    executed = []
    for _ in range(4):
        worlds.step(np.array([[0.5, 0.0]] * 2))
        executed.append(worlds.simulation.control[worlds.rows, 0].tolist())
    assert executed == [[0, 0], [0, 0], [0.5, 0.5], [0.5, 0.5]]
    worlds.reset()
    worlds.step(np.array([[0.5, 0.0]] * 2))
    assert not worlds.simulation.control.any(), "the actions of an episode do not reach the next one"


def test_a_batch_of_learners_equals_single_worlds() -> None:
    given = task({"actuation": LATE, "distribution": RANDOM}, {"distribution": RANDOM}, horizon=3)
    actions = np.random.default_rng(0).uniform(-1, 1, (20, 6, 2))
    together = Worlds(given, 3, seed=5)
    parts = [together.advance(np.ascontiguousarray(step)).seen.copy() for step in actions]
    again = Worlds(given, 3, seed=5)
    for k in range(7):
        again.advance(np.ascontiguousarray(actions[k]))
    kept = again.snapshot()
    for k in range(7, 12):
        again.advance(np.ascontiguousarray(actions[k]))
    again.restore(kept)
    for k in range(7, 20):
        assert np.array_equal(again.advance(np.ascontiguousarray(actions[k])).seen, parts[k])


def test_a_delay_given_twice_is_an_error_with_its_line(tmp_path: Path) -> None:
    late = task({"actuation": {"delay": 0.2}}, randomize={"latency": {"learners": [0, 2]}})
    path = tmp_path / "task.yaml"
    path.write_text(yaml.safe_dump(late, sort_keys=False), encoding="utf-8")
    with pytest.raises(TaskError, match="a delay of 'learners' is given twice"):
        Worlds(path)
    [finding] = task_report(str(path)).findings
    assert finding.line == path.read_text(encoding="utf-8").splitlines().index("  latency:") + 3
    assert "remove one of them" in str(finding.fix)
    Worlds(task({"actuation": {"lag": 0.2}}, randomize={"latency": {"learners": [0, 2]}}), 1)
