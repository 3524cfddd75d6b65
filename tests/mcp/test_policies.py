"""Policies given to tools: built-in ones and files of the workspace, nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest

from irsim.policies.networks import save_network
from irsim.policies.registry import POLICIES
from tests.mcp.conftest import ROOM, Caller
from tests.policies.networks.examples import go_to_goal

pytestmark = pytest.mark.anyio

SCENE = ROOM.replace("omni", "diff")


async def test_a_network_of_the_workspace_is_compared_and_run(client: Caller, empty: Path) -> None:
    save_network(empty / "net.npz", go_to_goal())
    (empty / "scene.yaml").write_text(
        "world: {time_limit: 20}\n"
        "robot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [5, 3], behavior: {name: dash}}\n"
    )
    table = await client.data("benchmark", scenarios=["scene.yaml"], policies=["dash", "net.npz", "random"], seeds=2)
    one = await client.data("run_episode", scenario_path="scene.yaml", policy="net.npz")
    last = {"run_id": one["run_id"], "step": -1, "return_image": False}
    picture = await client.call_tool("render_snapshot", last)
    shares = {row["behavior"]: row["success"][0] for row in table["rows"]}
    assert shares == {"dash": 1.0, "net.npz": 1.0, "random": 0.0}
    assert (one["outcome"], one["behavior"]) == ("success", "net.npz")
    assert "--policy net.npz" in one["reproduce"]
    assert not picture.is_error


async def test_files_outside_and_plug_ins_are_refused(
    client: Caller, empty: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    save_network(empty.parent / "outside.npz", go_to_goal())
    (empty / "link.npz").symlink_to(empty.parent / "outside.npz")
    (empty / "bad.npz").write_bytes(b"PK\x03\x04 nothing")
    monkeypatch.setattr(POLICIES, "_makers", {"plugged": go_to_goal})
    expected = {
        "../outside.npz": "path-outside-workspace",
        str(empty.parent / "outside.npz"): "path-outside-workspace",
        "link.npz": "path-outside-workspace",
        "gone.npz": "unknown-policy",
        "plugged": "unknown-policy",
        "bad.npz": "policy-file",
    }
    for policy, code in expected.items():
        for name, arguments in (
            ("run_episode", {"scenario_yaml": SCENE, "policy": policy}),
            ("benchmark", {"scenarios": [SCENE], "policies": [policy], "seeds": 1}),
        ):
            assert (await client.error(name, **arguments)).split(":")[0] == code, policy


async def test_two_names_of_one_argument_are_not_mixed(client: Caller) -> None:
    assert (await client.error("run_episode", scenario_yaml=ROOM, policy="dash", behavior="dash")).startswith(
        "bad-argument: policy and behavior are"
    )
