"""Networks made by hand."""

from __future__ import annotations

from typing import Any

import numpy as np

from irsim.policies.networks import Network, mlp
from irsim.policies.networks.document import PolicyDocument
from irsim.policies.networks.network import read_document


def go_to_goal() -> Network:
    """Drive ahead in proportion to how far ahead the goal is, and turn in proportion to the sine of its bearing."""
    hidden = np.array([[1, 0, 0], [0, 1, -1]], float), np.zeros(3)  # ahead, left, right
    result = np.array([[4, 0], [0, 2], [0, -2]], float), np.zeros(2)
    return mlp(
        [hidden, result],
        [{"name": "goal", "features": ["x", "sin"], "distance_max": 1.0}],
        drives=["diff"],
        output={"squash": "tanh", "low": [-1, -2], "high": [1, 2]},
        card={"description": "drives to its goal", "license": "MIT"},
    )


def crowd() -> dict[str, Any]:
    """A document with every kind of value: a crowd is pooled, attended to and remembered."""
    return {
        "format": "irsim-policy",
        "version": 1,
        "precision": "float32",
        "layout": {
            "version": 1,
            "parts": [
                {"name": "goal", "features": ["distance", "cos", "sin"]},
                {"name": "own", "features": ["vx", "yaw_rate"]},
                {"name": "neighbors", "label": "others", "count": 4},
            ],
        },
        "network": [
            {"name": "concat", "label": "self", "inputs": ["goal", "own"]},
            {"name": "concat", "label": "pairs", "inputs": ["others", "self"]},
            {"name": "dense", "label": "each", "inputs": ["pairs"], "units": 16, "activation": "relu"},
            {"name": "pool", "label": "pooled", "inputs": ["each"]},
            {"name": "attention", "label": "looked", "inputs": ["self", "each"], "units": 8, "heads": 2},
            {"name": "gru", "label": "read", "inputs": ["others"], "units": 6, "direction": "both"},
            {"name": "concat", "label": "all", "inputs": ["self", "pooled", "looked", "read"]},
            {"name": "layer_norm", "label": "normed", "inputs": ["all"]},
            {"name": "memory", "label": "kept", "inputs": ["normed"], "units": 8},
            {"name": "dense", "label": "result", "inputs": ["kept"], "units": 2},
        ],
        "output": {"input": "result", "squash": "tanh", "low": [0, -3], "high": [1, 3]},
        "drives": ["diff"],
        "decision_dt": 0.2,
        "card": {"license": "CC0-1.0", "seeds": [1, 2], "notes": {"epochs": 3}},
    }


def filled(data: dict[str, Any], seed: int = 0) -> Network:
    """A network of a document with random weights."""
    from irsim.policies.networks.layout import layout_shapes
    from irsim.policies.networks.network import plan_graph

    document: PolicyDocument = read_document(PolicyDocument, data, "test")
    plan = plan_graph(layout_shapes(document.layout), document.network)
    rng = np.random.default_rng(seed)
    arrays = {
        name: rng.uniform(-0.5, 0.5, shape).astype(document.precision) + (1 if name in plan.positive else 0)
        for name, shape in plan.arrays.items()
    }
    return Network(document, {name: array.astype(document.precision) for name, array in arrays.items()})
