"""Bridges in the steps of an environment: what they see, what they may change, and one of a package of its own."""

from __future__ import annotations

import math
import shlex
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated, Any, Literal

import numpy as np
import pytest
from pydantic import Field

import irsim
from irsim.bridges.base import BridgeError, BridgeLostError
from irsim.bridges.connect import connect
from irsim.bridges.options import check_files
from irsim.bridges.state import Motion
from irsim.plugins import BRIDGES, Bridge, BridgeOptions, Feedback, Meters, SceneDescription, WorldState
from irsim.scenario.limits import Limits
from tests.bridges.peer import Peer
from tests.bridges.scenes import environment

SCENE = """
world: {{width: 10, height: 10, step_time: 0.1{world}}}
robot:
  - {{kinematics: {{name: {drive}}}, state: [1, 5, 0], goal: [9, 5, 0], shape: {{name: circle, radius: 0.3}},
     vel_max: [1, 1], vel_min: [-1, -1], behavior: {{name: dash}},
     sensors: [{{name: lidar2d, number: 5, range_max: 4}}]}}
obstacle:
  - {{shape: {{name: polygon, vertices: [[4, 6], [6, 6], [5, 8]]}}, state: [0, 0, 0]}}
  - {{kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.2}}, state: [5, 1, 0], goal: [5, 3, 0]}}
"""


def make(drive: str = "diff", world: str = "", more: str = "") -> Any:
    return environment(SCENE.format(drive=drive, world=world) + more)


class Recording(Bridge):
    """Keeps what it gets, and says what it is told to say."""

    name = "recording"

    def __init__(self, agents: tuple[str, ...] = (), **said: Any) -> None:
        self.agents = frozenset(agents)
        self.said, self.calls = said, list[str]()
        self.states: list[WorldState] = []
        self.motions: list[Motion] = []
        self.closed = 0

    def open(self, scene: Any, start: WorldState) -> None:
        self.scene, self.start = scene, start

    def pull(self) -> Feedback | None:
        self.calls.append("pull")
        return self.said["pull"](len(self.motions)) if "pull" in self.said else None

    def exchange(self, motion: Motion) -> Feedback | None:
        self.calls.append("exchange")
        self.motions.append(motion)
        return self.said["exchange"](motion) if "exchange" in self.said else None

    def push(self, state: WorldState) -> None:
        self.calls.append("push")
        self.states.append(state)

    def close(self) -> None:
        self.closed += 1


def test_a_bridge_that_only_looks_changes_nothing() -> None:
    plain, watched = make(), make()
    bridge = Recording()
    with connect(watched, [bridge]):
        for _ in range(20):
            plain.step()
            watched.step()
    assert np.array_equal(plain.simulation.pose, watched.simulation.pose)
    assert bridge.calls[:6] == ["pull", "exchange", "push"] * 2
    assert [state.step for state in bridge.states] == list(range(1, 21))
    assert bridge.states[-1].pose[0] == pytest.approx([3, 5, 0])
    assert bridge.states[-1].twist[0] == pytest.approx([1, 0, 0])
    assert bridge.closed == 1


def test_the_scene_has_all_that_a_simulator_needs() -> None:
    with connect(make(), [bridge := Recording()]):
        pass
    robot, wall, walker = bridge.scene.agents
    assert (robot.role, robot.drive, robot.moves) == ("robot", "diff", True)
    assert (robot.pose, robot.goals) == ((1.0, 5.0, 0.0), ((9.0, 5.0, 0.0),))
    assert robot.parts[0].radius == 0.3
    assert robot.lidars[0].key == "robot_0/0"
    assert robot.lidars[0].angles == pytest.approx(np.linspace(-math.pi / 2, math.pi / 2, 5))
    assert wall.parts[0].corners.tolist() == [[4, 6], [6, 6], [5, 8]]
    assert not wall.moves
    assert walker.moves
    assert bridge.start.ranges["robot_0/0"].shape == (5,)


@pytest.mark.parametrize(
    ("behavior", "points"),
    [
        ("dash", [[1, 5], [5, 8], [9, 5]]), ("orca", [[1, 5], [5, 8], [9, 5]]), ("follow", None),
        (None, [[1, 5], [9, 5]]),
    ],
)  # fmt: skip
def test_every_robot_has_a_path_to_its_goals(behavior: str | None, points: list[Any] | None) -> None:
    way = "goal: [9, 5]" if behavior is None else f"waypoints: [[5, 8], [9, 5]], behavior: {{name: {behavior}}}"
    text = f"robot:\n  - {{kinematics: {{name: diff}}, state: [1, 5, 0], {way}}}\n"
    env, bridge = environment(text), Recording()
    with connect(env, [bridge]):
        assert (bridge.start.paths["robot_0"].tolist() if bridge.start.paths else None) == points
        env.step()
        after = bridge.states[-1].paths["robot_0"]
    assert after[0] == pytest.approx(bridge.states[-1].pose[0, :2] if points else [1, 5], abs=0.2)
    assert after[-1].tolist() == [9, 5] if points else len(after) > 1


def test_an_object_that_another_program_moves_is_where_that_program_has_it() -> None:
    """The robot stands in the way of nothing in irsim, but the other program moves it into the triangle."""
    bridge = Recording(("robot_0",), exchange=lambda motion: Feedback({"robot_0": (5.0, 5.0 + 0.1 * motion.step, 0.5)}))
    env = make()
    with connect(env, [bridge]):
        for _ in range(12):
            env.step()
    assert env.robot.state[:3, 0].tolist() == pytest.approx([5.0, 6.1, 0.5])
    assert env.robot.collision
    assert bridge.states[5].twist[0] == pytest.approx([0, 1, 0])
    assert bridge.motions[0].control[0] == pytest.approx([1, 0, 0]), "what its behavior wants is handed over"
    assert bridge.motions[0].pose[0] == pytest.approx([1.1, 5, 0])


def test_a_collision_that_irsim_alone_would_see_does_not_count() -> None:
    """The behavior drives into the wall, but the other program stops the robot before."""
    bridge = Recording(("robot_0",), exchange=lambda motion: Feedback({"robot_0": (2.0, 5.0, 0.0)}))
    env = make(more="  - {shape: {name: rectangle, length: 0.2, width: 4}, state: [2.45, 5, 0]}\n")
    with connect(env, [bridge]):
        for _ in range(20):
            env.step()
    assert not env.robot.collision
    assert env.events == []


@pytest.mark.parametrize(
    ("drive", "command", "expected"),
    [
        ("diff", (0.5, 9.0, 0.2), [0.5, 0.2]),
        ("diff_dynamic", (0.5, 9.0, 0.2), [0.4, 0.2]),
        ("skid_steer", (0.5, 9.0, 0.2), [0.5, 0.2]),
        ("omni", (0.5, 0.4, 9.0), [0.5, 0.4]),
        ("acker", (0.5, 0.0, 0.1), [0.5, math.atan(0.1 / 0.5)]),
        ("single_track", (0.5, 0.0, 0.1), [0.5, math.atan(0.3302 * 0.1 / 0.5)]),
        ("tricycle", (0.3, 0.0, 0.4), [0.5, math.atan(0.4 / 0.3)]),
        ("tricycle", (-0.3, 0.0, 0.4), [-0.5, -math.atan(0.4 / 0.3)]),
    ],
)
def test_commands_from_outside_drive_a_robot(drive: str, command: Any, expected: list[float]) -> None:
    bridge = Recording(pull=lambda step: Feedback(commands={"robot_0": command}))
    env = make(drive)
    with connect(env, [bridge]):
        env.step()
        env.step()
    assert bridge.states[-1].control[0][:2] == pytest.approx(expected)


def test_goals_and_starts_from_outside() -> None:
    said = Feedback(goals={"robot_0": (1.0, 9.0, 0.0)}, starts={"robot_0": (3.0, 3.0, 1.0)})
    bridge = Recording(pull=lambda step: said if step == 0 else None)
    env = make()
    with connect(env, [bridge]):
        env.step()
    assert bridge.states[0].goal[0][:2] == pytest.approx([1, 9])
    assert math.dist(bridge.states[0].pose[0][:2], (3, 3)) < 0.2


def test_scans_of_others_replace_those_of_irsim() -> None:
    beams = np.array([1, 2, np.inf, 3, 9], dtype=np.float32)
    bridge = Recording(exchange=lambda motion: Feedback(ranges={"robot_0/0": beams}))
    env = make()
    with connect(env, [bridge]):
        env.step()
    assert env.get_lidar_scan()["ranges"] == pytest.approx([1, 2, 4, 3, 4])
    assert bridge.states[0].ranges["robot_0/0"].tolist() == [1, 2, np.inf, 3, np.inf]


@pytest.mark.parametrize(
    ("said", "message"),
    [
        (Feedback(commands={"robto_0": (0, 0, 0)}), "unknown object"),
        (Feedback(poses={"robot_0": (0, 0, 0)}), "which irsim moves"),
        (Feedback(goals={"robot_0": (math.nan, 0, 0)}), "not three finite numbers"),
        (Feedback(starts={"robot_0": (1e308, 0, 0)}), "send x, y and yaw, none beyond 1e"),
        (Feedback(commands={"robot_0": None}), "send forward and leftward speed and yaw rate"),  # type: ignore[dict-item]
        ({"goals": {}}, "returned dict instead of Feedback"),
        (Feedback(ranges={"robot_0/0": np.zeros(3)}), "3 ranges of 'robot_0/0'"),
    ],
)
def test_what_cannot_be_used_is_reported(said: Any, message: str) -> None:
    env, bridge = make(), Recording(pull=lambda step: said)
    with pytest.raises(BridgeError, match=message), connect(env, [bridge]):
        env.step()
    assert bridge.closed == 1


def test_a_failure_closes_every_bridge() -> None:
    class Broken(Recording):
        def push(self, state: WorldState) -> None:
            raise RuntimeError("out of paper")

    env, others = make(), [Recording(), Recording()]
    with pytest.raises(BridgeError, match="RuntimeError: out of paper"), connect(env, [others[0], Broken(), others[1]]):
        env.step()
    assert [bridge.closed for bridge in others] == [1, 1]
    env.step()  # and takes no further part


def test_one_that_cannot_be_opened_closes_those_before_it() -> None:
    class Shut(Recording):
        def open(self, scene: Any, start: WorldState) -> None:
            raise ConnectionRefusedError(111, "Connection refused")

    first = Recording()
    with pytest.raises(BridgeLostError, match="Connection refused"):
        connect(make(), [first, Shut()])
    assert first.closed == 1


def test_each_object_belongs_to_one_program() -> None:
    with pytest.raises(BridgeError, match="both move 'robot_0'"):
        connect(make(), [Recording(("robot_0",)), Recording(("robot_0",))])
    with pytest.raises(BridgeError, match="unknown object"):
        connect(make(), [Recording(("robot_7",))])


def test_real_time() -> None:
    env, bridge = make(world=", control_mode: auto"), Recording()
    bridge.clock = "wall"
    with connect(env, [bridge]) as connection:
        begin = time.monotonic()
        for _ in range(6):
            env.step()
        assert 0.45 < time.monotonic() - begin < 3
        assert connection.late < 1


# lines of JSON --------------------------------------------------------------------------------------------------------
def lines(address: str, more: str = "") -> str:
    return f"bridges: [{{name: json_lines, address: '{address}'{more}}}]\n"


def test_lines_of_json_show_the_world() -> None:
    with Peer(lambda message: None) as peer:
        env = make(more=lines(peer.address))
        with irsim.connect(env):
            for _ in range(3):
                env.step()
    assert peer.kinds() == ["scene", "state", "state", "state", "end"]
    assert peer.received[0]["scene"]["agents"][0]["name"] == "robot_0"
    assert peer.received[3]["pose"][0] == pytest.approx([1.3, 5, 0])


def test_another_program_moves_the_robot() -> None:
    def answer(message: dict[str, Any]) -> Any:
        if message["kind"] != "motion":
            return {}
        x, y, yaw = message["pose"][0]
        return {"poses": {"robot_0": [x, y + 0.05, yaw]}}

    with Peer(answer) as peer:
        env = make(more=lines(peer.address, ", agents: [robot_0], answers: true"))
        with irsim.connect(env):
            for _ in range(4):
                env.step()
    assert env.robot.state[:2, 0] == pytest.approx([1.4, 5.2], abs=0.02)


@pytest.mark.parametrize(
    ("answer", "error", "message"),
    [
        (b"hello\n", BridgeError, "not JSON"),
        (b'{"goal": {}}\n', BridgeError, "goal cannot be used"),
        (b'{"goals": {"robot_0": [NaN, 0, 0]}}\n', BridgeError, "not JSON"),
        (b'{"end": "that is all"}\n', BridgeLostError, "that is all"),
        (None, BridgeLostError, "did not answer within 0.3 s"),
        (b"x" * 5_000_000, BridgeLostError, "more than 4 MB"),
    ],
)
def test_a_program_that_answers_nonsense(answer: Any, error: Any, message: str) -> None:
    with Peer(lambda sent: {} if sent["kind"] == "scene" else answer) as peer:
        seconds = 0.3 if answer is None else 10
        env = make(more=lines(peer.address, f", answers: true, timeout: {seconds}"))
        with pytest.raises(error, match=message), irsim.connect(env):
            env.rollout(3)


def test_no_program_is_there() -> None:
    env = make(more=lines("127.0.0.1:1"))
    with pytest.raises(BridgeLostError, match=r"no program listens at 127\.0\.0\.1:1"):
        irsim.connect(env)


def test_keys_are_checked() -> None:
    text = SCENE.format(drive="diff", world="") + "bridges: [{name: json_lines, agents: [robot_0]}]\n"
    errors = [finding for finding in irsim.validate(text=text).findings if finding.severity == "error"]
    assert [(finding.code, finding.path) for finding in errors] == [("invalid-value", "bridges[0]")]


def test_run_opens_the_bridges_of_a_scenario_and_others() -> None:
    text = SCENE.format(drive="diff", world="")
    with Peer(lambda message: None) as one, Peer(lambda message: None) as two:
        others = [{"name": "json_lines", "address": two.address}]
        result = irsim.run(text=text + lines(one.address), seed=0, steps=4, bridges=others)
    assert one.kinds() == two.kinds() == ["scene", *["state"] * 4, "end"]
    words = shlex.split(result.reproduce.partition("#")[0])
    assert words[words.index("--bridge") + 1] == f"{{name: json_lines, address: '{two.address}'}}"


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("json_line", "did you mean json_lines"),
        ("{name: json_lines, adress: x}", "adress"),
        ("{name: json_lines, timeout: 0}", "timeout"),
        ("{", "is not a bridge"),
        ({"address": "127.0.0.1:1"}, "'name' is missing"),
    ],
)
def test_a_bridge_that_is_given_wrongly(given: Any, message: str) -> None:
    with pytest.raises(BridgeError, match=message):
        irsim.run(text=SCENE.format(drive="diff", world=""), bridges=[given])


def test_bridges_can_be_forbidden() -> None:
    text = SCENE.format(drive="diff", world="") + lines("127.0.0.1:1")
    with pytest.raises(BridgeError, match="bridges-disabled"):
        irsim.run(text=text, limits=Limits(bridges=False))


@pytest.mark.parametrize("folder", ["../bag", "/tmp/bag", ".git/bag"])
def test_bridges_of_a_server_write_only_into_its_folder(folder: str, tmp_path: Path) -> None:
    one = SimpleNamespace(name="rosbag", files=("folder",), folder=folder)
    with pytest.raises(BridgeError, match="outside of the folder"):
        check_files([one], tmp_path)
    one.folder = "bags/first"
    check_files([one], tmp_path)


MEADOW = "robot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [8, 1], behavior: {name: dash}}\n"


class Leash(BridgeOptions):
    """Calls robots back that are too far from where they began."""

    name: Literal["leash"] = "leash"
    length: Annotated[Meters, Field(gt=0)] = 1.0
    """Length of the leash."""


class Called(Bridge):
    """Gives the start as a new goal."""

    def __init__(self, options: Leash) -> None:
        self.name, self.options, self.far = "leash", options, False

    def open(self, scene: SceneDescription, start: WorldState) -> None:
        self.start = scene.robots[0].pose

    def push(self, state: WorldState) -> None:
        self.far = self.far or bool(state.pose[0, 0] - self.start[0] > self.options.length)

    def pull(self) -> Feedback | None:
        return Feedback(goals={"robot_0": self.start}) if self.far else None

    def notes(self) -> list[str]:
        return ["the leash was tight"] if self.far else []


@pytest.fixture
def leash() -> Iterator[None]:
    BRIDGES.register(Leash)(Called)
    yield
    BRIDGES._features.pop("leash")


def test_it_is_a_bridge_like_any_other(leash: None) -> None:
    result = irsim.run(text=MEADOW + "bridges: [{name: leash, length: 0.5}]\n", seed=0, steps=30)
    assert 0.5 < result.robots[0].path_length < 2
    assert result.notes == ["the leash was tight"]


def test_its_options_are_checked(leash: None) -> None:
    wrong: Any = {"name": "leash", "length": 0}
    with pytest.raises(Exception, match="length"):
        irsim.run(text=MEADOW, seed=0, bridges=[wrong])
