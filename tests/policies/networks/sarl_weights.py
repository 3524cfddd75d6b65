"""Made-up weights of SARL, and what they compute in plain NumPy."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.policies.networks import Network
from irsim.policies.networks.sarl import sarl_network

Arrays = dict[str, NDArray[np.float32]]


def sarl_weights(global_state: bool = True, seed: int = 0) -> Arrays:
    """Weights named and shaped as in the published code."""
    rng = np.random.default_rng(seed)
    units = {
        "mlp1": [13, 150, 100],
        "mlp2": [100, 100, 50],
        "attention": [200 if global_state else 100, 100, 100, 1],
        "mlp3": [56, 150, 100, 100, 1],
    }
    weights: Arrays = {}
    for name, widths in units.items():
        for k, (inputs, outputs) in enumerate(pairwise(widths)):
            scale = np.sqrt(2 / inputs)
            weights[f"{name}.{2 * k}.weight"] = (rng.normal(size=(outputs, inputs)) * scale).astype(np.float32)
            weights[f"{name}.{2 * k}.bias"] = (rng.normal(size=outputs) * 0.1).astype(np.float32)
    return weights


def sarl_file(kind: str = "holonomic", seed: int = 0, frame: str = "world", people: int = 5) -> Network:
    """A network of such weights."""
    unicycle = kind == "unicycle"
    moves: dict[str, Any] = {"kind": kind, "headings": 7 if unicycle else 16, "frame": frame}
    return sarl_network(sarl_weights(not unicycle, seed), lookahead={"moves": moves}, neighbors=people)


def value_of(weights: Arrays, own: Any, people: Any) -> float:
    """The value of one state in double precision.

    Args:
        weights: The weights.
        own: (6,) numbers of the robot.
        people: (K, 7) numbers of the people that are present.
    """

    def perceptron(name: str, x: Any, last: bool = False) -> Any:
        numbers = sorted({int(key.split(".")[1]) for key in weights if key.startswith(name)})
        for number in numbers:
            x = x @ weights[f"{name}.{number}.weight"].T.astype(float) + weights[f"{name}.{number}.bias"]
            x = np.maximum(x, 0) if last or number != numbers[-1] else x
        return x

    if len(people) == 0:
        nobody = np.zeros(weights["mlp3.0.weight"].shape[1] - len(own))
        return float(perceptron("mlp3", np.concatenate([own, nobody]))[0])
    joint = np.concatenate([np.tile(own, (len(people), 1)), people], axis=1)
    embedded = perceptron("mlp1", joint, last=True)
    features = perceptron("mlp2", embedded)
    attended = embedded
    if weights["attention.0.weight"].shape[1] == 2 * embedded.shape[1]:
        attended = np.concatenate([embedded, np.tile(embedded.mean(axis=0), (len(people), 1))], axis=1)
    scores = perceptron("attention", attended)[:, 0]
    shares = np.exp(scores) * (scores != 0)
    crowd = (shares / shares.sum()) @ features
    return float(perceptron("mlp3", np.concatenate([own, crowd]))[0])
