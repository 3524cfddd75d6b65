"""Servers that are missing, refuse, or die, and runs that end early: in the town nothing is left of them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import irsim
from irsim.bridges.base import BridgeError, BridgeLostError
from tests.interop.carla.conftest import ROOT, StandIn, free_ports
from tests.interop.carla.scenes import CROWD

pytestmark = pytest.mark.interop
PROGRAM = """
import irsim, sys
env = irsim.make(sys.argv[1], display=False)
with irsim.connect(env):
    for step in range(10_000):
        env.step()
        if step == 5:
            print("going", flush=True)
"""


def _scene(folder: Path, port: int, more: str = "", timeout: float = 2) -> Path:
    path = folder / "crowd.yaml"
    path.write_text(CROWD.format(port=port, timeout=timeout, more=more))
    return path


def _run(path: Path, steps: int = 30) -> Any:
    env = irsim.make(path, display=False)
    with irsim.connect(env):
        for _ in range(steps):
            env.step()
    return env


def test_a_server_that_is_missing(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    port = free_ports()
    began = time.monotonic()
    with pytest.raises(BridgeLostError) as caught:
        _run(_scene(tmp_path, port))
    assert time.monotonic() - began < 12
    assert f"no CARLA server answers at 127.0.0.1:{port} within 2 s" in str(caught.value)
    assert "CarlaUE4.sh" in str(caught.value)


def test_a_server_that_is_silent(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    began = time.monotonic()
    with pytest.raises(BridgeLostError, match="no CARLA server answers"):
        _run(_scene(tmp_path, stand_in(silent=True).port))
    assert time.monotonic() - began < 12


def test_a_server_of_another_version(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in(version="0.9.13")
    with pytest.raises(BridgeError, match=r"has version 0\.9\.13, and the client of this Python 0\.9\.16") as caught:
        _run(_scene(tmp_path, town.port))
    assert "pip install carla==0.9.13" in str(caught.value)
    assert town.events("settings") == []
    _run(_scene(tmp_path, town.port, ", any_version: true"), steps=2)
    town.check_clean()


def test_actors_that_were_spawned_before_a_failure_are_destroyed(
    stand_in: Callable[..., StandIn], tmp_path: Path
) -> None:
    town = stand_in(full=2)
    with pytest.raises(BridgeError, match="there is no room in the town for 'obstacle_2'"):
        _run(_scene(tmp_path, town.port))
    assert len(town.events("spawn")) == 2
    assert len(town.events("refused")) == 4  # from four heights
    town.check_clean()


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (", town: Town07", "failed to generate map"),
        (", ground: road", "has no roads"),
        (", follow: {pillar: hero}", "the town has no such actor"),
    ],
)
def test_what_does_not_fit_is_said(stand_in: Callable[..., StandIn], tmp_path: Path, more: str, message: str) -> None:
    town = stand_in()
    with pytest.raises(BridgeError) as caught:
        _run(_scene(tmp_path, town.port, more))
    assert message in str(caught.value)
    assert town.left() == set()
    for event in town.events("settings")[-1:]:
        assert event["settings"][0] is False


def test_an_exception_in_the_loop(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in()
    env = irsim.make(_scene(tmp_path, town.port), display=False)

    def loop() -> None:
        with irsim.connect(env):
            env.step()
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        loop()
    town.check_clean()


def test_ctrl_c(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in()
    command = [sys.executable, "-c", PROGRAM, str(_scene(tmp_path, town.port))]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert "going" in process.stdout.readline()
    os.kill(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=20)
    assert "KeyboardInterrupt" in errors
    assert process.returncode != 0
    town.check_clean()


@pytest.mark.parametrize("facts", [{"die_after": 80}, {"hang_after": 80}])
def test_a_server_that_dies_ends_the_run(
    stand_in: Callable[..., StandIn], tmp_path: Path, facts: dict[str, int]
) -> None:
    town = stand_in(**facts)
    env = irsim.make(_scene(tmp_path, town.port), display=False)
    began = time.monotonic()

    def loop() -> None:
        with irsim.connect(env):
            for _ in range(1000):
                env.step()

    with pytest.raises(BridgeLostError) as caught:
        loop()
    assert caught.value.code == "bridge-lost"
    assert 0 < env.simulation.count[0] < 1000
    assert time.monotonic() - began < 15
    assert "did not answer" in str(caught.value)


def test_another_client_may_tick(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in(fixed=0.05)
    env = irsim.make(_scene(tmp_path, town.port, ", clock: external"), display=False)
    with irsim.connect(env) as connection:
        for _ in range(10):
            env.step()
        (bridge,) = connection.bridges
        assert 10 <= bridge.ticks <= 21  # a step has two; irsim does not wait for ticks that pass while it computes
    assert town.events("settings") == []
    assert town.left() == set()
    walked = [e for e in town.events("batch") if 4 in e["kinds"]]
    assert 15 <= walked[-1]["frame"] - walked[0]["frame"] <= 25


def test_a_client_that_ticks_irregularly(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    with pytest.raises(BridgeError, match=r"fixed_delta_seconds to 0\.1"):
        _run(_scene(tmp_path, stand_in().port, ", clock: external"))
