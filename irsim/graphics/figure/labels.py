"""The labels of a figure: texts at the things that they name, placed so that none covers another."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import compress

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patheffects import AbstractPathEffect, withStroke
from matplotlib.text import Text
from matplotlib.transforms import IdentityTransform, Transform

from irsim.common.arrays import Floats
from irsim.graphics.figure.canvas import rgba
from irsim.graphics.figure.glyphs import Glyphs, QuickText
from irsim.graphics.scene.labels import bodies_by_size, free_places, leader
from irsim.graphics.scene.scene import Bounds, Label, Scene

__all__ = ["LabelLayer", "printable"]

_LABEL_MARGIN_PX = 4.0
"""Distance that labels keep from the edge of the axes [px]."""
_LABEL_ZORDER_STEP = 0.01
"""Added to the zorder of labels, so that they cover marks of the same zorder."""
MAX_CACHED_EXTENTS = 2000
"""Number of label sizes after which the cache of label sizes is emptied."""
_HALO_WIDTH_PT = 2.0
_PAGE_PARTS = ("title", "outcome", "facts", "scale", "legend")
"""Labels on the page around the world."""
_NAMING_PARTS = ("name", "goal")
"""Labels that stand beside the thing that they name, with a line to it if they have no room there."""
_LEADER_COLOR = "#555555"
_LEADER_WIDTH_PT = 0.7
_LEADER_ZORDER = 9.5


class LabelLayer:
    """The labels of one figure.

    Args:
        figure: The figure.
        ax: Its axes.
        glyphs: Drawn letters, which texts share.
        halo: Give labels a white outline, so that they can be read on dark ground, move them away from bodies, and
            connect a label that stands away from its thing with it.
        placed: Labels have been placed already and stay where they are.

    Attributes:
        versions: Text on the page around the world -> number of changes, and of scenes since the last one.
    """

    def __init__(self, figure: Figure, ax: Axes, glyphs: Glyphs, *, halo: bool, placed: bool = False) -> None:
        self._placed = placed
        self.figure, self.ax = figure, ax
        self._glyphs, self._halo = glyphs, halo
        self._effects: list[AbstractPathEffect] = (
            [withStroke(linewidth=_HALO_WIDTH_PT, foreground="white")] if halo else []
        )
        self._texts: dict[tuple[int, str], QuickText] = {}
        self._known: dict[tuple[int, str], Label] = {}
        self.versions: dict[Artist, tuple[int, int]] = {}
        self._leaders: LineCollection | None = None
        self._extents: dict[tuple[str, float, float], Bounds] = {}

    def show(self, scene: Scene) -> None:
        """Bring the labels up to date, and place them."""
        labels = scene.labels
        if not labels and not self._texts:
            return
        shown: dict[tuple[int, str], tuple[Label, QuickText]] = {}
        anchors, seen = self._anchors(labels)
        for label in compress(labels, seen):
            key = label.object, label.part
            text = self._texts.get(key)
            if text is None:
                text = self._texts[key] = QuickText(self._glyphs, parse_math=False, clip_on=False)
                text.set_path_effects(self._effects)
                self.ax.add_artist(text)
            shown[key] = label, text
            if not text.get_visible():
                text.set_visible(True)
            before = self._known.get(key)
            changed = not self._placed or before is not label
            if changed:
                self._known[key] = label
                _change(text, before, label)
            if label.part in _PAGE_PARTS:
                text.covers = True
                version, resting = self.versions.get(text, (0, 0))
                self.versions[text] = (version + 1, 0) if changed else (version, resting + 1)
        for key, text in self._texts.items():
            if key not in shown and text.get_visible():
                text.set_visible(False)
        if shown and not self._placed:
            self._place(list(shown.values()), np.array(list(compress(anchors, seen))), scene)
        elif self._leaders is not None:
            self._leaders.set_segments([])

    def _anchors(self, labels: Sequence[Label]) -> tuple[list[tuple[float, float]], list[bool]]:
        """Places of the anchors of labels [px], and which of them are in view."""
        (xx, xy, left), (yx, yy, low), _ = self.ax.transData.get_matrix().tolist()
        x0, y0, x1, y1 = map(float, self.ax.bbox.extents)
        anchors = [(xx * x + xy * y + left, yx * x + yy * y + low) for x, y in (label.anchor for label in labels)]
        return anchors, [x0 <= x <= x1 and y0 <= y <= y1 for x, y in anchors]

    def _place(self, shown: list[tuple[Label, QuickText]], anchors: Floats, scene: Scene) -> None:
        """Shift labels that the edge of the axes would cut or that would cover another label.

        Goal labels give way to all others. With halo, a label that stands away from its thing gets a line to it.
        """
        order = sorted(range(len(shown)), key=lambda i: shown[i][0].part == "goal")
        labels, texts = [shown[i][0] for i in order], [shown[i][1] for i in order]
        anchors = anchors[order]
        view, data = self.ax.bbox, self.ax.transData
        starts = data.transform([text.get_position() for text in texts])
        boxes = np.array([self._extent_of(text) for text in texts]) + np.concatenate([starts, starts], axis=1)
        margin = _LABEL_MARGIN_PX * np.array([1.0, 1.0, -1.0, -1.0])
        names = np.array([self._halo and label.part in _NAMING_PARTS for label in labels])
        lifts = np.zeros_like(starts)  # the descenders of a name stand above its body, too
        lifts[names, 1] = np.maximum(starts[names, 1] - boxes[names, 1], 0.0)
        boxes += np.concatenate([lifts, lifts], axis=1)
        half = np.maximum(np.abs(boxes[:, :2] - anchors), 1.0)
        things = np.concatenate([anchors - half, anchors + half], axis=1)

        def bodies() -> tuple[Floats, Floats]:
            small, walls = bodies_by_size(scene)
            return _in_pixels(small, data), _in_pixels(walls, data)

        moves = free_places(boxes, things, np.array(view.extents) + margin, bodies, clear=self._halo)
        moved = data.inverted().transform(starts + lifts + moves)
        for text, move, (x, y) in zip(texts, (lifts + moves).tolist(), moved.tolist(), strict=True):
            if move != [0.0, 0.0]:
                text.set_position((x, y))
        if self._halo:
            placed = boxes + np.concatenate([moves, moves], axis=1)
            self._show_leaders([leader(placed[i], things[i]) for i in np.flatnonzero(names)])

    def _show_leaders(self, lines: list[Floats | None]) -> None:
        """Draw thin lines [px] from labels to the things that they name."""
        if self._leaders is None:
            self._leaders = LineCollection(
                [],
                colors=_LEADER_COLOR,
                linewidths=_LEADER_WIDTH_PT,
                zorder=_LEADER_ZORDER,
                transform=IdentityTransform(),
            )
            self.ax.add_collection(self._leaders, autolim=False)
        self._leaders.set_segments([line for line in lines if line is not None])

    def _extent_of(self, text: Text) -> Bounds:
        """Return left, bottom, right and top of a label relative to its position [px]."""
        key = text.get_text(), float(text.get_fontsize()), float(self.figure.dpi)
        extent = self._extents.get(key)
        if extent is None:
            if len(self._extents) >= MAX_CACHED_EXTENTS:
                self._extents.clear()
            box = text.get_window_extent(self.figure.canvas.get_renderer())  # type: ignore[attr-defined] # of Agg
            x, y = self.ax.transData.transform(text.get_position())
            extent = self._extents[key] = float(box.x0 - x), float(box.y0 - y), float(box.x1 - x), float(box.y1 - y)
        return extent


def _look(label: Label) -> tuple[object, ...]:
    return label.color, label.size, label.alpha, label.zorder, label.bold, label.italic, label.halo


def _change(text: QuickText, before: Label | None, label: Label) -> None:
    """Let a text show a label; most labels only move, or say another time."""
    text.move(label.x, label.y)
    if before is None or before.text != label.text:
        text.set_text(printable(label.text))
    if before is not None and _look(before) == _look(label):
        return
    text.set_color(rgba(label.color))
    text.set_fontsize(label.size)
    text.set_alpha(label.alpha)
    text.set_zorder(label.zorder + _LABEL_ZORDER_STEP)
    text.set_fontweight("bold" if label.bold else "normal")
    text.set_fontstyle("italic" if label.italic else "normal")
    text.halo = None if label.halo is None else (rgba(label.halo[0]), label.halo[1])


def _in_pixels(boxes: list[Bounds], data: Transform) -> Floats:
    """Transform (K, 4) boxes in the world to pixels."""
    corners = np.array(boxes, dtype=np.float64).reshape(-1, 2)
    return np.asarray(data.transform(corners), dtype=np.float64).reshape(-1, 4)


def printable(text: str) -> str:
    """Replace control characters, which fonts lack, by spaces."""
    return "".join(character if character.isprintable() or character == "\n" else " " for character in text)
