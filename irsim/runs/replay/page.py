"""The replay page: HTML, style sheet and JavaScript modules from ``web/`` as one text.

The modules become one script, each after those it imports and without its ``import`` and ``export`` statements, so a
name at the top level of a module must be unique in all modules. Uses the standard library only: the MCP server serves
the page without NumPy.
"""

from __future__ import annotations

import base64
import hashlib
import html
import re
from pathlib import Path

__all__ = ["bundle", "fingerprint", "page"]

_SOURCES = Path(__file__).with_name("web")
_IMPORT = re.compile(r"^import\s[^;]*?\sfrom\s+\"\./([a-z]+)\.js\";\n", re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?function |const |let |class )", re.MULTILINE)
_FIRST = "main"


def page(data: bytes | None = None, *, title: str = "irsim replay") -> str:
    """The page as text.

    Args:
        data: A packed run (:func:`irsim.runs.replay.data.pack_run`); without one the page asks its host for the run.
        title: Title of the window.
    """
    style = (_SOURCES / "replay.css").read_text(encoding="utf-8")
    script = f'"use strict";\n(() => {{\n{bundle()}}})();\n'
    parts = {
        "policy": "default-src 'none'; base-uri 'none'; form-action 'none'; img-src data:; "
        f"style-src {fingerprint(style)}; script-src {fingerprint(script)}",
        "title": html.escape(title),
        "style": style,
        "script": script,
        "data": "" if data is None else base64.b64encode(data).decode(),
    }
    frame = (_SOURCES / "page.html").read_text(encoding="utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match[1]], frame)


def bundle(sources: Path = _SOURCES) -> str:
    """All modules of a folder as one script, each after those it imports.

    Args:
        sources: The folder, whose module ``main.js`` is the last one.
    """
    done: dict[str, str] = {}

    def add(name: str) -> None:
        if name in done:
            return
        done[name] = ""  # allows circular imports, as functions refer to each other only when they are called
        text = (sources / f"{name}.js").read_text(encoding="utf-8")
        for other in _IMPORT.findall(text):
            add(other)
        del done[name]
        done[name] = _EXPORT.sub("", _IMPORT.sub("", text))

    add(_FIRST)
    return "\n".join(done.values())


def fingerprint(text: str) -> str:
    """Hash of a script or style sheet, as a content security policy lists it."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
