"""A fast robot and a thin wall through the server: no tool calls a passage an untroubled success."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.api.test_tunnels import CURE, STOP, TOLD
from tests.mcp.conftest import connected, data_of, text_of

pytestmark = pytest.mark.anyio


async def test_a_wall_that_was_passed(workspace: Path) -> None:
    async with connected(workspace) as client:
        run = await client.call_tool("run_episode", {"scenario_yaml": STOP})
        data = data_of(run)
        looked = data_of(await client.call_tool("inspect_run", {"run_id": data["run_id"], "view": "collisions"}))
    assert text_of(run).splitlines()[0] == f"success: {TOLD} {CURE}; the robot arrived at 8.4 s"
    assert data["next"].startswith("Do not trust this success")
    assert looked["summary"].startswith(TOLD)
