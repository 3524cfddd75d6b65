"""Peers of ROS bridges, each in a process of its own, all on the loopback."""

from __future__ import annotations

import fcntl
import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

import irsim
from irsim.bridges.ros.messages import Messages

HERE = Path(__file__).parent
KINDS = [
    "geometry_msgs/msg/Twist", "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseArray",
    "nav_msgs/msg/Odometry", "nav_msgs/msg/OccupancyGrid", "nav_msgs/msg/Path", "sensor_msgs/msg/LaserScan",
    "tf2_msgs/msg/TFMessage", "visualization_msgs/msg/MarkerArray",
]  # fmt: skip
SCENE = """\
world: {width: 10, height: 5, step_time: 0.05, obstacle_map: {name: perlin, resolution: 0.5, seed: 4}}
robot:
  - {name: robot_0, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0.3], goal: [9, 4, 0],
     vel_max: [1, 2], sensors: [{name: lidar2d, number: 90, range_max: 3}]}
obstacle:
  - {name: walker, kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [6, 1, 0], goal: [6, 4, 0],
     behavior: {name: dash}}
"""


class Peer:
    """A process of another program, whose lines are read while it runs."""

    def __init__(self, *command: str, **options: Any) -> None:
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True, **options)
        self.lines: list[str] = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.lines.append(line.rstrip("\n"))

    def on(self, topic: str) -> list[str]:
        """The content of the lines about a topic."""
        return [line.split(" ", 1)[1] for line in list(self.lines) if line.startswith(f"{topic} ")]

    def stop(self) -> None:
        """End it and all processes that it has started."""
        with suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        self._reader.join(5)
        assert self.process.stdout is not None
        self.process.stdout.close()


Start = Callable[..., Peer]
MakeEnv = Callable[[str], Any]


def until(holds: Callable[[], object], seconds: float, why: str) -> None:
    """Wait until something holds."""
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, why
        time.sleep(0.02)


def free_port() -> int:
    """A TCP port without a listener."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        return int(server.getsockname()[1])


@pytest.fixture(scope="session")
def fastdds_program(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The peer on Fast DDS, made by its code generator and the compiler."""
    for tool in ("fastddsgen", "g++"):
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is missing")
    base = tmp_path_factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    with (shared / "fastdds.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # one process of the tests builds it, the others wait
        folder = shared / "fastdds"
        if not (folder / "peer").exists():
            folder.mkdir(exist_ok=True)
            _build(folder)
    return str(folder / "peer")


def _build(folder: Path) -> None:
    (folder / "messages.idl").write_text(idl_of(Messages().store, KINDS))
    subprocess.run(["fastddsgen", "-replace", "messages.idl"], cwd=folder, check=True, capture_output=True)
    sources = [str(HERE / "fastdds_peer.cpp"), "messages.cxx", "messagesPubSubTypes.cxx"]
    libraries = ["-lfastrtps", "-lfastcdr", "-lpthread"]
    command = ["g++", "-std=c++17", "-O0", "-I.", "-o", "peer", *sources, *libraries]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)


@pytest.fixture
def start() -> Iterator[Start]:
    """Starts peers, and ends them after the test."""
    peers: list[Peer] = []

    def starting(*command: str, **options: Any) -> Peer:
        peers.append(Peer(*command, **options))
        return peers[-1]

    yield starting
    for peer in peers:
        peer.stop()


@pytest.fixture
def domain(request: pytest.FixtureRequest) -> int:
    """A domain of its own for each test of this process and its neighbours."""
    worker = os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw")
    number = _DOMAINS.setdefault(request.node.nodeid, len(_DOMAINS))
    return 2 + (os.getpid() * 7 + int(worker) * 31 + number) % 95


@pytest.fixture
def master(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """Address of a running roscore, which all processes of the test use."""
    if not Path("/usr/bin/roscore").exists():
        pytest.skip("roscore is missing")
    port = free_port()
    address = f"http://127.0.0.1:{port}"
    monkeypatch.setenv("ROS_MASTER_URI", address)
    monkeypatch.setenv("ROS_IP", "127.0.0.1")
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path))
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    core = subprocess.Popen(["/usr/bin/roscore", "-p", str(port)], **quiet)  # type: ignore[call-overload]

    def runs() -> bool:
        listed = subprocess.run(["/usr/bin/rostopic", "list"], capture_output=True, text=True, check=False)
        return "/rosout" in listed.stdout

    try:
        until(runs, 60, "roscore does not start")
        yield address
    finally:
        core.send_signal(signal.SIGINT)  # on which it ends the processes that it has started
        core.wait(30)


_DOMAINS: dict[str, int] = {}
PYTHON = sys.executable


@pytest.fixture
def make_env() -> MakeEnv:
    """Makes the environment of a scenario's text."""

    def make(text: str) -> Any:
        Path("scene.yaml").write_text(text)
        return irsim.make("scene.yaml", display=False, log_level="ERROR")

    return make


_BASE = {
    "bool": "boolean", "byte": "octet", "uint8": "uint8", "int8": "int8", "uint16": "unsigned short",
    "int16": "short", "uint32": "unsigned long", "int32": "long", "uint64": "unsigned long long", "int64": "long long",
    "float32": "float", "float64": "double", "string": "string",
}  # fmt: skip


def idl_of(store: Any, kinds: list[str]) -> str:
    """IDL of messages and all that they have, each before its first use."""
    done: dict[str, str] = {}
    for kind in kinds:
        _add(store, kind, done)
    return "\n".join(done.values())


def _add(store: Any, kind: str, done: dict[str, str]) -> None:
    if kind in done:
        return
    _, fields = store.fielddefs[kind]
    members = [_member(store, name, definition, done) for name, definition in fields]
    package, _, name = kind.split("/")
    done[kind] = (
        f"module {package} {{ module msg {{ module dds_ {{ struct {name}_ {{ {' '.join(members)} }}; }}; }}; }};"
    )


def _member(store: Any, name: str, definition: Any, done: dict[str, str]) -> str:
    form, detail = definition
    if form.name in ("ARRAY", "SEQUENCE"):
        inner, length = detail
        kind = _type(store, inner, done)
        return f"{kind} {name}[{length}];" if form.name == "ARRAY" else f"sequence<{kind}> {name};"
    return f"{_type(store, definition, done)} {name};"


def _type(store: Any, definition: Any, done: dict[str, str]) -> str:
    form, detail = definition
    if form.name == "BASE":
        return _BASE[detail[0]]
    _add(store, detail, done)
    package, _, name = detail.split("/")
    return f"{package}::msg::dds_::{name}_"
