"""Names that reach a reader of an answer are text: no mark changes the direction of what is read."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from irsim.common.text import escape_marks
from tests.mcp.conftest import connected

pytestmark = [pytest.mark.one_python, pytest.mark.anyio]

EVIL = "a\u202egnp\u2066\u0085=1+1"


def texts(answer: Any) -> str:
    return "".join(block.text for block in answer.content if hasattr(block, "text"))


async def test_no_answer_has_marks_of_direction(empty: Path) -> None:
    scene = (
        "world: {width: 6, height: 6}\n"
        f"robot: [{{name: {json.dumps(EVIL)}, kinematics: {{name: diff}}, state: [1, 1, 0], goal: [5, 5],\n"
        "  behavior: {name: dash}, shape: {name: circle, radius: 0.2}}]\n"
    )
    async with connected(empty) as client:
        for tool, arguments in (
            ("validate_scenario", {}),
            ("run_episode", {}),
            ("run_episode", {"response_format": "detailed"}),
            ("render_snapshot", {}),
        ):
            answer = await client.call_tool(tool, {"scenario_yaml": scene, **arguments})
            text = texts(answer)
            assert escape_marks(text) == text, (tool, text)
            assert "gnp" in text or tool == "validate_scenario", text
        wrong = await client.call_tool("run_episode", {"scenario_yaml": scene.replace("dash", EVIL)})
        assert escape_marks(texts(wrong)) == texts(wrong)
