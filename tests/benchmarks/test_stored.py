"""A benchmark in a folder: it goes on after any interruption, and its files equal an undisturbed run's."""

from __future__ import annotations

import hashlib
import json
import os
import re
import time
from pathlib import Path

import pytest
from PIL import Image

import irsim
import irsim.benchmarks
from irsim.benchmarks.plan import Plan, file_plan
from irsim.benchmarks.stored import EPISODES, PLAN, RESULTS, default_folder, last_folder, resume_benchmark, run_plan
from irsim.benchmarks.suite_plan import suite_plan
from irsim.runs.files import RunError
from irsim.simulation.engine import engine
from tests.benchmarks.conftest import SUITE

SCENE = "robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.1}, distribution: {name: random}}\n"


@pytest.fixture(scope="module")
def suite(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("suite") / "small.yaml"
    path.write_text(SUITE, encoding="utf-8")
    path.with_name("scene.yaml").write_text(SCENE, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def undisturbed(suite: Path) -> dict[str, str]:
    folder = suite.with_name("undisturbed")
    run_plan(suite_plan(str(suite), seeds=2), folder, workers=1)
    return contents(folder)


def contents(folder: Path) -> dict[str, str]:
    """Hash of each file of the benchmark, without its report."""
    kept = (EPISODES, PLAN, RESULTS)
    return {name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in kept}


@pytest.mark.parametrize("cut", [0.1, 0.5, 0.9])
def test_half_a_line_at_the_end_of_the_log_is_run_again(
    cut: float, suite: Path, undisturbed: dict[str, str], tmp_path: Path
) -> None:
    run_plan(suite_plan(str(suite), seeds=2), tmp_path / "run")
    log = tmp_path / "run" / EPISODES
    log.write_bytes(log.read_bytes()[: int(cut * log.stat().st_size)])
    (tmp_path / "run" / RESULTS).unlink()
    resume_benchmark(tmp_path / "run", workers=1)
    assert contents(tmp_path / "run") == undisturbed


def test_a_finished_run_is_not_run_again_but_may_be_read_again(suite: Path, tmp_path: Path) -> None:
    plan = suite_plan(str(suite), seeds=2)
    first = run_plan(plan, tmp_path / "run")
    with pytest.raises(RunError, match="holds episodes already"):
        run_plan(plan, tmp_path / "run")
    counted: list[tuple[int, int]] = []
    again = run_plan(plan, tmp_path / "run", resume=True, progress=lambda *counts: counted.append(counts))
    assert (again, counted) == (first, [])


def test_results_of_two_engines_do_not_mix(suite: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = suite_plan(str(suite), seeds=2)
    for folder, known in (("other", "aaaaaaaaaaaa"), ("before-engines-had-an-identity", "")):
        with monkeypatch.context() as patch:
            patch.setattr("irsim.benchmarks.preparation.engine", lambda known=known: known)
            run_plan(plan, tmp_path / folder)
    with pytest.raises(RunError, match=f"are of engine aaaaaaaaaaaa, and this is {engine()}"):
        resume_benchmark(tmp_path / "other", workers=1)
    assert resume_benchmark(tmp_path / "before-engines-had-an-identity", workers=1).engine == ""


def test_a_folder_holds_one_benchmark(suite: Path, tmp_path: Path) -> None:
    run_plan(suite_plan(str(suite), seeds=2), tmp_path / "run")
    with pytest.raises(RunError, match="holds another benchmark"):
        run_plan(suite_plan(str(suite), seeds=3), tmp_path / "run", resume=True)
    with pytest.raises(RunError, match="holds no benchmark"):
        resume_benchmark(tmp_path / "nothing")
    plan = Plan.model_validate_json((tmp_path / "run" / PLAN).read_bytes())
    (tmp_path / "run" / PLAN).write_text(plan.model_copy(update={"version": "0.0.1"}).model_dump_json(indent=1) + "\n")
    with pytest.raises(RunError, match=r"was started by irsim 0\.0\.1"):
        resume_benchmark(tmp_path / "run")


def test_a_log_that_does_not_fit_on_the_disk_for_a_while_is_complete_afterwards(
    suite: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain, calls = os.write, 0

    def full_for_a_while(descriptor: int, data: bytes) -> int:
        nonlocal calls
        calls += 1
        if calls == 3:
            return plain(descriptor, data[: len(data) // 2])
        if 3 < calls < 8:
            raise OSError(28, "No space left on device")
        return plain(descriptor, data)

    monkeypatch.setattr("irsim.benchmarks.log.os.write", full_for_a_while)
    result = irsim.benchmark(str(suite.with_name("scene.yaml")), ["dash"], 12, workers=1, log=tmp_path / "log")
    assert calls > 8
    assert irsim.benchmarks.logged(tmp_path / "log") == result


def test_a_folder_is_used_by_one_process_at_a_time(suite: Path, tmp_path: Path) -> None:
    pytest.importorskip("fcntl")
    plan = suite_plan(str(suite), seeds=1)

    def finish(result: object, folder: Path) -> None:
        with pytest.raises(RunError, match="another process is running the benchmark"):
            run_plan(plan, folder, resume=True)

    run_plan(plan, tmp_path / "run", finish=finish)
    run_plan(plan, tmp_path / "run", resume=True)


def test_a_run_does_not_go_on_with_another_map(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Image.new("L", (20, 20), "white").save("floor.png")
    Path("scene.yaml").write_text(SCENE + "world: {obstacle_map: floor.png, width: 4, height: 4}\n", encoding="utf-8")
    run_plan(file_plan(["scene.yaml"], ["dash"], "2", steps=3), Path("run"))
    resume_benchmark(Path("run"))
    Image.new("L", (20, 20), "lightgray").save("floor.png")
    with pytest.raises(RunError, match=r"floor\.png of the scenario scene\.yaml has changed"):
        resume_benchmark(Path("run"))


def test_the_folder_has_the_hash_of_what_decides_the_numbers(suite: Path, tmp_path: Path) -> None:
    plan = suite_plan(str(suite))
    moved = tmp_path / "elsewhere.yaml"
    moved.write_text(SUITE, encoding="utf-8")
    assert default_folder(plan).name == f"small-{plan.hash}"
    assert re.fullmatch("[0-9a-f]{12}", plan.hash)
    assert suite_plan(str(moved)).hash == plan.hash
    moved.write_text(SUITE.replace("timeHorizon: 2", "timeHorizon: 3"), encoding="utf-8")
    assert suite_plan(str(moved)).hash != plan.hash
    assert suite_plan(str(suite), seeds=3).hash != plan.hash


def test_decisions_of_behaviors_are_timed_in_an_episode_of_their_own(tmp_path: Path) -> None:
    plan = suite_plan("random_polygons_v1", policies=["orca"], seeds=2, scenarios=["robots-5/yield"])
    first = run_plan(plan, tmp_path).episodes[0]
    [timed] = json.loads((tmp_path / "timing.json").read_text())["policies"].values()
    assert (timed["episodes"], timed["episodes_in_all"], timed["decisions"]) == (1, 2, first.steps - 1)
    assert 0 < timed["per_robot"]["mean_ms"] < timed["per_decision"]["mean_ms"]


def test_the_last_benchmark_is_the_one_started_last_after_the_clock_was_set_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(SCENE, encoding="utf-8")
    plans = [file_plan(["scene.yaml"], ["dash"], [seed], steps=1) for seed in (7, 8)]
    run_plan(plans[0], default_folder(plans[0]), workers=1)
    ahead = time.time() + 365 * 86400
    os.utime(default_folder(plans[0]) / PLAN, (ahead, ahead))
    run_plan(plans[1], default_folder(plans[1]), workers=1)
    assert last_folder() == default_folder(plans[1])
