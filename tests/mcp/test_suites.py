"""Bundled suites in the tools: as benchmarks, and their scenarios wherever a scenario is expected."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from irsim.benchmarks.stored import measure_plan
from irsim.benchmarks.suite_plan import suite_plan
from irsim.policies.networks import save_network
from tests.mcp.conftest import Caller
from tests.policies.networks.examples import go_to_goal

pytestmark = [pytest.mark.one_python, pytest.mark.anyio]


async def test_a_suite_is_a_benchmark_and_a_failed_episode_can_be_looked_at(client: Caller, workspace: Path) -> None:
    data = await client.data("benchmark", scenarios=["random_polygons_v1/robots-5"], policies=["orca", "dash"], seeds=3)
    kept = json.loads((workspace / data["artifact"]).read_text())
    plan = suite_plan("random_polygons_v1", policies=["orca", "dash"], seeds=3, scenarios=["robots-5"])
    same = measure_plan(plan)
    timing = json.loads((workspace / data["artifact"]).with_name("timing.json").read_text())["policies"]
    assert set(timing) == set(same.behaviors)
    assert all(measured["per_robot"]["mean_ms"] > 0 for measured in timing.values())
    assert kept == json.loads(same.model_dump_json())
    assert [row["behavior"] for row in data["rows"][:2]] == ["orca", "dash"]
    assert data["reproduce"] == (
        "irsim benchmark random_polygons_v1 --policies orca,dash --scenario robots-5 --seeds 3"
    )
    assert "scenario_path='random_polygons_v1/robots-5/freeze' seed=100 policy='dash'" in data["next"]
    again = await client.data(
        "run_episode", scenario_path="random_polygons_v1/robots-5/freeze", seed=100, policy="dash"
    )
    assert again["outcome"] == "collision"
    listed = await client.data("inspect_run", run_id=data["job_id"])
    assert listed["rows"][0][1] == "dash"


async def test_a_suite_runs_files_of_the_workspace(client: Caller, workspace: Path) -> None:
    save_network(workspace / "goal.npz", go_to_goal())
    arguments = {"scenarios": ["random_polygons_v1/robots-5/yield"], "policies": ["orca", "goal.npz"], "seeds": 2}
    data = await client.data("benchmark", **arguments)
    assert [row["episodes"] for row in data["rows"]] == [2, 2]
    outside = arguments | {"policies": ["/etc/net.npz"]}
    assert "workspace" in await client.text("benchmark", **outside)


async def test_a_suite_runs_other_seeds(client: Caller, workspace: Path) -> None:
    arguments = {"scenarios": ["random_polygons_v1/robots-5/yield"], "policies": ["dash"], "seeds": 2}
    data = await client.data("benchmark", **arguments, first_seed=7)
    assert data["reproduce"].endswith("--scenario robots-5/yield --seeds 7-8")
    assert (await client.data("benchmark", **arguments))["reproduce"].endswith("--seeds 2")


async def test_an_episode_of_a_suite_knows_the_policies_of_the_suite(client: Caller, workspace: Path) -> None:
    arguments = {"scenario_path": "random_polygons_v1/robots-5/yield", "seed": 100, "max_steps": 3}
    data = await client.data("run_episode", **arguments, policy="ppo")
    assert data["behavior"] == "multi_robot"
    data = await client.data("run_episode", **arguments, policy="orca")
    assert data["behavior"].startswith("{name: orca, neighborDist: 5")


async def test_a_stopped_suite_is_named_like_a_finished_one(client: Caller, workspace: Path) -> None:
    arguments = {"scenarios": ["random_polygons_v1"], "policies": ["orca", "sarl_multi_robot"], "seeds": 30}
    job = (await client.data("benchmark", **arguments, wait_s=2))["job_id"]
    data = await client.data("get_job", job_id=job, cancel=True)
    while not data["done"]:  # the machine is slow
        job = (await client.data("benchmark", **arguments, wait_s=20))["job_id"]
        data = await client.data("get_job", job_id=job, cancel=True)
    assert data["status"] == "cancelled"
    assert data["rows"][0]["behavior"] == "orca"
    assert data["reproduce"] == "irsim benchmark random_polygons_v1 --policies orca,sarl_multi_robot --seeds 30"
    listed = await client.data("inspect_run", run_id=job)
    assert "scenario_path='random_polygons_v1/robots-5/freeze'" in listed["next"]


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"scenarios": ["random_polygons_v1/robot-5"]}, "did you mean random_polygons_v1/robots-5"),
        ({"scenarios": ["random_polygons_v1", "circle_swap_v1"]}, "benchmarked without others"),
        ({"scenarios": ["random_polygons_v1", "room.yaml"]}, "benchmarked without others"),
        ({"first_seed": 2**53 - 1}, "exceed"),
        ({"max_steps": 5}, "a suite has its own horizon"),
        ({"policies": ["orcas"]}, "there is no policy 'orcas'"),
        ({"policies": ["orca", "orcas", "sarll"]}, "there is no policy 'orcas'; there is no policy 'sarll'"),
        ({"seeds": 100}, "at most"),
    ],
)
async def test_what_does_not_fit_a_suite_is_refused(
    client: Caller, workspace: Path, changes: dict[str, object], problem: str
) -> None:
    asked = {"scenarios": ["random_polygons_v1"], "seeds": 2, **changes}
    assert problem in await client.error("benchmark", **asked)
    assert "robots-5/" in await client.error("run_episode", scenario_path="random_polygons_v1/robots-5")
