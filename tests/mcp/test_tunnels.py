"""A fast robot and a thin wall through the server: no tool calls a passage an untroubled success."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.api.test_tunnels import CONTACT, CURE, STOP, SWEPT, TOLD
from tests.mcp.conftest import Caller, data_of, text_of

pytestmark = pytest.mark.anyio


async def test_a_wall_that_was_passed(client: Caller, workspace: Path) -> None:
    run = await client.call("run_episode", scenario_yaml=STOP)
    data = data_of(run)
    looked = await client.data("inspect_run", run_id=data["run_id"], view="collisions")
    assert text_of(run).splitlines()[0] == f"success: {TOLD} {CURE}; the robot arrived at 8.4 s"
    assert data["next"].startswith("Do not trust this success")
    assert looked["summary"].startswith(TOLD)


async def test_a_wall_that_stopped_the_robot(client: Caller, workspace: Path) -> None:
    swept = await client.call("run_episode", scenario_yaml=SWEPT)
    pushed = await client.call("run_episode", scenario_yaml=CONTACT % 0.1)
    assert text_of(swept).startswith(
        "collision: the robot collided; 'robot_0' hit 'obstacle_1' at 3.13 s near (9.99, 5.00)"
    )
    assert "incidents" not in data_of(swept)
    assert data_of(pushed)["outcome"] == "timeout"
    assert "passed through" not in text_of(pushed)
