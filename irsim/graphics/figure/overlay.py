"""Drawings of scripts over the scene: paths, points, boxes, arrows. They stay until a reset, or for one frame."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import is_color_like
from numpy.typing import NDArray

from irsim.diagnostics.errors import InputError
from irsim.graphics.scene.style import Palette

__all__ = ["Overlay", "coordinates"]

_COLOR_IN_FORMAT = re.compile(r"C\d+|[bgrcmykw]")


class Overlay:
    """The drawings of a script on the axes of an environment.

    Each method draws until the next reset, or, with ``refresh``, for one frame only.
    """

    zorder: float | None = None
    """Layer of the drawings; None: Matplotlib's."""

    def __init__(self, palette: Palette) -> None:
        self.palette = palette
        self.forget()

    def forget(self) -> None:
        """Empty the list of drawings, because the axes were cleared."""
        self._waiting: list[Artist] = []
        self._shown: list[Artist] = []

    def next_frame(self) -> None:
        """Remove the one-frame drawings of the last frame; those added since then appear in the coming frame."""
        for artist in self._shown:
            artist.remove()
        self._shown, self._waiting = self._waiting, []

    def trajectory(
        self,
        ax: Axes,
        traj: Any,
        traj_type: str = "-",
        *,
        label: str = "trajectory",
        show_direction: bool = False,
        refresh: bool = False,
        **kwargs: Any,
    ) -> None:
        """Draw a path through ``traj``, given as columns or as an array (2 or more, N).

        ``show_direction`` also draws the headings, which are row 2.
        """
        rows = coordinates(traj, min_rows=3 if show_direction else 2)
        kwargs = self._with_color(traj_type, kwargs, self.palette.path)
        artists: list[Artist] = list(ax.plot(rows[0], rows[1], traj_type, label=label, **kwargs))
        if show_direction:
            artists.append(ax.quiver(rows[0], rows[1], np.cos(rows[2]), np.sin(rows[2]), width=0.003))
        self._keep(artists, refresh)

    def points(self, ax: Axes, points: Any, s: float = 30, c: Any = None, refresh: bool = True, **kwargs: Any) -> None:
        """Draw dots with an area of ``s`` square points; None or an empty list draws nothing."""
        rows = coordinates(points, min_rows=2) if points is not None else np.empty((2, 0))
        if rows.shape[1]:
            color = self.palette.marker if c is None else c
            self._keep([ax.scatter(rows[0], rows[1], s, color, **kwargs)], refresh)

    def box(self, ax: Axes, vertices: Any, refresh: bool = False, color: str = "-") -> None:
        """Draw a closed outline through (2, N) vertices; ``color`` is a Matplotlib line format."""
        rows = coordinates(vertices, min_rows=2)
        closed = np.concatenate([rows, rows[:, :1]], axis=1)
        kwargs = self._with_color(color, {}, self.palette.path)
        self._keep(list(ax.plot(closed[0], closed[1], color, **kwargs)), refresh)

    def quivers(self, ax: Axes, arrows: Any, refresh: bool = False, color: Any = None, **kwargs: Any) -> None:
        """Draw a dot and an arrow for each (x, y, u, v)."""
        if arrows is None:
            return
        rows = np.array([np.asarray(arrow, dtype=float).reshape(-1)[:4] for arrow in arrows]).reshape(-1, 4).T
        if rows.shape[1]:
            color = self.palette.quiver if color is None else color
            arrow = ax.quiver(rows[0], rows[1], rows[2], rows[3], color=color, **kwargs)
            self._keep([ax.scatter(rows[0], rows[1], color=color), arrow], refresh)

    def _keep(self, artists: Sequence[Artist], refresh: bool) -> None:
        if self.zorder is not None:
            for artist in artists:
                artist.set_zorder(self.zorder)
        if refresh:
            self._waiting += artists

    @staticmethod
    def _with_color(line_format: str, kwargs: dict[str, Any], default: str) -> dict[str, Any]:
        named = _COLOR_IN_FORMAT.search(line_format) is not None or is_color_like(line_format)
        return kwargs if named or "color" in kwargs or "c" in kwargs else {**kwargs, "color": default}


def coordinates(points: Any, min_rows: int) -> NDArray[np.float64]:
    """Convert points to rows of x, y, …: (at least ``min_rows``, N).

    Args:
        points: (2 or more, N) array, or a list of points (columns, rows or plain sequences).
        min_rows: Number of rows that are needed.

    Raises:
        ValueError: The points have too few numbers each.
    """
    if isinstance(points, np.ndarray):
        rows = np.asarray(points, dtype=np.float64)
        rows = rows.reshape(-1, 1) if rows.ndim == 1 else rows
    else:
        given: Sequence[Any] = list(points)
        columns = [np.asarray(point, dtype=np.float64).reshape(-1) for point in given]
        size = min((len(column) for column in columns), default=min_rows)
        rows = np.array([column[:size] for column in columns]).reshape(-1, size).T
    if rows.shape[0] < min_rows:
        raise InputError(f"each point must have at least {min_rows} numbers, got {rows.shape[0]}")
    return rows
