"""RL-RVO with the weights of its authors: the file that the user names, and right turns without a limit."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import irsim
from irsim.benchmarks.policies import files_of
from irsim.common.hashing import digest
from irsim.diagnostics.errors import ArgumentError, PolicyError
from irsim.policies import open_policy, rl_rvo_authors
from irsim.policies.converters.convert import convert_policy
from irsim.policies.networks import open_network
from irsim.policies.rl_rvo_authors import VARIABLE
from tests.benchmarks.authors_circle import outcomes
from tests.policies.converters.test_rl_rvo import rl_rvo_weights
from tests.policies.converters.torch_bytes import as_files
from tests.policies.networks.observed import observations


@pytest.fixture
def weights(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Small weights, which are taken for the authors' own."""
    path = tmp_path / "pre_train.pt"
    path.write_bytes(as_files(rl_rvo_weights())[0])
    monkeypatch.setattr(rl_rvo_authors, "SHA256", digest(path.read_bytes()))
    monkeypatch.setenv(VARIABLE, str(path))
    return path


def test_it_decides_like_the_converted_file(weights: Path, tmp_path: Path) -> None:
    convert_policy("rl_rvo", weights, tmp_path / "out.npz", {"margin": 0.2})
    seen = observations(20, neighbors=32)
    for policy in ("{name: rl_rvo_authors, margin: 0.2}", f"{{name: rl_rvo_authors, weights: {weights}, margin: 0.2}}"):
        np.testing.assert_array_equal(open_policy(policy).act(seen), open_network(tmp_path / "out.npz").act(seen))


def test_plans_keep_the_full_path_and_the_hash_of_the_weights(weights: Path) -> None:
    text = "{name: rl_rvo_authors, weights: pre_train.pt}"
    sources, digests = files_of({"mine": text, "orca": "orca"}, {"mine": weights.parent})
    assert list(digests.items()) == [("mine", digest(weights.read_bytes()))]
    assert sources["mine"] == f"{{name: rl_rvo_authors, weights: {weights.resolve()}}}"


def test_without_the_weights_the_error_says_where_to_get_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    (tmp_path / "other.pt").write_bytes(b"other")
    for options, message in (
        ("", "needs the weights of its authors, which irsim does not ship"),
        (", weights: gone.pt", "weights names 'gone.pt', which is not a file"),
        (f", weights: {tmp_path}/other.pt", f"its SHA-256 is {digest(b'other')}, theirs {rl_rvo_authors.SHA256}"),
    ):
        with pytest.raises(PolicyError) as caught:
            open_policy(f"{{name: rl_rvo_authors{options}}}")
        assert caught.value.code == "policy-file"
        assert message in caught.value.message
        assert "github.com/hanruihua/rl_rvo_nav" in (caught.value.fix or "")
        assert "RL_RVO_WEIGHTS=pre_train.pt" in (caught.value.fix or "")


@pytest.mark.parametrize("option", ["weights: 3", "margin: -1", "margin: .nan", "unlimited_right_turns: 1", "turns: 1"])
def test_options_are_checked(option: str, weights: Path) -> None:
    with pytest.raises((ArgumentError, PolicyError), match=option.split(":")[0]):
        open_policy(f"{{name: rl_rvo_authors, {option}}}")


def test_a_workspace_keeps_out_weights_from_elsewhere(weights: Path, tmp_path: Path) -> None:
    (tmp_path / "inside").mkdir()
    with pytest.raises(PolicyError) as caught:
        open_policy("{name: rl_rvo_authors, weights: ../pre_train.pt}", root=tmp_path / "inside")
    assert caught.value.code == "path-outside-workspace"
    assert open_policy("rl_rvo_authors", root=tmp_path / "inside").name == "rl_rvo_authors"


def test_right_turns_have_no_limit_and_left_turns_have_one(weights: Path) -> None:
    wide = np.array([-1.5, -16.0, 0.0]), np.array([1.5, 1.5, 0.0])
    seen = observations(200, neighbors=32)
    seen = replace(seen, low=np.tile(wide[0], (200, 1)), high=np.tile(wide[1], (200, 1)), first=np.ones(200, bool))
    still = replace(seen, commanded=np.zeros((200, 2)))
    wanted = open_policy("rl_rvo_authors").act(still)
    error = (np.arctan2(wanted[:, 1], wanted[:, 0]) - seen.pose[:, 2] + math.pi) % (2 * math.pi) - math.pi
    speed = np.hypot(*wanted.T)
    policy = open_policy("{name: rl_rvo_authors, unlimited_right_turns: true}")
    assert (policy.output, policy.drives) == ("control", {"diff"})
    forward, turn = policy.act(seen).T
    moving = speed > 0.02
    right, left = moving & (error < -0.1), moving & (error > 0.3)
    assert right.sum() > 20
    assert left.sum() > 20
    np.testing.assert_allclose(turn[right], error[right] / 0.2, atol=1e-9)
    np.testing.assert_array_equal(turn[left], 1.5)
    np.testing.assert_allclose(
        forward[moving], np.maximum(0, np.minimum(speed, 1.5) * np.cos(error))[moving], atol=1e-9
    )


def test_robots_that_may_not_turn_so_fast_are_refused(weights: Path) -> None:
    scene = """
world: {width: 10, height: 10}
robot: {kinematics: {name: diff}, state: [2, 5, 0], goal: [8, 5, 0], vel_max: [1.5, 1.5], vel_min: [-1.5, RIGHT]}
"""
    policy = "{name: rl_rvo_authors, unlimited_right_turns: true}"
    with pytest.raises(PolicyError, match="vel_min") as caught:
        irsim.run(text=scene.replace("RIGHT", "-1.5"), policy=policy, steps=3)
    assert caught.value.code == "policy-mismatch"
    with pytest.raises(PolicyError, match="has the drive omni"):
        irsim.run(text=scene.replace("diff", "omni").replace("RIGHT", "-16"), policy=policy, steps=3)
    assert irsim.run(text=scene.replace("RIGHT", "-16"), policy=policy, steps=3).steps == 3


@pytest.mark.foreign
def test_the_weights_of_the_authors_have_the_outcomes_of_the_page(
    foreign: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, str(foreign / "policies" / "rl_rvo_pre_train.pt"))
    kept = {"robots-5": {100: "success", 103: "collision", 118: "timeout"}, "robots-10": {100: "collision"}}
    for scenario, wanted in kept.items():
        for seed, outcome in wanted.items():
            result = irsim.run(f"random_polygons_v1/{scenario}/freeze", seed=seed, policy="rl_rvo_authors")
            assert (scenario, seed, result.outcome) == (scenario, seed, outcome)
    assert outcomes(14, range(4), free=False, margin=0.1) == "cccc"
    assert outcomes(14, range(4), free=True, margin=0.1).count("s") == 2
