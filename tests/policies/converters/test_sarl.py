"""Weights of SARL that a user brings become a policy file, or are refused with a reason."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.diagnostics.errors import ArgumentError
from irsim.policies.converters.convert import convert_policy
from irsim.policies.networks import PolicyFileError, observe, open_network
from irsim.policies.networks.network import run_graph
from irsim.policies.networks.sarl import sarl_network
from irsim.policies.networks.values import Value
from tests.policies.converters.torch_bytes import as_files
from tests.policies.networks.observed import observations
from tests.policies.networks.sarl_weights import Arrays, sarl_weights, value_of

AHEAD = {"moves": {"kind": "holonomic"}}


def assert_values(policy: Any, weights: Arrays, count: int = 30) -> Any:
    """Compare the values of a policy with plain NumPy; returns the observations that its robots make of themselves."""
    seen = observations(count)
    observed = observe(policy.head.layout, seen)
    own, people = observed["self"].array, observed["people"]
    assert len(set(people.mask.sum(axis=1).tolist())) > 3  # also no person at all
    expected = [value_of(weights, own[b], people.array[b, people.mask[b]]) for b in range(count)]
    np.testing.assert_allclose(policy.compute(observed, seen)[:, 0], expected, rtol=1e-5, atol=1e-5)
    return own


def test_people_whose_score_is_exactly_zero_do_not_count() -> None:
    """All scores are 0 if the last layer of the attention is, so no person has a share."""
    weights = sarl_weights()
    last = {"attention.4.weight": np.zeros((1, 100), np.float32), "attention.4.bias": np.zeros(1, np.float32)}
    network = sarl_network(weights | last, lookahead=AHEAD, neighbors=5)
    alone = sarl_network(weights, lookahead=AHEAD, neighbors=5)
    seen = observe(network.document.layout, observations(8))
    seen = {label: Value(value.array.astype(np.float32), value.mask) for label, value in seen.items()}
    nobody = {**seen, "people": Value(seen["people"].array, np.zeros((8, 5), bool))}
    results = [
        run_graph(one.document.network, one.by_layer(), what, {}, "value_3").array
        for one, what in ((network, seen), (alone, nobody))
    ]
    assert (results[0] == results[1]).all()


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"mlp1.0.weight": np.zeros((150, 14), np.float32)}, "has another number of inputs, given: 14, allowed: 13"),
        ({"mlp2.0.weight": np.zeros((100, 90), np.float32)}, "given: 90, allowed: 100"),
        ({"attention.0.weight": np.zeros((100, 150), np.float32)}, "given: 150, allowed: 200 or 100"),
        ({"attention.2.weight": np.zeros((100, 90), np.float32)}, "attention.2.weight: takes what the layer before"),
        ({"mlp3.6.weight": np.zeros((2, 100), np.float32), "mlp3.6.bias": np.zeros(2, np.float32)}, "one number"),
        ({"mlp1.0.bias": np.zeros(3, np.float32)}, "mlp1.0.weight: the shapes do not fit"),
        ({"mlp1.0.weight": np.zeros(3, np.float32)}, "the shapes do not fit"),
        ({"mlp1.0.bias": np.full(150, np.nan, np.float32)}, "mlp1.0.bias: this array has numbers that are not finite"),
        ({"mlp3.2.bias": np.full(100, 1e300)}, "too large for float32"),
        ({"mlp1.0.bias": np.zeros(150, np.int64)}, "floating-point"),
        ({"mlp1.7.weight": np.zeros((2, 2), np.float32)}, "not all there"),
        ({"lstm.weight": np.zeros((2, 2), np.float32)}, "lstm.weight: SARL has no such array"),
        ({"mlp3.2.bias": None}, "mlp3.2.bias: this array is missing"),
        ({"mlp2.0.weight": None}, r"mlp2.\*.weight: the layers of this perceptron are not all there"),
    ],
)
def test_weights_of_something_else_are_refused(changed: dict[str, Any], message: str) -> None:
    weights = {**sarl_weights(), **changed}
    with pytest.raises(PolicyFileError, match=message):
        sarl_network({name: x for name, x in weights.items() if x is not None}, lookahead=AHEAD)


SCENE = """
world: {width: 10, height: 10, step_time: 0.25, time_limit: 2}
robot:
  - number: 3
    distribution: {name: random, range_low: [1, 1, -3], range_high: [9, 9, 3]}
    kinematics: {name: diff}
    vel_max: [1, 3]
    vel_min: [-1, -3]
"""


@pytest.mark.parametrize("old", [False, True], ids=["zip", "old"])
@pytest.mark.parametrize("kind", ["holonomic", "unicycle"])
def test_a_converted_file_has_the_values_of_its_weights(tmp_path: Path, old: bool, kind: str) -> None:
    weights = sarl_weights(kind == "holonomic", seed=3)
    (tmp_path / "rl_model.pth").write_bytes(as_files(weights)[old])
    convert_policy("sarl", tmp_path / "rl_model.pth", tmp_path / "net.npz", {"license": "MIT", "neighbors": 5})
    policy: Any = open_network(tmp_path / "net.npz")
    moves = policy.lookahead.moves
    count, parameters = (81, 96_502) if kind == "holonomic" else (36, 86_502)
    assert (moves.kind, moves.count, moves.frame) == (kind, count, "world")
    assert policy.describe()["parameters"] == parameters
    assert policy.head.card.license == "MIT"
    assert (assert_values(policy, weights)[:, 2] != 0).any() == (kind == "unicycle")
    result = irsim.benchmark(SCENE, policies=[str(tmp_path / "net.npz")], seeds=2, workers=1)
    assert result.rows[0].episodes == 2


def test_names_of_a_wrapping_module_do_not_matter(tmp_path: Path) -> None:
    wrapped = {f"policy.model.{key}": x for key, x in sarl_weights().items()}
    other = {"other.weight": np.zeros((2, 2), np.float32)}
    (tmp_path / "net.pth").write_bytes(as_files({**wrapped, **other})[0])
    made = convert_policy("sarl", tmp_path / "net.pth", tmp_path / "net.npz", {"kinematics": "unicycle", "headings": 9})
    assert made.document.lookahead.moves.count == 46


def refused(tmp_path: Path, content: bytes) -> str:
    (tmp_path / "net.pth").write_bytes(content)
    with pytest.raises(PolicyFileError) as caught:
        convert_policy("sarl", tmp_path / "net.pth", tmp_path / "net.npz")
    assert not (tmp_path / "net.npz").exists()
    assert caught.value.fix
    return caught.value.message


def test_files_of_something_else_are_refused(tmp_path: Path) -> None:
    weights = sarl_weights()
    for wrong, message in (
        ({**weights, "mlp3.0.weight": np.zeros((150, 60), np.float32)}, "mlp3.0.weight: has another number of inputs"),
        ({**weights, "mlp2.2.bias": np.full(50, np.inf, np.float32)}, "mlp2.2.bias"),
        ({"actor.weight": np.zeros((2, 2), np.float32)}, "mlp1.0.weight"),
        (weights | {f"target.{key}": x for key, x in weights.items()}, "several arrays are called mlp1.0.weight"),
    ):
        assert message in refused(tmp_path, as_files(wrong)[0])
    with pytest.raises(ArgumentError, match="kinematics"):
        convert_policy("sarl", tmp_path / "net.pth", tmp_path / "net.npz", {"kinematics": "car"})
