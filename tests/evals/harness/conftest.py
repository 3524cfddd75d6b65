"""Cases for agents, agents that follow a script, and a guard that lets nothing but the loopback address be reached."""

from __future__ import annotations

import gc
import sys
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from irsim_evals.cases.store import Instance, case_of, golds_of
from irsim_evals.harness.arms import Side
from irsim_evals.harness.run import run_arm
from irsim_evals.results import Trial
from tests.evals.conftest import made_up
from tests.evals.harness.messages_api import MessagesApi, Reply, Script, follow, messages_api

KEY = "sk-ant-test-0123456789"
MODEL = "anthropic/claude-sonnet-4-6"
_LOOPBACK = ("127.0.0.1", "::1", "localhost", "0.0.0.0", "::", None, "")


class Guard:
    """Refuses every other address while it is on, and remembers which were asked for.

    Attributes:
        refused: Addresses that were refused.
        reached: Addresses that were not.
    """

    def __init__(self) -> None:
        self.on = False
        self.refused: list[str] = []
        self.reached: list[str] = []
        sys.addaudithook(self.watch)

    def watch(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self.on or event not in ("socket.connect", "socket.sendto", "socket.getaddrinfo"):
            return
        address = arguments[0] if event == "socket.getaddrinfo" else arguments[1]
        if isinstance(address, tuple):
            address = address[0]
        elif event != "socket.getaddrinfo":
            return  # the name of a socket in the file system
        host = address.decode() if isinstance(address, bytes) else address
        if host in _LOOPBACK:
            self.reached.append(f"{event} {host}")
            return
        self.refused.append(f"{event} {host}")
        raise OSError(f"the tests reach nothing but the loopback address, not {host}")


GUARD = Guard()


@pytest.fixture(scope="module", autouse=True)
def guarded() -> Iterator[None]:
    """Turns the guard on before anything else of a module is made."""
    GUARD.refused.clear()
    GUARD.on = True
    yield
    GUARD.on = False


@pytest.fixture(autouse=True)
def offline(guarded: None) -> Iterator[Guard]:
    """Fails a test in which anything but the loopback address was asked for, even if that was taken well."""
    yield GUARD
    assert GUARD.refused == []


@pytest.fixture(autouse=True)
def key(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("ANTHROPIC_AUTH_TOKEN", "ANTHROPIC_BASE_URL", "INSPECT_TELEMETRY", "INSPECT_LOG_LEVEL"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("ANTHROPIC_API_KEY", KEY)


@pytest.fixture(autouse=True)
def connections_of_others(request: pytest.FixtureRequest) -> Iterator[None]:
    """Connections that inspect_ai leaves open are collected here, where a warning about them is not an error."""
    yield
    if request.node.get_closest_marker("evals"):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            gc.collect()


def run(
    instances: list[Instance], api: MessagesApi, folder: Path, arm: str | list[Side] = "no-skill", **more: Any
) -> list[Trial]:
    """Let the stand-in answer in an arm."""
    return run_arm(arm, instances, log_dir=folder, base_url=api.url, **{"model": MODEL, **more})


@pytest.fixture
def empty_world() -> Instance:
    """A case that is quickly graded."""
    return case_of("pub-01")


@pytest.fixture
def scenario(empty_world: Instance) -> str:
    """Its right answer."""
    gold = golds_of(empty_world)[0]
    return next(text for name, text in gold.files.items() if name.endswith(".yaml"))


@pytest.fixture
def writes(scenario: str) -> tuple[str, dict[str, Any]]:
    """The call of a tool that writes it."""
    return ("write_file", {"path": "scenario.yaml", "content": scenario})


@pytest.fixture
def service(writes: tuple[str, dict[str, Any]]) -> Iterator[MessagesApi]:
    """The stand-in with an agent that writes the right answer and says so."""
    with messages_api(follow(Reply("I write it.", [writes]), Reply("The world is in scenario.yaml."))) as api:
        yield api


@pytest.fixture
def ask(empty_world: Instance, service: MessagesApi, tmp_path: Path) -> Callable[..., Trial]:
    """Has that agent, or one with another script, answer a case."""

    def answered(
        script: Script | None = None, arm: str = "no-skill", case: Instance = empty_world, **more: Any
    ) -> Trial:
        service.script = script or service.script
        (trial,) = run([case], service, tmp_path / "logs", arm, **more)
        return trial

    return answered


@pytest.fixture
def sketched() -> Instance:
    """A case with a picture, a file and a second turn."""
    return made_up(
        {"id": "robots", "count": {"of": "robots", "number": 1}},
        {"id": "built", "says": {"any_of": ["sketch"], "turn": 1}},
        {"id": "named", "says": {"any_of": ["Rosa"], "turn": 2}},
        prompt="Build the sketch.",
        turns=["Now call the robot Rosa."],
        files={"base.yaml": "world: {width: 12, height: 8}\nrobot: {state: [1, 1, 0], goal: [9, 6]}\n"},
        drawings={"sketch.png": {"size": [12, 8], "items": [{"kind": "box", "at": [2, 2, 4, 5]}]}},
        select={"robots": {"role": "robot"}},
    )
