"""Bundled suites and perturbed starts in the tools, seeds without room, and incidents in first lines."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import irsim
from irsim.benchmarks.stored import measure_plan
from irsim.benchmarks.suite_plan import suite_plan
from irsim.policies.networks import save_network
from tests.benchmarks.test_incidents import CROWDED, PEOPLE
from tests.benchmarks.test_perturb import CROSSING
from tests.mcp.conftest import Caller, data_of, text_of
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


async def test_a_perturbed_benchmark_and_one_of_its_episodes(
    client: Caller, workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (workspace / "crossing.yaml").write_text(CROSSING)
    spreads = "position=0.5; speed=10%,delay=1,objects=walker"
    arguments = {"scenarios": ["crossing.yaml"], "seeds": 6, "perturb": spreads}
    result = await client.call_tool("benchmark", arguments)
    data, told = data_of(result), text_of(result)
    kept = json.loads((workspace / data["artifact"]).read_text())
    monkeypatch.chdir(workspace)
    same = irsim.benchmark("crossing.yaml", seeds=6, perturb=spreads, strict=True)
    assert kept["episodes"] == json.loads(same.model_dump_json())["episodes"]
    assert len(data["rows"][0]["success"]) == 3  # random, so with an interval
    assert any(note.startswith("perturbed, drawn uniformly for each seed: start ±0.5 m") for note in data["notes"])
    assert "Note: perturbed" in told
    assert "--seeds 6 --perturb position=0.5 --perturb speed=0.1,delay=1,objects=walker" in data["reproduce"]
    call = re.search(r"run_episode scenario_path='crossing.yaml' seed=(\d) perturb='([^']+)' \(collision\)", told)
    assert call is not None
    again = await client.call("run_episode", scenario_path="crossing.yaml", seed=int(call[1]), perturb=call[2])
    episode = same.episodes[int(call[1])]
    assert (data_of(again)["outcome"], data_of(again)["steps"]) == (episode.outcome, episode.steps)
    assert data_of(again)["random"] == ["start positions", "speeds", "start delays"]
    run = data_of(again)["run_id"]
    table = await client.data("inspect_run", run_id=run, fields=["x", "y"], limit=2)
    start = irsim.run("crossing.yaml", seed=int(call[1]), perturb=spreads, steps=0).robots[0].pose
    assert table["rows"][0][-2:] == pytest.approx(start[:2], abs=1e-3)
    drawn = await client.call("render_snapshot", run_id=run, step=3, return_image=False)
    assert not drawn.is_error, text_of(drawn)  # it was simulated again and compared with the record


async def test_wrong_perturbations_are_told(client: Caller, workspace: Path) -> None:
    (workspace / "crossing.yaml").write_text(CROSSING)
    for tool, scenario in (
        ("benchmark", {"scenarios": ["crossing.yaml"]}),
        ("run_episode", {"scenario_path": "crossing.yaml"}),
    ):
        told = await client.error(tool, **scenario, perturb="heading=10")
        assert told.startswith("bad-argument: heading must be a number from 0 to 3.1416 [rad], got '10' (10 degrees")
        told = await client.error(tool, **scenario, perturb="delay=1,objects=missing")
        assert told.startswith("bad-argument: no object of 'crossing' has the name, tag or role 'missing' (perturb)")
        told = await client.error(tool, **scenario, perturb=["position=1"])
        assert told.startswith("bad-argument")
    jobs = workspace / ".irsim" / "jobs"
    assert not jobs.exists() or [path for path in jobs.iterdir() if path.is_dir()] == []


async def test_seeds_without_room_are_counted_beside_n(client: Caller, workspace: Path) -> None:
    (workspace / "crowded.yaml").write_text(CROWDED % 15)
    result = await client.call("benchmark", scenarios=["crowded.yaml"], seeds=12)
    data, first = data_of(result), text_of(result).splitlines()[0]
    table = await client.data("inspect_run", run_id=data["job_id"])
    kept = json.loads((workspace / data["artifact"]).read_text())
    without = sum(episode["outcome"] == "placement-crowded" for episode in kept["episodes"])
    assert 0 < without < 12
    [row] = data["rows"]
    assert row["episodes"] == 12 - without
    assert row["incidents"]["placement-crowded"] == without
    assert f"{without} of 12 seeds had no room and do not count (placement-crowded): " in first
    assert f"/{12 - without};" in first
    assert "episodes with placement-crowded: seeds 0, 1, 2" in text_of(result)
    assert "placement-crowded" not in data["next"]
    assert f"and {without} without room (placement-crowded)" in table["summary"]


async def test_contacts_between_people_are_in_the_first_line(client: Caller, workspace: Path) -> None:
    text = (PEOPLE % "unobstructed_obstacles").replace("goal: [3, 1]", "goal: [9, 1]")
    run = await client.call("run_episode", scenario_yaml=text)
    many = await client.call("benchmark", scenarios=[text], seeds=3, perturb="speed=1%")
    assert "1 contact between people ('ann' hit 'bob' at" in text_of(run).splitlines()[0]
    assert data_of(run)["incidents"] == {"human_contacts": 1}
    assert (
        "contacts between people, or other moving obstacles, in 3 of 3 episodes (3 contacts; seeds 0, 1, 2)"
        in text_of(many).splitlines()[0]
    )
    assert data_of(many)["rows"][0]["incidents"] == {"human_contacts": 3}


async def test_an_episode_of_a_suite_is_run_and_drawn_as_the_suite_runs_it(client: Caller) -> None:
    name = next(f"circle_swap_v1/{one.name}" for one in suite_plan("circle_swap_v1").scenarios)
    own = irsim.run(name, seed=3, policy="dash")
    told = await client.data("run_episode", scenario_path=name, seed=3, policy="dash", response_format="detailed")
    assert [robot["pose"] for robot in told["robots"]] == [[round(x, 3) for x in robot.pose] for robot in own.robots]
    start = irsim.run(name, seed=3, steps=0)
    x, y, _ = start.robots[0].pose
    assert f"'robot_0' (r0) at ({x:.2f}, {y:.2f})" in await client.text("render_snapshot", scenario_path=name, seed=3)


async def test_the_table_of_several_episodes_shows_the_starts_that_were_run(client: Caller, workspace: Path) -> None:
    (workspace / "crossing.yaml").write_text(CROSSING)
    arguments = {"scenario_path": "crossing.yaml", "seeds": [3], "perturb": "position=0.5"}
    told = await client.text("run_episode", **arguments)
    run = re.search(r"^Run: (\S+)$", told, re.MULTILINE)
    assert run is not None
    table = await client.data("inspect_run", run_id=run[1], fields=["x", "y"], limit=2)
    name, x, y = table["rows"][0][2:]
    assert f"'{name}' (r0) at ({x:.2f}, {y:.2f})" in told or f"'{name}' at ({x:.2f}, {y:.2f})" in told
