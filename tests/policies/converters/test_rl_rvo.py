"""Weights of RL-RVO become a policy, and other weights are refused with what was expected."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.diagnostics.errors import ArgumentError
from irsim.policies.converters.convert import convert_policy
from irsim.policies.networks import PolicyFileError, open_network
from irsim.policies.networks.layout import observe
from tests.policies.converters.torch_bytes import as_files, mapping, module, parameter, zip_file
from tests.policies.networks.observed import observations

Weights = dict[str, NDArray[np.float32]]


def rl_rvo_weights(units: int = 6, hidden: int = 5, *, backward: bool = True, seed: int = 0) -> Weights:
    """A state dictionary with the names of the authors' module, in which policy and value share a reader."""
    rng = np.random.default_rng(seed)

    def some(*shape: int) -> NDArray[np.float32]:
        return rng.uniform(-0.5, 0.5, shape).astype(np.float32)

    reader: Weights = {}
    for suffix in ("", "_reverse") if backward else ("",):
        reader[f"rnn_net.weight_ih_l0{suffix}"] = some(3 * units, 8)
        reader[f"rnn_net.weight_hh_l0{suffix}"] = some(3 * units, units)
        reader[f"rnn_net.bias_ih_l0{suffix}"] = some(3 * units)
        reader[f"rnn_net.bias_hh_l0{suffix}"] = some(3 * units)
    reader |= {"ln.weight": some(6 + units) + 1, "ln.bias": some(6 + units)}
    policy = {
        "pi.log_std": some(2),
        "pi.net_out.0.weight": some(hidden, 6 + units), "pi.net_out.0.bias": some(hidden),
        "pi.net_out.2.weight": some(hidden, hidden), "pi.net_out.2.bias": some(hidden),
        "pi.net_out.4.weight": some(2, hidden), "pi.net_out.4.bias": some(2),
        "v.v_net.0.weight": some(hidden, 6 + units), "v.v_net.0.bias": some(hidden),
        "v.v_net.2.weight": some(1, hidden), "v.v_net.2.bias": some(1),
    }  # fmt: skip
    shared = {f"{owner}.rnn_reader.{name}": array for owner in ("pi", "v") for name, array in reader.items()}
    return {**policy, **shared}


SCENE = """
world: {width: 10, height: 10, step_time: 0.1, collision_mode: stop}
robot:
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [2, 5, 0], goal: [8, 5, 0], vel_max: [1, 3]}
  - {kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [8, 5.2], goal: [2, 5.2], vel_max: [1, 1]}
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "policy.pt"
    path.write_bytes(as_files(rl_rvo_weights())[0])
    return path


def sigmoid(x: Any) -> Any:
    return 1 / (1 + np.exp(-x))


def decided(weights: Weights, own: Any, cones: Any, acceler: float) -> Any:
    """The change of velocity by the equations of the paper, in double precision."""
    total = 0
    for suffix in ("", "_reverse"):
        wx, wh, bx, bh = (
            weights[f"pi.rnn_reader.rnn_net.{name}_l0{suffix}"].astype(float)
            for name in ("weight_ih", "weight_hh", "bias_ih", "bias_hh")
        )
        state = np.zeros(wh.shape[1])
        for cone in cones[::-1] if suffix else cones:
            (r, z, n), (hr, hz, hn) = np.split(wx @ cone + bx, 3), np.split(wh @ state + bh, 3)
            update = sigmoid(z + hz)
            state = (1 - update) * np.tanh(n + sigmoid(r + hr) * hn) + update * state
        total = total + state
    x = np.concatenate([own, total])
    x = (x - x.mean()) / np.sqrt(x.var() + 1e-5)
    x = x * weights["pi.rnn_reader.ln.weight"] + weights["pi.rnn_reader.ln.bias"]
    for k in (0, 2, 4):
        x = weights[f"pi.net_out.{k}.weight"] @ x + weights[f"pi.net_out.{k}.bias"]
        x = np.maximum(x, 0) if k < 4 else np.tanh(x)
    return acceler * x


def test_decisions_are_those_of_the_equations(file: Path, tmp_path: Path) -> None:
    convert_policy("rl_rvo", file, tmp_path / "out.npz", {"acceler": 0.5})
    policy = open_network(tmp_path / "out.npz")
    assert policy.output == "velocity"
    seen = observations(40, neighbors=32)
    nobody = replace(seen, neighbors=replace(seen.neighbors, mask=np.zeros_like(seen.neighbors.mask)))
    for what, counts in ((seen, 3), (nobody, 1)):
        velocities, parts = policy.act(what), observe(policy.head.layout, what)
        mask = parts["rvo_cones"].mask
        assert len(set(mask.sum(axis=1).tolist())) >= counts
        for b in range(40):
            cones = np.zeros((1, 8)) if what is nobody else parts["rvo_cones"].array[b][mask[b]]  # one member of zeros
            change = decided(rl_rvo_weights(), parts["rvo_self"].array[b], cones, 0.5)
            np.testing.assert_allclose(velocities[b], what.velocity[b] + change, atol=1e-6)


def test_the_card_says_where_weights_come_from(file: Path, tmp_path: Path) -> None:
    options = {"license": "MIT", "source": "made up", "margin": 0.2, "speed": 1.5, "decision_dt": 0.1}
    document = convert_policy("rl_rvo", file, tmp_path / "out.npz", options).document
    assert (document.card.license, document.card.source, document.decision_dt) == ("MIT", "made up", 0.1)
    assert document.card.notes["converted_from"] == "policy.pt"
    assert len(str(document.card.notes["converted_sha256"])) == 64
    assert [part.model_dump()["margin"] for part in document.layout.parts] == [0.2, 0.2]


def test_a_converted_policy_drives_robots_of_every_drive(file: Path, tmp_path: Path) -> None:
    convert_policy("rl_rvo", file, tmp_path / "out.npz")
    policy = str(tmp_path / "out.npz")
    first, second = (irsim.run(text=SCENE, policy=policy, steps=40, seed=1) for _ in range(2))
    assert (first.steps, first.robots) == (second.steps, second.robots)
    assert all(robot.path_length > 0 for robot in first.robots)


def test_a_checkpoint_a_module_and_a_forward_unit_are_understood(tmp_path: Path) -> None:
    weights = rl_rvo_weights(backward=False)
    reader = module("Reader", {}, {"rnn_net": stored(weights, "pi.rnn_reader.rnn_net."),
                                   "ln": stored(weights, "pi.rnn_reader.ln.")})  # fmt: skip
    layers = {str(k): stored(weights, f"pi.net_out.{k}.") for k in (0, 2, 4)}
    actor = module("Actor", {}, {"rnn_reader": reader, "net_out": module("Layers", {}, layers)})
    raw = {name.replace(".", "-"): array.tobytes() for name, array in weights.items()}
    for body in (module("Both", {}, {"pi": actor}), mapping({"model_state": module("Both", {}, {"pi": actor})})):
        (tmp_path / "whole.pt").write_bytes(zip_file(body, raw))
        network = convert_policy("rl_rvo", tmp_path / "whole.pt", tmp_path / "out.npz")
        assert network.document.network[0].model_dump()["direction"] == "forward"


def stored(weights: Weights, prefix: str) -> bytes:
    own = {name.removeprefix(prefix): array for name, array in weights.items() if name.startswith(prefix)}
    return module("Any", {name: parameter((prefix + name).replace(".", "-"), array.shape)
                          for name, array in own.items()}, {})  # fmt: skip


def without(ending: str) -> Weights:
    return {name: array for name, array in rl_rvo_weights().items() if not name.endswith(ending)}


def changed(ending: str, array: Any) -> Weights:
    return {name: np.float32(array) if name.endswith(ending) else old for name, old in rl_rvo_weights().items()}


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ({"w": np.ones(3, np.float32)}, "no array is called weight_hh_l0, given: w (3)"),
        (without("ln.weight"), "the scale of the layer norm is missing: no array is called ln.weight or"),
        (without("bias_hh_l0_reverse"), "array bias_hh of the GRU is missing"),
        (without("net_out.4.weight"), "no sequence of linear layers from 12 to 2 numbers"),
        (without("net_out.2.bias"), "pi.net_out.2.bias: this bias does not fit, given: none, allowed: 5"),
        (changed("weight_ih_l0", np.ones((18, 5))), "has another shape, given: 18 x 5, allowed: 18 x 8"),
        (changed("weight_hh_l0", np.ones((24, 6))), "the recurrent unit is an LSTM"),
        (changed("weight_hh_l0", np.ones((7, 6))), "is not a GRU"),
        ({**rl_rvo_weights(), "old.ln.bias": np.ones(12, np.float32)}, "several arrays may be the shift"),
        ({**rl_rvo_weights(), "a.0.weight": np.ones((2, 12), np.float32)}, "more than one sequence"),
    ],
)
def test_other_weights_are_refused_and_nothing_is_written(weights: Weights, message: str, tmp_path: Path) -> None:
    (tmp_path / "other.pt").write_bytes(as_files(weights)[1])
    with pytest.raises(PolicyFileError) as caught:
        convert_policy("rl_rvo", tmp_path / "other.pt", tmp_path / "out.npz")
    assert message in caught.value.message
    assert [path.name for path in tmp_path.iterdir()] == ["other.pt"]


def test_the_command_converts_and_says_what_is_wrong(file: Path, tmp_path: Path) -> None:
    runner, out = CliRunner(), tmp_path / "out.npz"
    done = runner.invoke(app, ["convert", "rl_rvo", str(file), "-o", str(out), "--set", "acceler=0.5"])
    assert done.exit_code == 0, done.output
    assert "parameters)\ntry it: irsim run SCENARIO --policy" in done.output
    out.write_bytes(b"kept")
    for arguments, message in (
        (["rl_rv", str(file)], "did you mean rl_rvo"),
        (["rl_rvo", str(tmp_path / "none.pt")], "No such file"),
        (["rl_rvo", str(file), "--set", "acceleration=1"], "has no option 'acceleration'"),
        (["rl_rvo", str(file), "--set", "acceler=0"], "acceler: 'acceler' must be > 0 [m/s], got 0"),
        (["rl_rvo", str(file), "--set", "acceler"], "is not an option"),
        (["rl_rvo", str(tmp_path)], "it is a folder, not a file"),
    ):
        failed = runner.invoke(app, ["convert", *arguments, "-o", str(out), "--force"])
        assert (failed.exit_code, out.read_bytes(), "Traceback" in failed.output) == (2, b"kept", False)
        assert message.lower() in failed.output.replace("\n", " ").lower()
    convert = ["convert", "rl_rvo", str(file), "-o", str(out)]
    refused = runner.invoke(app, convert)
    assert (refused.exit_code, out.read_bytes()) == (2, b"kept")
    assert "exists" in refused.output
    assert "--force" in refused.output
    assert runner.invoke(app, [*convert, "--force"]).output.startswith("replaced ")
    assert runner.invoke(app, ["convert", "rl_rvo", str(file), "-o", "out.onnx"]).exit_code == 2
    with pytest.raises(ArgumentError, match="choose from"):
        convert_policy("unknown", file, out)
