"""Bridges that are lost, late, cannot be opened or closed, and runs that a signal ends."""

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
from irsim.bridges.base import Bridge, BridgeError, BridgeLostError
from irsim.bridges.connect import connect
from irsim.bridges.state import Feedback
from irsim.cli.app import app
from irsim.diagnostics.errors import CodedError
from tests.bridges.peer import Peer
from tests.bridges.test_connect import SCENE, Recording, lines, make
from tests.policies.test_process import ACT, PROGRAM

LOST = "did not answer within 0.5 s"


def leaving(message: dict[str, Any]) -> Any:
    """A program that falls silent after the third step."""
    return b"" if message["kind"] == "state" and message["step"] == 3 else {}


def call(*words: str) -> Any:
    result = CliRunner().invoke(app, list(words))
    assert "Traceback" not in result.output
    return result


def scene(peer: Peer | None) -> str:
    """Writes the scenario with a bridge to a peer."""
    more = "" if peer is None else lines(peer.address, ", answers: true, timeout: 0.5")
    Path("scene.yaml").write_text(SCENE.format(drive="diff", world="") + more)
    return "scene.yaml"


def test_the_command_fails_and_says_why() -> None:
    with Peer(leaving) as peer:
        result = call("run", scene(peer), "--record")
    assert result.exit_code == 1
    assert f"error bridge-lost: json_lines {peer.address} {LOST}; the run ended after 0.3 s" in result.stderr
    assert "lost: the robot did not arrive" in result.stdout
    assert "timeout:" not in result.stdout
    assert LOST in result.stdout
    assert " lost " in call("inspect").stdout, "runs are listed with how they ended"


def test_result_and_record_have_the_reason() -> None:
    with Peer(leaving) as peer:
        result = call("run", scene(peer), "--json", "--record-to", "record")
    data = json.loads(result.stdout)
    assert (result.exit_code, data["outcome"], data["lost_code"]) == (1, "timeout", "bridge-lost")
    assert LOST in data["lost"]
    assert data["reason"] == f"{data['lost']}; the run ended"
    assert "the program of a bridge was lost" in data["summary"]
    assert result.stderr.count("\n") == 1  # only the error
    run = irsim.runs.open_run("record")
    assert run.result is not None
    assert (run.status, run.result.lost_code, run.result.steps) == ("finished", "bridge-lost", 3)
    assert run.result.lost == data["lost"]
    shown = call("inspect", "record")
    assert ": lost: the robot did not arrive" in shown.stdout
    assert f"reason: json_lines {peer.address} {LOST}" in shown.stdout
    assert json.loads(call("inspect", "record", "--json").stdout)["lost"] == run.result.lost


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


def test_a_lost_policy_fails_as_well() -> None:
    Path("policy.py").write_text(PROGRAM.replace("    print(json", f"    if {ACT}: sys.exit(3)\n    print(json"))
    policy = json.dumps({"name": "process", "command": [sys.executable, "policy.py"]})
    result = call("run", scene(None), "--policy", policy)
    assert result.exit_code == 1
    assert "error policy-lost: " in result.stderr
    assert "has ended with exit code 3; the run ended after 0 s" in result.stderr
    assert "\nlost: " in result.stdout
    assert "the policy was lost, which ended the run" in result.stdout


def test_a_run_says_to_what_it_is_connected() -> None:
    with Peer(lambda message: {}) as peer:
        result = call("run", scene(peer), "--steps", "3")
    said = result.stderr.splitlines()[0]
    until = "the run ends when all robots have arrived or stopped, or at 0.3 s; Ctrl-C ends it now"
    assert said == f"connected to the program at {peer.address} (mode: sim); {until}"
    assert "connected to" not in result.stdout


def test_a_run_for_programs_says_nothing_of_it() -> None:
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
def test_the_other_program_is_told_the_end() -> None:
    Path("scene.yaml").write_text(ENDLESS)
    with Peer(lambda message: None) as peer:
        bridge = f"{{name: json_lines, clock: wall, address: '{peer.address}'}}"
        command = [sys.executable, "-m", "irsim", "run", "scene.yaml", "--steps", "100000", "--bridge", bridge]
        with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
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


def test_steps_are_not_caught_up_after_a_long_delay(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim.bridges.connect._MAX_DELAY_S", 0.3)
    env, bridge = make(), Recording()
    bridge.clock = "wall"
    with connect(env, [bridge]) as connection:
        env.step()
        time.sleep(0.6)
        begin = time.monotonic()
        for _ in range(6):
            env.step()
        assert time.monotonic() - begin > 0.4  # the world outside goes on as fast as before
        assert connection.late > 0.3


def test_another_scene_needs_bridges_of_its_own() -> None:
    env = irsim.make(scene(None), display=False, log_level="ERROR")
    with connect(env, [Recording()]), pytest.raises(CodedError, match="while its bridges are open"):
        env.reload()
    env.reload()


def test_two_bridges_do_not_write_to_one_file() -> None:
    with pytest.raises(BridgeError, match="two bridges write to 'lab'"):
        irsim.run(text=SCENE.format(drive="diff", world=""), bridges=[{"name": "rosbag", "folder": "lab"}] * 2)
    assert not list(Path().iterdir())


def test_what_is_no_bridge_is_named() -> None:
    first = Recording()
    with pytest.raises(BridgeError, match="'ros2' is not a bridge"):
        connect(make(), [first, "ros2"])  # type: ignore[list-item]
    assert first.closed == 1


def test_a_bridge_that_cannot_be_closed_is_named() -> None:
    class Full(Recording):
        name = "full"

        def close(self) -> None:
            raise OSError(28, "No space left on device")

    with pytest.raises(BridgeError, match=r"full could not be closed: No space left on device. Fix: "):
        connect(make(), [Full()]).close()
    with pytest.raises(ZeroDivisionError), connect(make(), [Full()]):
        raise ZeroDivisionError  # the first error is the one that is told


def test_a_line_without_end_is_told_though_nobody_waits_for_it() -> None:
    with Peer(lambda message: b"x" * 5_000_000 if message["kind"] == "scene" else None) as peer:
        env = make(more=lines(peer.address))

        def step_until_lost() -> None:
            with connect(env):
                for _ in range(500):
                    env.step()
                    time.sleep(0.01)

        with pytest.raises(BridgeLostError, match="a line of more than 4 MB"):
            step_until_lost()
