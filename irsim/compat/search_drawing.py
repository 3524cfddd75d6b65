"""Draws the nodes and the path of a search into a figure that already exists."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats

__all__ = ["draw_search"]


def draw_search(
    env_map: Any,
    nodes: Floats,
    parents: NDArray[np.int32],
    path: Floats | None,
    start: tuple[float, float],
    goal: tuple[float, float],
) -> None:
    """Draw nodes, the edges between them, and the path; without a figure, do nothing.

    Args:
        env_map: The map; its ``canvas`` returns the axes of its environment.
        nodes: (K, 2) visited points [m].
        parents: (K,) index of the node from which each node was reached, or -1.
        path: (2, N) points of the path, or None.
        start: Start position [m].
        goal: Goal position [m].
    """
    axes = _axes(env_map)
    if axes is None:
        return
    reached = np.flatnonzero(np.asarray(parents) >= 0)
    if reached.size:
        edges = np.full((3 * reached.size, 2), np.nan)
        edges[0::3], edges[1::3] = nodes[parents[reached]], nodes[reached]
        axes.plot(edges[:, 0], edges[:, 1], "-", color="#88CCEE", linewidth=0.8, zorder=1)
    elif len(nodes):
        axes.plot(nodes[:, 0], nodes[:, 1], ".", color="#88CCEE", markersize=2, zorder=1)
    axes.plot(*start, "o", color="#332288", markersize=5, zorder=3)
    axes.plot(*goal, "x", color="#332288", markersize=7, zorder=3)
    if path is not None:
        axes.plot(path[0], path[1], "-", color="#CC6677", linewidth=1.5, zorder=3)
    axes.figure.canvas.draw_idle()


def _axes(env_map: Any) -> Any:
    canvas = getattr(env_map, "canvas", None)
    if canvas is not None:
        return canvas()
    pyplot = sys.modules.get("matplotlib.pyplot")
    return pyplot.gca() if pyplot is not None and pyplot.get_fignums() else None
