"""Reference of the MCP server: what it lists of tools, prompts and resources."""

from __future__ import annotations

import inspect
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import anyio
from mcp import Client
from pages import Page, anchor, cell

from irsim.lookup.answer import plain_table
from irsim_mcp.server import build_server

__all__ = ["listed", "tool_pages"]

PAGE = "reference/tools"


def listed(*, writing: bool = True) -> dict[str, list[Any]]:
    """Lists of the server: ``tools``, ``prompts``, ``resources`` and ``templates``."""

    async def ask() -> dict[str, list[Any]]:
        with tempfile.TemporaryDirectory() as folder:
            async with Client(build_server(Path(folder), writing=writing)) as client:
                return {
                    "tools": (await client.list_tools()).tools,
                    "prompts": (await client.list_prompts()).prompts,
                    "resources": (await client.list_resources()).resources,
                    "templates": (await client.list_resource_templates()).resource_templates,
                }

    return anyio.run(ask)


def tool_pages() -> Iterator[Page]:
    """One page: tools with their arguments, prompts, resources."""
    answers, always = listed(), {tool.name for tool in listed(writing=False)["tools"]}
    parts = [
        "# MCP tools",
        "The server `irsim-mcp` lists these tools, prompts and resources; a host shows the same to its model.",
        "## Tools",
    ]
    parts += [_tool(tool, tool.name in always) for tool in answers["tools"]]
    prompts = []
    for prompt in answers["prompts"]:
        takes = ", ".join(f"`{one.name}`{'' if one.required else ' (optional)'}" for one in prompt.arguments or ())
        prompts.append((f"{anchor(prompt.name)}`{prompt.name}`", cell(prompt.description or ""), takes))
    parts.append("## Prompts\n\n" + plain_table(("prompt", "what it is for", "arguments"), prompts))
    patterns = [(f"`{one.uri_template}`", cell(one.description or "")) for one in answers["templates"]]
    parts.append("## Resources\n\n" + plain_table(("address", "what it is"), patterns))
    singles = [(f"`{one.uri}`", cell(one.title or one.name)) for one in answers["resources"]]
    parts.append("### Addresses\n\n" + plain_table(("address", "title"), singles))
    text = "\n\n".join(parts)
    yield Page(PAGE, text, text, "MCP tools", "Tools, prompts and resources of the server `irsim-mcp`.")


def _tool(tool: Any, is_always: bool) -> str:
    hints = tool.annotations
    marks = [
        word
        for word, has in (
            ("reads only", hints and hints.read_only_hint),
            ("may be repeated without effect", hints and hints.idempotent_hint),
            ("there with `--enable-write`", not is_always),
        )
        if has
    ]
    schema = tool.input_schema
    parts = [
        f"### {tool.name}",
        anchor(f"tool-{tool.name}"),
        f"*{tool.title}*" + (f": {', '.join(marks)}." if marks else ""),
    ]
    parts.append(cell(inspect.cleandoc(tool.description or "")))
    rows = []
    for name, one in schema.get("properties", {}).items():
        default = f"`{one['default']}`" if one.get("default") not in (None, "", []) else ""
        default = "required" if name in schema.get("required", ()) else default
        rows.append((f"{anchor(f'{tool.name}.{name}')}`{name}`", _type(one), cell(one.get("description", "")), default))
    return "\n\n".join([*parts, plain_table(("argument", "type", "meaning", "default"), rows)])


def _type(node: dict[str, Any]) -> str:
    if "enum" in node:
        return ", ".join(f"`{value}`" for value in node["enum"])
    if "anyOf" in node:
        return " or ".join(_type(one) for one in node["anyOf"] if one.get("type") != "null")
    if node.get("type") == "array":
        return f"list of {_type(node.get('items', {}))}"
    return str(node.get("const") or node.get("type") or "any value")
