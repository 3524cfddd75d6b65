"""The skill ``irsim-runner``: its programs run, its examples end as they state, what its pages say is so."""

from __future__ import annotations

import ast
import json
import re
import shlex
import shutil
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.learning import VectorEnv
from irsim.learning.tasks.files import TASKS
from irsim.options.registry import BRIDGES
from irsim.validation.file_reports import task_report
from tests.bridges import crowds
from tests.cli.conftest import ROOM
from tests.skills.conftest import ROOT, commands, execute, fences, parts, read, script, spans
from tests.skills.test_skill import SKELETON

SKILL = ROOT / "skills" / "irsim-runner"
_, BODY = parts(SKILL / "SKILL.md")
HALL = SKELETON.replace("    plot:", "    sensors: [{name: lidar2d}]\n    plot:").replace(
    "  height: 8 ", "  time_limit: 15\n  height: 8 "
)
BRIDGE_PAGES = SKILL / "bridges"
OVERVIEW = (BRIDGE_PAGES / "overview.md").read_text(encoding="utf-8")
GUIDE = (SKILL / "guides" / "learning.md").read_text(encoding="utf-8")
SCENE = {
    "world": {"width": 10, "height": 10, "boundary": "walls", "collision_mode": "stop"},
    "robot": [
        {
            "kinematics": {"name": "diff"},
            "distribution": {"name": "random", "goal_distance": 4},
            "vel_min": [0, -2],
            "vel_max": [1, 2],
            "sensors": [{"name": "lidar2d", "number": 72}],
        }
    ],
    "obstacle": [{"number": 8, "distribution": {"name": "random"}, "shape": {"name": "circle", "radius": 0.3}}],
}
POLICY = "def act(env):\n    return [0.5, 0.0]\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A directory with the scenario that the skill speaks of, and a policy."""
    (tmp_path / "hall.yaml").write_text(HALL, encoding="utf-8")
    (tmp_path / "policy.py").write_text(POLICY, encoding="utf-8")
    return tmp_path


@pytest.fixture
def copied(tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    """A copy of an example, with the skill's scripts where it looks for them."""
    shutil.copytree(SKILL / "scripts", tmp_path / "scripts")
    shutil.copytree(SKILL / "examples" / request.param, tmp_path / "examples" / request.param)
    return tmp_path / "examples" / str(request.param)


def test_the_loop_runs_and_repeats_itself(folder: Path) -> None:
    program, _ = fences(BODY, "python")
    first, second = (execute(["python", "-c", program], folder).splitlines() for _ in range(2))
    rows = [line for line in first if re.match(r"\d ", line)]
    assert len(rows) == 5
    assert rows == [line for line in second if re.match(r"\d ", line)]


def test_the_episodes_of_the_guide_run_on_all_cores(folder: Path) -> None:
    text = (SKILL / "guides" / "output.md").read_text(encoding="utf-8")
    controller, program = fences(text, "python")[:2]
    (folder / "controller.py").write_text(controller, encoding="utf-8")
    (folder / "program.py").write_text(program, encoding="utf-8")
    [hall] = fences((ROOT / "README.md").read_text(encoding="utf-8"), "yaml")
    for scene in (HALL, hall):
        (folder / "hall.yaml").write_text(scene, encoding="utf-8")
        first, second = execute(["python", "program.py"], folder).splitlines()[-2:]
        assert [row[0] for row in ast.literal_eval(second)] == list(range(6))
    assert "6 of 6 episodes succeeded" in first


def test_the_script_works_as_written(folder: Path) -> None:
    [words] = commands(SKILL / "SKILL.md")
    told = json.loads(execute(["python", str(SKILL / words[1]), *words[2:]], folder))
    assert told["seed"] == 7
    assert len(told["episodes"]) == 5
    assert told["success"] + told["collision"] + told["timeout"] == 5
    assert (folder / "end.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["hall.yaml", "--policy", "policy:missing"], 2, "missing"),
        (["hall.yaml", "--policy", "broken:act"], 1, "ZeroDivisionError"),
        (["wrong.yaml"], 2, "hight"),
    ],
)
def test_the_scripts_exit_codes_tell_whose_fault_it_is(folder: Path, words: list[str], code: int, said: str) -> None:
    (folder / "broken.py").write_text("def act(env):\n    return 1 / 0\n", encoding="utf-8")
    (folder / "wrong.yaml").write_text(HALL.replace("height", "hight"), encoding="utf-8")
    if words[0] == "hall.yaml":
        words = [*words, "--steps", "5"]
    ended, told = script(SKILL / "scripts" / "episodes.py", *words, folder=folder)
    assert (ended, list(told)) == (code, ["said"])
    assert said in told["said"]


def test_without_a_time_limit_the_script_has_the_horizon_of_irsim_run(folder: Path) -> None:
    (folder / "open.yaml").write_text(SKELETON, encoding="utf-8")
    _, told = script(SKILL / "scripts" / "episodes.py", "open.yaml", "--episodes", "1", folder=folder)
    run = irsim.run(folder / "open.yaml")
    assert run.time_limit_from == "default"
    assert told["time_limit"] == pytest.approx(run.time_limit)


def test_the_behavior_works_by_the_command_it_names(folder: Path) -> None:
    _, program = fences(BODY, "python")
    (folder / "creeping.py").write_text(program, encoding="utf-8")
    mapping = re.search(r"`behavior: (\{name: creep.*?\})`", BODY)
    assert mapping
    (folder / "creep.yaml").write_text(HALL.replace("{name: dash}", mapping[1]), encoding="utf-8")
    told = execute(["irsim", "run", "creep.yaml", "--import", "creeping", "--steps", "100", "--json"], folder)
    assert json.loads(told)["robots"][0]["path_length"] == pytest.approx(4.0, abs=0.1)


@pytest.mark.parametrize("copied", ["lidar-policy"], indirect=True)
def test_the_policy_arrives_as_often_as_stated(copied: Path) -> None:
    words = next(words for words in commands(copied) if words[0] == "irsim")
    given = (copied / "scenario.yaml").read_text(encoding="utf-8")
    execute([*words, "--force"], copied)
    filled = yaml.safe_load((copied / "scenario.yaml").read_text(encoding="utf-8"))
    edited = yaml.safe_load(given)
    assert edited["world"].pop("plot") != filled["world"].pop("plot")
    assert edited["robot"][0].pop("plot") == {**filled["robot"][0].pop("plot"), "show_trajectory": True}
    assert edited == filled
    (copied / "scenario.yaml").write_text(given, encoding="utf-8")
    [words] = [words for words in commands(copied) if "../../scripts/episodes.py" in words]
    told = json.loads(execute(words, copied))
    assert f"**{told['success']} of {len(told['episodes'])}**" in read(copied, "elements.md")
    assert f"{told['success']} of {len(told['episodes'])} layouts" in read(copied, "reply.md")
    assert (told["success"], told["seed"]) == (10, 1)


@pytest.mark.parametrize("copied", ["give-way"], indirect=True)
def test_the_behavior_of_ones_own_makes_the_stated_difference(copied: Path) -> None:
    for words in commands(copied):
        told = execute(words, copied)
        if words[1] == "run":
            assert "the robot arrived at 11 s" in told
    dashing = (copied / "scenario.yaml").read_text(encoding="utf-8").replace("give_way, distance: 1.6", "dash")
    (copied / "dash.yaml").write_text(dashing, encoding="utf-8")
    result = irsim.run(copied / "dash.yaml", seed=3)
    assert (result.outcome, round(result.sim_time, 1)) == ("collision", 2.8)
    assert "in **success** after 11.0 s" in read(copied, "elements.md")
    assert "**collision** at 2.8 s" in read(copied, "elements.md")


@pytest.mark.parametrize("copied", ["scan-data"], indirect=True)
def test_the_data_set_is_the_stated_one(copied: Path) -> None:
    for words in commands(copied):
        told = execute(words, copied)
        if words[1] == "run":
            assert "the last at 9 s" in told
    shapes = json.loads(told)["shapes"]
    assert f"**{shapes['scan'][0]}** samples" in read(copied, "elements.md")
    data = np.load(copied / "samples.npz")
    assert data["scan"].shape == (shapes["scan"][0], 61)
    assert data["action"][:, 0].max() <= 1.0
    assert 0 < data["scan"].min() <= data["scan"].max() == 5.0


def test_what_it_names_exists() -> None:
    from irsim.compat.objects.view import ScriptObject
    from irsim.env import Env

    for name in re.findall(r"`env\.(\w+)", BODY):
        assert hasattr(Env, name) or name in ("seed", "scenario"), name
    for name in ("state", "goal", "velocity_xy", "get_lidar_scan", "set_state"):
        assert hasattr(ScriptObject, name)
    named = {span.split()[1] for span in spans(BODY) if span.startswith("irsim ")}
    assert named <= {"run", "render", "benchmark", "inspect", "replay", "validate", "export", "diff-runs", "train"}


def test_what_it_warns_of_is_so(folder: Path) -> None:
    env = irsim.make(folder / "hall.yaml", display=False, seed=1, log_level="ERROR")
    env.step([5.0, 0.0])
    assert env.robot.velocity[0, 0] == 1.0  # limited by the file
    assert env.robot.state.shape == (3, 1)
    with pytest.raises(ValueError, match="read-only"):
        env.robot.state[0, 0] = 1
    assert env.get_lidar_scan()["ranges"].max() == env.get_lidar_scan()["range_max"]
    for _ in range(20):
        env.step([0.0, 0.0])
    assert (env.outcome, env.done()) == ("running", False)
    env.end(ending_time=0)
    quiet = irsim.make(folder / "hall.yaml", headless=True, log_level="ERROR")
    assert quiet.save_figure("x.png") is None
    quiet.end()


def test_done_is_true_after_a_collision_and_outcome_tells(folder: Path) -> None:
    (folder / "hit.yaml").write_text(HALL.replace("[6, 6.5, 0]", "[6, 4, 0]"), encoding="utf-8")
    env = irsim.make(folder / "hit.yaml", display=False, log_level="ERROR")
    for _ in range(100):
        env.step()
    assert (env.done(), env.outcome) == (True, "collision")
    env.end(ending_time=0)


def test_an_animation_of_a_loop_lands_where_told(folder: Path) -> None:
    env = irsim.make(folder / "hall.yaml", display=False, save_ani=True, log_level="ERROR")
    for _ in range(3):
        env.step([0.5, 0.1])
        env.render(0)
    env.end(ending_time=0, path=folder / "run.gif")
    assert (folder / "run.gif").read_bytes().startswith(b"GIF8")


def test_layouts_follow_the_seed_and_batches_are_the_same_worlds() -> None:
    path = SKILL / "examples" / "scan-data" / "scenario.yaml"
    env = irsim.make(path, display=False, seed=5, log_level="ERROR")
    start = [robot.state.copy() for robot in env.robot_list]
    env.step()
    env.reset()
    assert all(np.array_equal(robot.state, before) for robot, before in zip(env.robot_list, start, strict=True))
    env.reset(random=True)
    assert not np.array_equal(env.robot_list[0].state, start[0])
    worlds = irsim.batch(path, 2, seeds=[4, 5])
    np.testing.assert_array_equal(worlds.pose[1, 0], start[0][:, 0])
    kept = worlds.pose
    before = kept.copy()
    worlds.step()
    assert not np.array_equal(kept, before)  # a view
    env.end(ending_time=0)


def test_a_program_of_any_kind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    [_, program] = fences(OVERVIEW, "python")
    [command] = fences(OVERVIEW, "bash")
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = str(free.getsockname()[1])
    (tmp_path / "driver.py").write_text(program.replace("9100", port))
    (tmp_path / "hall.yaml").write_text(ROOM)
    with subprocess.Popen([sys.executable, "driver.py"]) as driver:
        try:
            wait_for(port)
            words = shlex.split(command.replace("9100", port))[1:]
            done = CliRunner().invoke(app, [*words, "--steps", "30", "--json"])
            assert done.exit_code == 0, done.output
            assert driver.wait(10) == 0
        finally:
            driver.kill()
    [robot] = json.loads(done.stdout)["robots"]
    assert robot["path_length"] == pytest.approx(1.53, abs=0.03)  # 0.5 m/s, after a first step of its own


def wait_for(port: str) -> None:
    """Wait until something listens, without connecting to it."""
    for _ in range(200):
        listening = Path("/proc/net/tcp").read_text() if sys.platform == "linux" else ""
        if not listening or f":{int(port):04X} 00000000:0000 0A" in listening:
            return
        time.sleep(0.05)
    raise AssertionError("the port does not listen")


def test_the_loop_with_connections_is_right(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "hall.yaml").write_text(ROOM)
    [loop, _] = fences(OVERVIEW, "python")
    seen: dict[str, Any] = {}
    exec(loop, seen)
    assert seen["env"].outcome == "success"


def test_every_bridge_has_a_page_that_says_what_was_not_run() -> None:
    pages = {page.stem: page.read_text(encoding="utf-8") for page in BRIDGE_PAGES.glob("*.md")}
    for name in BRIDGES.names():
        assert any(f"name: {name}" in text or f"`{name}`" in text for text in pages.values()), name
    for name, text in pages.items():
        if name != "overview":
            assert "not run" in text.lower(), f"{name}.md does not say what was not run"
            assert "hecklist" in text, f"{name}.md has no checklist"


def test_the_commands_about_recorded_pedestrians_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "obsmat.txt").write_text(crowds.obsmat())
    (tmp_path / "crowd.vsp").write_text(crowds.vsp())
    (tmp_path / "walk.txt").write_text(crowds.square())
    np.savetxt(tmp_path / "H.txt", np.array([[0.02, 0, -7.2], [0, -0.02, 5.76], [0, 0, 1]]))
    (tmp_path / "hall.yaml").write_text("world: {width: 20, height: 16}\nrobot: [{kinematics: {name: diff}}]\n")
    told = commands(BRIDGE_PAGES / "pedestrians.md")
    assert len(told) == 12
    for _, *words in told:
        done = CliRunner().invoke(app, [*words, *(["--seeds", "2"] if words[0] == "benchmark" else [])])
        assert done.exit_code == 0, (words, done.output)
    texts = {path.stem: path.read_text() for path in tmp_path.glob("*.yaml")}
    assert set(texts) == {"crowd", "crowd_suite", "zara", "corner", "part", "people", "short", "hall", "busy"}
    assert "robot:" not in texts["people"]
    places = [text[text.index("poses:") :].split("]")[0] for text in (texts["zara"], texts["corner"])]
    first = [np.array([float(v) for v in text.split("[[")[1].split(",")]) for text in places]
    np.testing.assert_allclose(*first, atol=1e-9)


@pytest.mark.parametrize("with_draws", [False, True])
def test_the_task_of_the_guide_is_valid_and_steps(with_draws: bool, tmp_path: Path) -> None:
    task, more = fences(GUIDE, "yaml")
    (tmp_path / "task.yaml").write_text(task + (more if with_draws else ""), encoding="utf-8")
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(SCENE), encoding="utf-8")
    report = task_report(str(tmp_path / "task.yaml"))
    assert report.valid, report.findings
    env = VectorEnv(tmp_path / "task.yaml", 4)
    _, info = env.reset(seed=0)
    assert ("drawn" in info) == with_draws
    if with_draws:
        assert info["level"].tolist() == [0] * 4
        assert set(info["drawn"]["number.obstacle[0]"].tolist()) <= {0, 1}
        _, info = env.reset(options={"level": 1})
        assert set(info["drawn"]["number.obstacle[0]"].tolist()) <= set(range(2, 9))
    assert env.step(env.action_space.sample())[0].shape == (4, env.worlds.eyes.size)


def test_the_skill_names_the_guide_to_learning_and_the_guide_bundled_tasks() -> None:
    assert "(guides/learning.md)" in BODY
    named = set(re.findall(r"`(goal_lidar|multi_robot|[a-z]+_[a-z]+)`", GUIDE)) & {"goal_lidar", "multi_robot"}
    assert named == {"goal_lidar", "multi_robot"} <= set(TASKS.names())
