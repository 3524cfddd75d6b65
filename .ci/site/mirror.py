"""Pages made of Markdown files of the checkout, at the same paths: their links lead where they lead there."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator

from pages import ROOT, Page, anchor, contents, summary_of

__all__ = ["FOLDERS", "GUIDES", "LISTED", "files_of", "mirrored", "rewritten"]

GUIDES = {
    "skills/irsim-scenario": "Scenarios",
    "skills/irsim-runner": "Programs and learning",
    "skills/irsim-benchmark": "Comparisons",
    "skills/irsim-dev": "Changing irsim",
}
"""Folder of a skill -> title of its part of the guides."""
_PARTS = ("guides", "references", "recipes")
_OTHERS = {
    "README.md": "irsim on one page",
    "CHANGELOG.md": "Changelog",
    "CONTRIBUTING.md": "Contributing",
    "RELEASING.md": "Releasing",
    "AGENTS.md": "Guide for coding agents",
    "evals/README.md": "How agents are evaluated",
    "evals/write-a-case.md": "Write a case",
    "irsim/core/README.md": "The core",
    "tests/speed/README.md": "Speed",
    "irsim/compat/README.md": "All differences from IR-SIM 2.12",
}
"""Single files -> title, where theirs says too little."""
FOLDERS = {
    "templates": "gallery/index",
    "skills": "guides/index",
    "evals/cases": "evals/README",
}
"""Folders that links lead to -> the page about what is there."""
_LINK = re.compile(r"(?P<text>!?\[[^\]]*\])\((?P<target>[^)\s]+)\)")


def _pages() -> dict[str, str]:
    """Path of a file -> title; empty where its first heading is the title."""
    result: dict[str, str] = dict(_OTHERS)
    for skill, title in GUIDES.items():
        result[f"{skill}/SKILL.md"] = title
        for path in sorted((ROOT / skill).rglob("*.md")):
            name = path.relative_to(ROOT).as_posix()
            if path.parent.name in (*_PARTS, "bridges", "results") or path.name == "elements.md":
                result.setdefault(name, "")
    return result


LISTED = _pages()
"""Files that are pages -> title."""


def files_of(folder: str, *parts: str) -> list[str]:
    """Pages of a skill that lie in some of its folders, in the order of their names."""
    return [
        name.removesuffix(".md")
        for name in LISTED
        if name.startswith(f"{folder}/") and (set(name.split("/")) & set(parts))
    ]


def mirrored() -> Iterator[tuple[Page, set[str]]]:
    """Each page, and the other files of the checkout that it links or shows."""
    for name, title in LISTED.items():
        text = (ROOT / name).read_text(encoding="utf-8")
        body = re.sub(r"\A---\n.*?\n---\n+", "", text, flags=re.DOTALL)
        body = re.sub(r"\A(<!--[^>]*-->\n)+", "", body)
        body, files = rewritten(body, name)
        if title:
            body = re.sub(r"\A# .*$", f"# {title}", body, count=1, flags=re.MULTILINE)
        heading = re.match(r"# (.*)", body)
        shown = title or (heading[1] if heading else name)
        path = name.removesuffix(".md")
        body = _anchored(body, path)
        if path.endswith("/SKILL"):
            body += f"\n\n{_parts(path)}\n"
        yield Page(path, body, text, shown, summary_of(text)), files


def _parts(path: str) -> str:
    """Pages of a skill, for the navigation."""
    skill = path.removesuffix("/SKILL")
    inside = [page for page in files_of(skill, *_PARTS, "examples") if not page.endswith("/SKILL")]
    return contents([page for page in inside if "/references/protocol_" not in page], hidden=True)


def rewritten(text: str, name: str) -> tuple[str, set[str]]:
    """A text whose links hold on the site, and the files that must lie beside the pages.

    Args:
        text: Markdown.
        name: Path of its file in the checkout.
    """
    files: set[str] = set()

    def replace(match: re.Match[str]) -> str:
        target = match["target"].partition("#")[0]
        if re.match(r"[a-z]+:", match["target"]) or not target:
            return match[0]
        path = posixpath.normpath(posixpath.join(posixpath.dirname(name), target))
        if path in LISTED:
            return match[0]
        page = FOLDERS.get(path) or _gallery(path)
        if page is None and (ROOT / path).is_dir():
            inside = [one for one in (f"{path}/README.md", f"{path}/SKILL.md") if one in LISTED]
            page = inside[0].removesuffix(".md") if inside else None
        if page is not None:
            return f"{match['text']}({posixpath.relpath(page, posixpath.dirname(name) or '.')}.md)"
        if not (ROOT / path).is_file():
            raise SystemExit(f"{name}: the link to {match['target']!r} leads to no page and no file")
        files.add(path)
        return match[0] if match["text"].startswith("!") else f"{match['text']}(<path:{target}>)"

    parts = re.split(r"(^ *```.*?^ *```)", text, flags=re.DOTALL | re.MULTILINE)
    return "".join(_LINK.sub(replace, part) if k % 2 == 0 else part for k, part in enumerate(parts)), files


def _gallery(path: str) -> str | None:
    parts = path.split("/")
    return f"gallery/{parts[1]}" if parts[0] == "templates" and len(parts) == 2 else None


def _anchored(text: str, path: str) -> str:
    """Anchors for the rows of a table whose first cell is a number of a difference."""
    if path != "irsim/compat/README":
        return text
    return re.sub(r"^\| `([A-Z]\d+|[a-z]+-\d+)` \|", lambda row: f"| {anchor(row[1])}`{row[1]}` |", text, flags=re.M)
