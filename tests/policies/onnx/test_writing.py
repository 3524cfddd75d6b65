"""Networks written as ONNX models decide as before."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irsim.policies.networks import PolicyFileError, open_network, save_network
from irsim.policies.networks.document import PolicyDocument
from irsim.policies.networks.network import Network, read_document
from irsim.policies.networks.onnx.writing import onnx_bytes, save_onnx
from tests.policies.networks.observed import observations

pytestmark = pytest.mark.onnx


def network(method: str = "max", activation: str = "relu", **changed: Any) -> Network:
    """A network that reads a set and a vector."""
    rng = np.random.default_rng(3)
    layers = [
        {"name": "concat", "label": "each", "inputs": ["neighbors", "goal"]},
        {"name": "dense", "label": "member", "inputs": ["each"], "units": 8, "activation": activation},
        {"name": "pool", "label": "crowd", "inputs": ["member"], "method": method},
        {"name": "concat", "label": "all", "inputs": ["goal", "crowd"]},
        {"name": "dense", "label": "action", "inputs": ["all"], "units": 2},
    ]
    sizes = {"member.w": (7, 8), "member.b": (8,), "action.w": (11, 2), "action.b": (2,)}
    data = {
        "layout": {"parts": [{"name": "goal"}, {"name": "neighbors", "count": 5, "features": ["x", "y", "vx", "gap"]}]},
        "network": layers,
        "output": {"input": "action", "squash": "tanh", "low": [0, -3], "high": [1, 3]},
        "drives": ["diff"],
        "card": {"license": "MIT"},
        **changed,
    }
    arrays = {name: rng.normal(size=size).astype(np.float32) for name, size in sizes.items()}
    return Network(read_document(PolicyDocument, data, "test"), arrays)


@pytest.mark.parametrize("method", ["max", "mean", "sum"])
@pytest.mark.parametrize("activation", ["none", "relu", "tanh", "sigmoid", "elu"])
def test_a_written_model_decides_as_the_network(tmp_path: Path, method: str, activation: str) -> None:
    made = network(method, activation)
    save_network(tmp_path / "a.npz", made)
    save_onnx(tmp_path / "a.onnx", made)
    ours, theirs = open_network(tmp_path / "a.npz"), open_network(tmp_path / "a.onnx")
    seen = observations(40)  # the first row has no neighbor
    np.testing.assert_allclose(theirs.act(seen), ours.act(seen), atol=1e-5)
    assert (theirs.output, theirs.drives, theirs.needs) == (ours.output, ours.drives, ours.needs)
    assert theirs.describe()["card"]["license"] == "MIT"


def test_a_model_takes_many_robots_at_once(tmp_path: Path) -> None:
    import onnxruntime

    session = onnxruntime.InferenceSession(onnx_bytes(network()), providers=["CPUExecutionProvider"])
    rng = np.random.default_rng(0)
    feed = {
        "goal": rng.normal(size=(6, 3)).astype(np.float32),
        "neighbors": rng.normal(size=(6, 5, 4)).astype(np.float32),
        "neighbors_mask": (rng.uniform(size=(6, 5)) < 0.5).astype(np.float32),
    }
    (together,) = session.run(["action"], feed)
    for k in range(6):
        (alone,) = session.run(["action"], {name: array[k : k + 1] for name, array in feed.items()})
        np.testing.assert_allclose(together[k : k + 1], alone, atol=1e-6)


def test_equal_networks_give_equal_bytes() -> None:
    assert onnx_bytes(network()) == onnx_bytes(network())


def test_layers_that_are_not_written_are_named() -> None:
    layers = [{"name": "layer_norm", "label": "action", "inputs": ["goal"]}]
    data = {"layout": {"parts": [{"name": "goal"}]}, "network": layers, "output": {"input": "action"}, "drives": None}
    arrays = {"action.scale": np.ones(3, np.float32), "action.shift": np.zeros(3, np.float32)}
    data["output"] = {"input": "action", "low": [0, -1, 0], "high": [1, 1, 1]}
    data["drives"] = ["omni_angular"]
    made = Network(read_document(PolicyDocument, data, "test"), arrays)
    with pytest.raises(PolicyFileError, match=r"network\[0\]: this layer is not written as ONNX, given: layer_norm"):
        onnx_bytes(made)
