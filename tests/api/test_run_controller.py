"""``irsim.episodes``: many episodes with a controller of one's own."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.api.run_controller import episodes
from irsim.benchmarks import pool
from irsim.diagnostics.errors import InputError, PolicyError, ScenarioNotFoundError
from irsim.lookup.python_guides import PYTHON
from irsim.runs.files import RunError
from irsim.runs.reading import open_run
from tests.api import controllers

SCENE = """
world: {width: 12, height: 12, step_time: 0.1, time_limit: 3}
robot: {distribution: {name: random, range_low: [1, 1, -3], range_high: [11, 11, 3]}, goal: [6, 6],
        kinematics: {name: diff, noise: true}, shape: {name: circle, radius: 0.2}}
"""


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(SCENE, encoding="utf-8")
    return tmp_path / "scene.yaml"


@pytest.mark.parametrize("kind", ["function", "object"])
def test_results_do_not_depend_on_the_number_of_workers(
    scene: Path, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pool, "_START_DELAY_S", 0.0)
    results = []
    for workers in (1, 2):
        folder = tmp_path / f"processes-{workers}"
        folder.mkdir()
        own = controllers.wander if kind == "function" else controllers.Counting(folder, workers)
        results.append(irsim.episodes(scene, own, seeds=8, workers=workers))
        assert len(list(folder.iterdir())) == (workers if kind == "object" else 0)
    for one, other in zip(*(result.episodes for result in results), strict=True):
        assert one.model_dump(exclude={"artifacts"}) == other.model_dump(exclude={"artifacts"})
        first, second = (open_run(Path(run.artifacts["run.json"]).parent).trace() for run in (one, other))
        np.testing.assert_array_equal(first.pose, second.pose)
        np.testing.assert_array_equal(first.control, second.control)
    assert [one.seed for one in results[0].episodes] == list(range(8))


def test_an_episode_begins_with_a_fresh_controller(scene: Path) -> None:
    [first, second] = irsim.episodes(scene, controllers.Counting(), seeds=[5, 6], workers=1).episodes
    traces = [open_run(Path(run.artifacts["run.json"]).parent).trace() for run in (first, second)]
    np.testing.assert_array_equal(traces[0].control[1:4, 0, 1], traces[1].control[1:4, 0, 1])


def test_the_documented_controller_drives_to_its_goal(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    head, _, program = (PYTHON["episodes"].example or "").partition("# the program\n")
    for line in head.splitlines()[3:]:
        assert line.strip() in str(episodes.__doc__)
    scene.rename("scenario.yaml").write_text(SCENE.replace("time_limit: 3", "time_limit: 30"), encoding="utf-8")
    (tmp_path / "goal_seeker.py").write_text(head, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    names: dict[str, Any] = {}
    lines = program.replace("from controller", "from goal_seeker").replace("seeds=20", "seeds=4").splitlines()
    exec("\n".join(line for line in lines if "to_pandas" not in line), names)
    assert names["result"].summary == "4 of 4 episodes succeeded"
    assert not names["result"].same


def test_a_printed_result_is_a_short_table(scene: Path) -> None:
    result = irsim.episodes(scene, controllers.wander, seeds=12, workers=1)
    first, columns, *rows = str(result).splitlines()
    assert first == f"12 episodes of {scene}: {result.summary}"
    assert columns.split() == ["seed", "outcome", "simulated", "[s]", "reason"]
    assert [row.split()[:2] for row in rows[:2]] == [[str(one.seed), one.outcome] for one in result.episodes[:2]]
    assert rows[-1] == "and 2 more rows"
    one = result.episodes[3]
    assert str(one).startswith(f"{one.scenario}: {one.summary}\nrobot ")
    assert len(str(result)) < 4000 > len(str(one))


def test_episodes_without_randomness_say_that_they_are_the_same(scene: Path) -> None:
    fixed = SCENE.replace(
        "distribution: {name: random, range_low: [1, 1, -3], range_high: [11, 11, 3]}", "state: [1, 1]"
    )
    scene.write_text(fixed.replace(", noise: true", ""), encoding="utf-8")
    result = irsim.episodes(scene, controllers.failing, seeds=2, workers=1)
    assert result.same
    assert result.summary.endswith("all are the same, as nothing is random in the scenario or the controller")


def test_recordings_are_kept_where_one_asks(scene: Path) -> None:
    result = irsim.episodes(scene, controllers.wander, seeds="4-5", workers=1, record="kept")
    assert sorted(path.name for path in Path("kept").iterdir()) == ["seed-4", "seed-5"]
    assert "Replay of scene" in repr(result.episodes[0].replay())
    with pytest.raises(RunError, match="not empty"):
        irsim.episodes(scene, controllers.wander, seeds=1, record="kept")
    folder = Path(irsim.episodes(scene, controllers.wander, seeds=1).episodes[0].artifacts["run.json"]).parent
    assert not folder.exists()  # the result is gone


def test_a_controller_that_cannot_be_sent_is_one_error(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lock = threading.Lock()
    monkeypatch.setattr("irsim.benchmarks.controlled.find_spec", lambda name: None)
    with pytest.raises(InputError, match="cannot be sent to other processes") as caught:
        irsim.episodes(scene, lambda env: [0.5, 0.0] if lock else None, seeds=4, workers=2)
    assert (caught.value.code, caught.value.where) == ("bad-argument", "controller")
    assert "workers=1" in str(caught.value.fix)
    assert irsim.episodes(scene, lambda env: [0.5, 0.0], seeds=2, workers=1).episodes
    monkeypatch.setattr(controllers.wander, "__module__", "__main__")
    monkeypatch.setattr("__main__.wander", controllers.wander, raising=False)
    with pytest.raises(InputError, match="running script or notebook"):
        irsim.episodes(scene, controllers.wander, seeds=4, workers=2)


def test_mistakes_are_said_before_anything_runs(scene: Path) -> None:
    with pytest.raises(InputError, match="cannot be called"):
        irsim.episodes(scene, "orca", seeds=2)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="Did you mean 'workers'"):
        irsim.episodes(scene, controllers.wander, worker=2)  # type: ignore[call-arg]
    with pytest.raises(ScenarioNotFoundError):
        irsim.episodes("scen.yaml", controllers.wander)
    with pytest.raises(InputError, match="workers"):
        irsim.episodes(scene, controllers.wander, workers=0)


@pytest.mark.parametrize("workers", [1, 2])
def test_a_controller_that_fails_is_named_with_seed_and_step(
    scene: Path, workers: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pool, "_START_DELAY_S", 0.0)
    with pytest.raises(PolicyError, match="failed with seed 3 in step 2: ZeroDivisionError: no way") as caught:
        irsim.episodes(scene, controllers.failing, seeds=5, workers=workers)
    assert caught.value.code == "policy-failed"
    assert isinstance(caught.value.__cause__, ZeroDivisionError)


@pytest.mark.usefixtures("interruptible")
def test_an_interrupt_leaves_nothing(scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    with pytest.raises(KeyboardInterrupt):
        irsim.episodes(scene, controllers.interrupted, seeds=4, workers=2)
    assert list((tmp_path / "temporary").iterdir()) == []
