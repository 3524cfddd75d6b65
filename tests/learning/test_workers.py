"""Worlds that are divided among processes: the same results, the same errors, and no process that stays behind."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irsim.diagnostics.errors import ArgumentError, WorkerError
from irsim.learning import VectorEnv
from irsim.learning.worlds import Worlds
from irsim.plugins import register_behavior
from tests.effort import some
from tests.learning.tasks import (
    CHOICES,
    EVERYTHING,
    NOISY,
    RANDOM,
    STARTS,
    corridor,
    crowd,
    lidar_among_boxes,
    of_python,
    rich,
    task,
)
from tests.processes import runs, wait_until_gone

pytestmark = pytest.mark.one_python

STAIRS: dict[str, Any] = {"levels": [{"randomize": {"number": {"obstacle[0]": [1, 2]}}}, {"horizon": 2}], "episodes": 8}
PEOPLE = {"number": 3, "kinematics": {"name": "omni"}, "behavior": {"name": "sfm"}, "distribution": RANDOM}
TERMS = [{"name": "progress"}, {"name": "social"}, {"name": "smoothness"}, {"name": "clearance"}]
TASKS = {
    "lidar": lidar_among_boxes(horizon=1.5),
    "drawn": rich(randomize={**EVERYTHING, "observed": ["latency", "speed"]}, horizon=1.5),
    "perturbed": task(horizon=1.5, perturb=STARTS),
    "variants": corridor(horizon=1.5),
    "crowd": crowd(3, horizon=2, ends={"world": "all"}, randomize={"number": {"learners": [1, 3]}}),
    "choices": lidar_among_boxes(horizon=1, action=CHOICES),
    "people": task({"sensors": [NOISY], "distribution": RANDOM}, obstacles=[PEOPLE], reward=TERMS, horizon=1.5),
}
PROGRAM = """
import sys, time
from irsim.learning import VectorEnv
env = VectorEnv("goal_lidar", 3, workers=3)
env.reset(seed=0)
env.step(env.action_space.sample())
print(*env.worlds.pids, flush=True)
{end}
"""


def same(a: Any, b: Any) -> bool:
    """Whether two answers of environments have the same bits."""
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, tuple):
        return all(map(same, a, b))
    if a is None or b is None:
        return a is b
    one, other = np.asarray(a), np.asarray(b)
    if one.dtype == object:
        return all(map(same, one, other))
    return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()


def pair(made: Any, slots: int, workers: int = 2, **keys: Any) -> tuple[VectorEnv, VectorEnv]:
    """The same worlds in this process and divided among several, both reset with seed 0."""
    plain, divided = (VectorEnv(made, slots, workers=w, threads=w, **keys) for w in (1, workers))
    assert [len(getattr(env.worlds, "pids", ())) for env in (plain, divided)] == [0, workers - 1]
    assert same(plain.reset(seed=0), divided.reset(seed=0))
    return plain, divided


# results --------------------------------------------------------------------------------------------------------------
@pytest.mark.usefixtures("warm_workers")
@pytest.mark.parametrize(
    ("name", "mode"), some([*((name, "SameStep") for name in TASKS), ("drawn", "NextStep"), ("crowd", "NextStep")], 3)
)
def test_results_do_not_depend_on_the_number_of_workers(name: str, mode: str) -> None:
    slots = 5 * Worlds(TASKS[name]).learners
    plain, divided = pair(TASKS[name], slots, 3, autoreset_mode=mode)
    plain.action_space.seed(1)
    ended = 0
    for _ in range(60):
        actions = plain.action_space.sample()
        expected = plain.step(actions)
        assert same(divided.step(actions), expected)
        ended += (expected[2] | expected[3]).sum()
    assert ended >= 2 * slots
    divided.close()


@pytest.mark.usefixtures("warm_workers")
def test_masks_seeds_and_levels_reach_the_worlds_of_all_processes() -> None:
    made = lidar_among_boxes(horizon=2, curriculum=STAIRS)
    plain, divided = pair(made, 5, 3, autoreset_mode="Disabled", copy=False)
    mask = np.array([False, True, False, True, True])
    for asked in (
        {"options": {"level": 1}},
        {"options": {"reset_mask": mask}},
        {"seed": [5, 1, 8, 2, 9]},
        {"seed": [7, 7, 7, 7, 7], "options": {"reset_mask": mask}},
        {"options": {"reset_mask": np.ones(5, dtype=bool), "level": 0}},
    ):
        assert same(plain.reset(**asked), divided.reset(**asked))
        assert plain.worlds.seeds == divided.worlds.seeds
        for _ in range(3):
            actions = 0.1 * plain.action_space.sample()
            assert same(plain.step(actions), divided.step(actions))
    assert same(plain.worlds.step(None).reward, divided.worlds.step(None).reward)
    assert plain.worlds.level.tolist() == divided.worlds.level.tolist()
    divided.close()


@pytest.mark.usefixtures("warm_workers")
@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("copy", [False, True])
def test_observations_are_not_copied_unless_asked_for(copy: bool, workers: int) -> None:
    env = VectorEnv(lidar_among_boxes(), 4, copy=copy, workers=workers)
    first, _ = env.reset(seed=0)
    before = first.copy()
    second = env.step(np.ones((4, 2)))[0]
    kept = second.copy()
    assert np.shares_memory(first, second) is not copy
    assert np.array_equal(first, before) is copy
    env.close()
    assert np.array_equal(second, kept)  # the memory lives as long as the array


# functions of the user, pictures, arguments ---------------------------------------------------------------------------
@pytest.mark.usefixtures("warm_workers")
def test_pictures_show_the_first_world_and_reward_functions_get_those_of_their_process() -> None:
    plain, divided = pair(task(reward=[of_python("chatty")]), 3, render_mode="rgb_array")
    for _ in range(3):
        assert same(plain.step(np.ones((3, 2))), divided.step(np.ones((3, 2))))
    assert same(plain.render(), divided.render())
    divided.close()


@pytest.mark.usefixtures("warm_workers")
def test_an_error_in_another_process_is_the_same_error_here() -> None:
    env = VectorEnv(task(reward=[of_python("picky")]), 3, workers=2)
    env.reset(seed=0)
    for _ in range(2):  # the processes are still in step with each other
        with pytest.raises(ZeroDivisionError, match="there are two worlds") as failed:
            env.step(np.zeros((3, 2)))
        assert failed.value.args[1] == {"number": 2}
    env.close()
    wrong = VectorEnv(task(reward=[of_python("nothing")]), 3, workers=2)
    wrong.reset()
    with pytest.raises(ArgumentError, match="cannot be imported") as refused:
        wrong.step(np.zeros((3, 2)))
    assert refused.value.fix == "give MODULE:FUNCTION of a module that Python finds"
    wrong.close()


@pytest.mark.usefixtures("warm_workers")
def test_behaviors_that_only_this_program_knows_are_refused() -> None:
    @register_behavior("diff", "circling")
    def circling(ego_object: Any, **keys: Any) -> Any:
        return np.array([[0.5], [0.5]])

    moving = {"kinematics": {"name": "diff"}, "behavior": {"name": "circling"}, "distribution": RANDOM}
    made = task(obstacles=[moving])
    VectorEnv(made, 2).close()
    with pytest.raises(ArgumentError, match=r"(?s)worker process cannot make the worlds.*circling.*leave out workers"):
        VectorEnv(made, 2, workers=2)


@pytest.mark.usefixtures("warm_workers")
def test_arguments_are_checked_before_any_world_moves() -> None:
    plain, divided = pair(task(), 4)
    for wrong in (np.zeros((3, 2)), np.array([[0, 0]] * 3 + [[np.nan, 0]])):
        with pytest.raises(ArgumentError, match="action"):
            divided.step(wrong)
    with pytest.raises(ArgumentError, match="there is no level 1"):
        divided.set_level(1)
    with pytest.raises(ArgumentError, match="2 seeds are given for 4 worlds"):
        divided.reset(seed=[1, 2])
    assert same(plain.step(np.ones((4, 2))), divided.step(np.ones((4, 2))))
    divided.close()


@pytest.mark.parametrize("wrong", [0, -1, 257, True, 10**9])
def test_numbers_of_workers_that_make_no_sense_are_refused(wrong: int) -> None:
    with pytest.raises(ArgumentError, match="give a whole number from 1 to 256"):
        VectorEnv(task(), 4, workers=wrong)


@pytest.mark.usefixtures("warm_workers")
def test_there_are_no_more_processes_than_worlds() -> None:
    env = VectorEnv(task(), 2, workers=50)
    assert len(env.worlds.pids) == 1
    env.close()
    assert not hasattr(VectorEnv(task(), 1, workers=50).worlds, "pids")


# ends -----------------------------------------------------------------------------------------------------------------
def divided_env(made: Any, slots: int = 3) -> tuple[VectorEnv, list[int]]:
    env = VectorEnv(made, slots, workers=2)
    env.reset(seed=0)
    return env, env.worlds.pids


def test_a_process_that_is_killed_is_an_error() -> None:
    env, pids = divided_env(task())
    os.kill(pids[0], signal.SIGKILL)
    wait_until_gone(pids)
    with pytest.raises(WorkerError, match=r"a worker process of the environment has died \(signal 9\)"):
        env.step(np.zeros((3, 2)))
    with pytest.raises(ArgumentError, match="the environment is closed"):
        env.step(np.zeros((3, 2)))
    env.close()


def test_a_process_that_ends_itself_is_an_error() -> None:
    env, pids = divided_env(task(reward=[of_python("deadly")]))
    with pytest.raises(WorkerError, match="exit code 3"):
        env.step(np.zeros((3, 2)))
    wait_until_gone(pids)


def test_processes_end_with_the_environment() -> None:
    env, pids = divided_env(task())
    assert all(map(runs, pids))
    env.close()
    env.close()
    assert not any(map(runs, pids))
    with pytest.raises(ArgumentError, match="the environment is closed"):
        env.reset()
    other, pids = divided_env(task())
    del other
    gc.collect()
    assert not any(map(runs, pids))


@pytest.mark.skipif(sys.platform != "linux", reason="looks for processes in /proc")
@pytest.mark.parametrize(
    "end",
    [
        pytest.param("", marks=pytest.mark.slow(4), id="end"),
        pytest.param("1 / 0", marks=pytest.mark.slow(4), id="error"),
        pytest.param("import os; os._exit(0)", marks=pytest.mark.slow(4), id="at_once"),
        pytest.param("time.sleep(60)", id="kill"),
    ],
)
def test_processes_end_with_their_program(end: str, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(PROGRAM.format(end=end), encoding="utf-8")  # without `if __name__ == "__main__"`
    with subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as program:
        assert program.stdout is not None
        pids = [int(word) for word in program.stdout.readline().split()]
        assert len(pids) == 2
        if "sleep" in end:
            program.send_signal(signal.SIGKILL)
        program.wait(20)
        wait_until_gone(pids)
