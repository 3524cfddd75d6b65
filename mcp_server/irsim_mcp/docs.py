"""Documentation as resources: ``irsim://docs/{topic}``, at most 1 MB per read. The tools work without it."""

from __future__ import annotations

import functools
from pathlib import Path

from mcp.server import MCPServer
from mcp.server.mcpserver.exceptions import ResourceNotFoundError
from mcp.server.mcpserver.resources import FunctionResource

from irsim.common import data_files as resources
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import nearest

__all__ = ["DOC", "add_docs", "topics"]

DOC = "irsim://docs/{topic}{?offset,limit}"
_MAX_BYTES = 1_000_000
_README = "readme"


def topics() -> list[str]:
    """Names of the pages: ``readme``, and the references of the skills by file name."""
    return sorted((_README, *_pages()))


def add_docs(server: MCPServer) -> None:
    """Register the resource template and each page with a server."""
    description = "A page of the documentation as Markdown. At most 1 MB per read: offset and limit select characters."
    server.resource(DOC, name="docs", title="Documentation", description=description, mime_type="text/markdown")(page)
    for topic in topics():
        server.add_resource(
            FunctionResource.from_function(
                functools.partial(page, topic),
                uri=f"irsim://docs/{topic}",
                name=f"docs-{topic}",
                title=f"Documentation: {topic}",
                description="?offset=…&limit=… selects a part, counted in characters.",
                mime_type="text/markdown",
            )
        )


def page(topic: str, offset: int = 0, limit: int = _MAX_BYTES) -> str:
    """A page of the documentation, or a part of it."""
    if offset < 0 or limit < 1:
        raise ResourceNotFoundError("bad-argument: offset must be at least 0, limit at least 1 (both in characters).")
    part = _text(topic)[offset : offset + min(limit, _MAX_BYTES)]
    return part.encode()[:_MAX_BYTES].decode(errors="ignore")


def _text(topic: str) -> str:
    if topic == _README:
        root = resources.checkout()
        if root is not None:
            return (root / "README.md").read_text(encoding="utf-8")
        from importlib.metadata import metadata

        return str(metadata("irsim-mcp").get_payload())  # type: ignore[attr-defined]
    pages = _pages()
    if topic not in pages:
        near = nearest(topic, topics())
        fix = f"Did you mean {near}?" if near else f"The pages are {', '.join(topics())}."
        raise ResourceNotFoundError(f"unknown-topic: there is no page {clean(topic)!r}. {fix}")
    return pages[topic].read_text(encoding="utf-8")


def _pages() -> dict[str, Path]:
    """Files of the pages by name; of two pages with the same name, the second has its skill as prefix."""
    found: dict[str, Path] = {}
    for path in sorted(resources.skills_directory().glob("*/references/*.md")):
        name = path.stem if path.stem not in found else f"{path.parents[1].name}-{path.stem}"
        found[name] = path
    return found
