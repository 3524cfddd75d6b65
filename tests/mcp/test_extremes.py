"""Each number that a tool takes, at its extremes: a result, or one line with a code."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.fuzz.extremes import EXTREMES
from tests.mcp.conftest import ROOM, connected, error_of, text_of
from tests.mcp.golden.write import FILE

pytestmark = pytest.mark.one_python
TOOLS = {tool["name"]: tool["inputSchema"]["properties"] for tool in json.loads(FILE.read_text(encoding="utf-8"))}
VALUES = [*(value for value in EXTREMES if math.isfinite(value)), 2, 10**4300 - 1, -(10**4299), 1.5]
"""The last integers have as many digits as Python reads: one more cannot be written."""
MOST_TEXT = 24_500
SCENE = {"scenario_path": "room.yaml"}
NEEDED: dict[str, dict[str, Any]] = {
    "lookup": {"topic": "crossing"},
    "validate_scenario": SCENE,
    "render_snapshot": SCENE,
    "run_episode": {**SCENE, "max_steps": 3},
    "inspect_run": {"run_id": "last"},
    "benchmark": {"scenarios": ["room.yaml", "other.yaml"], "seeds": 2, "max_steps": 3},
    "get_job": {"job_id": "last"},
}


def numbers(part: dict[str, Any]) -> Iterator[Any]:
    """Functions from a number to the value of an argument, for each place of a number in it."""
    options = part.get("anyOf", [part])
    for option in options:
        if option.get("type") in ("integer", "number"):
            yield lambda value: value
        elif option.get("type") == "array" and option["items"].get("type") in ("integer", "number"):
            rest = list(range(1, option.get("minItems", 1)))
            yield lambda value, rest=rest: [value, *rest]
        elif option.get("type") == "object" and "additionalProperties" in option:
            yield lambda value: {"beams": value}


def calls() -> list[tuple[str, dict[str, Any]]]:
    """All calls: each number of each tool at each extreme."""
    return [
        (tool, {**NEEDED[tool], name: value_of(value)})
        for tool, arguments in TOOLS.items()
        for name, part in arguments.items()
        for value_of in numbers(part)
        for value in VALUES
    ]


async def check(workspace: Path, part: int, parts: int) -> None:
    """Make one of so many parts of the calls."""
    for name in NEEDED["benchmark"]["scenarios"]:
        (workspace / name).write_text(ROOM)
    async with connected(workspace) as client:
        assert not (await client.call_tool("run_episode", NEEDED["run_episode"])).is_error
        for name, arguments in calls()[part::parts]:
            result = await client.call_tool(name, arguments)
            assert len(text_of(result)) <= MOST_TEXT, (name, arguments)
            if result.is_error:
                assert not error_of(result).startswith(("internal-error", "worker-failed")), (name, arguments)


def test_every_number_of_every_tool_is_among_the_calls() -> None:
    assert {"lookup", "render_snapshot", "run_episode", "inspect_run", "benchmark"} <= {name for name, _ in calls()}
    assert len(calls()) > 300


@pytest.mark.anyio
@pytest.mark.parametrize("name", ["seeds", "first_seed"])
@pytest.mark.parametrize("scenario", ["room.yaml", "navigation"])
async def test_numbers_that_are_too_long_in_sum(workspace: Path, name: str, scenario: str) -> None:
    (workspace / "room.yaml").write_text(ROOM)
    arguments = {"scenarios": [scenario], "policies": ["dash", "rvo"], "seeds": 2, name: VALUES[-3]}
    async with connected(workspace) as client:
        assert (await client.error("benchmark", **arguments)).startswith(("bad-argument", "over-limit"))


@pytest.mark.anyio
async def test_some_extremes(workspace: Path) -> None:
    await check(workspace, 5, 40)


@pytest.mark.slow(10)
@pytest.mark.rotates(10)
@pytest.mark.anyio
@pytest.mark.parametrize("part", range(10))
async def test_all_extremes(workspace: Path, part: int) -> None:
    await check(workspace, part, 10)
