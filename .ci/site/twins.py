"""Markdown beside each page, and ``llms.txt``, which lists it, for programs that read."""

from __future__ import annotations

from pathlib import Path

from pages import Page

__all__ = ["FULL_BYTES", "PARTS", "write_twins"]

PARTS = {
    "start": "Start",
    "skills": "Guides",
    "reference": "Reference",
    "realism": "Models of realism",
    "gallery": "Templates",
    "suites": "Suites",
    "evals": "Evaluating agents",
    "": "Project",
}
"""Beginning of the path of a page -> its heading in ``llms.txt``."""
FULL_BYTES = 500_000
"""Size of ``llms-full.txt``, which has the pages of the first parts as long as they fit."""
_ABOUT = (
    "> irsim is a fast 2D robot-navigation simulator. Scenarios are YAML files; a command, a Python package and an MCP "
    "server run them. Every page is here as Markdown, as the tool `lookup` and the resources `irsim://docs` of the "
    "server give it."
)


def write_twins(pages: list[Page], html: Path) -> None:
    """Write the twin of each page, the list of all of them, and the text of the most important ones."""
    for page in pages:
        (html / f"{page.path}.md").write_text(page.twin.rstrip() + "\n", encoding="utf-8")
    parts: dict[str, list[Page]] = {name: [] for name in PARTS}
    for page in pages:
        parts[_part(page)].append(page)
    lines, full, size = ["# irsim", "", _ABOUT], ["# irsim", "", _ABOUT], 0
    for name, title in PARTS.items():
        lines += ["", f"## {title}", ""]
        for page in parts[name]:
            about = f": {' '.join(page.summary.split())}" if page.summary else ""
            lines.append(f"- [{page.title}]({page.path}.md){about}")
            whole = f"\n<!-- {page.path}.md -->\n\n{page.twin.strip()}"
            most_read = name in ("start", "skills", "reference") and "/results/" not in page.path
            if most_read and size + len(whole.encode()) < FULL_BYTES - 1000:
                full.append(whole)
                size += len(whole.encode()) + 1
    (html / "llms.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (html / "llms-full.txt").write_text("\n".join(full) + "\n", encoding="utf-8")


def _part(page: Page) -> str:
    start = page.path.partition("/")[0]
    start = {"guides": "skills", "bridges": "skills", "index": "start", "README": "start"}.get(start, start)
    return start if start in PARTS else ""
