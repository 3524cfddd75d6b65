"""The answer to ``tools/list``: ``python tests/mcp/golden/write.py`` writes the golden file again."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import anyio
from mcp import Client

from irsim_mcp.server import build_server

FILE = Path(__file__).with_name("tools_list.json")


def listed(tools: list[Any]) -> list[dict[str, Any]]:
    """Tools as they are on the wire."""
    return [tool.model_dump(mode="json", by_alias=True, exclude_none=True) for tool in tools]


async def current() -> list[dict[str, Any]]:
    """The tools of the server as it is now."""
    async with Client(build_server(Path())) as client:
        return listed((await client.list_tools()).tools)


if __name__ == "__main__":
    FILE.write_text(json.dumps(anyio.run(current), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
