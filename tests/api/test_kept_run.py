"""The recording behind a result of ``irsim.run``: the one that was made, or one of a second simulation."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path

import pytest

import irsim
from irsim.api.kept_run import recorded_run
from irsim.common.extras import ExtraError
from irsim.diagnostics.errors import InputError

SCENE = """
world: {width: 10, height: 10, time_limit: 5}
robot: {state: [1, 5, 0], goal: [9, 5], kinematics: {name: diff}, behavior: {name: dash}}
"""


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return path


def test_a_run_without_a_recording_is_simulated_again(scene: Path) -> None:
    result = irsim.run(scene)
    recorded = irsim.run(scene, record=True)
    first, second = recorded_run(result).trace(), recorded_run(recorded).trace()
    assert (first.pose == second.pose).all()
    assert recorded_run(result).folder == recorded_run(result).folder  # once
    assert sorted(path.name for path in scene.parent.iterdir()) == [".irsim", "scene.yaml"]


def test_the_temporary_recording_goes_with_the_result(scene: Path) -> None:
    result = irsim.run(scene)
    folder = recorded_run(result).folder
    assert folder.is_dir()
    del result
    assert not folder.exists()


def test_results_are_compared_by_their_contents(scene: Path) -> None:
    first, second = irsim.run(scene, seed=1), irsim.run(str(scene), seed=1)
    assert first == second
    recorded_run(first)
    assert first == second == copy.deepcopy(first) == pickle.loads(pickle.dumps(first))


def test_a_scenario_that_has_changed_gives_no_table_of_another_episode(scene: Path) -> None:
    result = irsim.run(scene)
    scene.write_text(SCENE.replace("[9, 5]", "[8, 5]"), encoding="utf-8")
    with pytest.raises(InputError, match=r"gives another episode.*record=True"):
        recorded_run(result)
    with pytest.raises(InputError, match="read from a file or another process"):
        recorded_run(pickle.loads(pickle.dumps(result)))


def test_a_missing_pandas_is_one_error_with_the_command(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result, benchmark = irsim.run(scene), irsim.benchmark([scene], ["dash"], seeds=1)
    monkeypatch.setattr("irsim.common.extras.find_spec", lambda name: None)
    for one in (result, benchmark):
        with pytest.raises(ExtraError) as caught:
            one.to_pandas()
        assert caught.value.code == "missing-extra"
        assert str(caught.value) == "missing-extra: pandas is not installed. Fix: install it: pip install pandas."
