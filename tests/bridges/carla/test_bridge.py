"""The bridge with a module of the same names in place of the client; the version of a server, asked for in bytes."""

from __future__ import annotations

import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.api import read_scenario
from irsim.bridges.base import BridgeError, BridgeLostError
from irsim.bridges.carla.bridge import CarlaBridge
from irsim.bridges.carla.client import import_client, server_version
from irsim.common.extras import ExtraError
from irsim.components.bridges.carla import Carla
from tests.bridges.carla.fake import Server, fake_module

SCENE = """
world: {width: 20, height: 20, step_time: 0.1, control_mode: auto, collision_mode: unobstructed}
robot:
  - {name: car, kinematics: {name: acker}, shape: {name: rectangle, length: 3, width: 1.4, wheelbase: 2},
     state: [3, 3, 0], goal: [15, 9], behavior: {name: dash}, vel_max: [2, 0.6], vel_min: [-2, -0.6],
     sensors: [{name: lidar2d, number: 19}]}
obstacle:
  - {name: walker, kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [5, 5, 0], goal: [15, 5],
     behavior: {name: dash}}
  - {name: late, kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [9, 5, 0], goal: [9, 15],
     behavior: {name: dash}}
  - {name: crate, shape: {name: circle, radius: 0.2}, state: [12, 12, 0]}
"""


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> Server:
    server = Server()
    monkeypatch.setitem(sys.modules, "carla", fake_module(server))
    monkeypatch.setattr("irsim.bridges.carla.client.server_version", lambda *_: server.version)
    return server


def _env() -> Any:
    scenario, _ = read_scenario(text=SCENE, strict=True)
    return irsim.Env(scenario, headless=True, log_level="ERROR")


def _steps(steps: int = 5, **options: Any) -> CarlaBridge:
    env, bridge = _env(), CarlaBridge(Carla(**options))
    with irsim.connect(env, [bridge]):
        for _ in range(steps):
            env.step()
    return bridge


def _clean(server: Server) -> bool:
    return not server.actors and server.settings["synchronous_mode"] is False


def test_who_is_what(server: Server) -> None:
    env, bridge = _env(), CarlaBridge(Carla(lidar={}))
    with irsim.connect(env, [bridge]):
        kinds = {actor.attributes["role_name"]: actor.type_id for actor in server.actors.values()}
        assert kinds == {
            "car": "vehicle.tesla.model3", "car/0": "sensor.lidar.ray_cast", "walker": "walker.pedestrian.0002",
            "late": "walker.pedestrian.0001",
        }  # fmt: skip
        assert server.settings == {"synchronous_mode": True, "fixed_delta_seconds": 0.1, "no_rendering_mode": False}
        assert bridge.agents == {"car"}
        env.step()
        assert env.simulation.ranges == pytest.approx([10] * 10 + [3] * 9, abs=1e-3)  # nothing to the right
    assert _clean(server)
    bridge.close()


def test_one_batch_in_a_step_and_walkers_arrive_where_they_should(server: Server) -> None:
    env, bridge = _env(), CarlaBridge(Carla(transform={"x": 5.0, "y": 1.0, "yaw": 90.0}))
    with irsim.connect(env, [bridge]):
        (walker,) = [actor for actor in server.actors.values() if actor.attributes["role_name"] == "walker"]
        for _ in range(10):
            env.step()
        x, y, _ = env.simulation.pose[1]
        assert (walker.transform.location.x, walker.transform.location.y) == pytest.approx((5 + y, 1 + x), abs=1e-6)
        assert x > 5.5
    assert [event for event in server.done if event[0] == "batch"] == [("batch", 3)] * 10 + [("batch", 3)]
    assert bridge.ticks == 15


def test_an_object_that_leaves_the_world_leaves_the_town(server: Server) -> None:
    env = _env()
    with irsim.connect(env, [CarlaBridge(Carla(vehicles=[]))]):
        env.step()
        env.simulation.pose[2] = np.nan
        env.step()
        assert "late" not in {actor.attributes["role_name"] for actor in server.actors.values()}
        env.simulation.pose[2] = [9, 9, 0]
        env.step()
        env.step()
        assert "late" in {actor.attributes["role_name"] for actor in server.actors.values()}
    assert _clean(server)


@pytest.mark.parametrize(
    "call", ["apply_settings", "spawn walker.pedestrian.0001", "spawn sensor.lidar.ray_cast", "tick"]
)
def test_a_failure_while_opening_leaves_nothing(server: Server, call: str) -> None:
    server.fail[call] = "no"
    with pytest.raises(BridgeError, match="CARLA refused setting up the town: no"):
        _steps(lidar={})
    server.fail.clear()
    assert not server.actors
    assert call == "apply_settings" or server.settings["synchronous_mode"] is False


def test_no_room(server: Server) -> None:
    server.room = 2
    with pytest.raises(BridgeError, match="there is no room in the town for 'late'"):
        _steps()
    assert _clean(server)


def test_a_server_that_dies(server: Server) -> None:
    env, bridge = _env(), CarlaBridge(Carla(timeout=3))
    connection = irsim.connect(env, [bridge])
    env.step()
    server.fail = dict.fromkeys(("tick", "apply_batch_sync", "apply_settings"), "time-out of 3000ms while waiting")
    with pytest.raises(BridgeLostError, match=r"did not answer \(a step\)"):
        env.step()
    connection.close()  # says nothing more: the server is gone


def test_a_server_that_does_not_clean_up_is_told(server: Server) -> None:
    env, bridge = _env(), CarlaBridge(Carla())
    connection = irsim.connect(env, [bridge])
    server.fail = {"apply_batch_sync": "no"}
    with pytest.raises(BridgeError, match="did not clean up"):
        connection.close()
    assert server.settings["synchronous_mode"] is False  # restored all the same


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"walkers": ["wolker"]}, "did you mean walker"),
        ({"walkers": ["car"], "vehicles": ["car"]}, "named under walkers and under vehicles"),
        ({"walkers": [], "vehicles": []}, "no object of the scenario is in the town"),
        ({"vehicles": ["walker"]}, "moves sideways"),
        ({"lidar": {"robots": ["walker"]}}, "not an object in the town with a lidar"),
        ({"walker_blueprint": "walker.dog"}, "no blueprint 'walker.dog'"),
        ({"town": "Town01"}, "has loaded Carla/Maps/Town03, not Town01"),
        ({"tick": 0.03}, "not a whole number of ticks of 0.03 s"),
        ({"ground": "road"}, "no road within"),
        ({"follow": {"crate": "hero"}}, "no such actor"),
        ({"clock": "external"}, "fixed_delta_seconds to 0.1"),
    ],
)
def test_what_does_not_fit_is_said(server: Server, options: Any, message: str) -> None:
    with pytest.raises(BridgeError) as caught:
        _steps(**options)
    assert message in str(caught.value)
    assert _clean(server)


def test_versions(server: Server) -> None:
    server.version = "0.9.15"
    with pytest.raises(BridgeError, match=r"pip install carla==0\.9\.15"):
        _steps()
    assert _steps(any_version=True, town="Town03").ticks == 10


def test_no_client(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim.common.extras.find_spec", lambda _: None)
    monkeypatch.setattr(sys, "version_info", (3, 12, 0))
    with pytest.raises(ExtraError, match=r"pip install 'irsim-mcp\[carla\]'"):
        import_client()
    monkeypatch.setattr(sys, "version_info", (3, 14, 0))
    with pytest.raises(ExtraError, match=r"made for Python up to 3\.12, and this is 3\.14"):
        import_client()


Serve = Callable[..., int]


@pytest.fixture
def serve() -> Iterator[Serve]:
    """Starts a server that answers one connection with pieces, and returns its port."""
    servers: list[socket.socket] = []

    def start(*pieces: bytes, stay: bool = False) -> int:
        server = socket.create_server(("127.0.0.1", 0))
        servers.append(server)

        def run() -> None:
            try:
                connection, _ = server.accept()
                with connection:
                    assert connection.recv(100) == b"\x94\x00\x01\xa7version\x91\x91\xc2"  # as the official client
                    for piece in pieces:
                        connection.sendall(piece)
                        time.sleep(0.02)
                    if stay:
                        connection.recv(1)
            except OSError:
                pass

        threading.Thread(target=run, daemon=True).start()
        return int(server.getsockname()[1])

    yield start
    for server in servers:
        server.close()


def test_the_version_of_a_server_is_read(serve: Serve) -> None:
    assert server_version("127.0.0.1", serve(b"\x94\x01\x01\xc0\x91\x92\x01\xa60.9.16", stay=True), 5) == "0.9.16"
    pieces = (b"\x94\x01", b"\x01\xc0\x91\x92", b"\x01\xa60.", b"9.16")
    assert server_version("127.0.0.1", serve(*pieces, stay=True), 5) == "0.9.16"
    long = "0.9.16-" + "a" * 40
    named = b"\x94\x01\x01\xc0\x91\x92\x01\xd9" + bytes((47,)) + long.encode()
    assert server_version("127.0.0.1", serve(named), 5) == long


@pytest.mark.parametrize(
    "answer",
    [
        b"HTTP/1.1 400 Bad Request\r\n\r\n",
        bytes(range(256)) * 100,
        b"\x94\x01\x01\xc0\x91\x92\x00\x91\xa2no",
        b"\x94\x01\x01\xc0\x91\x92\x01\xbf cut",
    ],
)
def test_others_are_refused(serve: Serve, answer: bytes) -> None:
    with pytest.raises(BridgeError, match=r"is not a CARLA server: it answered|does not say its version") as caught:
        server_version("127.0.0.1", serve(answer), 5)
    assert caught.value.code == "bridge-mismatch"


def test_silence_and_nobody(serve: Serve) -> None:
    for port in (serve(stay=True), serve(), 9):
        began = time.monotonic()
        with pytest.raises(BridgeLostError, match=r"no CARLA server answers at .* within 0\.5 s") as caught:
            server_version("127.0.0.1", port, 0.5)
        assert time.monotonic() - began < 3
        assert "CarlaUE4.sh" in str(caught.value)


def test_a_server_that_is_about_to_start() -> None:
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        port = server.getsockname()[1]

        def run() -> None:
            time.sleep(0.5)
            server.listen()
            connection, _ = server.accept()
            connection.sendall(b"\x94\x01\x01\xc0\x91\x92\x01\xa60.9.16")
            connection.close()

        thread = threading.Thread(target=run)
        thread.start()
        assert server_version("127.0.0.1", port, 10) == "0.9.16"
        thread.join()
