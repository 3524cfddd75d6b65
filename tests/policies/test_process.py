"""Policies in other processes: the lines of JSON, time limits, and what happens when a process is lost."""

from __future__ import annotations

import gc
import io
import json
import os
import socket
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.diagnostics.errors import ArgumentError, CodedError, PolicyError, PolicyLostError
from irsim.lookup.topics import lookup
from irsim.policies import open_policy
from irsim.policies.catalog import UnknownPolicyError
from irsim.policies.process import ProcessPolicy
from irsim.policies.process.channel import Channel, PeerError
from tests.policies.scenes import FREE
from tests.processes import runs, wait_until_gone

PROGRAM = lookup("process").example or ""
"""The program of the guide: it drives straight to the goal."""
ACT = 'asked["type"] == "act"'


def script(folder: Path, before: str = "", text: str = PROGRAM) -> Path:
    """A program that runs a statement before it answers."""
    file = folder / f"program{len(list(folder.iterdir()))}.py"
    file.write_text(text.replace("    print(json", f"    {before}\n    print(json") if before else text)
    return file


def program(folder: Path, *, before: str = "", text: str = PROGRAM) -> ProcessPolicy:
    """The policy of such a program."""
    return ProcessPolicy([sys.executable, str(script(folder, before, text))], timeout=1.0)


def straight(seen: irsim.policies.Observations) -> np.ndarray:
    """The same as the program of the guide."""
    away = (seen.goal - seen.pose)[:, :2]
    return away / np.maximum(np.sqrt(away[:, :1] ** 2 + away[:, 1:] ** 2), 1e-9)


straight.output = "velocity"  # type: ignore[attr-defined]


def test_the_program_of_the_guide_drives_as_the_same_function_here(make: Any, tmp_path: Path) -> None:
    there = program(tmp_path)
    assert (there.output, there.stochastic) == ("velocity", False)
    here, away = (make(FREE, policy=policy) for policy in (straight, there))
    for _ in range(40):
        here.step()
        away.step()
    np.testing.assert_array_equal(here.simulation.pose, away.simulation.pose)
    assert np.abs(here.simulation.pose[:, :2]).max() > 1


@pytest.mark.parametrize(
    ("before", "why"),
    [
        (f"import time; time.sleep(60 * ({ACT}))", "gave no answer within 1 s"),
        (f"if {ACT}: sys.exit(3)", "has ended with exit code 3"),
        (f"if {ACT}: answer = 5", "answered '5' where an object with type 'decision' is expected"),
        (f"if {ACT}: print('hello')", "answered 'hello', which is not a line of JSON"),
        (f"if {ACT}: answer['decision'] = 'fast'", "decided something that is not a table of numbers"),
        (f"if {ACT}: answer['decision'] = [[1, 2]] * 99", "decided an array of shape (99, 2) where 2 rows"),
        (f"if {ACT}: answer['decision'][0][0] = float('nan')", "decided numbers that are not finite"),
        (f"if {ACT}: answer['decision'] = None", "decided an array of shape () where 2 rows"),
    ],
)
def test_a_process_that_fails_ends_the_run_with_a_reason(before: str, why: str, tmp_path: Path) -> None:
    began = time.monotonic()
    result = irsim.run(text=FREE, policy=program(tmp_path, before=before))
    assert (result.outcome, result.steps, result.reason) == ("timeout", 0, f"{result.lost}; the run ended")
    assert why in result.lost
    assert "the policy was lost" in result.summary
    assert time.monotonic() - began < 20


@pytest.mark.parametrize(
    ("said", "why"),
    [
        ('{"type": "policy", "protocol": 7}', "speaks protocol 7, and irsim speaks 1"),
        ('{"type": "policy", "speed": 7}', "declares 'speed'"),
        ('{"type": "policy", "drives": "diff"}', "drives that are not a list"),
        ('{"type": "policy", "needs": {"lidar": 7}}', "needs other than neighbors"),
        ('{"type": "policy", "needs": {"scan": 7}}', "'scan' is neither true nor false"),
        ('{"type": "policy", "drives": ["plane"]}', "declares the drive 'plane'; drives are acker, diff"),
        ("", "has ended with exit code 0"),
        ("[" * 100_000, "not a line of JSON"),
    ],
)
def test_a_process_that_does_not_say_what_it_is_cannot_be_opened(said: str, why: str, tmp_path: Path) -> None:
    text = f"print({said!r}, flush=True)\ninput()\nimport time; time.sleep(30)" if said else "input()"
    with pytest.raises(PolicyLostError, match="policy-lost") as raised:
        program(tmp_path, text=text)
    assert why in raised.value.message


def test_what_is_declared_is_checked_like_that_of_any_policy(tmp_path: Path) -> None:
    for declared, message in (
        ('"output": "speed"', "output of policy 'process' must be 'control' or 'velocity'"),
        ('"drives": ["acker"]', "policy-mismatch"),
    ):
        text = PROGRAM.replace('"output": "velocity"', declared)
        with pytest.raises(PolicyError, match=message):
            irsim.run(text=FREE, policy=program(tmp_path, text=text))


def test_lost_episodes_of_a_benchmark_are_counted_and_the_others_go_on(tmp_path: Path) -> None:
    before = f'if {ACT} and asked["time"][0] > 1 and seed % 2: sys.exit()'
    text = PROGRAM.replace('answer = {"type": "ready"}', 'answer, seed = {"type": "ready"}, asked["seed"]')
    policy = f"{{name: process, command: [{sys.executable}, {script(tmp_path, before, text)}]}}"
    result = irsim.benchmark(FREE, ["dash", policy], 8, perturb="position=0.1")
    mine = [episode for episode in result.episodes if episode.behavior != "dash"]
    lost = [episode for episode in mine if episode.lost]
    assert 0 < len(lost) < 8
    assert {episode.steps for episode in lost} == {11}
    assert all("has ended with exit code 0" in episode.lost for episode in lost)
    assert {episode.outcome for episode in mine if not episode.lost} == {"success"}
    assert result.rows[1].incidents["policy-lost"] == len(lost)
    assert any(f"the policy was lost in {len(lost)} of 16 episodes" in text for text in result.incidents)
    again = irsim.benchmark(FREE, [result.behaviors[1]], 8, perturb="position=0.1")
    assert [episode.lost for episode in again.episodes] == [episode.lost for episode in mine]  # seeds decide


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_process_ends_with_its_policy_and_takes_its_children_with_it(tmp_path: Path) -> None:
    note = tmp_path / "pids"
    started = "subprocess.Popen(['sleep', '99']).pid"
    before = f"import os, subprocess; print(os.getpid(), {started}, file=open({str(note)!r}, 'w'))"
    policy = program(tmp_path, before=f'if asked["type"] == "reset": {before}')
    irsim.run(text=FREE, policy=policy)
    pids = [int(pid) for pid in note.read_text().split()]
    assert all(map(runs, pids))
    del policy
    gc.collect()
    wait_until_gone(pids)


@pytest.mark.parametrize("family", ["inet", "unix"])
def test_one_that_listens_on_a_socket_is_asked_the_same(family: str, tmp_path: Path) -> None:
    if family == "inet":
        server = socket.create_server(("127.0.0.1", 0))
        address = f"127.0.0.1:{server.getsockname()[1]}"
    else:
        address = str(tmp_path / "s")
        server = socket.create_server(address, family=socket.AF_UNIX)
    asked: list[dict[str, Any]] = []
    thread = threading.Thread(target=_serve, args=(server, asked), daemon=True)
    thread.start()
    policy = open_policy({"name": "process", "address": address})
    result = irsim.run(text=FREE, policy=policy)
    assert result.outcome == "success"
    kinds = [one["type"] for one in asked]
    assert (kinds[0], kinds[1], set(kinds[2:])) == ("hello", "reset", {"act"})
    assert asked[1]["robots"] == [0, 1]
    first = asked[2]
    assert set(first["neighbors"]) == {"position", "heading", "velocity", "radius", "arrived", "mask", "index", "robot",
                                       "extent", "own_extent"}  # fmt: skip
    assert (np.shape(first["pose"]), np.shape(first["neighbors"]["position"])) == ((2, 3), (2, 1, 2))
    assert first["goal"][0][2] is None or isinstance(first["goal"][0][2], float)
    assert first["maps"]["of_row"] == [0, 0]
    assert first["maps"]["distinct"][0]["resolution"] > 0
    policy.close()
    thread.join(10)
    assert not thread.is_alive()
    server.close()


def _serve(server: socket.socket, asked: list[dict[str, Any]]) -> None:
    connection, _ = server.accept()
    with connection, connection.makefile("rwb") as stream:
        for line in stream:
            data = json.loads(line)
            asked.append(data)
            answer: dict[str, Any] = {"type": "policy", "output": "velocity", "needs": {"neighbors": 1, "map": True}}
            if data["type"] == "reset":
                answer = {"type": "ready"}
            if data["type"] == "act":
                pairs = zip(data["goal"], data["pose"], strict=True)
                answer = {"type": "decision", "decision": [[g[0] - p[0], g[1] - p[1]] for g, p in pairs]}
            stream.write(json.dumps(answer).encode() + b"\n")
            stream.flush()


SILENT = [sys.executable, "-c", "import time; time.sleep(9)"]
TALKING = [sys.executable, "-c", "print('hello')"]


@pytest.mark.parametrize(
    ("options", "error", "why", "fix"),
    [
        ({}, ArgumentError, "is started by its command, or listens", ""),
        ({"command": ["a"], "address": "b"}, ArgumentError, "is started by its command, or listens", ""),
        ({"command": "python mine.py"}, ArgumentError, "command must be a list of texts", ""),
        ({"command": []}, ArgumentError, "command must be a list of texts", ""),
        ({"command": ["python"], "timeout": 0}, ArgumentError, "timeout must be a time", ""),
        ({"command": ["no-such-program-here"]}, PolicyLostError, "cannot be started", "correct its command"),
        ({"address": "example.com:80"}, PolicyLostError, "is not on this machine", "machine and write 127.0.0.1:80"),
        ({"address": "127.0.0.1:9"}, PolicyLostError, "does not listen there", ""),
        ({"address": "127.0.0.1:99999"}, PolicyLostError, "does not listen there", ""),
        ({"address": "/no/such/socket"}, PolicyLostError, "does not listen there", ""),
        (
            {"address": "127.0.0.1"},
            PolicyLostError,
            "policy-lost",
            "write HOST:PORT such as 127.0.0.1:9000, or the path of its",
        ),
        ({"command": SILENT, "start_timeout": 0.2}, PolicyLostError, "policy-lost", "start_timeout"),
        ({"command": TALKING}, PolicyLostError, "policy-lost", "irsim describe process says what it must answer"),
    ],
)
def test_options_that_cannot_be_used_have_their_own_fix(
    options: dict[str, Any], error: type[CodedError], why: str, fix: str
) -> None:
    with pytest.raises(error, match=why) as raised:
        open_policy({"name": "process", **options})
    assert fix in str(raised.value.fix)


def test_the_report_of_a_benchmark_shows_lost_episodes_as_far_as_they_went(tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text(FREE)
    before = f'if {ACT} and asked["time"][0] > 1: sys.exit()'
    policy = f"{{name: process, command: [{sys.executable}, {script(tmp_path, before)}]}}"
    result = CliRunner().invoke(app, ["benchmark", str(file), "--policies", policy, "-o", str(tmp_path / "out")])
    assert result.exit_code == 0
    assert "has ended with exit code 0" in result.output
    page = (tmp_path / "out" / "results.html").read_text()
    assert page.count('<figure class="episode">') == 1


def test_no_program_is_started_where_only_files_of_a_folder_may_be_used(tmp_path: Path) -> None:
    with pytest.raises(UnknownPolicyError) as raised:
        open_policy(f"{{name: process, command: [touch, {tmp_path / 'made'}]}}", root=tmp_path)
    assert "plug-ins are not run here" in str(raised.value.fix)
    assert not (tmp_path / "made").exists()


def test_what_a_program_said_before_it_ended_is_read() -> None:
    reading, writing = os.pipe()
    os.close(reading)  # it no longer reads
    with os.fdopen(writing, "wb", 0) as writer:
        channel = Channel(io.BufferedReader(io.BytesIO(b"hello\n")), writer, lambda: None)  # type: ignore[arg-type]
        assert channel.ask(b"{}", 10) == b"hello\n"
        with pytest.raises(PeerError, match="has closed the connection"):
            channel.ask(b"{}", 10)
        channel.close()
