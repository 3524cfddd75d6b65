"""The 3-D picture of an environment."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure

from irsim.diagnostics.errors import InputError
from irsim.env.old.env_plot import EnvPlot
from irsim.graphics.figure.figure3d import SceneFigure3D
from irsim.graphics.figure.overlay import Overlay, coordinates

__all__ = ["EnvPlot3D"]

_ARROW_NUMBERS = 6
_XYZ_ROWS = 3


class _Overlay3D(Overlay):
    """Drawings of a script in 3-D: points and paths have three rows (or two, on the ground), arrows six numbers."""

    def trajectory(self, ax: Any, traj: Any, traj_type: str = "-", **kwargs: Any) -> None:
        """Draw a path through ``traj``."""
        refresh = kwargs.pop("refresh", False)
        show_direction = kwargs.pop("show_direction", False)
        rows = _xyz(traj, flat=True)
        kwargs = self._with_color(traj_type, {"label": "trajectory", **kwargs}, self.palette.path)
        artists: list[Artist] = list(ax.plot(*rows, traj_type, **kwargs))
        if show_direction:
            heading = coordinates(traj, min_rows=_XYZ_ROWS)[2]
            artists.append(ax.quiver(*rows, np.cos(heading), np.sin(heading), 0 * heading, length=0.4))
        self._keep(artists, refresh)

    def points(self, ax: Any, points: Any, s: float = 30, c: Any = None, refresh: bool = True, **kwargs: Any) -> None:
        """Draw dots at (3, N) or (2, N) points."""
        rows = _xyz(points) if points is not None else np.empty((3, 0))
        if rows.shape[1]:
            self._keep([ax.scatter(*rows, s=s, c=self.palette.marker if c is None else c, **kwargs)], refresh)

    def box(self, ax: Any, vertices: Any, refresh: bool = False, color: str = "-") -> None:
        """Draw a closed outline."""
        rows = _xyz(vertices)
        closed = np.concatenate([rows, rows[:, :1]], axis=1)
        self._keep(list(ax.plot(*closed, color, **self._with_color(color, {}, self.palette.path))), refresh)

    def quivers(self, ax: Any, arrows: Any, refresh: bool = False, color: Any = None, **kwargs: Any) -> None:
        """Draw arrows (x, y, z, u, v, w)."""
        if arrows is None:
            return
        rows = np.array([np.asarray(arrow, dtype=float).reshape(-1) for arrow in arrows])
        if rows.size and rows.shape[1] != _ARROW_NUMBERS:
            raise InputError(f"a 3-D arrow must have {_ARROW_NUMBERS} numbers (x, y, z, u, v, w), got {rows.shape[1]}")
        if rows.size:
            self._keep([ax.quiver(*rows.T, color=self.palette.quiver if color is None else color, **kwargs)], refresh)


class EnvPlot3D(EnvPlot):
    """Draws one environment in 3-D; see :class:`irsim.env.old.env_plot.EnvPlot`. Grid maps and fog are not drawn.

    Args:
        env: The environment.
        depth: Extent along z [m].
        **kwargs: Arguments of ``EnvPlot``.
    """

    def set_style(self, style: str, theme: str | None = None, printed: bool = False) -> None:
        """Keep the style of 3-D pictures, which is their only one."""

    def __init__(self, env: Any, *, depth: float, **kwargs: Any) -> None:
        self._depth = depth
        super().__init__(env, **kwargs)
        self._overlay = _Overlay3D(self.palette)

    def _has_picture(self, name: str) -> bool:
        return False

    def _new_figure(self, figure: Figure | None) -> Any:
        axis = not self._options.no_axis
        return SceneFigure3D(self._size, self._dpi, depth=self._depth, axis=axis, figure=figure)


def _xyz(points: Any, *, flat: bool = False) -> Any:
    """Convert points to (3, N); ``flat`` sets z to 0, for points whose third row is a heading."""
    rows = coordinates(points, min_rows=2)
    third = np.zeros(rows.shape[1]) if flat or rows.shape[0] < _XYZ_ROWS else rows[2]
    return np.vstack([rows[:2], third])
