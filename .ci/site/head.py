"""The head of each page: it asks for little before the page is shown, and describes it to search engines."""

from __future__ import annotations

import re
from html import escape, unescape

__all__ = ["lighter"]

_SEARCH = r"searchtools\.js|language_data\.js|searchindex\.js"
"""Scripts of the search, half a megabyte, which Sphinx puts into every page and only the page of results runs."""
_LATER = rf"doctools\.js|sphinx_highlight\.js|{_SEARCH}"
"""Scripts that nothing in the text of a page waits for."""
_DESCRIBED = 155
"""Number of characters of a description that search engines show."""


def lighter(text: str, *, searches: bool, about: str = "") -> str:
    """A page that shows its text without waiting for scripts.

    Args:
        text: The page as Sphinx has written it.
        searches: Whether it shows results of the search.
        about: Its subject; empty: its first paragraph says it.
    """
    text = re.sub(r'<link rel="preload" as="script"[^>]*>\n?', "", text)
    if not searches:
        text = re.sub(rf'\s*<script src="[^"]*/?(?:{_SEARCH})[^"]*"></script>', "", text)
    text = re.sub(rf'<script src="([^"]*(?:{_LATER})[^"]*)">', r'<script defer src="\1">', text)
    basic = r'<link href="\2basic.css" rel="preload" as="style" />\n\1'  # which theme.css imports
    text = re.sub(r'(<link href="([^"]*)styles/theme\.css)', basic, text, count=1)
    described = f'<meta name="description" content="{escape(_short(about or _first_paragraph(text)))}" />'
    return text.replace("<title>", f"{described}\n    <title>", 1)


def _first_paragraph(text: str) -> str:
    """The words of the first paragraph of the article."""
    _, _, article = text.partition('<article class="bd-article">')
    first = re.search(r"<p>(.*?)</p>", article, re.DOTALL)
    return unescape(re.sub(r"<[^>]*>", "", first[1])) if first else ""


def _short(words: str) -> str:
    line = " ".join(words.replace("`", "").split())
    return line if len(line) <= _DESCRIBED else f"{line[:_DESCRIBED].rpartition(' ')[0]} …"
