"""``run_episode``: how it ended, why, and how far it is while it runs."""

from __future__ import annotations

import itertools
import json
import re
import time
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from irsim.cli.app import app
from irsim.results.run import RunResult
from tests.episodes.test_between_steps import CONTACT, SWEPT
from tests.episodes.test_between_steps import scene as tunnel
from tests.mcp.conftest import CRASH, ERAS, LONG, ROOM, Caller, connected, data_of, error_of, text_of

pytestmark = [pytest.mark.one_python, pytest.mark.anyio]


async def test_success(client: Caller) -> None:
    data = await client.data("run_episode", scenario_yaml=ROOM, seed=3)
    assert (data["outcome"], data["seed"], data["time_limit_from"]) == ("success", 3, "default")
    assert "reason" not in data
    assert data["robots"] == [
        {"name": "rover", "outcome": "success", "collision_count": 0}
        | {key: data["robots"][0][key] for key in ("time_to_goal", "distance_to_goal")}
    ]
    assert [event["kind"] for event in data["events"]] == ["arrival"]


async def test_collision_names_both_the_place_and_the_step_to_look_at(client: Caller) -> None:
    result = await client.call("run_episode", scenario_yaml=CRASH, seed=3)
    data, text = data_of(result), text_of(result)
    hit = data["events"][0]
    assert data["outcome"] == "collision"
    assert (
        f"'rover' hit 'crate' at {hit['time']:.1f} s, contact near ({hit['x']:.2f}, {hit['y']:.2f})" in data["reason"]
    )
    assert (hit["kind"], hit["object"], hit["partner"]) == ("collision", "rover", "crate")
    assert f"render_snapshot run_id={data['run_id']} strip=6 step={hit['step']}" in data["next"]
    for said in (data["summary"], data["reason"], data["next"], "'rover' collision"):
        assert said in text
    assert "reproduce" not in data  # the command would need a file
    assert "'rover' collided" in await client.text(
        "render_snapshot", scenario_yaml=CRASH, seed=3, step=hit["step"], return_image=False
    )


async def test_events_of_robots_are_told_first_but_in_order(client: Caller) -> None:
    start = "kinematics: {name: omni}, shape: {name: circle, radius: 0.1}, behavior: {name: dash}"
    people = [f"  - {{{start}, state: [1, {y}, 0], goal: [{2 + y / 8}, {y}, 0]}}\n" for y in range(1, 12)]
    text = f"world: {{width: 10, height: 20}}\nrobot:\n  - {{{start}, name: r, state: [1, 15, 0], goal: [4, 15, 0]}}\n"
    events = (await client.data("run_episode", scenario_yaml=text + "obstacle:\n" + "".join(people)))["events"]
    assert len(events) == 10
    assert "r" in [event["object"] for event in events]
    assert [event["step"] for event in events] == sorted(event["step"] for event in events)
    assert events[0]["object"] != "r"


async def test_timeout_says_what_the_robot_was_doing(client: Caller) -> None:
    still = ROOM.replace("    behavior: {name: dash}\n", "")
    data = await client.data("run_episode", scenario_yaml=still, max_steps=20)
    assert (data["outcome"], data["steps"], data["time_limit_from"]) == ("timeout", 20, "argument")
    assert "'rover' has no behavior, so it stands still 3.61 m from its goal" in data["reason"]


async def test_the_same_seed_gives_the_same(client: Caller) -> None:
    random = ROOM.replace("    state: [1, 1, 0]\n    goal: [4, 3, 0]\n", "    distribution: {name: random}\n")
    first = await client.data("run_episode", scenario_yaml=random)
    again = await client.data("run_episode", scenario_yaml=random, seed=first["seed"])
    assert without_run(first) == without_run(again)


def without_run(data: dict[str, Any]) -> dict[str, Any]:
    """All data that does not name the record of the run."""
    return {key: value for key, value in data.items() if key not in ("run_id", "artifacts", "next")}


async def test_unsuccessful_robots_come_first_and_long_lists_are_cut(client: Caller) -> None:
    states = ", ".join(f"[2, {2 * i + 1}]" for i in range(14))
    goals = ", ".join(f"[{2.5 if i < 12 else 9}, {2 * i + 1}]" for i in range(14))
    many = (
        "world: {width: 40, height: 40, time_limit: 2}\nrobot:\n"
        "  - {number: 14, kinematics: {name: diff}, behavior: {name: dash}, shape: {name: circle, radius: 0.2},\n"
        f"     state: [{states}], goal: [{goals}]}}\n"
    )
    data = await client.data("run_episode", scenario_yaml=many)
    full = await client.data("run_episode", scenario_yaml=many, response_format="detailed")
    assert (data["robot_count"], len(data["robots"])) == (14, 10)
    assert [robot["outcome"] for robot in data["robots"]][:3] == ["timeout", "timeout", "success"]
    assert len(full["robots"]) == 14
    assert {"pose", "path_length"} <= set(full["robots"][0])
    assert (data["robots"][0]["min_clearance"], data["robots"][0]["nearest"]) == (1.6, "robot_11")


async def test_command_line_and_server_say_the_same(
    client: Caller, workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (workspace / "crash.yaml").write_text(CRASH, encoding="utf-8")
    run = await client.data("run_episode", scenario_path="crash.yaml", seed=5, response_format="detailed")
    report = await client.data("validate_scenario", scenario_path="crash.yaml")
    monkeypatch.chdir(workspace)
    said = json.loads(CliRunner().invoke(app, ["run", "crash.yaml", "--seed", "5", "--strict", "--json"]).stdout)
    checked = json.loads(CliRunner().invoke(app, ["validate", "crash.yaml", "--json"]).stdout)

    def rounded(value: object) -> object:
        if isinstance(value, float):
            return round(value, 3)
        if isinstance(value, list):
            return [rounded(item) for item in value]
        if isinstance(value, dict):
            empty = (("contacts_between_steps", 0), ("passed_through", []))
            return {key: rounded(v) for key, v in value.items() if v is not None and (key, v) not in empty}
        return value

    same = {"outcome", "reason", "summary", "seed", "steps", "sim_time", "time_limit", "time_limit_from", "robots"}
    same |= {"events", "event_count", "reproduce"}
    assert {key: run[key] for key in same} == {key: rounded(said[key]) for key in same}
    assert {key: report[key] for key in ("valid", "counts")} == {key: checked[key] for key in ("valid", "counts")}
    assert report["summary"].startswith(checked["summary"])  # and how many hints there are


@pytest.mark.parametrize("era", [ERAS[0], pytest.param(ERAS[1], marks=pytest.mark.slow)])
async def test_progress_increases_at_most_once_a_second(client: Caller) -> None:
    told: list[tuple[float, float, float]] = []

    async def on_progress(done: float, total: float | None, message: str | None) -> None:
        assert total is not None
        told.append((time.monotonic(), done, total))

    arguments = {"scenario_yaml": LONG, "max_wall_s": 4, "max_steps": 4000}
    result = await client.call_tool("run_episode", arguments, progress_callback=on_progress)
    assert "out-of-time" in error_of(result)
    assert len(told) >= 2
    assert len(told) <= 7
    assert all(total == 4000 for _, _, total in told)
    assert all(a[1] < b[1] and b[0] - a[0] > 0.9 for a, b in itertools.pairwise(told))


async def test_time_is_limited_and_the_error_says_what_fits(client: Caller) -> None:
    result = await client.call("run_episode", scenario_yaml=LONG, max_wall_s=2)
    assert error_of(result).startswith("out-of-time: 2 s of computing time were used up after ")
    assert "fewer steps" in error_of(result)


async def test_work_is_limited(empty: Path) -> None:
    async with connected(empty, work=100) as client:
        assert (await client.error("run_episode", scenario_yaml=ROOM, max_steps=101)).startswith(
            "over-limit: 101 steps are too many: at most 100 steps x objects"
        )
        data = await client.data("run_episode", scenario_yaml=ROOM, max_steps=100)
    assert data["outcome"] == "success"


async def test_a_longer_horizon_is_cut_and_said(client: Caller) -> None:
    slow = ROOM.replace("height: 6", "height: 6, step_time: 0.001, time_limit: 60") + "    vel_max: [0.1, 1]\n"
    data = await client.data("run_episode", scenario_yaml=slow)
    assert (data["steps"], data["time_limit_from"]) == (5000, "limits")
    assert "the maximum number of steps of one run here" in data["reason"]


async def test_memory_is_limited(empty: Path) -> None:
    huge = ROOM.replace("name: rover", "number: 100") + "    sensors: [{name: lidar2d, number: 1000000}]\n"
    async with connected(empty, memory=512 * 1024**2) as client:
        told = await client.error("run_episode", scenario_yaml=huge, max_steps=1)
    assert told.startswith("out-of-memory: ")
    assert "fewer objects, lidar beams or steps" in told


async def test_another_behavior_for_all_robots(client: Caller, workspace: Path) -> None:
    standing = ROOM.replace("    behavior: {name: dash}\n", "")
    plain = await client.call("run_episode", scenario_yaml=standing)
    driven = await client.call("run_episode", scenario_yaml=standing, behavior="dash")
    options = await client.call("run_episode", scenario_yaml=standing, behavior="{name: orca, timeHorizon: 3}")
    wrong = await client.call("run_episode", scenario_yaml=standing, behavior="dahs")
    last = {"run_id": data_of(driven)["run_id"], "step": -1, "return_image": False}
    picture = await client.call_tool("render_snapshot", last)
    assert data_of(plain)["outcome"] == "timeout"
    assert "policy=dash" in data_of(plain)["next"]
    assert "behavior" not in data_of(plain)
    assert (data_of(driven)["outcome"], data_of(driven)["behavior"]) == ("success", "dash")
    assert "with behavior dash for all robots" in text_of(driven)
    assert "'rover' arrived at (4.0" in text_of(picture)
    assert data_of(options)["outcome"] == "success"
    assert error_of(wrong) == "unknown-policy: there is no policy 'dahs' (policy). Fix: did you mean dash?"


async def test_no_seed_is_shown_where_it_decides_nothing(client: Caller, workspace: Path) -> None:
    first, second = [await client.call("run_episode", scenario_yaml=ROOM) for _ in range(2)]
    scenes = [
        await client.call("render_snapshot", scenario_yaml=scene, return_image=False)
        for scene in (ROOM, ROOM.replace("{name: diff}", "{name: diff, noise: true}"))
    ]
    assert data_of(first)["seed"] == data_of(second)["seed"] == 0
    for told in (text_of(first), text_of(scenes[0])):
        assert "nothing is random" in told
        assert "seed" not in told
    assert "seed" in text_of(scenes[1])


async def test_the_whole_result_on_request(empty: Path) -> None:
    async with connected(empty) as client:
        result = await client.call("run_episode", scenario_yaml=ROOM, response_format="json")
        whole = json.loads(text_of(result))
        assert RunResult.model_validate(whole).outcome == data_of(result)["outcome"] == "success"
    async with connected(empty, text=500) as client:
        result = await client.call("run_episode", scenario_yaml=ROOM, response_format="json")
        line = error_of(result)
        run = re.search(r"run_id=(\S+)", line)
        assert run is not None
        assert line.startswith("over-limit: the run is done, outcome success, but the whole result has ")
        assert f"irsim://runs/{run[1]}/result.json has all; or use response_format=detailed" in line
    async with connected(empty) as client:
        table = await client.data("inspect_run", run_id=run[1], view="speeds")
        assert len(table["rows"]) == 1


async def test_next_after_people_stand_since_a_collision_and_after_what_is_parked(client: Caller) -> None:
    people = ROOM + (
        "obstacle:\n  - {number: 2, distribution: {name: manual}, kinematics: {name: omni},"
        " shape: {name: circle, radius: 0.2}, state: [[4, 5, 0], [6, 5, 0]], goal: [[7, 5, 0], [3, 5, 0]],"
        " behavior: {name: dash}}\n"
    )
    parked = "world: {time_limit: 1}\nrobot:\n  - {name: watcher, shape: {name: circle}, state: [1, 5]}\n"
    jam = await client.data("run_episode", scenario_yaml=people)
    tried = await client.data("validate_scenario", scenario_yaml=people)
    still = await client.data("run_episode", scenario_yaml=parked)
    looked = await client.data("validate_scenario", scenario_yaml=parked)
    assert jam["outcome"] == "success"
    assert "2 of 2 moving obstacles were stopped by a collision" in jam["summary"]
    assert "view=collisions" in jam["next"]
    assert "2 of 2 moving obstacles were stopped by a collision" in tried["dry_run"]
    assert "when it was tried" in tried["next"]
    assert still["next"].startswith("Nothing to change")
    assert "tried" not in looked["next"]


POCKET = """
world: {{width: 10, height: 6, time_limit: 8}}
robot:
  - {{name: caught, state: [1, 3, 0], goal: [9, 3], kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.3}},
     behavior: {{name: orca, timeHorizon: 3}}, vel_max: [1, 1], vel_min: [-1, -1]}}
obstacle:
  - {{shape: {{name: linestring, vertices: [[6, 3.5], [0.5, 3.5], [0.5, 2.5], [6, 2.5]]}}, state: [0, 0, 0]}}
  - {{state: [8, 3, 0], goal: [{goal}, 3], kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.3}},
     behavior: {{name: dash}}, vel_max: [2, 2]}}
"""


@pytest.mark.parametrize(("goal", "said"), [(3, "but no contact"), (2, "and it touched something")])
async def test_steps_without_a_way_to_avoid_everybody_say_whether_that_mattered(
    client: Caller, goal: float, said: str
) -> None:
    assert re.search(
        rf"\d+ steps? without a collision-free velocity, {said}",
        await client.text("run_episode", scenario_yaml=POCKET.format(goal=goal), seed=0),
    )


async def test_a_success_that_passed_a_wall_is_told_and_not_trusted(client: Caller, workspace: Path) -> None:
    run = await client.call("run_episode", scenario_yaml=tunnel())
    data, text = data_of(run), text_of(run)
    table = await client.data("inspect_run", run_id=data["run_id"], view="collisions")
    many = await client.call("benchmark", scenarios=[tunnel()], seeds=1)
    tried = await client.call("validate_scenario", scenario_yaml=tunnel(), simulate=True)
    assert text.splitlines()[0].startswith("success: 'runner' passed through 'board' between two steps at 2.31 s")
    assert data["incidents"] == {"contacts_between_steps": 2}
    [runner] = data["robots"]
    assert (runner["contacts_between_steps"], runner["passed_through"]) == (2, ["board"])
    assert "2 contacts between steps (passed through 'board')" in text
    assert "passed_through of 'runner' with 'board'" in text
    assert [event["kind"] for event in data["events"]] == ["contact_between_steps", "passed_through", "arrival"]
    assert data["next"].startswith("Do not trust this success: a robot touched something between two steps; ")
    assert "world.contacts: swept" in data["next"]
    assert [row[table["columns"].index("kind")] for row in table["rows"]] == ["contact_between_steps", "passed_through"]
    assert "robots touched something between steps in 1 of 1 episodes (seed 0)" in text_of(many).splitlines()[0]
    assert data_of(many)["rows"][0]["incidents"] == {"contacts_between_steps": 1}
    assert "passed through 'board' between two steps" in text_of(tried)


async def test_a_wall_that_stops_the_robot_is_no_contact_between_steps(client: Caller) -> None:
    swept = await client.call("run_episode", scenario_yaml=SWEPT)
    pushed = await client.call("run_episode", scenario_yaml=CONTACT % 0.1)
    assert text_of(swept).startswith("collision: 'robot_0' hit 'obstacle_1' at 3.13 s, contact near (9.99")
    assert "incidents" not in data_of(swept)
    assert data_of(pushed)["outcome"] == "timeout"
    assert "passed through" not in text_of(pushed)


async def test_of_many_events_contacts_between_steps_are_listed(client: Caller, workspace: Path) -> None:
    others = "".join(
        f"\n  - {{kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.1}}, state: [{x}, 0.5], "
        f"goal: [{x}, 1], behavior: {{name: dash}}}}"
        for x in range(1, 12)
    )
    text = tunnel().replace("obstacle:", "obstacle:" + others)
    data = await client.data("run_episode", scenario_yaml=text)
    kinds = [event["kind"] for event in data["events"]]
    assert (len(kinds), data["event_count"]) == (10, 14)
    assert {"contact_between_steps", "passed_through"} <= set(kinds)
