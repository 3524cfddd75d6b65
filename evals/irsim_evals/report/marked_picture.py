"""A picture with axes and with the places that failed assertions are about, as inline SVG."""

from __future__ import annotations

import math
from collections.abc import Sequence

from irsim_evals.grader.outcome import Mark
from irsim_evals.report.html_text import escaped
from irsim_evals.report.pictures import Drawn

__all__ = ["marked_picture"]

NumberedMark = tuple[int, Mark]
"""Number of an assertion, and a mark of it."""

_LEFT, _BELOW, _ABOVE, _RIGHT = 30, 18, 6, 10
"""Margins for the axes [px]."""
_MAX_MARKS = 40
_MAX_TEXT = 24
"""Characters of the text beside a mark."""
_RING = 11
"""Radius of the ring round a point [px]."""
_TICKS = 5
"""Labels along an axis, about."""


def marked_picture(name: str, drawn: Drawn, marks: Sequence[NumberedMark], caption: str) -> str:
    """A figure. The page's script puts the picture called ``name`` into it when the figure is first seen."""
    (x0, x1, y0, y1), (width, height) = drawn.extent, drawn.size
    whole_width, whole_height = width + _LEFT + _RIGHT, height + _ABOVE + _BELOW
    body, outside = _marks(drawn, marks[:_MAX_MARKS])
    label = f"{caption}. The world reaches from x = {x0:g} to {x1:g} m and from y = {y0:g} to {y1:g} m."
    notes = [f"{outside} marks lie outside of the picture."] if outside else []
    if len(marks) > _MAX_MARKS:
        notes.append(f"{len(marks) - _MAX_MARKS} more marks are left out.")
    note = f' <span class="note">{" ".join(notes)}</span>' if notes else ""
    return (
        f'<figure><svg viewBox="0 0 {whole_width} {whole_height}" width="{whole_width}" height="{whole_height}" '
        f'role="img" aria-label="{escaped(label)}">'
        f'<rect class="paper" x="{_LEFT}" y="{_ABOVE}" width="{width}" height="{height}"/>'
        f'<image data-picture="{escaped(name)}" x="{_LEFT}" y="{_ABOVE}" width="{width}" height="{height}"/>'
        f"{_axes(drawn)}{body}</svg><figcaption>{escaped(caption)}{note}</figcaption></figure>"
    )


def _spot(drawn: Drawn, x: float, y: float) -> tuple[float, float]:
    x0, x1, y0, y1 = drawn.extent
    width, height = drawn.size
    return _LEFT + (x - x0) / (x1 - x0) * width, _ABOVE + (y1 - y) / (y1 - y0) * height


def _axes(drawn: Drawn) -> str:
    x0, x1, y0, y1 = drawn.extent
    width, height = drawn.size
    bottom = _ABOVE + height
    parts = [f'<rect class="frame" x="{_LEFT}" y="{_ABOVE}" width="{width}" height="{height}"/>']
    for value in _ticks(x0, x1):
        at = _spot(drawn, value, y0)[0]
        parts.append(f'<path class="tick" d="M{at:.1f} {bottom}v4"/>')
        parts.append(f'<text class="axis" x="{at:.1f}" y="{bottom + 15}" text-anchor="middle">{value:g}</text>')
    for value in _ticks(y0, y1, max(2, round(_TICKS * height / max(width, height)))):
        at = _spot(drawn, x0, value)[1]
        parts.append(f'<path class="tick" d="M{_LEFT} {at:.1f}h-4"/>')
        parts.append(f'<text class="axis" x="{_LEFT - 6}" y="{at + 4:.1f}" text-anchor="end">{value:g}</text>')
    return "".join(parts)


def _ticks(low: float, high: float, count: int = _TICKS) -> list[float]:
    """Round numbers between two values."""
    raw = (high - low) / count
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= raw * (1 - 1e-9))
    first = math.ceil(low / step - 1e-9)
    return [round(k * step, 10) + 0.0 for k in range(first, math.floor(high / step + 1e-9) + 1)]


def _marks(drawn: Drawn, marks: Sequence[NumberedMark]) -> tuple[str, int]:
    """The marks, and how many lie outside.

    Those at one place are drawn once, with one label. If all marks of an assertion have the same text, one shows it.
    """
    places: dict[tuple[tuple[int, int], ...], list[NumberedMark]] = {}
    outside = 0
    texts_of: dict[int, set[str]] = {}
    for number, mark in marks:
        texts_of.setdefault(number, set()).add(mark.text)
        points = [_spot(drawn, p[0], p[1]) for p in mark.points if len(p) >= 2 and _is_place(p)]
        if any(_is_inside(drawn, point) for point in points):
            places.setdefault(tuple((round(x), round(y)) for x, y in points), []).append((number, mark))
        else:
            outside += 1
    named: set[int] = set()
    parts = []
    for place, here in places.items():
        untold = [(k, mark.text) for k, mark in here if mark.text and (k not in named or len(texts_of[k]) > 1)]
        numbers = {number for number, _ in here}
        named |= numbers
        parts.append(_shape(drawn, place, sorted(numbers), list(dict.fromkeys(text for _, text in untold))))
    return "".join(parts), outside


def _shape(drawn: Drawn, points: Sequence[tuple[int, int]], numbers: Sequence[int], texts: Sequence[str]) -> str:
    """A ring round a point, or a line; its numbers and text are beside it, on the side that has space."""
    if len(points) > 1:
        form = f'polyline points="{" ".join(f"{x},{y}" for x, y in points)}"'
    else:
        form = f'circle cx="{points[0][0]}" cy="{points[0][1]}" r="{_RING}"'
    shape = [f'<{form} class="{kind}"/>' for kind in ("halo", "mark")]
    x, y = next(point for point in points if _is_inside(drawn, point))
    more = f" +{len(texts) - 1}" if len(texts) > 1 else ""
    text = escaped(f"{', '.join(map(str, numbers))} {texts[0] if texts else ''}".strip(), _MAX_TEXT) + more
    left = x - _LEFT > drawn.size[0] / 2
    above = y - _ABOVE > 2 * _RING
    place = f'x="{x - 9 if left else x + 9}" y="{y - 10 if above else y + 20}"'
    anchor = ' text-anchor="end"' if left else ""
    return f'{"".join(shape)}<text class="marktext" {place}{anchor}>{text}</text>'


def _is_inside(drawn: Drawn, point: tuple[float, float]) -> bool:
    return -1 <= point[0] - _LEFT <= drawn.size[0] + 1 and -1 <= point[1] - _ABOVE <= drawn.size[1] + 1


def _is_place(point: Sequence[float]) -> bool:
    return all(math.isfinite(value) and abs(value) < 1e6 for value in point[:2])
