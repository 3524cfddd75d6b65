"""Links of the built site: pages, anchors, pictures and files that they lead to exist; nothing comes from elsewhere."""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from urllib.parse import unquote

import pytest

from irsim.common.data_files import published_schema, schema_file
from tests.site.pages import read_pages

pytestmark = [pytest.mark.site, pytest.mark.one_python]


def _leads(html: Path, start: str, target: str) -> bool:
    """Whether a relative address leads to a file, and to an anchor of it."""
    name, _, anchor = target.partition("#")
    path = (
        posixpath.normpath(posixpath.join(posixpath.dirname(start), unquote(name.partition("?")[0]))) if name else start
    )
    if not (html / path).is_file():
        return (html / path / "index.html").is_file() and not anchor
    pages = read_pages(html)
    return not anchor or path not in pages or unquote(anchor) in pages[path].ids


def test_links_and_anchors_lead_somewhere(html: Path) -> None:
    broken = [
        f"{name}: {link}"
        for name, page in read_pages(html).items()
        for link in page.links
        if not re.match(r"[a-z]+:", link) and not _leads(html, name, link)
    ]
    assert broken == []


def test_the_readme_leads_to_pages_of_the_site(html: Path) -> None:
    text = (Path(__file__).resolve().parents[2] / "README.md").read_text(encoding="utf-8")
    paths = re.findall(r"\]\(https://[^/]+\.github\.io/irsim/latest/([^)]+)\)", text)
    assert len(paths) >= 4
    assert [path for path in paths if not (html / path).is_file()] == []


def test_scenarios_name_a_schema_of_the_site(html: Path) -> None:
    path = published_schema().partition("/latest/")[2]
    assert (html / path).read_bytes() == schema_file().read_bytes()


def test_pictures_and_players_are_there(html: Path) -> None:
    missing = [
        f"{name}: {source}"
        for name, page in read_pages(html).items()
        for source in page.sources
        if not source.startswith("data:") and not _leads(html, name, source)
    ]
    assert missing == []


def test_pictures_have_words_and_frames_titles(html: Path) -> None:
    pages = read_pages(html).items()
    assert [name for name, page in pages for picture in page.pictures if not picture.get("alt")] == []
    assert [name for name, page in pages for frame in page.frames if not frame.get("title")] == []


def test_anchors_are_there_once(html: Path) -> None:
    assert {name for name, page in read_pages(html).items() if len(page.ids) != len(set(page.ids))} == set()


def test_nothing_is_loaded_from_elsewhere(html: Path) -> None:
    """Pages load scripts, styles, fonts and pictures from the site alone."""
    sources = [source for page in read_pages(html).values() for source in page.sources]
    assert [source for source in sources if re.match(r"(https?:)?//", source)] == []
    styles = [path.read_text(encoding="utf-8") for path in html.rglob("*.css")]
    assert [address for text in styles for address in re.findall(r"url\(['\"]?(https?:[^)]*)", text)] == []


def test_links_of_markdown_lead_somewhere(html: Path) -> None:
    """The Markdown beside the pages is what the server gives; its links lead to something."""
    broken = []
    for path in sorted(html.rglob("*.md")):
        name = path.relative_to(html).as_posix()
        text = re.sub(r"```.*?```|`[^`\n]*`", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
        for target in re.findall(r"\]\(<?([^)\s>#]+)", text):
            if not re.match(r"[a-z]+:", target) and not _leads(html, name, target):
                broken.append(f"{name}: {target}")
    assert broken == []


def test_size(html: Path) -> None:
    assert sum(path.stat().st_size for path in html.rglob("*") if path.is_file()) < 40_000_000
