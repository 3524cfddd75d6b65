"""Next steps that answers advise: never a step that was just done, a file that is gone, or a run without robots."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.mcp.conftest import CRASH, ROOM, Caller, connected

pytestmark = [pytest.mark.one_python, pytest.mark.anyio]

EMPTY = "world: {width: 5, height: 5, time_limit: 1}\n"


def last(text: str) -> str:
    return text.splitlines()[-1]


async def test_what_was_done_with_a_file_as_it_is_is_not_advised_again(workspace: Path) -> None:
    file = workspace / "room.yaml"
    noisy = ROOM.replace("{name: diff}", "{name: diff, noise: true}")  # so that a trial does not say all
    file.write_text(noisy, encoding="utf-8")
    given = {"scenario_path": "room.yaml"}
    async with connected(workspace) as client:
        checked = last(await client.text("validate_scenario", **given))
        assert checked == "Next: run_episode scenario_path=room.yaml seeds=3."
        seen = last(await client.text("render_snapshot", **given, return_image=False))
        assert "run_episode scenario_path=room.yaml seeds=3" in seen
        await client.data("run_episode", **given)
        seen = last(await client.text("render_snapshot", **given, return_image=False))
        assert "run_episode" not in seen
        file.write_text(noisy + "# changed\n", encoding="utf-8")
        seen = last(await client.text("render_snapshot", **given, return_image=False))
        assert "run_episode scenario_path=room.yaml" in seen
        file.write_text(EMPTY, encoding="utf-8")
        assert "render_snapshot" in last(await client.text("validate_scenario", **given))
        await client.call("render_snapshot", **given, return_image=False)
        assert "nothing is left to do" in last(await client.text("validate_scenario", **given)).lower()


async def test_a_trial_that_says_all_needs_no_run(workspace: Path) -> None:
    async with connected(workspace) as client:
        assert "report it" in last(await client.text("render_snapshot", scenario_yaml=ROOM, return_image=False))
        for text in (CRASH, ROOM.replace("{name: diff}", "{name: diff, noise: true}")):
            assert "run_episode" in last(await client.text("render_snapshot", scenario_yaml=text, return_image=False))


async def test_a_world_without_robots_is_not_to_be_run(client: Caller) -> None:
    for tool in ("validate_scenario", "render_snapshot"):
        advice = last(await client.text(tool, scenario_yaml=EMPTY))
        assert "run_episode" not in advice
        assert "no robots" in advice or "without robots" in advice


async def test_a_file_that_is_gone_is_not_named_as_the_next_scenario(workspace: Path) -> None:
    file = workspace / "still.yaml"
    file.write_text(ROOM.replace("    behavior: {name: dash}\n", ""), encoding="utf-8")
    async with connected(workspace) as client:
        done = await client.data("benchmark", scenarios=["still.yaml"], seeds=1, max_steps=5)
        assert "run_episode scenario_path='still.yaml'" in done["next"]
        file.unlink()
        again = await client.data("get_job", job_id=done["job_id"])
        assert "scenario_path" not in again["next"]
        assert "still.yaml" in again["next"]
        table = await client.text("inspect_run", run_id=done["job_id"])
        assert "scenario_path" not in last(table)
