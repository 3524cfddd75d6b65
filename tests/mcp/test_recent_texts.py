"""The short id of a scenario text, which later calls take instead of the text."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from irsim_mcp.services import RecentTexts
from tests.mcp.conftest import CRASH, ROOM, Caller

pytestmark = pytest.mark.anyio


async def test_a_text_is_sent_once(client: Caller, workspace: Path) -> None:
    looked = await client.text("render_snapshot", scenario_yaml=ROOM, return_image=False)
    [name] = set(re.findall(r"scenario_path=(text-[0-9a-f]{6})", looked))
    checked = await client.data("validate_scenario", scenario_yaml=ROOM)
    assert name in checked["next"]
    ran = await client.data("run_episode", scenario_path=name, seed=3)
    same = await client.data("run_episode", scenario_yaml=ROOM, seed=3)
    assert (ran["outcome"], ran["steps"]) == (same["outcome"], same["steps"]) == ("success", ran["steps"])
    compared = await client.data("benchmark", scenarios=[name], seeds=1)
    assert compared["rows"][0]["success"] == [1.0]
    assert (await client.data("validate_scenario", scenario_yaml=CRASH, base=name, simulate=False))["changes"]


async def test_next_names_the_id_of_a_text_and_never_the_text(client: Caller, workspace: Path) -> None:
    drawn = "robot: {distribution: {name: random}, kinematics: {name: omni}, shape: {name: circle, radius: 0.2}"
    for text, arguments, said in (
        (drawn + ", behavior: {name: dash}}\n", {}, "run_episode scenario_path={} seeds=20"),
        (drawn + "}\n", {"max_steps": 5}, "run_episode scenario_path={} policy=dash."),
    ):
        ran = await client.data("run_episode", scenario_yaml=text, **arguments)
        assert said.format(RecentTexts().remember(text)) in ran["next"]
        assert "distribution" not in ran["next"]


@pytest.mark.parametrize("more", ["", "vel_max: [1, 1]\n    plot: {show_goal: true}\n"])
async def test_a_look_at_a_text_without_a_behavior_names_its_id(client: Caller, workspace: Path, more: str) -> None:
    still = ROOM.replace("behavior: {name: dash}\n", more)
    looked = await client.text("render_snapshot", scenario_yaml=still, return_image=False)
    name = RecentTexts().remember(still)
    advice = looked.splitlines()[-1]
    assert f"run_episode scenario_path={name} policy=dash, " in advice
    assert f"benchmark scenarios=['{name}'] policies=[...]" in advice
    assert (await client.data("run_episode", scenario_path=name, policy="dash"))["outcome"] == "success"


async def test_the_id_of_a_run_where_a_scenario_is_meant_leads_to_the_scenario(client: Caller, workspace: Path) -> None:
    (workspace / "room.yaml").write_text(ROOM)
    for arguments, name in (
        ({"scenario_yaml": ROOM}, RecentTexts().remember(ROOM)),
        ({"scenario_path": "room.yaml"}, "room.yaml"),
    ):
        run = (await client.data("run_episode", **arguments))["run_id"]
        for tool, wrong, right in (
            ("run_episode", {"scenario_path": run}, f"give scenario_path={name}"),
            ("render_snapshot", {"scenario_path": run}, f"give scenario_path={name}"),
            ("benchmark", {"scenarios": [run]}, f"give scenarios=['{name}']"),
            ("validate_scenario", {"scenario_yaml": CRASH, "base": run}, f"give base={name}"),
        ):
            told = await client.error(tool, **wrong)
            assert told.startswith(f"file-not-found: there is no file '{run}': that is a run id (")
            assert told.endswith(f"Fix: {right}, which gives the scenario of that run.")
    (workspace / "room.yaml").unlink()  # the run still has its text
    told = await client.error("run_episode", scenario_path=run)
    text = re.findall(r"text-[0-9a-f]{6}", told)[0]
    assert (await client.data("run_episode", scenario_path=text))["outcome"] == "success"


async def test_an_unknown_id_says_what_to_do(client: Caller, workspace: Path) -> None:
    for tool, arguments in (
        ("run_episode", {"scenario_path": "text-000000"}),
        ("benchmark", {"scenarios": ["text-000000"]}),
    ):
        told = await client.error(tool, **arguments)
        assert told.startswith("file-not-found: no text with the id 'text-000000' is kept")
        assert told.endswith("Fix: give the text again, as scenario_yaml.")


def test_texts_used_least_recently_are_forgotten() -> None:
    texts = RecentTexts()
    first, second = texts.remember("a: 0\n"), texts.remember("b: 0\n")
    for number in range(62):
        texts.remember(f"c: {number}\n")
        assert texts.find(first) == "a: 0\n"
    texts.remember("d: 0\n")
    assert texts.find(first) == "a: 0\n"
    assert texts.find(second) is None


def test_long_texts_leave_room_for_few() -> None:
    texts = RecentTexts()
    names = [texts.remember(str(number) * 2**21) for number in range(3)]
    assert [texts.find(name) is not None for name in names] == [False, True, True]
