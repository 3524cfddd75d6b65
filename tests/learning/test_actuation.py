"""Learners whose robots have actuators: what they see, batches, snapshots, and delays that are given twice."""

from __future__ import annotations

from pathlib import Path
from typing import Any

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


def test_dead_time_and_lag_are_drawn_as_factors() -> None:
    given = {"delay": {"learners": [0.5, 3.0]}, "lag": {"learners": [0.0, 2.0]}, "observed": ["delay"]}
    made = task(*[{"actuation": {"delay": 0.2, "lag": 0.3}}] * 2, world={"collision_mode": "unobstructed"})
    worlds = Worlds({**made, "horizon": 9, "randomize": given}, 40, seed=2)
    drawn = worlds.drawn
    assert drawn["delay.learners"].shape == drawn["lag.learners"].shape == (40, 2)
    for name, low, high in (("delay", 0.5, 3.0), ("lag", 0.0, 2.0)):
        values = drawn[f"{name}.learners"]
        assert low <= values.min() < low + 0.2 * (high - low) < high - 0.2 * (high - low) < values.max() <= high
    first = np.full(80, -1)
    for step in range(12):
        worlds.step(np.array([[1.0, 0.0]] * 80))
        moved = worlds.simulation.control[worlds.rows, 0] > 0
        first[moved & (first < 0)] = step
    assert np.array_equal(first, np.floor(0.2 / 0.1 * drawn["delay.learners"].reshape(-1) + 1e-9))


def test_a_drawn_lag_is_that_of_the_same_number_in_the_scenario() -> None:
    drawn = Worlds(task({"actuation": {"lag": 0.2}}, randomize={"lag": {"learners": [2.5, 2.5]}}), 1, seed=0)
    written = Worlds(task({"actuation": {"lag": 0.5}}), 1, seed=0)
    for worlds in (drawn, written):
        for _ in range(5):
            worlds.step(np.array([[1.0, 0.5]]))
    assert np.array_equal(drawn.simulation.control, written.simulation.control)
    assert drawn.simulation.control[0, 0] == pytest.approx(1 - np.exp(-1))


@pytest.mark.parametrize(
    ("actuation", "randomize", "message"),
    [
        (None, {"delay": {"learners": [0, 2]}}, "has no delay that could be drawn"),
        ({"delay": 0.1}, {"lag": {"learners": [0, 2]}}, "has no lag that could be drawn"),
        ({"delay": [0.0, 0.5]}, {"delay": {"learners": [1, 5]}}, r"2.5 s would be longer than 2 s.*end the range at 4"),
    ],
)
def test_draws_without_effect_are_refused(actuation: Any, randomize: Any, message: str) -> None:
    with pytest.raises(TaskError, match=message):
        Worlds(task({"actuation": actuation}, randomize=randomize), 1)
