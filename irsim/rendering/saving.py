"""Saved pictures of an environment: files of single figures, and frames of its animation."""

from __future__ import annotations

import io
from collections.abc import Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, Protocol

import matplotlib
from PIL import Image

from irsim.common.files import replacing
from irsim.diagnostics.diagnostic import nearest
from irsim.graphics.encoding.picture_files import picture_path
from irsim.graphics.encoding.pixels import Pixels, from_image
from irsim.graphics.encoding.png import png_bytes
from irsim.graphics.figure.canvas import Box
from irsim.graphics.figure.figure import SceneFigure
from irsim.graphics.figure.layers import hint_colors, opaque_colors
from irsim.graphics.scene.scene import Scene
from irsim.rendering.recording import Pictured, Recording

__all__ = ["LivePlot", "Saving", "saved_figure_options"]

_PAD_INCHES = 0.1
"""Margin around tight pictures [inch], as in Matplotlib."""
_SAVE_OPTIONS = frozenset(
    [
        "dpi",
        "bbox_inches",
        "pad_inches",
        "transparent",
        "facecolor",
        "edgecolor",
        "metadata",
        "bbox_extra_artists",
        "pil_kwargs",
        "orientation",
        "papertype",
        "backend",
    ]
)
"""Options of Matplotlib's ``savefig`` that a saved figure may have."""
_QUICK_OPTIONS = frozenset({"dpi", "bbox_inches", "pad_inches"})
"""Options that the canvas itself can serve, without ``savefig``."""


_VECTOR_OPTIONS: dict[Any, Any] = {"svg.fonttype": "none", "svg.hashsalt": "irsim", "pdf.fonttype": 42}
"""In vector graphics text stays text, and the same picture is the same file."""


class LivePlot(Protocol):
    """The part of a plot that saving uses."""

    env: Pictured
    saved_figure_kwargs: dict[str, Any]

    @property
    def tokens(self) -> list[str] | None:
        """Colours of the theme of the style `modern`; None in other styles."""

    def made_figure(self) -> SceneFigure:
        """Return the figure, which is made when it is first needed."""

    def synced_figure(self) -> SceneFigure:
        """Return the figure with its artists brought up to date."""

    def as_shown(self) -> AbstractContextManager[None]:
        """Draw and read the artists as they are, without bringing them up to date."""

    def note_drawn(self) -> None:
        """Note that the canvas shows what the artists show."""

    def scene(self) -> Scene:
        """Return what the picture shows, as data."""


class Saving:
    """Saves pictures of one plot.

    Args:
        plot: The plot.
        format: Format of file names without suffix; None for the default.

    Attributes:
        recording: The frames of its animation.
        size: Width and height of the last saved picture [px]; None before the first.
    """

    def __init__(self, plot: LivePlot, format: str | None) -> None:
        self.recording = Recording(plot.env)
        self.size: tuple[int, int] | None = None
        self._plot, self._format = plot, format

    def pixels(self, options: Mapping[str, Any] | None = None) -> tuple[Pixels, tuple[int, int, int, int] | None]:
        """Draw the present picture.

        Args:
            options: Options of ``savefig`` that replace the defaults of saved figures.

        Returns:
            The pixels, and the box (left, top, right, bottom) [px] that they were cut from, if they were cut.
        """
        plot = self._plot
        wanted = {**plot.saved_figure_kwargs, **(options or {})}
        figure = plot.synced_figure()
        tight = wanted.get("bbox_inches") == "tight"
        with plot.as_shown():
            if _is_quick(wanted, figure.figure.dpi):
                plot.note_drawn()
                return figure.pixels(tight=tight, pad_inches=wanted.get("pad_inches", _PAD_INCHES))
            data = io.BytesIO()
            figure.figure.savefig(data, **{**wanted, "format": "png"})
        with Image.open(data) as image:
            return from_image(image), None

    def save_figure(
        self, save_name: str | Path | None, *, include_index: bool, save_gif: bool, options: dict[str, Any]
    ) -> Path:
        """Save the present picture; see :meth:`irsim.rendering.env_plot.EnvPlot.save_figure`."""
        plot, env = self._plot, self._plot.env
        wanted = options.pop("format", None)
        self._keep_options(options)
        count = int(env.simulation.count[0])
        path = picture_path(
            env.path_param.ani_buffer_path if save_gif else env.path_param.fig_path,
            save_name,
            env.simulation.scenario.name,
            count=count if include_index or save_gif else None,
            format=wanted,
            default_format=self._format,
        )
        figure = plot.made_figure()
        with replacing(path) as temporary:
            if path.suffix == ".png" and _is_quick(plot.saved_figure_kwargs, figure.figure.dpi):
                pixels, _ = self.pixels()
                temporary.write_bytes(png_bytes(pixels, figure.figure.dpi))
                self.size = pixels.shape[1], pixels.shape[0]
            else:
                plot.synced_figure()
                with plot.as_shown(), matplotlib.rc_context(_VECTOR_OPTIONS if plot.tokens is not None else {}):
                    figure.figure.savefig(temporary, format=path.suffix[1:], **plot.saved_figure_kwargs)
        if save_gif and count != self.recording.last_count:
            self.add_frame({})
        return path

    def add_frame(self, options: Mapping[str, Any]) -> None:
        """Store the present picture for the animation; all frames are cut like the first."""
        self._keep_options(options)
        plot = self._plot
        kwargs, crop = plot.saved_figure_kwargs, self.recording.crop
        if crop is not None and _is_quick(kwargs, plot.made_figure().figure.dpi):
            figure = plot.synced_figure()
            with plot.as_shown():
                figure.draw()
                pixels = figure.compositor.pixels(crop)
            plot.note_drawn()
            changed = _cut(figure.compositor.take_changes(), crop)
        else:
            pixels, self.recording.crop = self.pixels()
            changed = None
            plot.made_figure().compositor.take_changes()
        self.recording.add(pixels, self._colors, changed)
        self.size = pixels.shape[1], pixels.shape[0]

    def _keep_options(self, options: Mapping[str, Any]) -> None:
        """Refuse misspelt options, then keep the options for later saves."""
        for name in options:
            if name not in _SAVE_OPTIONS:
                near = nearest(name, _SAVE_OPTIONS)
                hint = f"did you mean {near!r}?" if near else f"known are {', '.join(sorted(_SAVE_OPTIONS))}"
                raise TypeError(f"unknown option {name!r} of a saved figure; {hint}")
        self._plot.saved_figure_kwargs.update(options)

    def _colors(self) -> list[tuple[int, int, int]]:
        """Return the colours that a reduced palette must keep: opaque bodies, paper and ink."""
        tokens = self._plot.tokens
        return opaque_colors(self._plot.scene()) if tokens is None else hint_colors(self._plot.scene(), tokens)


def _cut(boxes: list[Box] | None, crop: Box) -> list[Box] | None:
    """Move boxes of a canvas into a part that is cut out of it."""
    left, top = crop[:2]
    return boxes and [(x0 - left, y0 - top, x1 - left, y1 - top) for x0, y0, x1, y1 in boxes]


def saved_figure_options(options: Any) -> dict[str, Any]:
    """Return the options of ``savefig`` that a scenario sets.

    Args:
        options: The plot options of its world.
    """
    values: dict[str, Any] = options.saved_figure.model_dump(exclude_unset=True)
    return {key: value for key, value in values.items() if value is not None or key == "bbox_inches"}


def _is_quick(options: Mapping[str, Any], dpi: float) -> bool:
    """Whether the canvas can serve these options of ``savefig`` as it is."""
    same_dpi = options.get("dpi") in (dpi, "figure", None)
    return same_dpi and set(options) <= _QUICK_OPTIONS and options.get("bbox_inches") in ("tight", None)
