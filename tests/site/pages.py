"""The built site as data: pages, what they link and show, the places that links lead to."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import TypeVar

import anyio

__all__ = ["HtmlPage", "read_page", "read_pages", "run"]

Answer = TypeVar("Answer")


class HtmlPage(HTMLParser):
    """A page, as far as tests ask about it."""

    def __init__(self, path: Path) -> None:
        super().__init__(convert_charrefs=True)
        self.ids: list[str] = []
        self.links: list[str] = []
        self.sources: list[str] = []
        self.pictures: list[dict[str, str | None]] = []
        self.frames: list[dict[str, str | None]] = []
        self.feed(path.read_text(encoding="utf-8"))
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if given.get("id"):
            self.ids.append(given["id"] or "")
        if tag in ("a", "link") and given.get("href") is not None:
            self.links.append(given["href"] or "")
        if tag in ("img", "script", "iframe", "source", "video") and given.get("src"):
            self.sources.append(given["src"] or "")
        if tag == "img":
            self.pictures.append(given)
        if tag == "iframe":
            self.frames.append(given)


@cache
def read_page(path: Path) -> HtmlPage:
    return HtmlPage(path)


@cache
def read_pages(html: Path) -> dict[str, HtmlPage]:
    """Path from the root -> page, without players and without pages that only lead on."""
    files = sorted(html.rglob("*.html"))
    names = [path.relative_to(html).as_posix() for path in files]
    names = [name for name in names if not name.startswith(("players/", "_static/"))]
    moved = 'http-equiv="refresh"'
    return {name: read_page(html / name) for name in names if moved not in (html / name).read_text(encoding="utf-8")}


def run(ask: Callable[[], Awaitable[Answer]]) -> Answer:
    """Wait for an answer of the server in a thread of its own: Chromium keeps a loop in the thread of the tests."""
    with ThreadPoolExecutor(max_workers=1) as pool:
        return pool.submit(anyio.run, ask).result()
