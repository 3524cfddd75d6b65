"""SARL as layers: equal to plain NumPy, in both published shapes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irsim.policies.networks import PolicyFileError, observe, open_network, save_network
from irsim.policies.networks.sarl import sarl_network
from tests.policies.networks.observed import observations
from tests.policies.networks.sarl_weights import sarl_file, sarl_weights, value_of

AHEAD = {"moves": {"kind": "holonomic"}}


@pytest.mark.parametrize(("kind", "parameters"), [("holonomic", 96_502), ("unicycle", 86_502)])
def test_values_are_those_of_plain_numpy(tmp_path: Path, kind: str, parameters: int) -> None:
    save_network(tmp_path / "net.npz", sarl_file(kind))
    policy: Any = open_network(tmp_path / "net.npz")
    assert policy.describe()["parameters"] == parameters
    weights, seen = sarl_weights(kind == "holonomic"), observations(30)
    observed = observe(policy.head.layout, seen)
    values = policy.compute(observed, seen)[:, 0]
    own, people = observed["self"].array, observed["people"]
    assert people.mask is not None
    assert len(set(people.mask.sum(axis=1).tolist())) > 3  # also nobody at all
    expected = [value_of(weights, own[b], people.array[b, people.mask[b]]) for b in range(30)]
    np.testing.assert_allclose(values, expected, rtol=1e-5, atol=1e-5)


def test_people_whose_score_is_exactly_zero_do_not_count() -> None:
    """All scores are 0 if the last layer of the attention is, so nobody has a share."""
    weights = sarl_weights()
    blind = weights | {
        "attention.4.weight": np.zeros((1, 100), np.float32),
        "attention.4.bias": np.zeros(1, np.float32),
    }
    network = sarl_network(blind, lookahead=AHEAD, neighbors=5)
    alone = sarl_network(weights, lookahead=AHEAD, neighbors=5)
    from irsim.policies.networks.network import run_graph
    from irsim.policies.networks.values import Value

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
