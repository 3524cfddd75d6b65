"""What a picture shows, in words; it needs no engine."""

from __future__ import annotations

__all__ = ["view_message"]


def view_message(view: tuple[float, float, float, float]) -> str:
    """Say which part of the world a picture shows.

    Args:
        view: x_min, x_max, y_min, y_max [m], the part of the world that it shows.
    """
    x0, x1, y0, y1 = view
    return f"shows only x {x0:g}..{x1:g} m, y {y0:g}..{y1:g} m, as plot.viewpoint centres the view"
