"""Pages of one file, which need neither a network nor other files: a frame, a style sheet and a script of a folder.

Modules become one script, each after the modules that it imports and without its ``import`` and
``export`` statements, so a name at the top level of a module must be unique in all modules. Uses the standard library
only: the MCP server serves the replay page without NumPy.
"""

from __future__ import annotations

import base64
import re
from pathlib import Path

from irsim.common.hashing import digest

__all__ = ["bundle", "one_page"]

_IMPORT = re.compile(r"^import\s[^;]*?\sfrom\s+\"\./([a-z]+)\.js\";\n", re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?function |const |let |class )", re.MULTILINE)
_FIRST = "main"


def one_page(sources: Path, script: str, *policy: str, variables: str = "", **parts: str) -> str:
    """The page of a folder as text.

    Args:
        sources: The folder: it has ``page.html``, whose ``{{name}}`` are replaced, and one style sheet.
        script: The script of the page.
        variables: Rules that come before the style sheet.
        *policy: Further rules of its content security policy, which allows only this style sheet and script.
        **parts: Name of a place in ``page.html`` -> the HTML there.
    """
    [sheet] = sources.glob("*.css")
    style = variables + sheet.read_text(encoding="utf-8")
    strict = f'"use strict";\n(() => {{\n{script}}})();\n'
    rules = ("default-src 'none'", "base-uri 'none'", "form-action 'none'", *policy)
    hashes = (f"style-src {_fingerprint(style)}", f"script-src {_fingerprint(strict)}")
    values = {"policy": "; ".join([*rules, *hashes]), "style": style, "script": strict, **parts}
    frame = (sources / "page.html").read_text(encoding="utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda match: values[match[1]], frame)


def bundle(*sources: Path) -> str:
    """The module ``main.js`` and all that it imports as one script, each module after the modules that it imports.

    Args:
        *sources: The folders of the modules; a module of the first folder goes before its namesakes in others.
    """
    done: dict[str, str] = {}

    def add(name: str) -> None:
        if name in done:
            return
        done[name] = ""  # allows circular imports, as functions refer to each other only when they are called
        path = next(file for folder in sources if (file := folder / f"{name}.js").is_file())
        text = path.read_text(encoding="utf-8")
        for other in _IMPORT.findall(text):
            add(other)
        del done[name]
        done[name] = _EXPORT.sub("", _IMPORT.sub("", text))

    add(_FIRST)
    return "\n".join(done.values())


def _fingerprint(text: str) -> str:
    """Hash of a script or style sheet, as a content security policy lists it."""
    return f"'sha256-{base64.b64encode(bytes.fromhex(digest(text))).decode()}'"
