"""Value networks as policies: moves, predictions, rewards, and what follows in situations worked by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.policies import Observations
from irsim.policies.networks import Network, PolicyFileError, PolicyInputError, network_policy, observe
from irsim.policies.networks.document import PolicyDocument
from irsim.policies.networks.layout import Layout
from irsim.policies.networks.lookahead import Lookahead, MoveSet, look_ahead, moves_of
from irsim.policies.networks.network import read_document
from irsim.policies.networks.sarl import joint_state_parts
from tests.policies.networks.observed import assert_same_in_any_company, moved, observations, people, rows, same_bits
from tests.policies.networks.sarl_weights import sarl_file

SPEEDS = [(math.exp(k / 5) - 1) / (math.e - 1) for k in range(1, 6)]


def greedy(ahead: dict[str, Any] | None = None, slope: float = -1.0, **keys: Any) -> Network:
    """A network whose value is ``slope`` for each metre to the goal."""
    data: dict[str, Any] = {
        "layout": {"parts": joint_state_parts(3)},
        "network": [{"name": "dense", "label": "value", "inputs": ["self"], "units": 1}],
        "output": {"input": "value", "returns": "velocity"},
        "lookahead": {"moves": {"frame": "goal"}} if ahead is None else ahead,
        "decision_dt": 0.25,
        **keys,
    }
    arrays = {"value.w": np.array([[slope], [0], [0], [0], [0], [0]], np.float32), "value.b": np.zeros(1, np.float32)}
    return Network(read_document(PolicyDocument, data, "test"), arrays)


def scene(pose: Any, goal: Any, *others: tuple[float, float, float, float]) -> Observations:
    """A robot of 0.3 m and 1 m/s, and people of the same size: x, y, vx, vy in the world."""
    limit = np.array([[1.0, 3.0, 0.0]])
    return replace(
        rows(observations(), [0]), pose=np.array([pose], float), goal=np.array([[*goal, 0.0]], float),
        goal_threshold=np.array([0.3]), radius=np.array([0.3]), velocity=np.array([[0.2, 0.1]]), low=-limit,
        high=limit, arrived=np.zeros(1, bool), neighbors=people(*others, count=3), scan=None, maps=None,
    )  # fmt: skip


FAR = (50.0, 50.0, 0.0, 0.0)


def test_moves_are_standing_and_speeds_times_headings() -> None:
    shares, angles = moves_of(MoveSet())
    assert len(shares) == 81
    assert (shares[0], angles[0]) == (0.0, 0.0)
    np.testing.assert_allclose(shares[1:6], SPEEDS, atol=1e-15)
    np.testing.assert_allclose(angles[1::5], np.arange(16) * math.pi / 8, atol=1e-15)
    shares, angles = moves_of(MoveSet(kind="unicycle", headings=7))
    assert len(shares) == 36
    np.testing.assert_allclose(angles[1::5], np.linspace(-math.pi / 4, math.pi / 4, 7), atol=1e-15)
    assert moves_of(MoveSet(kind="unicycle", headings=1))[1].tolist() == [0.0] * 6


def test_joint_states_after_a_move() -> None:
    """The robot looks along y at (1, 2), its goal lies 4 m along -x, a person 3 m above it walks along x."""
    seen = scene([1, 2, math.pi / 2], [-3, 2], (1, 5, 0.8, 0))
    later = look_ahead(Lookahead(moves=MoveSet(frame="goal")), seen)
    fastest = 5  # full speed toward the goal
    np.testing.assert_allclose(later.move[0, fastest], [-1, 0], atol=1e-15)
    parts = observe(Layout.model_validate({"parts": joint_state_parts(3)}), later.observations)
    np.testing.assert_allclose(parts["self"].array[fastest], [3.75, 1, 0, 0.3, 1, 0], atol=1e-12)
    # the frame of the goal is turned by 180 degrees: the person is at (1.2, 5), the robot at (0.75, 2)
    gap = math.hypot(0.45, 3)
    np.testing.assert_allclose(parts["people"].array[fastest, 0], [-0.45, -3, -0.8, 0, 0.3, gap, 0.6], atol=1e-12)
    assert parts["people"].mask[fastest].tolist() == [True, False, False]
    np.testing.assert_allclose(parts["self"].array[0, 4:], 0, atol=0)  # standing still
    assert later.discount.tolist() == [0.9**0.25]


def test_the_heading_of_a_unicycle_is_that_after_the_move() -> None:
    seen = scene([0, 0, -math.pi / 2], [4, 0], FAR)
    later = look_ahead(Lookahead(moves=MoveSet(kind="unicycle", headings=3)), seen)
    parts = observe(Layout.model_validate({"parts": joint_state_parts(3, heading="unwrapped")}), later.observations)
    straight_on, left = 1 + 5 + 4, 1 + 10 + 4  # full speed with the second and the third change of the heading
    np.testing.assert_allclose(later.move[0, straight_on], [1, 0], atol=1e-15)
    np.testing.assert_allclose(later.move[0, left], [1, math.pi / 4], atol=1e-15)
    away = [math.hypot(4, 0.25), 1, 1.5 * math.pi - math.atan2(0.25, 4)]  # the heading counts from 0 to 360 degrees
    np.testing.assert_allclose(parts["self"].array[straight_on, :3], away, atol=1e-12)
    moved = [0.25 * math.cos(-math.pi / 4), 0.25 * math.sin(-math.pi / 4)]
    np.testing.assert_allclose(later.observations.pose[left, :2], moved, atol=1e-12)
    np.testing.assert_allclose(later.observations.velocity[left], [4 * one for one in moved], atol=1e-12)


def reward(seen: Observations, move: int = 5, **options: Any) -> float:
    ahead = Lookahead.model_validate({"moves": {"frame": "goal"}, "reward": options})
    return float(look_ahead(ahead, seen).reward[0, move])


def test_rewards_are_those_of_the_paper() -> None:
    assert reward(scene([0, 0, 0], [4, 0], FAR)) == 0
    assert reward(scene([0, 0, 0], [0.5, 0], FAR)) == 1  # 0.25 m are left
    assert reward(scene([0, 0, 0], [0.56, 0], FAR)) == 0  # 0.31 m are left
    ahead = scene([0, 0, 0], [4, 0], (0.95, 0, 0, 0))  # a gap of 0.1 m after the move
    assert reward(ahead) == pytest.approx(-0.1 * 0.5 * 0.25)
    assert reward(ahead, move=0) == 0
    assert reward(scene([0, 0, 0], [0.5, 0], (0.95, 0, 0, 0))) == 1
    assert reward(scene([0, 0, 0], [0.5, 0], (0.8, 0, 0, 0))) == -0.25  # a collision counts more than the goal
    assert reward(scene([0, 0, 0], [4, 0], (1.05, 0, -1, 0))) == -0.25  # the person comes closer, too
    assert reward(scene([0, 0, 0], [4, 0], (0.84, 0, 0, 0)), collision=-3.0) == -3


def test_the_smallest_gap_is_that_within_the_move() -> None:
    """A person crosses so fast that it is past the robot at the end of the move."""
    crossing = scene([0, 0, 0], [4, 0], (0.125, 1, 0, -8))
    assert reward(crossing) == 0
    assert reward(crossing, gap="smallest") == -0.25
    assert reward(scene([0, 0, 0], [4, 0], FAR), gap="smallest") == 0


def test_a_free_way_is_taken_at_full_speed(opened: Any) -> None:
    policy = opened(greedy())
    for goal in ([4, 0], [0.7, 3], [-2, -2.5]):
        away = np.array(goal) / np.hypot(*goal)
        np.testing.assert_allclose(policy.act(scene([0, 0, 1], goal, FAR)), [away], atol=1e-15)
        np.testing.assert_allclose(policy.act(scene([0, 0, 1], goal)), [away], atol=1e-15)  # no person is in sight


def test_a_person_in_the_way_is_not_run_into(opened: Any) -> None:
    policy = opened(greedy(slope=-0.1))
    blocked = scene([0, 0, 0], [4, 0], (0.8, 0, 0, 0))
    ((vx, vy),) = policy.act(blocked)
    assert reward(blocked) == -0.25
    assert math.hypot(0.8 - 0.25 * vx, -0.25 * vy) >= 0.6
    assert (vx > 0, abs(vy) > 0.3) == (True, True)  # it goes round
    boxed = scene([0, 0, 0], [4, 0], (0.7, 0, 0, 0), (0.1, 0.7, 0, 0), (0.1, -0.7, 0, 0))
    assert policy.act(boxed)[0, 0] <= 0


def test_it_stands_still_at_its_goal_without_one_and_where_all_moves_are_equal(opened: Any) -> None:
    policy = opened(greedy())
    for still in (scene([0, 0, 0], [0.29, 0], FAR), scene([0, 0, 0], [0.29, 0]), scene([0, 0, 0], [np.nan] * 2, FAR)):
        assert policy.act(still).tolist() == [[0, 0]]
    assert policy.act(scene([0, 0, 0], [0.31, 0], FAR))[0, 0] > 0
    # the free way ends at the goal, not behind it
    np.testing.assert_allclose(opened(greedy({"dt": 1.0})).act(scene([0, 0, 0], [0.5, 0])), [[0.5, 0]], atol=1e-15)
    ahead = scene([0, 0, 0], [4, 0], FAR)
    assert opened(greedy(slope=0.0)).act(ahead).tolist() == [[0, 0]]
    with pytest.raises(PolicyInputError, match="the largest speed"):
        policy.act(replace(ahead, high=np.full((1, 3), np.inf)))


@pytest.mark.parametrize("kind", ["holonomic", "unicycle"])
def test_a_decision_is_the_same_alone_and_in_any_batch(opened: Any, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    policy = opened(sarl_file(kind))
    for count in (1, 2, 7, 40):
        whole = observations(count, seed=count, neighbors=5)
        together = assert_same_in_any_company(policy.act, whole)
        assert together.shape == (count, 2)
        monkeypatch.setattr(network_policy, "_MOVES_AT_ONCE", 250)
        assert same_bits(policy.act(whole), together)
        monkeypatch.undo()
    assert policy.act(rows(whole, np.zeros(0, dtype=int))).shape == (0, 2)


def test_decisions_turn_with_the_world_in_the_frame_of_the_goal(opened: Any) -> None:
    policy = opened(sarl_file("holonomic", frame="goal", people=3))
    seen = scene([0, 0, 0], [4, 0], (1, 0.5, -0.3, 0.1), (2, -1, 0, 0.7))
    c, s = math.cos(0.7), math.sin(0.7)
    turned = policy.act(moved(seen, 0.7, (0.0, 0.0)))
    np.testing.assert_allclose(turned, policy.act(seen) @ [[c, s], [-s, c]], atol=1e-12)


SCENE = """
world: {{width: 10, height: 10, step_time: 0.1, time_limit: 30}}
robot:
  - kinematics: {{name: {drive}}}
    shape: {{name: circle, radius: 0.3}}
    state: [1, 5, 2]
    goal: [9, 5]
    goal_threshold: 0.3
    vel_max: [1, {most}]
    vel_min: [-1, -{most}]
obstacle:
  - kinematics: {{name: omni}}
    shape: {{name: circle, radius: 0.3}}
    state: [9, 6.5, 0]
    goal: [1, 6.5]
    behavior: {{name: dash}}
"""


@pytest.mark.parametrize(("drive", "moves"), [("omni", "holonomic"), ("diff", "holonomic"), ("diff", "unicycle")])
def test_every_drive_reaches_its_goal_beside_a_person(opened: Any, tmp_path: Path, drive: str, moves: str) -> None:
    unicycle = {"output": {"input": "value", "returns": "control"}, "drives": ["diff"]} if moves == "unicycle" else {}
    ahead = {"moves": {"kind": moves, "headings": 16 if moves == "holonomic" else 7}}
    opened(greedy(ahead, slope=-0.1, **unicycle))
    scene = SCENE.format(drive=drive, most=1 if drive == "omni" else 3)
    result = irsim.benchmark(scene, policies=[str(tmp_path / "net.npz")], seeds=1, workers=1)
    assert result.rows[0].success.rate == 1


def test_a_unicycle_turns_by_the_angle_until_its_next_decision(opened: Any) -> None:
    output = {"output": {"input": "value", "returns": "control"}, "drives": ["diff"]}
    policy = opened(greedy({"moves": {"kind": "unicycle", "headings": 7}}, **output))
    aside = scene([0, 0, 0], [0, 4], FAR)
    (control,) = policy.act(replace(aside, step_time=0.1))
    np.testing.assert_allclose(control[1], math.pi / 4 / 0.3)  # 0.25 s are three steps of 0.1 s
    (control,) = policy.act(replace(aside, step_time=0.25))
    np.testing.assert_allclose(control[1], math.pi / 4 / 0.25)
    behind = scene([0, 0, 0], [-4, 1])
    np.testing.assert_allclose(policy.act(replace(behind, step_time=0.25)), [[0, math.pi]], atol=1e-15)


def test_files_keep_the_lookahead(opened: Any) -> None:
    network = sarl_file("holonomic", frame="goal")
    policy = opened(network)
    assert policy.lookahead == network.document.lookahead
    moves = {"kind": "holonomic", "speeds": 5, "headings": 16, "frame": "goal"}
    assert policy.describe()["lookahead"]["moves"] == moves
    assert (policy.output, policy.drives, policy.decision_dt) == ("velocity", None, 0.25)


DENSE = {"name": "dense", "label": "value", "inputs": ["self"], "units": 1}
WIDE = {**DENSE, "label": "wide", "units": 60000}
CONTROLS = {"output": {"input": "value", "returns": "control"}, "drives": ["omni"]}


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"output": {"input": "value", "returns": "velocity", "squash": "tanh"}}, "the output is a value"),
        (CONTROLS, "moves are of the kind velocity"),
        ({"lookahead": {"moves": {"kind": "unicycle"}}}, "moves are of the kind control"),
        ({"lookahead": {"moves": {"kind": "unicycle"}}, **CONTROLS}, "controls of diff"),
        ({"layout": {"parts": [{"name": "self_state", "label": "self"}]}}, "takes neighbors"),
        ({"layout": {"parts": [*joint_state_parts(3), {"name": "scan"}]}}, "no scan, map or extents"),
        ({"lookahead": {"moves": {"headings": 0}}}, "must be ≥ 1"),
        ({"lookahead": {"dt": 0}}, "must be > 0"),
        ({"network": [{**DENSE, "units": 2}]}, "a value is one number"),
        ({"network": [{**DENSE, "inputs": ["people"]}]}, "a value is one number"),
        ({"network": [{**DENSE, "name": "memory"}]}, "remembers nothing"),
        ({"network": [{**DENSE, "label": "other"}]}, "no part and no layer"),
        (
            {"network": [WIDE, {**WIDE, "label": "wider", "inputs": ["wide"]}, {**DENSE, "inputs": ["wider"]}]},
            "too many multiplications",
        ),
    ],
)
def test_documents_that_cannot_look_ahead_are_refused(opened: Any, changed: dict[str, Any], message: str) -> None:
    data = greedy().document.model_dump(mode="json") | changed
    with pytest.raises(PolicyFileError, match=message):
        opened(Network(read_document(PolicyDocument, data, "test"), {}))
