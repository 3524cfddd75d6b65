"""``perturb`` of the tools ``benchmark`` and ``run_episode``, seeds without room, and incidents in first lines."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import irsim
from tests.benchmarks.test_incidents import CROWDED, PEOPLE
from tests.benchmarks.test_perturb import CROSSING
from tests.mcp.conftest import Caller, data_of, text_of

pytestmark = pytest.mark.anyio


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
    assert not jobs.exists() or list(jobs.iterdir()) == []


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
    assert "contacts between people in 3 of 3 episodes (3 contacts; seeds 0, 1, 2)" in text_of(many).splitlines()[0]
    assert data_of(many)["rows"][0]["incidents"] == {"human_contacts": 3}
