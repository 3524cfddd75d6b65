"""``run_episode`` with ``seeds``: check, runs, diagnosis and a picture of the first failure in one answer."""

from __future__ import annotations

import base64
import json
import re
import statistics
from pathlib import Path

import pytest
from mcp.types import ImageContent

from irsim_mcp.limits import MAX_RUN_SEEDS
from tests.episodes.test_rounds import PATROL
from tests.mcp.conftest import CRASH, ROOM, Caller, connected, data_of, text_of

pytestmark = [pytest.mark.one_python, pytest.mark.anyio]

CROWD = """\
world: {width: 12, height: 6}
robot:
  - {name: r, state: [1, 3, 0], goal: [11, 3], kinematics: {name: diff}, behavior: {name: dash}}
obstacle:
  - {number: 2, shape: {name: circle, radius: 0.3},
     distribution: {name: random, range_low: [3, 1, -3], range_high: [9, 5, 3]}}
"""
"""Some seeds place a rock on the way, others do not."""


async def test_several_seeds_are_told_with_a_picture_of_the_first_that_failed(client: Caller) -> None:
    result = await client.call("run_episode", scenario_yaml=CROWD, seeds=6)
    data, text = data_of(result), text_of(result)
    outcomes = {episode["seed"]: episode["outcome"] for episode in data["episodes"]}
    assert list(outcomes) == list(range(6))
    failed = [seed for seed, outcome in outcomes.items() if outcome != "success"]
    assert 0 < len(failed) < 6, "the scene is meant to fail sometimes"
    assert text.startswith(f"{6 - len(failed)} of 6 episodes succeeded; failed: collision: seed")
    assert (data["seed"], data["outcome"]) == (failed[0], "collision")
    assert isinstance(picture := result.content[1], ImageContent)
    assert base64.b64decode(picture.data).startswith(b"\x89PNG")
    step = data["events"][-1]["step"]
    assert f"The first that failed, seed {failed[0]} (the picture shows step {step}):" in text
    assert f"'r' hit '{data['events'][-1]['partner']}'" in text
    assert f"inspect_run run_id={data['run_id']} view=collisions" in data["next"]
    assert "render_snapshot" not in data["next"], "the picture is there"
    alone = await client.data("run_episode", scenario_yaml=CROWD, seed=failed[0])
    assert "episodes" not in alone
    same = set(alone) - {"next", "run_id", "artifacts", "summary", "warnings"}
    assert {key: data[key] for key in same} == {key: alone[key] for key in same}
    assert data["summary"].endswith(alone["summary"])


async def test_episodes_that_succeed_are_told_in_a_few_lines(client: Caller) -> None:
    moved = CROWD.replace("[3, 1, -3]", "[3, 4.5, -3]")
    result = await client.call("run_episode", scenario_yaml=moved, seeds="4..6")
    text = text_of(result)
    assert text.startswith("3 of 3 episodes succeeded.\n- success: seed 4 at ")
    assert "Check: no warnings" in text
    assert "Next: If the picture is right, report it: nothing failed; for more: benchmark scenarios=['text-" in text
    again = await client.call("run_episode", scenario_yaml=moved, seeds="4..6")
    assert "Next: Report it: nothing failed; for more: benchmark scenarios=['text-" in text_of(again)
    assert [block.type for block in again.content] == ["text"]
    assert len(text_of(again)) < 400


async def test_one_call_says_all_of_a_new_scenario(workspace: Path) -> None:
    """Findings, every entry, the run, how near the bodies came, and a picture; what is known is not said again."""
    meeting = (
        ROOM
        + "  - {name: other, kinematics: {name: diff}, state: [7, 4.5, 3.14], goal: [1, 4.5], behavior: {name: dash}}\n"
    )
    async with connected(workspace) as client:
        first, second = [await client.call("run_episode", scenario_yaml=meeting, seeds=3) for _ in range(2)]
    assert [block.type for block in first.content] == ["text", "image"]
    assert [block.type for block in second.content] == ["text"]
    for said in ("Check: no warnings", "Objects:\n- diff, circle r 0.3, dash", "'rover' at (1.00, 1.00)",
                 "seed 0 (the picture shows step ", "'other' success, arrived at "):  # fmt: skip
        assert said in text_of(first)
    assert "Next: If the picture is right, report it: every run is this one." in text_of(first)
    assert "Objects:" not in text_of(second)
    assert "Next: Report it: every run is this one." in text_of(second)


async def test_how_near_bodies_came_is_said_once(client: Caller) -> None:
    wall = "obstacle:\n  - {number: 2, shape: {name: rectangle, length: 6, width: 0.1}, "
    walls = wall + "state: [[4, 2.6, 0], [4, 0.6, 0]]}\n"
    meeting = ROOM.replace("goal: [4, 3, 0]", "goal: [7, 1, 0]").replace("state: [1, 1, 0]", "state: [1, 2.2, 0]")
    meeting = meeting.replace("goal: [7, 1, 0]", "goal: [7, 2.2, 0]") + (
        "  - {name: other, kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [7, 1, 3.14],\n"
        "     goal: [1, 1], behavior: {name: dash}}\n"
    )
    told = await client.text("run_episode", scenario_yaml=meeting + walls, seeds=1)
    line = next(line for line in told.splitlines() if line.startswith("Closest to one another: "))
    assert float(line.split()[-5]) == pytest.approx(1.2 - 0.6, abs=0.02)
    assert "Closest to one another" not in await client.text("run_episode", scenario_yaml=CRASH, seeds=1)


async def test_where_nothing_is_random_one_run_stands_for_all(client: Caller) -> None:
    result = await client.call("run_episode", scenario_yaml=CRASH, seeds=[3, 4, 5])
    text, data = text_of(result), data_of(result)
    assert text.startswith("collision; nothing is random, so every seed gives this run (perturb varies its start).\n")
    assert len(data["episodes"]) == 1
    assert "Warning: dash-into-obstacle at robot[0].goal: 'rover' dashes straight" in text
    assert "it collided when tried" in text
    varied = await client.data("run_episode", scenario_yaml=CRASH, seeds=2, perturb="position=0.05")
    assert len(varied["episodes"]) == 2


async def test_seeds_are_bounded_and_wrong_ones_refused(client: Caller) -> None:
    assert "benchmark runs up to 100" in await client.error("run_episode", scenario_yaml=ROOM, seeds=MAX_RUN_SEEDS + 1)
    assert "one of them" in await client.error("run_episode", scenario_yaml=ROOM, seeds=2, seed=3)
    for wrong in ("x", [], [-1], 0):
        assert (await client.error("run_episode", scenario_yaml=ROOM, seeds=wrong)).startswith("bad-argument: ")
    assert "an integer or text or a" in await client.error("run_episode", scenario_yaml=ROOM, seeds=True)


async def test_the_whole_result_is_a_list_of_the_results_of_single_runs(client: Caller) -> None:
    told = json.loads(await client.text("run_episode", scenario_yaml=CROWD, seeds=2, response_format="json"))
    single = json.loads(await client.text("run_episode", scenario_yaml=CROWD, seed=0, response_format="json"))
    assert set(told["episodes"][0]) == set(single)
    assert [one["seed"] for one in told["episodes"]] == [0, 1]


async def test_counts_of_episodes_end_at_their_total(client: Caller) -> None:
    told: list[tuple[float, float | None]] = []

    async def on_progress(done: float, total: float | None, message: str | None) -> None:
        told.append((done, total))

    await client.call_tool("run_episode", {"scenario_yaml": CROWD, "seeds": 4}, progress_callback=on_progress)
    assert told[-1] == (4, 4)
    await client.call_tool("run_episode", {"scenario_yaml": ROOM}, progress_callback=on_progress)
    assert told[-1][0] == told[-1][1]


async def test_a_patrol_is_offered_to_go_on_and_does(client: Caller) -> None:
    data = await client.data("run_episode", scenario_yaml=PATROL)
    assert data["robots"][0]["laps"] == 1
    assert "to see it patrol on, run_episode scenario_path=text-" in data["next"]
    on = await client.data("run_episode", scenario_yaml=PATROL, until="time_limit")
    assert on["robots"][0]["laps"] > 1
    assert "until" not in on["next"]


async def test_a_world_without_robots_is_not_told_to_be_run_again(client: Caller) -> None:
    empty = "world: {width: 5, height: 5, time_limit: 1}\n"
    for arguments in ({}, {"seeds": 2}):
        advice = (await client.data("run_episode", scenario_yaml=empty, **arguments))["next"]
        assert advice.startswith("Nothing to run for: there are no robots")


@pytest.mark.slow
async def test_the_median_answer_is_short(client: Caller) -> None:
    """Of all templates, of one episode and of three: all cut short, so that each has a failure to explain."""
    for seeds in ({}, {"seeds": 3}):
        sizes = []
        for file in sorted((Path(__file__).parents[2] / "templates").glob("*/scenario.yaml")):
            text = file.read_text(encoding="utf-8")
            result = await client.call("run_episode", scenario_yaml=text, max_steps=60, **seeds)
            sizes.append(len(text_of(result).encode()))
        assert len(sizes) > 40
        assert statistics.median(sizes) <= 1_750, (seeds, sorted(sizes))


async def test_an_edit_is_run_and_compared_with_its_base_in_one_call(client: Caller) -> None:
    told = await client.text("run_episode", scenario_yaml=ROOM.replace("0.3}", "0.4}"), base=ROOM)
    assert "Changes: 1 key differs: robot[0].shape.radius" in told
    assert "- changed robot[0].shape.radius: 0.3 -> 0.4" in told
    assert "Next: If the picture is right, report it: every run is this one." in told
    free = CRASH.replace("state: [4, 1, 0]", "state: [4, 4, 0]")
    told = await client.text("run_episode", scenario_yaml=CRASH, base=free, seeds=1)
    assert "Next: The edit causes a collision ('rover' hits 'crate' at " in told
    assert "not forbidden other changes" in told
    blocked = ROOM + "obstacle: [{state: [1.4, 1], shape: {name: circle, radius: 0.2}}]\n"
    told = await client.text("run_episode", scenario_yaml=blocked.replace("[4, 3, 0]", "[4, 4, 0]"), base=blocked)
    assert re.search("Warning: initial-overlap at .* deep \\(also in base\\)", told)
    assert "(also in base)" not in await client.text("run_episode", scenario_yaml=blocked, base=ROOM)
    told = await client.text("run_episode", scenario_yaml=ROOM, base="no: {such")
    assert "the worlds are not compared: one of the scenarios is invalid" in told
