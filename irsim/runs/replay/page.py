"""The page, put together from the files in ``web/``: HTML, style sheet and modules become one text.

The modules are ordinary ones for editors and tools. Here they become one script: what one of them imports comes before
it, and the words ``import`` and ``export`` go. So a name at the top of a module is used once in the whole page.
Standard library only: the MCP server serves the page without NumPy.
"""

from __future__ import annotations

import base64
import hashlib
import html
import re
from pathlib import Path

__all__ = ["bundle", "page"]

_SOURCES = Path(__file__).with_name("web")
_IMPORT = re.compile(r"^import\s[^;]*?\sfrom\s+\"\./([a-z]+)\.js\";\n", re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?function |const |let |class )", re.MULTILINE)
_FIRST = "main"


def page(data: bytes | None = None, *, title: str = "irsim replay") -> str:
    """The page as text.

    Args:
        data: A packed run (:func:`irsim.runs.replay.data.pack_run`); without one the page asks the host that shows it.
        title: Of the window.
    """
    style = (_SOURCES / "replay.css").read_text(encoding="utf-8")
    script = f'"use strict";\n(() => {{\n{bundle()}}})();\n'
    parts = {
        "policy": "default-src 'none'; base-uri 'none'; form-action 'none'; img-src data:; "
        f"style-src {_fingerprint(style)}; script-src {_fingerprint(script)}",
        "title": html.escape(title),
        "style": style,
        "script": script,
        "data": "" if data is None else base64.b64encode(data).decode(),
    }
    frame = (_SOURCES / "page.html").read_text(encoding="utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match[1]], frame)


def bundle() -> str:
    """All modules as one script, each after those it imports."""
    done: dict[str, str] = {}

    def add(name: str) -> None:
        if name in done:
            return
        done[name] = ""  # modules that import each other: functions only meet when they are called
        text = (_SOURCES / f"{name}.js").read_text(encoding="utf-8")
        for other in _IMPORT.findall(text):
            add(other)
        del done[name]
        done[name] = _EXPORT.sub("", _IMPORT.sub("", text))

    add(_FIRST)
    return "\n".join(done.values())


def _fingerprint(text: str) -> str:
    """As a content security policy names the one script or style sheet that is allowed."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
