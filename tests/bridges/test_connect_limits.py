"""Bridges in the steps of an environment: delays, other scenes, and what cannot be opened or closed."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

import irsim
from irsim.bridges.base import BridgeError, BridgeLostError
from irsim.bridges.connect import connect
from irsim.diagnostics.errors import CodedError
from tests.bridges.peer import Peer
from tests.bridges.test_connect import SCENE, Recording, lines, make


def test_steps_are_not_caught_up_after_a_long_delay() -> None:
    env, bridge = make(), Recording()
    bridge.clock = "wall"
    with connect(env, [bridge]) as connection:
        env.step()
        time.sleep(1.5)
        begin = time.monotonic()
        for _ in range(6):
            env.step()
        assert time.monotonic() - begin > 0.4  # the world outside goes on as fast as before
        assert connection.late > 1


def test_another_scene_needs_bridges_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE.format(drive="diff", world=""))
    env = irsim.make(str(tmp_path / "scene.yaml"), display=False, log_level="ERROR")
    with connect(env, [Recording()]), pytest.raises(CodedError, match="while its bridges are open"):
        env.reload()
    env.reload()


def test_two_bridges_do_not_write_to_one_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BridgeError, match="two bridges write to 'lab'"):
        irsim.run(text=SCENE.format(drive="diff", world=""), bridges=[{"name": "rosbag", "folder": "lab"}] * 2)
    assert not list(tmp_path.iterdir())


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
