"""The Markdown beside the pages is what the MCP server says; ``llms.txt`` lists it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from mcp import Client

from irsim.benchmarks.suite import SUITES
from irsim.bundled import templates
from irsim.diagnostics.codes import CODES, TOOL_CODES
from irsim.options.registry import REGISTRIES
from irsim_mcp.server import build_server
from tests.site.pages import read_pages, run

pytestmark = [pytest.mark.site, pytest.mark.one_python]


def ask(topics: list[str]) -> dict[str, str]:
    """The answers of the tool ``lookup``, by topic."""

    async def each() -> dict[str, str]:
        async with Client(build_server(Path())) as client:
            return {topic: await _text(client, topic) for topic in topics}

    return run(each)


async def _text(client: Any, topic: str) -> str:
    return str((await client.call_tool("lookup", {"topic": topic})).content[0].text)


def test_references_are_the_documents_of_the_server(html: Path) -> None:
    async def read() -> dict[str, str]:
        async with Client(build_server(Path())) as client:
            uris = [one.uri for one in (await client.list_resources()).resources if "//docs/" in str(one.uri)]
            return {str(uri): (await client.read_resource(uri)).contents[0].text for uri in uris}

    documents = run(read)
    texts = {path.read_text(encoding="utf-8").strip() for path in html.rglob("*.md")}
    assert len(documents) > 20
    assert [uri for uri, text in documents.items() if text.strip() not in texts] == []


def test_components_templates_and_suites_say_what_lookup_says(html: Path) -> None:
    places = {f"{kind}.{name}": f"reference/{kind}/{name}" for kind, one in REGISTRIES.items() for name in one.names()}
    places |= {name: f"gallery/{name}" for name in templates.names()}
    places |= {name: f"suites/{name}" for name in SUITES.names()}
    for topic, text in ask(list(places)).items():
        twin = (html / f"{places[topic]}.md").read_text(encoding="utf-8")
        part, cut, _ = text.partition("\n… cut here")
        assert twin.startswith(part) if cut else twin.startswith(text.rstrip()), topic


def test_codes_say_what_lookup_says(html: Path) -> None:
    twin = (html / "reference/codes.md").read_text(encoding="utf-8")
    assert [topic for topic, text in ask([*CODES, *TOOL_CODES]).items() if text not in twin] == []


def test_the_list_has_every_page_once(html: Path) -> None:
    listed = re.findall(r"\]\(([^)]+\.md)\)", (html / "llms.txt").read_text(encoding="utf-8"))
    pages = {name.removesuffix(".html") + ".md" for name in read_pages(html)} - {"search.md", "404.md"}
    assert sorted(listed) == sorted(pages)
    assert (html / "llms-full.txt").stat().st_size < 500_000


def test_the_list_says_what_pages_are_about(html: Path) -> None:
    text = (html / "llms.txt").read_text(encoding="utf-8")
    about = dict(re.findall(r"^- \[.*?\]\((.*?)\.md\)(.*)$", text, re.MULTILINE))
    assert about["irsim/core/README"].startswith(": The core is a C++17 library")
    assert len([page for page, sentence in about.items() if not sentence]) <= 3, "lists and tables only"
