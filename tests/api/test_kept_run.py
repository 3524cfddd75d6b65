"""The recording behind a result of ``irsim.run``: the one that was made, or one of a second simulation."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path

import pytest

import irsim
from irsim.api.kept_run import recorded_run
from irsim.common.extras import ExtraError, require
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


@pytest.mark.records
def test_a_run_has_a_table_of_its_robots_as_several_runs_have(scene: Path) -> None:
    table = irsim.run(scene, seed=3).to_pandas("robots")
    assert [*table["seed"]] == [3]
    assert [*table["outcome"]] == ["timeout"]


def test_a_table_of_other_rows_is_refused_with_those_that_exist(scene: Path) -> None:
    with pytest.raises(InputError, match="choose steps or robots"):
        irsim.run(scene).to_pandas("episodes")  # type: ignore[arg-type]


def test_a_benchmark_is_printed_as_a_short_table(scene: Path) -> None:
    lines = str(irsim.benchmark([scene], ["dash", "orca"], seeds=1)).splitlines()
    assert lines[1].split() == [
        "scenario",
        "policy",
        "episodes",
        "success",
        "95",
        "%",
        "interval",
        "collision",
        "timeout",
    ]
    assert [line.split()[1:4] for line in lines[2:4]] == [["dash", "1", "0%"], ["orca", "1", "0%"]]
    assert lines[4].startswith("reproduce: irsim benchmark")
    assert len(lines) == 5


def test_a_missing_torch_is_told_with_its_size_and_the_index_for_processors(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim.common.extras.find_spec", lambda name: None)
    with pytest.raises(ExtraError, match=r"whl/cpu \(1 GB in all, with CUDA 5.6 GB\); .*irsim-mcp\[learn\]"):
        require("learn", "torch", "gymnasium")
    with pytest.raises(ExtraError, match="Fix: install the extra"):
        require("gym", "gymnasium")


def test_a_missing_pandas_is_one_error_with_the_command(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result, benchmark = irsim.run(scene), irsim.benchmark([scene], ["dash"], seeds=1)
    monkeypatch.setattr("irsim.common.extras.find_spec", lambda name: None)
    for one in (result, benchmark):
        with pytest.raises(ExtraError) as caught:
            one.to_pandas()
        assert caught.value.code == "missing-extra"
        assert str(caught.value) == "missing-extra: pandas is not installed. Fix: install it: pip install pandas."
