"""The list of tools: what every host puts before its model, so it is small, complete and the same every time."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

from tests.mcp.conftest import ERAS, Caller
from tests.mcp.golden.write import FILE, listed

pytestmark = pytest.mark.anyio

NAMES = ["lookup", "validate_scenario", "render_snapshot", "run_episode", "inspect_run", "benchmark", "get_job"]
MOST_BYTES = 13_800


@pytest.mark.parametrize("era", ERAS)
async def test_golden(client: Caller) -> None:
    tools = listed((await client.list_tools()).tools)
    golden = json.loads(FILE.read_text(encoding="utf-8"))
    assert tools == golden, "python tests/mcp/golden/write.py writes the golden file again"
    assert [list(tool["inputSchema"]["properties"]) for tool in tools] == [
        list(tool["inputSchema"]["properties"]) for tool in golden
    ]


def test_size() -> None:
    tools = json.loads(FILE.read_text(encoding="utf-8"))
    size = len(json.dumps(tools, separators=(",", ":"), ensure_ascii=False).encode())
    assert size <= MOST_BYTES


def test_every_tool_is_complete() -> None:
    tools = json.loads(FILE.read_text(encoding="utf-8"))
    assert [tool["name"] for tool in tools] == NAMES
    for tool in tools:
        assert set(tool["annotations"]) == {"readOnlyHint", "destructiveHint", "idempotentHint", "openWorldHint"}
        assert tool["title"]
        assert tool["description"].count(". ") >= 3
        assert "Next: " in tool["description"]
        assert tool["inputSchema"]["additionalProperties"] is False
        jsonschema.Draft202012Validator.check_schema(tool["inputSchema"])


def test_data_tools_have_output_schemas_and_the_others_none() -> None:
    tools = {tool["name"]: tool for tool in json.loads(FILE.read_text(encoding="utf-8"))}
    with_schema = [name for name, tool in tools.items() if "outputSchema" in tool]
    assert with_schema == ["validate_scenario", "run_episode", "inspect_run", "benchmark", "get_job"]
    for name in with_schema:
        schema = tools[name]["outputSchema"]
        open_ended = name == "inspect_run"  # all of `irsim inspect --json`, the schema names what matters
        assert (schema["type"], schema.get("additionalProperties", True)) == ("object", open_ended)
        assert {"summary", "next"} <= set(schema["required"])
        jsonschema.Draft202012Validator.check_schema(schema)


async def test_instructions_tell_the_order_and_the_workspace(client: Caller, empty: Path) -> None:
    told = client.instructions
    assert told is not None
    assert str(empty) in told
    assert [told.index(name) for name in NAMES] == sorted(told.index(name) for name in NAMES)


async def test_the_server_says_who_it_is_in_few_words(client: Caller) -> None:
    info = client.server_info
    assert info is not None
    assert info.name == "irsim"
    assert info.version
    assert info.icons is None
