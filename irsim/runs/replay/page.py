"""The replay page: HTML, style sheet and JavaScript modules from ``web/`` as one text."""

from __future__ import annotations

import base64
import html
from pathlib import Path

from irsim.common.pages import bundle, one_page
from irsim.graphics.scene.theme import css_variables

__all__ = ["WEB", "page", "player"]

WEB = Path(__file__).with_name("web")
"""Folder of the page: its modules, its style sheet, and the markup of the player."""


def page(data: bytes | None = None, *, title: str = "irsim replay", feed: Path | None = None) -> str:
    """The page as text.

    Args:
        data: A packed run (:func:`irsim.runs.replay.data.pack_run`); without one the page asks its host for the run.
        title: Title of the window.
        feed: Folder with another ``main.js``, which starts the player with a run that the server of the page sends.
    """
    content = "" if data is None else base64.b64encode(data).decode()
    script = bundle(*filter(None, [feed]), WEB)
    rules = ["img-src data:", *(["connect-src 'self'"] if feed else [])]
    shown = html.escape(title)
    return one_page(WEB, script, *rules, variables=css_variables(), title=shown, player=player(shown), data=content)


def player(title: str = "") -> str:
    """The markup of the player, with the head, the world, the panel and the timeline.

    Args:
        title: The HTML that its head says until a run is there.
    """
    return (WEB / "player.html").read_text(encoding="utf-8").replace("{{title}}", title)
