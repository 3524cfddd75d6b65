"""Plots of the site, in the colours of pictures of irsim: one SVG for light pages and one for dark ones."""

from __future__ import annotations

from pathlib import Path

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from realism.validation import Validation

from irsim.graphics.scene.theme import THEMES, Theme

__all__ = ["draw"]

_SIZE, _WIDE = (5.6, 3.6), (5.6, 4.4)
"""Inches; plots of ways in the plane are higher."""
_TONES = ("near", "away", "good", "muted")
"""Colours of the theme, by the tone of a curve."""
_SAME_BYTES = {"svg.hashsalt": "irsim", "svg.fonttype": "path", "path.simplify": True}
"""Options with which the same numbers give the same file."""


def draw(validation: Validation, folder: Path, name: str) -> None:
    """Write ``NAME-light.svg`` and ``NAME-dark.svg`` of a comparison, with a transparent background."""
    folder.mkdir(parents=True, exist_ok=True)
    for theme in THEMES.values():
        with rc_context({**_SAME_BYTES, "font.size": 10}):
            figure = Figure(figsize=_WIDE if validation.paths else _SIZE, layout="constrained")
            axes = figure.subplots()
            _style(axes, theme)
            _fill(axes, validation, theme)
            figure.savefig(
                folder / f"{name}-{theme.name}.svg", transparent=True, metadata={"Date": None, "Creator": None}
            )


def _style(axes: Axes, theme: Theme) -> None:
    """Colour axes, ticks and grid, and leave out the frame above and to the right."""
    axes.grid(color=theme.line, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(colors=theme.muted, which="both")
    for side, spine in axes.spines.items():
        spine.set_color(theme.still_edge)
        spine.set_visible(side in ("left", "bottom"))


def _fill(axes: Axes, validation: Validation, theme: Theme) -> None:
    for curve in validation.lines:
        style = {"linestyle": (0, (4, 3)), "linewidth": 1.2} if curve.faint else {"linewidth": 1.8}
        axes.plot(curve.x, curve.y, color=theme.tokens[_TONES[curve.tone]], label=curve.label or None, **style)
    for curve in validation.points:
        color = theme.tokens[_TONES[curve.tone]]
        axes.plot(curve.x, curve.y, "o", color=color, markersize=4.5, markerfacecolor="none", label=curve.label or None)
    axes.set_xlabel(validation.x, color=theme.ink)
    axes.set_ylabel(validation.y, color=theme.ink)
    if "x" in validation.logarithmic:
        axes.set_xscale("log")
    if "y" in validation.logarithmic:
        axes.set_yscale("log")
    if validation.paths:
        axes.set_aspect("equal", adjustable="datalim")
    legend = axes.figure.legend(
        loc="outside upper left", ncols=2, frameon=False, labelcolor=theme.ink, fontsize=9, borderaxespad=0.2
    )
    legend.set_in_layout(True)
