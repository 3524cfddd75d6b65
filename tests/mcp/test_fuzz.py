"""Any arguments that a schema allows, and some it does not: one clear line or a result of the promised form."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import anyio
import jsonschema
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.effort import examples
from tests.mcp.conftest import CRASH, ROOM, connected, error_of, text_of
from tests.mcp.golden.write import FILE

pytestmark = pytest.mark.one_python

TOOLS = {tool["name"]: tool for tool in json.loads(FILE.read_text(encoding="utf-8"))}
MOST_TEXT = 24_500
OPTIONS = {"deadline": None, "derandomize": True, "suppress_health_check": [*HealthCheck]}

words = st.sampled_from(
    [
        ROOM,
        CRASH,
        "room.yaml",
        "../x.yaml",
        "a.yaml",
        "world: {",
        "robot: 3\n",
        "\n",
        "orca",
        "crossing",
        "last",
        "\x00",
    ]
)
junk = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(max_size=9),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=4), inner, max_size=3),
    max_leaves=6,
)


def values(part: dict[str, Any]) -> st.SearchStrategy[Any]:
    """Values that a part of a schema allows."""
    if "anyOf" in part:
        return st.one_of([values(option) for option in part["anyOf"]])
    if "enum" in part:
        return st.sampled_from(part["enum"])
    kind = part.get("type")
    low, high = part.get("minimum", -5), part.get("maximum", 60)
    if kind == "integer":
        return st.integers(low, min(high, low + 5)) | st.integers(low, high)
    if kind == "number":
        return st.floats(low, high)
    if kind == "array":
        least = part.get("minItems", 0)
        return st.lists(values(part["items"]), min_size=least, max_size=max(least, min(part.get("maxItems", 3), 3)))
    if kind == "boolean":
        return st.booleans()
    return words | st.text(max_size=min(part.get("maxLength", 20), 20)) if kind == "string" else junk


def calls(tool: dict[str, Any]) -> st.SearchStrategy[dict[str, Any]]:
    """Arguments as the schema has them, at times with one of another kind or one too many."""
    schema = tool["inputSchema"]
    required = {name: values(schema["properties"][name]) for name in schema.get("required", ())}
    others = {name: values(part) for name, part in schema["properties"].items() if name not in required}
    for name in ("wait_s", "max_wall_s"):  # no test waits for long
        if name in others:
            others[name] = st.integers(1, 3)
    sound = st.fixed_dictionaries(required, optional=others)
    odd = st.dictionaries(st.sampled_from([*schema["properties"], "speed", ""]) | st.text(max_size=5), junk, max_size=2)
    return sound | sound | st.tuples(sound, odd).map(lambda pair: pair[0] | pair[1])


def check(workspace: Path, name: str, arguments: dict[str, Any]) -> None:
    """Call it, look at the answer."""

    async def call() -> Any:
        async with connected(workspace) as client:
            return await client.call_tool(name, arguments)

    result = anyio.run(call)
    assert len(text_of(result)) <= MOST_TEXT
    if result.is_error:
        told = error_of(result)
        assert not told.startswith(("internal-error", "worker-failed")), told
        return
    assert set(arguments) <= set(TOOLS[name]["inputSchema"]["properties"])
    if result.structured_content is not None:
        jsonschema.validate(result.structured_content, TOOLS[name]["outputSchema"])


@pytest.fixture(scope="module")
def workspace_of_all(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fuzzed")
    (folder / "room.yaml").write_text(ROOM)
    return folder


@pytest.mark.parametrize("name", TOOLS)
def test_some_arguments(workspace_of_all: Path, name: str) -> None:
    settings(max_examples=6, **OPTIONS)(given(calls(TOOLS[name]))(lambda found: check(workspace_of_all, name, found)))()


@pytest.mark.slow
@pytest.mark.parametrize("name", TOOLS)
def test_many_arguments(workspace_of_all: Path, name: str) -> None:
    settings(max_examples=examples(100), **OPTIONS)(
        given(calls(TOOLS[name]))(lambda found: check(workspace_of_all, name, found))
    )()
