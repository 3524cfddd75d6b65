"""A stand-in of the server (not CARLA) in a process of its own, for the official client."""

from __future__ import annotations

import json
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]


class StandIn:
    """A stand-in that listens, whose town has the facts that ``standin/server.py`` reads."""

    def __init__(self, facts: dict[str, Any], folder: Path) -> None:
        for _ in range(3):  # another process may take the port first
            if self._start(facts, folder):
                return
        raise AssertionError(self.said)

    def _start(self, facts: dict[str, Any], folder: Path) -> bool:
        self.port = free_ports()
        self.log = folder / f"standin-{self.port}.jsonl"
        given = folder / f"facts-{self.port}.json"
        given.write_text(json.dumps(facts))
        command = [sys.executable, "-m", "tests.interop.carla.standin", "--port", str(self.port)]
        command += ["--facts", str(given), "--log", str(self.log)]
        self.process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        assert self.process.stdout is not None
        self.said = self.process.stdout.readline()
        if "listening" in self.said:
            return True
        self.said += self.process.communicate()[0]
        return False

    def events(self, what: str | None = None) -> list[dict[str, Any]]:
        """The events so far, all or of one kind."""
        lines = self.log.read_text().splitlines()
        events = [json.loads(line) for line in lines if line.endswith("}")]
        return [event for event in events if what is None or event["what"] == what]

    def left(self) -> set[int]:
        """Ids of the actors that were spawned and not destroyed."""
        return {e["id"] for e in self.events("spawn")} - {e["id"] for e in self.events("destroy")}

    def check_clean(self) -> None:
        """Everything is destroyed, and the settings are as at the start."""
        deadline = time.monotonic() + 5
        while self.left() and time.monotonic() < deadline:
            time.sleep(0.05)
        assert self.events("spawn")
        assert self.left() == set()
        settings = [event["settings"] for event in self.events("settings")]
        assert settings[0][0] is True
        assert settings[-1] == [False, False, [False], True, 0.01, 10, 0.0, True, 3000.0, 2000.0, True]
        assert not self.events("unknown")

    def actor_of(self, name: str) -> int:
        """Id of the actor with a role name."""
        (actor,) = [e["id"] for e in self.events("spawn") if e["attributes"].get("role_name") == name]
        return int(actor)

    def path_of(self, name: str) -> Any:
        """(T, 3) x, y, yaw [deg] of an actor after each tick since it was spawned."""
        number = str(self.actor_of(name))
        return np.array(
            [[*e["places"][number][1:3], e["places"][number][4]] for e in self.events("tick") if number in e["places"]]
        )

    def kill(self) -> None:
        """End it at once."""
        self.process.kill()
        self.process.wait()


StartTown = Callable[..., StandIn]


def free_ports() -> int:
    """A port that is free together with the next one."""
    for _ in range(100):
        with socket.socket() as first, socket.socket() as second:
            first.bind(("127.0.0.1", 0))
            port = int(first.getsockname()[1])
            try:
                second.bind(("127.0.0.1", port + 1))
            except (OSError, OverflowError):
                continue
            return port
    raise AssertionError("no two ports are free")


@pytest.fixture
def stand_in(tmp_path: Path) -> Iterator[StartTown]:
    """Starts stand-ins with facts of their town; they are ended with the test."""
    pytest.importorskip("carla")
    pytest.importorskip("msgpack")
    started: list[StandIn] = []

    def start(**facts: Any) -> StandIn:
        started.append(StandIn(facts, tmp_path))
        return started[-1]

    yield start
    for one in started:
        one.process.send_signal(signal.SIGTERM)
        one.process.wait(10)
        assert one.process.stdout is not None
        one.process.stdout.close()
