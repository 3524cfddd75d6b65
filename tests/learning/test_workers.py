"""Worlds that are divided among processes: the same results, the same errors, and no process that stays behind."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irsim.diagnostics.errors import ArgumentError, WorkerError
from irsim.learning import VectorEnv
from irsim.learning.step import Moment
from irsim.learning.workers.divided import DividedWorlds
from irsim.learning.worlds import Worlds
from irsim.plugins import register_behavior
from tests.effort import some
from tests.learning.tasks import LIDAR, RANDOM, corridor, crowd, lidar_among_boxes, task

pytestmark = pytest.mark.one_python

NOISY = {**LIDAR, "noise": True, "std": 0.1}
EVERYTHING: dict[str, Any] = {
    "number": {"obstacle[0]": [0, 4]},
    "size": {"obstacle[0]": [0.5, 1.5]},
    "speed": {"learners": [0.5, 1.5]},
    "sensor_noise": {"learners": [0, 2]},
    "latency": {"learners": [0, 3]},
    "observed": ["latency", "speed"],
}
STAIRS: dict[str, Any] = {"levels": [{"randomize": {"number": {"obstacle[0]": [1, 2]}}}, {"horizon": 2}], "episodes": 8}
PERTURBED = [{"position": 0.5, "heading": "20deg", "objects": ["robot"]}]
TASKS = {
    "lidar": lidar_among_boxes(horizon=1.5),
    "drawn": task(
        {"sensors": [NOISY]},
        obstacles=[{"number": 4, "distribution": RANDOM}],
        observation=[{"name": "scan", "sectors": 9}, {"name": "own"}],
        randomize=EVERYTHING,
        horizon=1.5,
    ),
    "perturbed": task(horizon=1.5, perturb=PERTURBED),
    "variants": corridor(horizon=1.5),
    "crowd": crowd(3, horizon=2, ends={"world": "all"}, randomize={"number": {"learners": [1, 3]}}),
    "choices": lidar_among_boxes(horizon=1, action={"choices": [[0, 0], [1, 0], [0.5, 1], [0.5, -1]]}),
    "people": task(
        {"sensors": [NOISY], "distribution": RANDOM},
        obstacles=[{"number": 3, "kinematics": {"name": "omni"}, "behavior": {"name": "sfm"}, "distribution": RANDOM}],
        reward=[{"name": "progress"}, {"name": "social"}, {"name": "smoothness"}, {"name": "clearance"}],
        horizon=1.5,
    ),
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


def wait_for_end(pids: list[int], seconds: float = 10.0) -> None:
    """Wait until processes have ended."""
    until = time.monotonic() + seconds
    while any(map(lives, pids)):
        assert time.monotonic() < until, f"of {pids}, {[one for one in pids if lives(one)]} still live"
        time.sleep(0.01)


def lives(pid: int) -> bool:
    """Whether a process lives; one that has ended and was not collected does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


# results --------------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("name", "mode"), some([*((name, "SameStep") for name in TASKS), ("drawn", "NextStep"), ("crowd", "NextStep")], 3)
)
def test_results_do_not_depend_on_the_number_of_workers(name: str, mode: str) -> None:
    slots = 5 * Worlds(TASKS[name]).learners
    envs = [VectorEnv(TASKS[name], slots, autoreset_mode=mode, workers=w, threads=w) for w in (1, 3)]
    plain, *divided = envs
    assert [len(getattr(env.worlds, "pids", ())) for env in envs] == [0, 2]
    first = [env.reset(seed=3) for env in envs]
    assert all(same(first[0], one) for one in first)
    plain.action_space.seed(1)
    ended = 0
    for _ in range(60):
        actions = plain.action_space.sample()
        expected = plain.step(actions)
        assert all(same(env.step(actions), expected) for env in divided)
        ended += (expected[2] | expected[3]).sum()
    assert ended >= 2 * slots
    for env in envs:
        env.close()


def test_masks_seeds_and_levels_reach_the_worlds_of_all_processes() -> None:
    made = lidar_among_boxes(horizon=2, curriculum=STAIRS)
    plain, divided = (VectorEnv(made, 5, autoreset_mode="Disabled", workers=w, copy=False) for w in (1, 3))
    mask = np.array([False, True, False, True, True])
    all_of_them = np.ones(5, dtype=bool)
    for asked in (
        {"options": {"level": 1}},
        {"options": {"reset_mask": mask}},
        {"seed": [5, 1, 8, 2, 9]},
        {"seed": [7, 7, 7, 7, 7], "options": {"reset_mask": mask}},
        {"options": {"reset_mask": all_of_them, "level": 0}},
    ):
        assert same(plain.reset(**asked), divided.reset(**asked))
        assert plain.worlds.seeds == divided.worlds.seeds
        for _ in range(3):
            actions = 0.1 * plain.action_space.sample()
            assert same(plain.step(actions), divided.step(actions))
    assert same(plain.worlds.step(None).reward, divided.worlds.step(None).reward)
    assert plain.worlds.level.tolist() == divided.worlds.level.tolist()
    divided.close()


def test_observations_are_not_copied_unless_asked_for() -> None:
    env = VectorEnv(lidar_among_boxes(), 4, copy=False, workers=2)
    first, _ = env.reset(seed=0)
    second = env.step(np.ones((4, 2)))[0]
    assert np.shares_memory(first, second)
    kept = second.copy()
    env.close()
    assert np.array_equal(second, kept)  # the memory lives as long as the array
    other = VectorEnv(lidar_among_boxes(), 4, workers=2)
    before, _ = other.reset(seed=0)
    kept = before.copy()
    other.step(np.ones((4, 2)))
    assert np.array_equal(before, kept)
    other.close()


def test_pictures_show_the_first_world() -> None:
    plain, divided = (VectorEnv(task(), 2, workers=w, render_mode="rgb_array") for w in (1, 2))
    pictures = []
    for env in (plain, divided):
        env.reset(seed=0)
        env.step(np.ones((2, 2)))
        pictures.append(env.render())
        env.close()
    assert same(*pictures)


# functions of the user ------------------------------------------------------------------------------------------------
def chatty(moment: Moment) -> Any:
    """A reward that prints."""
    print("a reward function prints this")
    return moment.distance_before - 2.0 * moment.distance


def picky(moment: Moment) -> Any:
    """A reward that fails in processes with two worlds."""
    if len(moment.arrived) == 2:
        raise ZeroDivisionError("there are two worlds", {"number": 2})
    return moment.distance


def deadly(moment: Moment) -> Any:
    """A reward that ends a process with two worlds."""
    if len(moment.arrived) == 2:
        os._exit(3)
    return moment.distance


def of_python(name: str) -> dict[str, Any]:
    return task(reward=[{"name": "python", "function": f"tests.learning.test_workers:{name}"}])


def test_reward_functions_in_python_get_the_worlds_of_their_process() -> None:
    plain, divided = (VectorEnv(of_python("chatty"), 3, workers=w) for w in (1, 2))
    plain.reset(seed=0)
    divided.reset(seed=0)
    for _ in range(3):
        assert same(plain.step(np.ones((3, 2))), divided.step(np.ones((3, 2))))
    divided.close()


def test_an_error_in_another_process_is_the_same_error_here() -> None:
    env = VectorEnv(of_python("picky"), 3, workers=2)
    env.reset(seed=0)
    for _ in range(2):  # the processes are still in step with each other
        with pytest.raises(ZeroDivisionError, match="there are two worlds") as failed:
            env.step(np.zeros((3, 2)))
        assert failed.value.args[1] == {"number": 2}
    env.close()
    wrong = VectorEnv(of_python("nothing"), 3, workers=2)
    with pytest.raises(ArgumentError, match="cannot be imported") as refused:
        wrong.step(np.zeros((3, 2)))
    assert refused.value.fix == "give MODULE:FUNCTION of a module that Python finds"
    wrong.close()


def test_behaviors_that_only_this_program_knows_are_refused() -> None:
    @register_behavior("diff", "circling")
    def circling(ego_object: Any, **keys: Any) -> Any:
        return np.array([[0.5], [0.5]])

    moving = {"kinematics": {"name": "diff"}, "behavior": {"name": "circling"}, "distribution": RANDOM}
    made = task(obstacles=[moving])
    VectorEnv(made, 2).close()
    with pytest.raises(ArgumentError, match=r"(?s)worker process cannot make the worlds.*circling.*leave out workers"):
        VectorEnv(made, 2, workers=2)


# arguments ------------------------------------------------------------------------------------------------------------
def test_actions_are_checked_before_any_world_moves() -> None:
    plain, divided = (VectorEnv(task(), 4, workers=w) for w in (1, 2))
    plain.reset(seed=0)
    divided.reset(seed=0)
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


def test_there_are_no_more_processes_than_worlds() -> None:
    env = VectorEnv(task(), 2, workers=50)
    assert isinstance(env.worlds, DividedWorlds)
    assert len(env.worlds.pids) == 1
    env.close()
    assert not hasattr(VectorEnv(task(), 1, workers=50).worlds, "pids")


# ends -----------------------------------------------------------------------------------------------------------------
def divided_env(made: Any, slots: int = 3) -> tuple[VectorEnv, list[int]]:
    env = VectorEnv(made, slots, workers=2)
    env.reset(seed=0)
    assert isinstance(env.worlds, DividedWorlds)
    return env, env.worlds.pids


def test_a_process_that_is_killed_is_an_error() -> None:
    env, pids = divided_env(task())
    os.kill(pids[0], signal.SIGKILL)
    wait_for_end(pids)
    with pytest.raises(WorkerError, match=r"a worker process of the environment has died \(signal 9\)"):
        env.step(np.zeros((3, 2)))
    with pytest.raises(ArgumentError, match="the environment is closed"):
        env.step(np.zeros((3, 2)))
    env.close()


def test_a_process_that_ends_itself_is_an_error() -> None:
    env, pids = divided_env(of_python("deadly"))
    with pytest.raises(WorkerError, match="exit code 3"):
        env.step(np.zeros((3, 2)))
    wait_for_end(pids)


def test_processes_end_with_the_environment() -> None:
    env, pids = divided_env(task())
    assert all(map(lives, pids))
    env.close()
    env.close()
    assert not any(map(lives, pids))
    with pytest.raises(ArgumentError, match="the environment is closed"):
        env.reset()
    other, pids = divided_env(task())
    del other
    gc.collect()
    assert not any(map(lives, pids))


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
        wait_for_end(pids)
