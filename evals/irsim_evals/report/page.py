"""The page of a report: one HTML file that works without a network and asks for nothing but itself."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Iterable
from pathlib import Path

from irsim_evals.report.case_section import case_sections
from irsim_evals.report.content import Content
from irsim_evals.report.html_text import escaped
from irsim_evals.report.sections import sections

__all__ = ["page"]

_SOURCES = Path(__file__).with_name("web")
_CHANGED = (
    '<p class="note">These answers were graded with other cases than those that are installed now. So changes of given '
    "files are not shown, and the second picture shows each world after 10 s.</p>\n"
)


def page(content: Content) -> str:
    """The page as text."""
    style = (_SOURCES / "report.css").read_text(encoding="utf-8")
    script = f'"use strict";\n(() => {{\n{(_SOURCES / "report.js").read_text(encoding="utf-8")}}})();\n'
    trials, count = content.results.trials, len(content.arms)
    parts = {
        "policy": "default-src 'none'; base-uri 'none'; form-action 'none'; img-src data:; "
        f"style-src {_fingerprint(style)}; script-src {_fingerprint(script)}",
        "title": escaped(content.title, 120),
        "facts": escaped(
            f"{len({trial.key for trial in trials})} cases, {len(trials)} answers, "
            f"{count} {'arm' if count == 1 else 'arms'} · irsim {content.results.irsim_version} · "
            f"cases {content.results.cases or 'unknown'}"
        ),
        "style": style,
        "script": script,
        "sections": sections(content),
        "arms": _options(arm.arm for arm in content.arms),
        "categories": _options(name for name, _ in content.categories.rows),
        "note": "" if any(asked.known for asked in content.asked) else _CHANGED,
        "cases": case_sections(content),
        "pictures": _pictures(content),
    }
    frame = (_SOURCES / "page.html").read_text(encoding="utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match[1]], frame)


def _options(names: Iterable[str]) -> str:
    return "".join(f'<option value="{escaped(name)}">{escaped(name, 60)}</option>' for name in names)


def _pictures(content: Content) -> str:
    """Name → PNG file as base64; both are made of characters that need no escape."""
    pictures = content.gallery.pictures if content.gallery else {}
    return json.dumps({name: base64.b64encode(one.png).decode() for name, one in pictures.items()})


def _fingerprint(text: str) -> str:
    """Hash of a script or style sheet, as a content security policy lists it."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
