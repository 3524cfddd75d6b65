"""``irsim run --watch`` as a command: what it prints, when it ends, and that it changes nothing of the run."""

from __future__ import annotations

import http.client
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from threading import Thread
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest
from typer.testing import CliRunner

from irsim import api
from irsim.bundled import templates
from irsim.cli.app import app
from irsim.runs import open_run
from irsim.runs.replay.data import pack_run
from irsim.studio.feed import Feed, Follower
from tests.cli.conftest import CRASH, ROOM
from tests.runs.replay.conftest import scene
from tests.runs.replay.reading import unpacked

Watching = Any

LEAVING = """\
world: {width: 12, height: 8, step_time: 0.1}
robot:
  - {kinematics: {name: omni}, state: [1, 7], goal: [11, 7], behavior: {name: dash}, start_time: 1}
obstacle:
  - {name: gone, kinematics: {name: omni_angular}, behavior: {name: replay, times: [0, 1], poses: [[2, 4], [4, 4]]}}
  - {name: coming, kinematics: {name: omni_angular}, behavior: {name: replay, times: [3, 4], poses: [[8, 4], [10, 4]]}}
  - {name: crate, state: [9, 6.5], appear_time: 2}
"""


@pytest.fixture(autouse=True)
def _in_tmp_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


class Command:
    """``irsim run FILE --watch`` as a process."""

    def __init__(self, file: str, *words: str, **environment: str) -> None:
        command = [sys.executable, "-m", "irsim", "run", file, "--watch", *words]
        self.process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ, **environment}
        )
        assert self.process.stderr is not None
        line = self.process.stderr.readline()
        match = re.fullmatch(r"watch: http://127\.0\.0\.1:(\d+)/#([\w-]{43})\n", line)
        assert match is not None, line
        self.port, self.token = int(match[1]), match[2]

    def post(self, path: str, body: str, cookie: str = "") -> http.client.HTTPResponse:
        """Send what the page sends."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        origin = f"http://127.0.0.1:{self.port}"
        connection.request("POST", path, body, {"Origin": origin, "Cookie": cookie, "Connection": "close"})
        return connection.getresponse()

    def view(self) -> http.client.HTTPResponse:
        """The stream of a page that has entered."""
        with self.post("/session", self.token) as answer:
            cookie = answer.getheader("Set-Cookie", "").partition(";")[0]
        return self.post("/stream", '{"from": 0}', cookie)

    def until_over(self) -> str:
        """The line that is printed when the run is over."""
        assert self.process.stderr is not None
        return self.process.stderr.readline()

    def end(self, *, interrupt: bool) -> tuple[int, str, str]:
        """Exit code and output, after Ctrl-C if it is not to end by itself."""
        if interrupt:
            self.process.send_signal(signal.SIGINT)
        out, err = self.process.communicate(timeout=30)
        return self.process.returncode, out, err


@pytest.fixture
def watch(ordinary_processes: None, interruptible: None) -> Iterator[Watching]:
    commands = list[Command]()

    def start(text: str, *words: str, **environment: str) -> Command:
        Path("room.yaml").write_text(text, encoding="utf-8")
        commands.append(Command("room.yaml", *words, **environment))
        return commands[-1]

    yield start
    for command in commands:
        command.process.kill()
        command.process.communicate()


@pytest.mark.parametrize(("text", "words", "code"), [(ROOM, [], 0), (CRASH, ["--require-success"], 1)])
def test_ctrl_c_ends_it_with_the_exit_code_of_the_run(watch: Watching, text: str, words: list[str], code: int) -> None:
    command = watch(text, "--no-browser", "--json", *words)
    assert command.until_over() == "the page stays until it is closed; Ctrl-C ends it now\n"
    done, out, err = command.end(interrupt=True)
    assert (done, err) == (code, "")
    assert json.loads(out)["outcome"] == ("success" if code == 0 else "collision")


def test_it_ends_when_its_page_is_closed(watch: Watching) -> None:
    command = watch(ROOM, "--no-browser")
    page = command.view()
    page.read(9)
    command.until_over()
    time.sleep(0.3)
    assert command.process.poll() is None, "the page is open"
    page.close()
    code, _, err = command.end(interrupt=False)
    assert (code, err) == (0, "")


def test_ctrl_c_while_it_simulates_is_said_in_one_line(watch: Watching) -> None:
    command = watch(
        ROOM.replace("goal: [4, 3, 0]", "goal: [4, 3, 0]\n    vel_max: [1.0e-6, 1]"),
        "--no-browser",
        "--steps",
        "100000000",
    )
    code, _, err = command.end(interrupt=True)
    assert code == 130
    assert re.fullmatch(r"interrupted; again: .*--watch.*\n", err)


def test_the_page_opens_in_the_browser_of_the_user(watch: Watching, tmp_path: Path) -> None:
    script = tmp_path / "browser.sh"
    script.write_text(f'#!/bin/sh\necho "$1" >> {tmp_path}/opened\n')
    script.chmod(0o755)
    command = watch(ROOM, BROWSER=f"{script} %s")
    command.until_over()
    end = time.monotonic() + 10
    while not (tmp_path / "opened").exists() and time.monotonic() < end:
        time.sleep(0.05)
    assert (tmp_path / "opened").read_text() == f"http://127.0.0.1:{command.port}/#{command.token}\n"
    assert command.end(interrupt=True)[0] == 0


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--port", "1"], "--port is about the page of --watch"),
        (["--no-browser"], "--no-browser is about the page of --watch"),
        (["--speed", "2"], "--speed is about what is shown"),
        (["--watch", "--seeds", "3"], "--watch is about one run, and --seeds about several"),
        (["--watch", "--port", "70000"], "65535"),
    ],
)
def test_options_that_do_not_fit_are_refused(words: list[str], said: str) -> None:
    Path("room.yaml").write_text(ROOM, encoding="utf-8")
    done = CliRunner().invoke(app, ["run", "room.yaml", *words])
    assert done.exit_code == 2
    assert said in " ".join(done.output.replace("│", " ").split())


def test_a_scenario_with_errors_opens_no_page() -> None:
    Path("room.yaml").write_text(ROOM.replace("width: 8", "width: -8"), encoding="utf-8")
    done = CliRunner().invoke(app, ["run", "room.yaml", "--watch", "--no-browser"])
    assert done.exit_code == 2
    assert "watch:" not in done.output


def watched_run(text: str, **options: Any) -> tuple[Feed, Any]:
    """Run a scenario with a follower; its feed and result."""
    feed = Feed()
    result = api.run(
        text=text, seed=1, watched=lambda simulation, horizon: Follower(feed, simulation, horizon), **options
    )
    return feed, result


def test_a_record_is_the_same_bit_for_bit(tmp_path: Path) -> None:
    text = scene()
    plain = api.run(text=text, seed=1, record=tmp_path / "plain")
    _, watched = watched_run(text, record=tmp_path / "watched")
    ignored = {"run_id", "artifacts"}
    assert watched.model_dump(exclude=ignored) == plain.model_dump(exclude=ignored)
    for one in sorted((tmp_path / "plain").iterdir()):
        other = (tmp_path / "watched" / one.name).read_bytes()
        if one.suffix == ".json":
            times = r'"(id|created|run_id|artifacts)": ("[^"]*"|\{[^}]*\})'
            assert re.sub(times, "", other.decode()) == re.sub(times, "", one.read_text()), one.name
        elif one.suffix == ".npz":
            with ZipFile(one) as mine, ZipFile(tmp_path / "watched" / one.name) as its:
                assert mine.namelist() == its.namelist()
                assert all(mine.read(name) == its.read(name) for name in mine.namelist())
        else:
            assert other == one.read_bytes(), one.name


def joined(feed: Feed) -> tuple[dict[str, Any], dict[str, np.ndarray], list[list[Any]]]:
    """Head, poses and events that a page has after all frames of a feed."""
    head, columns = unpacked(feed.after(0, 0)[0][9:])
    series = {name: [columns[name]] for name in ("step", "x", "y", "heading")}
    events = []
    for one in feed.after(1, 0):
        more, columns = unpacked(one[9:])
        events += more["events"]
        for name, parts in series.items():
            parts.append(columns[name])
        for row, bounds in more["bounds"]:
            head["objects"][row] |= bounds
    return head, {name: np.concatenate(parts, axis=-1) for name, parts in series.items()}, events


@pytest.mark.parametrize("text", [scene(), LEAVING], ids=["scene", "leaving"])
def test_the_page_has_what_the_record_has(text: str, tmp_path: Path) -> None:
    feed, _ = watched_run(text, record=tmp_path / "run")
    run = open_run(tmp_path / "run")
    head, series, events = joined(feed)
    trace, (quantum, _) = run.trace(), head["quanta"]
    assert series["step"].tolist() == trace.step.tolist()
    packed, _ = unpacked(pack_run(run).data)
    assert events == packed["events"]
    for row, (item, its) in enumerate(zip(head["objects"], packed["objects"], strict=True)):
        assert [item.get(key) for key in ("from", "until", "to")] == [its.get(key) for key in ("from", "until", "to")]
        if "track" in item:
            there = np.isfinite(trace.pose[:, row, 0])
            for axis, name in enumerate("xy"):
                track = series[name][item["track"]] * quantum
                np.testing.assert_allclose(track[there], trace.pose[there, row, axis], atol=quantum)
        else:
            assert np.ptp(trace.pose[:, row], axis=0).max() == 0, "only what can move has a track"


def test_long_runs_are_thinned_and_keep_their_last_step(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim.runs.replay.rows._MAX_POSES", 60)
    feed, result = watched_run(ROOM, steps=100)
    head, series, _ = joined(feed)
    assert head["every"] == 2
    assert series["step"].tolist() == [*range(0, result.steps, 2), result.steps]


@pytest.mark.slow(2)
@pytest.mark.parametrize("name", templates.names())
def test_every_template_can_be_watched(name: str) -> None:
    feed = Feed()
    result = api.run(templates.scenario_file(name), steps=30, watched=lambda *given: Follower(feed, *given))
    assert joined(feed)[1]["step"][-1] == result.steps


def test_a_held_simulation_waits_and_executes_single_steps() -> None:
    feed = Feed()
    feed.enter()
    feed.hold(True)
    thread = Thread(target=lambda: api.run(text=ROOM, watched=lambda *given: Follower(feed, *given)), daemon=True)
    thread.start()

    def steps() -> int:
        return int(joined(feed)[1]["step"][-1])

    assert len(feed.after(1, 20)) == 1
    assert steps() == 1, "the first step is executed, after it the run is held"
    feed.advance(2)
    feed.after(3, 20)
    assert steps() == 3
    feed.leave()
    thread.join(20)
    assert not thread.is_alive(), "no simulation is held without a viewer"
    assert steps() > 20
