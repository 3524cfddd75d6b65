"""A page of the site, and how pages name and link each other."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterable
from dataclasses import dataclass
from html import escape
from pathlib import Path

__all__ = ["ROOT", "Page", "anchor", "cell", "contents", "headed", "href", "link", "once", "plain", "summary_of"]

ROOT = Path(__file__).resolve().parents[2]
"""The checkout."""


@dataclass(frozen=True)
class Page:
    """One page of the site.

    Attributes:
        path: Where it is, without suffix, such as ``reference/behavior/rvo``.
        text: Markdown that Sphinx lays out.
        twin: Markdown for programs that read, beside the page: what the MCP server says, or the file it is made of.
        title: Its name in lists.
        summary: One sentence about it.
    """

    path: str
    text: str
    twin: str
    title: str
    summary: str = ""


def href(start: str, target: str, suffix: str = ".html") -> str:
    """Relative address from one page to another, ``PAGE`` or ``PAGE#ANCHOR``."""
    page, _, name = target.partition("#")
    if page == start and name:
        return f"#{name}"
    way = posixpath.relpath(page + suffix, posixpath.dirname(start) or ".")
    return f"{way}#{name}" if name else way


def link(text: str, start: str, target: str) -> str:
    """A link from a page to another one, or to an anchor of it, for Markdown."""
    if "#" in target:
        return f'<a href="{escape(href(start, target))}">{escape(text)}</a>'
    return f"[{text}]({href(start, target, '.md')})"


def anchor(name: str) -> str:
    """A place that links lead to."""
    return f'<span id="{escape(name)}"></span>'


def headed(html: str) -> str:
    """A page whose anchors below headings are the headings themselves, so that links show these, too."""
    form = r'<(h[1-6])>((?:(?!</?h[1-6]>).)*?</\1>)\s*<p><span id="([^"]*)"></span>(</p>)?'
    return re.sub(form, _with_id, html, flags=re.DOTALL)


def _with_id(found: re.Match[str]) -> str:
    kind, rest, name, alone = found.groups()
    return f'<{kind} id="{name}">{rest}' + ("" if alone else "\n<p>")


def plain(text: str) -> str:
    """Text of the program as Markdown: what is between backticks is code, everything else is words."""
    parts = re.split(r"(`+[^`]*`+)", text)
    return "".join(
        part if part.startswith("`") else re.sub(r"[<*\[\]]|(?<![^\W_])_|_(?![^\W_])", r"\\\g<0>", part)
        for part in parts
    )


def cell(text: str) -> str:
    """Text of the program for a cell of a table."""
    return plain(" ".join(text.split()))


def once(text: str) -> str:
    """A text in which each anchor is there once: where it is first."""
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    seen = {anchor(re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")) for title in headings}

    def first(match: re.Match[str]) -> str:
        known = match[0] in seen
        seen.add(match[0])
        return "" if known else match[0]

    return re.sub(r'<span id="[^"]*"></span>', first, text)


def contents(pages: Iterable[str], *, caption: str = "", depth: int = 1, hidden: bool = False) -> str:
    """The list of pages that Sphinx makes a navigation of.

    Args:
        pages: Paths from the root of the site.
        caption: Title of the list in the navigation.
        depth: Levels that are shown.
        hidden: Whether only the navigation shows it.
    """
    options = [f":maxdepth: {depth}"] + [f":caption: {caption}"] * bool(caption) + [":hidden:"] * hidden
    return "\n".join(["```{toctree}", *options, "", *(f"/{page}" for page in pages), "```"])


def summary_of(text: str) -> str:
    """First sentence of a Markdown text that is in no title, list, table or block, without its links."""
    body = re.sub(
        r"\A---\n.*?\n---\n|<!--.*?-->|```.*?```|^(?:#|!\[|\||<)[^\n]*$", "", text, flags=re.DOTALL | re.MULTILINE
    )
    parts = [part.strip() for part in re.split(r"\n\s*\n", body)]
    first = next((part for part in parts if part and not re.match(r"-|\d+\.", part)), "")
    words = re.sub(r"!?\[([^]]*)\]\([^)]*\)", r"\1", " ".join(first.split()))
    return re.split(r"(?<=[.!?])\s", words)[0]
