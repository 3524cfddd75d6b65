"""Notebooks: whether the program runs in one, pictures that replace each other in a cell, and HTML of facts.

Everything here works without IPython, which irsim does not need: the kernel of a notebook has imported it already.
"""

from __future__ import annotations

import base64
import html
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from irsim.common.files import check_suffix, write_atomically
from irsim.common.text import clean

__all__ = ["MAX_ROWS", "SUFFIXES", "Cell", "Page", "draws_inline", "facts", "picture", "section", "table", "text_table"]

MAX_ROWS = 10
"""Number of rows that a table of a notebook shows."""


def _shell() -> Any:
    """The shell of the notebook's kernel; None in a script, in a terminal and in IPython without a kernel."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return shell if getattr(shell, "kernel", None) is not None else None


def draws_inline() -> bool:
    """Whether the figures of Matplotlib appear below the cells of a notebook, and not in windows."""
    if _shell() is None:
        return False
    pyplot = sys.modules.get("matplotlib.pyplot")
    backend = os.environ.get("MPLBACKEND", "") if pyplot is None else pyplot.get_backend()
    return "inline" in backend


class Cell:
    """The place of a picture below the present cell of a notebook; each picture replaces the one before."""

    def __init__(self) -> None:
        self._count: int | None = None
        self._handle: Any = None

    def show(self, png: bytes) -> None:
        """Show a picture: the first one of each execution of a cell gets a new place.

        Args:
            png: The content of a PNG file.
        """
        display, count = import_module("IPython.display"), _shell().execution_count
        image = display.Image(data=png, format="png")
        if self._handle is None or count != self._count:
            self._count, self._handle = count, display.display(image, display_id=True)
        else:
            self._handle.update(image)


SUFFIXES = (".html", ".htm")
"""Suffixes of files of pages."""


class Page:
    """A page of its own, such as a replay, which a notebook shows below its cell.

    Attributes:
        text: The page as text of HTML, which needs no network and no other file.
        height: Height in the notebook [px].

    Args:
        text: The page.
        about: A description in a few words.
        height: Height in the notebook [px].
    """

    def __init__(self, text: str, about: str, height: int) -> None:
        self.text, self.height, self._about = text, int(height), about

    def save(self, path: str | Path) -> Path:
        """Write the page to a file, which is replaced if it exists.

        Raises:
            TargetError: The file has another suffix than ``.html`` and ``.htm``.
        """
        check_suffix(Path(path), SUFFIXES)
        write_atomically(Path(path), self.text)
        return Path(path)

    def __repr__(self) -> str:
        return f"<{self._about}; .save('replay.html') writes its page>"

    def _repr_html_(self) -> str:
        """A frame, in which the page neither sees the notebook nor changes it."""
        style = f"width:100%;height:{self.height}px;border:0"
        about, text = (html.escape(one, quote=True) for one in (self._about, self.text))
        return f'<iframe title="{about}" sandbox="allow-scripts" style="{style}" srcdoc="{text}"></iframe>'


def section(title: str, *parts: str) -> str:
    """Parts below a title.

    Args:
        title: The title, as plain text.
        *parts: HTML.
    """
    return f"<div><p><strong>{_text(title)}</strong></p>{''.join(parts)}</div>"


def facts(rows: Mapping[str, object]) -> str:
    """A list of names and values, as HTML; values that are None are left out."""
    lines = [
        f'<tr><th style="text-align:left">{_text(name)}</th><td style="text-align:left">{_text(value)}</td></tr>'
        for name, value in rows.items()
        if value is not None
    ]
    return f"<table><tbody>{''.join(lines)}</tbody></table>"


def table(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table as HTML, cut after :data:`MAX_ROWS` rows; None is an empty cell.

    Args:
        columns: Names of the columns.
        rows: A value for each column.
    """
    listed = list(rows)
    head = "".join(f'<th style="text-align:left">{_text(column)}</th>' for column in columns)
    lines = [
        "<tr>" + "".join(f'<td style="text-align:left">{_text(value)}</td>' for value in row) + "</tr>"
        for row in listed[:MAX_ROWS]
    ]
    more = len(listed) - MAX_ROWS
    rest = f"<p>and {more} more rows</p>" if more > 0 else ""
    return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(lines)}</tbody></table>{rest}"


def text_table(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """The same table as plain text, for a console."""
    listed = list(rows)
    cells = [[_plain(value) for value in row] for row in (columns, *listed[:MAX_ROWS])]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in cells]
    more = len(listed) - MAX_ROWS
    return "\n".join([*lines, *([f"and {more} more rows"] if more > 0 else [])])


def picture(png: bytes, alt: str) -> str:
    """A picture as HTML.

    Args:
        png: The content of a PNG file.
        alt: A description for people who do not see it.
    """
    return f'<img alt="{_text(alt)}" src="data:image/png;base64,{base64.b64encode(png).decode()}">'


def _text(value: object) -> str:
    """A value as text of HTML: names come from files of other people."""
    return html.escape(_plain(value))


def _plain(value: object) -> str:
    """A value as text without marks that change the text around it; None is empty."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return clean(f"{value:.6g}" if isinstance(value, float) else str(value), 400)
