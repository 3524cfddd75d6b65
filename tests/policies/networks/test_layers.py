"""Layers: the numbers of plain NumPy, and rows that do not depend on one another."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from irsim.options.registry import Feature
from irsim.policies.converters.convert import CONVERTERS
from irsim.policies.networks.layers._options import LAYERS
from irsim.policies.networks.network import GraphPlan, plan_graph, run_graph
from irsim.policies.networks.parts._options import PARTS as PARTS_OF_LAYOUTS
from irsim.policies.networks.values import Shape, Value
from irsim.testing import conformance
from tests.policies.networks.observed import same_bits

PARTS = {"own": Shape(5), "goal": Shape(3), "crowd": Shape(4, 6), "score": Shape(1, 6)}
ALL: dict[str, dict[str, Any]] = {
    "activation": {"inputs": ["crowd"], "function": "tanh"},
    "add": {"inputs": ["crowd", "crowd"]},
    "attention": {"inputs": ["own", "crowd"], "units": 6, "heads": 2},
    "concat": {"inputs": ["own", "crowd", "goal"]},
    "dense": {"inputs": ["crowd"], "units": 33, "activation": "relu"},
    "flatten": {"inputs": ["crowd"]},
    "gru": {"inputs": ["crowd"], "units": 5, "direction": "both"},
    "layer_norm": {"inputs": ["own"]},
    "memory": {"inputs": ["own"], "units": 4},
    "pool": {"inputs": ["crowd"], "method": "mean"},
    "running_norm": {"inputs": ["crowd"]},
    "score_pool": {"inputs": ["score", "crowd"]},
    "select": {"inputs": ["crowd"], "start": 1, "stop": 3},
}
"""An example of every layer."""
VARIANTS = [
    *ALL.items(),
    ("activation", {"inputs": ["own"], "function": "softmax"}),
    ("add", {"inputs": ["own", "own", "own"]}),
    ("attention", {"inputs": ["crowd"], "units": 4}),
    ("dense", {"inputs": ["own"], "units": 2, "bias": False}),
    ("gru", {"inputs": ["crowd"], "units": 3, "direction": "backward", "result": "all"}),
    ("gru", {"inputs": ["crowd"], "units": 3, "direction": "both", "merge": "sum"}),
    ("layer_norm", {"inputs": ["crowd"], "affine": False}),
    ("pool", {"inputs": ["crowd"], "method": "sum"}),
    ("pool", {"inputs": ["crowd"], "method": "max"}),
    ("running_norm", {"inputs": ["own"], "clip": None}),
    ("score_pool", {"inputs": ["score", "crowd"], "skip_zero": True}),
]


def plan(name: str, **options: Any) -> tuple[list[Any], GraphPlan]:
    feature: Any = LAYERS.get(name)
    layers = [feature.options.model_validate({"name": name, "label": "out", **options})]
    return layers, plan_graph(PARTS, layers)


def observed(rows: int, dtype: Any, seed: int = 0) -> dict[str, Value]:
    """Values of all parts; the first robot has no neighbor."""
    rng = np.random.default_rng(seed)
    mask = rng.uniform(size=(rows, 6)) < 0.6
    mask[0] = False
    values = {}
    for label, shape in PARTS.items():
        size = (rows, shape.features) if shape.members is None else (rows, shape.members, shape.features)
        array = rng.normal(size=size).astype(dtype)
        values[label] = Value(array, None if shape.members is None else mask)
    return values


def weights(plan: GraphPlan, dtype: Any) -> dict[str, Any]:
    rng = np.random.default_rng(1)
    return {name.partition(".")[2]: rng.uniform(0.1, 0.9, shape).astype(dtype) for name, shape in plan.arrays.items()}


def run(name: str, options: Mapping[str, Any], values: Mapping[str, Value], arrays: Any, memory: Any = None) -> Value:
    layers, _ = plan(name, **options)
    return run_graph(layers, {"out": arrays}, values, {"out": memory} if memory is not None else {}, "out")


def test_all_layers_are_tried_here() -> None:
    assert sorted(ALL) == LAYERS.names()


FEATURES = [*LAYERS.features(), *PARTS_OF_LAYOUTS.features(), *CONVERTERS.features()]


@pytest.mark.parametrize("feature", FEATURES, ids=lambda feature: feature.name)
def test_declaration(feature: Feature) -> None:
    conformance.check_documented(feature)
    conformance.check_units(feature)
    if feature.name not in ALL:  # inputs and units of a layer have no defaults
        conformance.check_defaults(feature)
    for example in feature.options.schema_extra.get("examples", ()):
        assert feature.options.model_validate(example).name == feature.name


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize(("name", "options"), VARIANTS, ids=[name for name, _ in VARIANTS])
def test_a_row_is_the_same_alone_and_in_any_batch(name: str, options: Any, dtype: Any) -> None:
    _, needs = plan(name, **options)
    assert needs.problems == ()
    arrays = weights(needs, dtype)
    for rows in (1, 2, 3, 8, 19):
        values = observed(rows, dtype, rows)
        before = np.random.default_rng(2).normal(size=(rows, 4)).astype(dtype) if name == "memory" else None
        after = None if before is None else before.copy()
        whole = run(name, options, values, arrays, after)
        assert (whole.shape, whole.array.dtype) == (needs.shapes["out"], dtype)
        assert np.isfinite(whole.array).all()
        for k in range(rows):
            one = {
                label: Value(value.array[k : k + 1], None if value.mask is None else value.mask[k : k + 1])
                for label, value in values.items()
            }
            own = None if before is None else before[k : k + 1].copy()
            alone = run(name, options, one, arrays, own)
            assert same_bits(alone.array, whole.array[k : k + 1])
            assert own is None or after is None or same_bits(own, after[k : k + 1])


@pytest.mark.parametrize(("name", "options"), VARIANTS, ids=[name for name, _ in VARIANTS])
def test_absent_members_have_no_influence(name: str, options: Any) -> None:
    values = observed(9, np.float64)
    crowd = values["crowd"]
    other = {**values, "crowd": Value(np.where(crowd.mask[:, :, None], crowd.array, 1e6), crowd.mask)}
    arrays, memory = weights(plan(name, **options)[1], np.float64), np.zeros((9, 4))
    one, two = (run(name, options, seen, arrays, memory.copy()) for seen in (values, other))
    np.testing.assert_array_equal(one.present(), two.present())


def sigmoid(x: Any) -> Any:
    return 1 / (1 + np.exp(-x))


def gru_step(x: Any, h: Any, a: Any, suffix: str = "") -> Any:
    i, r = x @ a["wx" + suffix] + a["bx" + suffix], h @ a["wh" + suffix] + a["bh" + suffix]
    u = len(h)
    reset, update = sigmoid(i[:u] + r[:u]), sigmoid(i[u : 2 * u] + r[u : 2 * u])
    return (1 - update) * np.tanh(i[2 * u :] + reset * r[2 * u :]) + update * h


def expected(name: str, options: Any, a: Any, own: Any, crowd: Any, score: Any, h: Any) -> Any:
    """The result of a layer for one robot, with the members that are present."""
    if name == "dense":
        return np.maximum(crowd @ a["w"] + a["b"], 0) if options["units"] == 33 else own @ a["w"]
    if name == "layer_norm":
        x = own if options["inputs"] == ["own"] else crowd
        y = (x - x.mean(-1, keepdims=True)) / np.sqrt(x.var(-1, keepdims=True) + 1e-5)
        return y * a["scale"] + a["shift"] if "scale" in a else y
    if name == "running_norm":
        x = own if options["inputs"] == ["own"] else crowd
        return (x - a["mean"]) / a["std"] if "clip" in options else np.clip((x - a["mean"]) / a["std"], -10, 10)
    if name == "pool":
        return getattr(np, options["method"])(crowd, axis=0) if len(crowd) else np.zeros(4)
    if name == "score_pool":
        return np.exp(score[:, 0]) @ crowd / np.exp(score).sum() if len(crowd) else np.zeros(4)
    if name == "memory":
        return gru_step(own, h, a)
    if name == "gru":
        forward = backward = np.zeros(options["units"])
        states = []
        for x in crowd:
            forward = gru_step(x, forward, a) if "wx" in a else forward
        for x in crowd[::-1]:
            backward = gru_step(x, backward, a, "_back")
            states.insert(0, backward)
        if options.get("result") == "all":
            return np.array(states).reshape(-1, options["units"])
        return forward + backward if options.get("merge") == "sum" else np.concatenate([forward, backward])
    if name == "attention":
        asks = own[None] if options["inputs"][0] == "own" else crowd
        q, k, v = asks @ a["wq"] + a["bq"], crowd @ a["wk"] + a["bk"], crowd @ a["wv"] + a["bv"]
        size, parts = options["units"] // options.get("heads", 1), []
        for at in range(0, options["units"], size):
            weight = np.exp(q[:, at : at + size] @ k[:, at : at + size].T / np.sqrt(size))
            sums = weight.sum(1, keepdims=True)
            parts.append(weight @ v[:, at : at + size] / np.where(sums > 0, sums, 1))
        result = np.concatenate(parts, axis=1) @ a["wo"] + a["bo"]
        return result[0] if options["inputs"][0] == "own" else result
    raise AssertionError(name)


COMPUTED = [(n, o) for n, o in VARIANTS if n not in ("activation", "add", "concat", "flatten", "select")]


@pytest.mark.parametrize(("name", "options"), COMPUTED, ids=[name for name, _ in COMPUTED])
def test_numbers_of_plain_numpy(name: str, options: Any) -> None:
    values, a = observed(7, np.float64), weights(plan(name, **options)[1], np.float64)
    h = np.random.default_rng(5).normal(size=(7, 4))
    result = run(name, options, values, a, h.copy())
    mask = values["crowd"].mask
    for b in range(7):
        own, crowd, score = values["own"].array[b], values["crowd"].array[b][mask[b]], values["score"].array[b][mask[b]]
        ours = result.array[b] if result.mask is None else result.array[b][mask[b]]
        np.testing.assert_allclose(ours, expected(name, options, a, own, crowd, score, h[b]), rtol=1e-9, atol=1e-12)


def test_wiring() -> None:
    values = observed(4, np.float64)
    own, goal, crowd = (values[label].array for label in ("own", "goal", "crowd"))
    joined = run("concat", ALL["concat"], values, {})
    assert joined.shape == Shape(12, 6)
    np.testing.assert_array_equal(joined.array[:, 2], np.concatenate([own, crowd[:, 2], goal], axis=1))
    np.testing.assert_array_equal(run("concat", {"inputs": ["goal", "own"]}, values, {}).array[:, :3], goal)
    np.testing.assert_array_equal(run("add", ALL["add"], values, {}).array, 2 * crowd)
    np.testing.assert_array_equal(run("select", ALL["select"], values, {}).array, crowd[:, :, 1:3])
    flat = run("flatten", ALL["flatten"], values, {}).array.reshape(4, 6, 4)
    np.testing.assert_array_equal(flat, values["crowd"].present())
    soft = run("activation", {"inputs": ["own"], "function": "softmax"}, values, {}).array
    np.testing.assert_allclose(soft, np.exp(own) / np.exp(own).sum(1, keepdims=True))


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("dense", {"inputs": ["won"], "units": 1}, r"no part .* did you mean own\?, given: won"),
        ("dense", {"inputs": ["own", "goal"], "units": 1}, "takes 1 input, not 2; put a concat layer before it"),
        ("pool", {"inputs": ["own"]}, r"takes a set, not a vector of 5, given: own \(5\)"),
        ("memory", {"inputs": ["crowd"], "units": 2}, "takes a vector, not a set of 6 x 4"),
        ("gru", {"inputs": ["own"], "units": 2}, "reads a set, not a vector"),
        ("attention", {"inputs": ["crowd"], "units": 5, "heads": 2}, "2 heads, which do not divide its 5 units"),
        ("attention", {"inputs": ["crowd", "own"], "units": 4}, "takes a set, or what asks and a set"),
        ("add", {"inputs": ["own", "goal"]}, "equally many features, not 3 and 5"),
        ("select", {"inputs": ["own"], "stop": 6}, "selects features 0 to 6 of 5"),
        ("score_pool", {"inputs": ["crowd", "crowd"]}, "takes a set of scores"),
    ],
)
def test_layers_that_do_not_fit_are_named(name: str, options: Any, message: str) -> None:
    (problem,) = plan(name, **options)[1].problems
    assert problem.path[:2] == ("network", 0)
    assert re.search(message, problem.message)


def test_a_label_is_used_once_and_layers_after_a_bad_one_are_not_blamed() -> None:
    dense: Any = LAYERS.get("dense")
    layers = [
        dense.options.model_validate({"label": label, "inputs": inputs, "units": 2})
        for label, inputs in (("goal", ["own"]), ("bad", ["missing"]), ("after", ["bad"]))
    ]
    places = [problem.path for problem in plan_graph(PARTS, layers).problems]
    assert places == [("network", 0, "label"), ("network", 1, "inputs")]
