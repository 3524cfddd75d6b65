"""ONNX models as policies, and networks written as such models."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from irsim.policies.networks import Limits, PolicyFileError, mlp, open_network, save_network
from irsim.policies.networks.document import PolicyDocument
from irsim.policies.networks.network import Network, read_document
from irsim.policies.networks.onnx.writing import onnx_bytes, save_onnx
from tests.policies.networks.observed import assert_same_in_any_company, observations, rows
from tests.policies.onnx.models import DOCUMENT, FLOAT, model, perceptron, tensor, weights, write

pytestmark = pytest.mark.onnx


def refused(path: Path, **limits: int) -> str:
    with pytest.raises(PolicyFileError) as caught:
        open_network(path, limits=Limits(**limits))
    assert caught.value.fix
    return caught.value.message


@pytest.mark.parametrize("inside", [True, False])
def test_a_model_decides_as_the_same_network_of_our_layers(tmp_path: Path, inside: bool) -> None:
    policy = open_network(write(tmp_path / "net.onnx", perceptron(), inside=inside))
    w = weights()
    parts = DOCUMENT["layout"]["parts"]
    output = {key: value for key, value in DOCUMENT["output"].items() if key != "input"}
    layers = [(w["w0"], w["b0"]), (w["w1"], w["b1"])]
    save_network(tmp_path / "own.npz", mlp(layers, parts, output=output, drives=["diff"]))
    seen = observations(40)
    np.testing.assert_allclose(policy.act(seen), open_network(tmp_path / "own.npz").act(seen), atol=1e-5)
    assert (policy.name, policy.output, policy.drives) == ("net", "control", {"diff"})
    facts = json.loads(json.dumps(policy.describe()))
    assert (facts["format"], facts["parameters"], facts["operations"]) == ("onnx", 64 * 6 + 2, 3)
    assert facts["runtime"].startswith("onnxruntime ")


def test_a_decision_is_the_same_alone_and_in_any_batch(tmp_path: Path) -> None:
    policy = open_network(write(tmp_path / "net.onnx", perceptron()))
    for count in (1, 2, 5, 33):
        assert assert_same_in_any_company(policy.act, observations(count, count)).shape == (count, 2)
    assert policy.act(rows(observations(), np.zeros(0, dtype=int))).shape == (0, 2)


def test_sets_masks_and_joined_inputs(tmp_path: Path) -> None:
    from onnx import helper

    parts = [{"name": "goal"}, {"name": "neighbors", "label": "others", "count": 3, "features": ["x", "y"]}]
    nodes = [
        helper.make_node("Unsqueeze", ["others_mask", "last"], ["m"]),
        helper.make_node("Mul", ["others", "m"], ["shown"]),
        helper.make_node("ReduceSum", ["shown", "one"], ["action"], keepdims=0),
    ]
    inputs = [tensor("goal", ["n", 3]), tensor("others", ["n", 3, 2]), tensor("others_mask", ["n", 3])]
    result = [tensor("action", ["n", 2])]
    arrays = {"last": np.array([2]), "one": np.array([1])}
    document = {**DOCUMENT, "layout": {"parts": parts}, "output": {"input": "action"}}
    seen = observations(9)
    summed = open_network(write(tmp_path / "sum.onnx", model(nodes, inputs, result, arrays), document)).act(seen)
    joined = {**document, "joined": "obs"}
    w = np.concatenate([np.zeros((3, 2)), np.tile(np.eye(2), (3, 1))]).astype(np.float32)
    take = model([helper.make_node("Gemm", ["obs", "w"], ["action"])], [tensor("obs", ["n", 9])], result, {"w": w})
    policy = open_network(write(tmp_path / "joined.onnx", take, joined))
    np.testing.assert_allclose(policy.act(seen), summed, atol=1e-6)
    assert not summed[~seen.neighbors.mask[:, :3].any(axis=1)].any()


def test_memory_belongs_to_a_robot_and_ends_with_its_episode(tmp_path: Path) -> None:
    from onnx import helper

    nodes = [
        helper.make_node("Add", ["count", "step"], ["next"]),
        helper.make_node("Mul", ["goal", "zero"], ["z"]),
        helper.make_node("ReduceSum", ["z", "one"], ["s"]),
        helper.make_node("Add", ["next", "s"], ["action"]),
    ]
    inputs = [tensor("goal", ["n", 3]), tensor("count", ["n", 2])]
    outputs = [tensor("action", ["n", 2]), tensor("next", ["n", 2])]
    arrays = {"step": np.ones((1, 2), np.float32), "zero": np.zeros(1, np.float32), "one": np.array([1])}
    document = {**DOCUMENT, "output": {"input": "action"}, "memory": {"count": "next"}}
    policy = open_network(write(tmp_path / "count.onnx", model(nodes, inputs, outputs, arrays), document))
    seen = observations(4)
    policy.act(replace(seen, first=np.ones(4, dtype=bool)))
    policy.act(seen)
    assert policy.act(replace(seen, first=np.array([True, False, False, True])))[:, 0].tolist() == [1, 3, 3, 1]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"layout": {"parts": [{"name": "own"}]}}, "own: the model has no such input, allowed: goal"),
        ({"layout": {"parts": [{"name": "goal", "features": ["x"]}]}}, "1 x 3, allowed: float32 or float64 1 x 1"),
        ({"layout": {"parts": [{"name": "goal"}, {"name": "own"}]}}, "own: the model has no such input"),
        ({"output": {"input": "result"}}, "output.input: the model has no such output, given: result, allowed: action"),
        ({"drives": ["omni_angular"]}, "omni_angular has 3 controls, given: 2"),
        ({"joined": "obs"}, "obs: the model has no such input"),
        ({"memory": {"goal": "later"}}, "memory.goal: the model has no such output, given: later"),
        ({"network": []}, "network: 'network' is not a key of a policy"),
        ({"version": 3}, "version: 3 is not a valid value of 'version' (allowed: 1)"),
    ],
)
def test_documents_that_do_not_fit_the_model(tmp_path: Path, change: dict[str, Any], message: str) -> None:
    assert message in refused(write(tmp_path / "net.onnx", perceptron(), {**DOCUMENT, **change}))


def test_a_model_needs_a_document(tmp_path: Path) -> None:
    path = write(tmp_path / "net.onnx", perceptron(), None)
    with pytest.raises(PolicyFileError, match=r"write the JSON document to net\.json"):
        open_network(path)
    assert "not valid JSON" in refused(write(path, perceptron(), "{"))


def one_node(operation: str, inputs: list[str], sides: list[Any], arrays: dict[str, Any], **options: Any) -> Any:
    from onnx import helper

    node = helper.make_node(operation, inputs, ["action"], **options)
    opsets = [helper.make_opsetid(options["domain"], 1)] if "domain" in options else []
    return model([node], [tensor("goal", ["n", 3])], [tensor("action", sides)], arrays, opsets=opsets)


def test_operations_that_are_custom_random_or_unbounded_are_refused(tmp_path: Path) -> None:
    from onnx import helper

    body = helper.make_graph(
        [helper.make_node("Identity", ["going"], ["goes"]), helper.make_node("Identity", ["v"], ["w"])],
        "body",
        [tensor("k", [], 7), tensor("going", [], 9), tensor("v", [1, 3])],
        [tensor("goes", [], 9), tensor("w", [1, 3])],
    )
    loop = {"count": np.array(2**62), "yes": np.array(True)}
    for made, name in (
        (one_node("Loop", ["count", "yes", "goal"], ["n", 3], loop, body=body), "Loop"),
        (one_node("RandomNormalLike", ["goal"], ["n", 3], {}), "RandomNormalLike"),
        (one_node("Attack", ["goal"], ["n", 3], {}, domain="evil.ops"), "evil.ops.Attack"),
    ):
        message = refused(write(tmp_path / "net.onnx", made, {**DOCUMENT, "output": {"input": "action"}}))
        assert f"this operation is not run, given: {name}" in message


def test_arrays_in_other_files_are_refused(tmp_path: Path) -> None:
    made = perceptron()
    (tmp_path / "secret").write_bytes(b"\0" * 4096)
    array = made.graph.initializer[0]
    array.ClearField("raw_data")
    array.data_location = 1
    array.external_data.add(key="location", value="secret")
    assert "w0: arrays in other files are not read" in refused(write(tmp_path / "net.onnx", made))


def test_work_and_memory_are_bounded_before_anything_runs(tmp_path: Path) -> None:
    from onnx import helper

    wide = {"shape": np.array([1, 50_000, 1000])}
    nodes = [
        helper.make_node("Expand", ["one", "shape"], ["huge"]),
        helper.make_node("ReduceMax", ["huge"], ["m"], keepdims=0),
        helper.make_node("Add", ["goal", "m"], ["action"]),
    ]
    arrays = {**wide, "one": np.ones((1, 1, 1), np.float32)}
    bomb = model(nodes, [tensor("goal", ["n", 3])], [tensor("action", ["n", 3])], arrays)
    message = refused(write(tmp_path / "bomb.onnx", bomb))
    assert "too many numbers that operations return for a robot, given: 5000000" in message
    free = one_node("Reshape", ["goal", "shape"], ["n", "m"], {})
    free.graph.input.append(tensor("shape", [2], 7))
    message = refused(write(tmp_path / "free.onnx", free))
    assert "action: the size of this tensor is not known before the model runs" in message
    path = write(tmp_path / "net.onnx", perceptron())
    for limit, what in (
        ({"parameters": 100}, "too many parameters, given: 386"),
        ({"work": 100}, "too many multiplications"),
        ({"numbers": 100}, "too many numbers"),
        ({"arrays": 3}, "too many arrays, given: 4"),
        ({"file_bytes": 100}, "it is too large, given"),
        ({"document_bytes": 10}, "the document is too long"),
    ):
        assert what in refused(path, **limit)  # type: ignore[arg-type]


def test_a_model_with_a_fixed_batch_is_refused(tmp_path: Path) -> None:
    message = refused(write(tmp_path / "net.onnx", perceptron(rows=8)))
    assert "goal: this input of the model has another shape or type, given: float32 8 x 3" in message


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.tuples(st.integers(0, 10_000), st.integers(0, 255)), min_size=1, max_size=6), st.booleans())
def test_damaged_files_are_refused_or_read_but_never_fail_otherwise(tmp_path: Path, damage: Any, cut: bool) -> None:
    path = write(tmp_path / "net.onnx", perceptron())
    content = bytearray(path.read_bytes())
    for at, value in damage:
        content[at % len(content)] = value
    path.write_bytes(bytes(content[: damage[0][0]]) if cut else bytes(content))
    try:
        policy = open_network(path)
    except PolicyFileError:
        return
    assert policy.act(observations(2)).shape == (2, 2)


def test_the_type_float64_is_kept(tmp_path: Path) -> None:
    from onnx import helper

    node = helper.make_node("Mul", ["goal", "k"], ["action"])
    double = FLOAT + 10
    ends = [tensor("goal", ["n", 3], double)], [tensor("action", ["n", 3], double)]
    made = model([node], *ends, {"k": np.array([1 / 3])})
    policy = open_network(write(tmp_path / "net.onnx", made, {**DOCUMENT, "output": {"input": "action"}}))
    seen = replace(observations(3), goal=np.full((3, 3), np.nan))
    assert policy.act(seen).tolist() == [[0, 0, 0]] * 3


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
    data = {
        "layout": {"parts": [{"name": "goal"}]}, "drives": ["omni_angular"],
        "network": [{"name": "layer_norm", "label": "action", "inputs": ["goal"]}],
        "output": {"input": "action", "low": [0, -1, 0], "high": [1, 1, 1]},
    }  # fmt: skip
    arrays = {"action.scale": np.ones(3, np.float32), "action.shift": np.zeros(3, np.float32)}
    made = Network(read_document(PolicyDocument, data, "test"), arrays)
    with pytest.raises(PolicyFileError, match=r"network\[0\]: this layer is not written as ONNX, given: layer_norm"):
        onnx_bytes(made)
