"""Addresses of pages that are gone lead on to the list that they stood in."""

from __future__ import annotations

from html import escape
from pathlib import Path

__all__ = ["STUB", "write_stubs"]

STUB = (
    '<!doctype html><html lang="en"><meta charset="utf-8"><title>This page has moved</title>\n'
    '<meta name="robots" content="noindex"><meta http-equiv="refresh" content="0; url={to}">\n'
    '<p>This page has moved: <a href="{to}">go on</a>.</p></html>\n'
)


def write_stubs(previous: Path, html: Path) -> list[str]:
    """Write a stub for each page of an older site that this one lacks.

    Returns:
        The addresses.
    """
    written = []
    for path in sorted(previous.rglob("*.html")):
        name = path.relative_to(previous)
        if (html / name).exists() or name.parts[0] in ("_static", "players"):
            continue
        folder = next(one for one in name.parents if (html / one / "index.html").exists())
        to = "/".join([".."] * (len(name.parts) - 1 - len(folder.parts)) + ["index.html"])
        (html / name).parent.mkdir(parents=True, exist_ok=True)
        (html / name).write_text(STUB.format(to=escape(to)), encoding="utf-8")
        written.append(name.as_posix())
    return written
