"""Bridges that are lost, and runs that a signal ends."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import irsim
from irsim.bridges.base import Bridge, BridgeLostError
from irsim.bridges.connect import connect
from irsim.bridges.state import Feedback
from irsim.cli.app import app
from tests.bridges.peer import Peer
from tests.bridges.test_connect import SCENE, lines, make
from tests.policies.test_process import ACT, PROGRAM

LOST = "did not answer within 0.5 s"


def leaving(message: dict[str, Any]) -> Any:
    """A program that falls silent after the third step."""
    return b"" if message["kind"] == "state" and message["step"] == 3 else {}


def call(*words: str) -> Any:
    result = CliRunner().invoke(app, list(words))
    assert "Traceback" not in result.output
    return result


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Writes the scenario with a bridge to a peer, and goes to its folder."""
    monkeypatch.chdir(tmp_path)

    def write(peer: Peer | None) -> str:
        more = "" if peer is None else lines(peer.address, ", answers: true, timeout: 0.5")
        Path("scene.yaml").write_text(SCENE.format(drive="diff", world="") + more)
        return "scene.yaml"

    return write


def test_the_command_fails_and_says_why(scene: Any) -> None:
    with Peer(leaving) as peer:
        result = call("run", scene(peer))
    assert result.exit_code == 1
    assert f"error bridge-lost: json_lines {peer.address} {LOST}; the run ended after 0.3 s" in result.stderr
    assert "lost: the robot did not arrive" in result.stdout
    assert "timeout:" not in result.stdout
    assert LOST in result.stdout


def test_the_result_as_json_has_the_reason(scene: Any) -> None:
    with Peer(leaving) as peer:
        result = call("run", scene(peer), "--json")
    data = json.loads(result.stdout)
    assert (result.exit_code, data["outcome"], data["lost_code"]) == (1, "timeout", "bridge-lost")
    assert LOST in data["lost"]
    assert data["reason"] == f"{data['lost']}; the run ended"
    assert result.stderr.count("\n") == 1  # only the error


def test_the_record_keeps_the_reason_and_the_notes(scene: Any) -> None:
    with Peer(leaving) as peer:
        call("run", scene(peer), "--record-to", "record")
    run = irsim.runs.open_run("record")
    assert run.result is not None
    assert (run.status, run.result.lost_code, run.result.steps) == ("finished", "bridge-lost", 3)
    assert LOST in str(run.result.lost)
    shown = call("inspect", "record")
    assert ": lost: the robot did not arrive" in shown.stdout
    assert f"reason: json_lines {peer.address} {LOST}" in shown.stdout
    assert json.loads(call("inspect", "record", "--json").stdout)["lost"] == run.result.lost


def test_runs_are_listed_with_how_they_ended(scene: Any) -> None:
    with Peer(leaving) as peer:
        call("run", scene(peer), "--record")
    assert " lost " in call("inspect").stdout


def test_a_script_gets_an_exception_in_this_and_each_further_step() -> None:
    with Peer(leaving) as peer:
        env = make(more=lines(peer.address, ", answers: true, timeout: 0.5"))
        with irsim.connect(env) as connection:
            env.step()
            env.step()
            assert connection.lost is None
            for _ in range(2):
                with pytest.raises(BridgeLostError, match=LOST):
                    env.step()
            assert LOST in str(connection.lost)
    assert env.outcome == "running"


def test_a_collision_before_the_loss_stays_one() -> None:
    """The other program drives the robot into the triangle, and leaves."""

    class Pushing(Bridge):
        name = "pushing"
        agents = frozenset(["robot_0"])

        def exchange(self, motion: Any) -> Feedback:
            if motion.step == 3:
                raise ConnectionResetError(104, "Connection reset by peer")
            return Feedback({"robot_0": (5.0, 6.5, 0.0)})

    env = make()
    with connect(env, [Pushing()]) as connection:
        for _ in range(3):
            env.step()
        with pytest.raises(BridgeLostError, match="pushing: Connection reset by peer"):
            env.step()
        assert connection.lost == "pushing: Connection reset by peer"
    assert env.outcome == "collision"


def test_a_lost_policy_fails_as_well(scene: Any, tmp_path: Path) -> None:
    file = tmp_path / "policy.py"
    file.write_text(PROGRAM.replace("    print(json", f"    if {ACT}: sys.exit(3)\n    print(json"))
    policy = json.dumps({"name": "process", "command": [sys.executable, str(file)]})
    result = call("run", scene(None), "--policy", policy)
    assert result.exit_code == 1
    assert "error policy-lost: " in result.stderr
    assert "has ended with exit code 3; the run ended after 0 s" in result.stderr
    assert "\nlost: " in result.stdout
    assert "the policy was lost, which ended the run" in result.stdout


def test_a_run_says_to_what_it_is_connected(scene: Any) -> None:
    with Peer(lambda message: {}) as peer:
        result = call("run", scene(peer), "--steps", "3")
    said = result.stderr.splitlines()[0]
    until = "the run ends when all robots have arrived or stopped, or at 0.3 s; Ctrl-C ends it now"
    assert said == f"connected to the program at {peer.address} (mode: sim); {until}"
    assert "connected to" not in result.stdout


def test_a_run_for_programs_says_nothing_of_it(scene: Any) -> None:
    with Peer(lambda message: {}) as peer:
        result = call("run", scene(peer), "--steps", "3", "--json")
    assert (result.exit_code, result.stderr) == (0, "")


def test_two_bridges_are_told_in_one_line() -> None:
    told: list[str] = []
    with Peer(lambda message: {}) as one, Peer(lambda message: {}) as two:
        text = SCENE.format(drive="diff", world="") + lines(one.address)
        others = [{"name": "json_lines", "address": two.address}]
        irsim.run(text=text, steps=2, bridges=others, connected=told.append)
    [said] = told
    assert f"{one.address} (mode: sim) and the program at {two.address} (mode: sim)" in said


ENDLESS = """
world: {width: 10, height: 10}
robot: [{kinematics: {name: diff}, state: [1, 5, 0], goal: [1000, 5], vel_max: [0, 0]}]
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_the_other_program_is_told_the_end(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(ENDLESS)
    with Peer(lambda message: None) as peer:
        bridge = f"{{name: json_lines, clock: wall, address: '{peer.address}'}}"
        command = [sys.executable, "-m", "irsim", "run", "scene.yaml", "--steps", "100000", "--bridge", bridge]
        with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
            try:
                until = time.monotonic() + 60
                while len(peer.kinds()) < 5 and time.monotonic() < until:
                    time.sleep(0.05)
                process.send_signal(signal.SIGTERM)
                _, error = process.communicate(timeout=20)
            finally:
                process.kill()
        assert process.returncode == 128 + signal.SIGTERM
        assert "Traceback" not in error
        assert peer.kinds()[-1] == "end"
