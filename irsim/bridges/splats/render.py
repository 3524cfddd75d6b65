"""Pictures of splats, made on the CPU with NumPy: for key frames, small films and tests.

Each splat is projected to an ellipse with a normal distribution (elliptical weighted average), and the ellipses are
blended from front to back. Source: Zwicker, Pfister, van Baar, Gross: EWA Splatting (2002), and Kerbl et al. (2023).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.frames import inverse
from irsim.bridges.splats.splats import Singles, Splats, covariance_of
from irsim.common.arrays import Floats

__all__ = ["View", "colors_seen", "picture"]


def colors_seen(color: Singles, harmonics: Singles | None, direction: Singles) -> Singles:
    """Colors as they are seen.

    Args:
        color: (N, 3) colors without a view direction.
        harmonics: (N, K, 3) coefficients; None without any.
        direction: (N, 3) unit vectors from the camera to the splats, frame of the scene.

    Returns:
        (N, 3) colors, not below 0.

    References:
        The constants and signs follow the real harmonics without the Condon-Shortley phase, with y, z, x as the order
        of degree 1 and alternating signs, as Kerbl et al. (2023) write them to files.
    """
    if harmonics is None:
        return np.maximum(color, 0)
    x, y, z = (direction[:, axis] for axis in range(3))
    terms = [-0.4886025119029199 * y, 0.4886025119029199 * z, -0.4886025119029199 * x]
    if harmonics.shape[1] >= 8:
        terms += [
            1.0925484305920792 * x * y,
            -1.0925484305920792 * y * z,
            0.31539156525252005 * (2 * z * z - x * x - y * y),
            -1.0925484305920792 * x * z,
            0.5462742152960396 * (x * x - y * y),
        ]
    if harmonics.shape[1] >= 15:
        terms += [
            -0.5900435899266435 * y * (3 * x * x - y * y),
            2.890611442640554 * x * y * z,
            -0.4570457994644658 * y * (4 * z * z - x * x - y * y),
            0.3731763325901154 * z * (2 * z * z - 3 * x * x - 3 * y * y),
            -0.4570457994644658 * x * (4 * z * z - x * x - y * y),
            1.445305721320277 * z * (x * x - y * y),
            -0.5900435899266435 * x * (x * x - 3 * y * y),
        ]
    weights = np.stack(terms, axis=1)
    result: Singles = np.maximum(color + np.einsum("nk,nkc->nc", weights, harmonics[:, : len(terms)]), 0)
    return result


_NEAR = 0.05
"""Share of a metre in front of the camera in which nothing is drawn, in the unit of the scene."""
_BLUR = 0.3
"""Variance that each ellipse gains, so that it is not smaller than a pixel [px²]."""
_LEAST = 1 / 255
"""Opacity below which nothing changes in a picture of 8 bits."""
_MOST = 0.99
"""Opacity that a single splat has at most, as in the program that scenes are trained with."""
_FULL = 1e-3
"""Light that still comes through a pixel which counts as full."""
_WIDE = 1.3
"""How far beyond the picture, in half pictures, the slope of the projection is followed; beyond it stays as it is."""
_PAIRS = 3_000_000
"""Pairs of splats and pixels that are blended at once, which bounds the memory."""
_MAX_SIDE = 8192


@dataclass(frozen=True)
class View:
    """A pinhole camera.

    Attributes:
        matrix: (4, 4) rigid camera-to-world matrix in the frame of the scene; the camera looks along z, y is down.
        width, rows: Size of the picture [px].
        focal: Focal length [px].
    """

    matrix: Floats
    width: int
    rows: int
    focal: float


@dataclass(frozen=True)
class _Ellipses:
    """Projected splats from front to back: centers (M, 2) [px], inverse covariances a, b, c (M, 3), opacity, color."""

    center: Singles
    form: Singles
    opacity: Singles
    color: Singles
    box: NDArray[np.int32]
    """(M, 4) first and last column and row."""


def picture(splats: Splats, view: View, background: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> NDArray[np.uint8]:
    """(rows, width, 3) the picture of splats that a camera takes, sRGB values as they are in the file.

    Args:
        splats: The scene, with everything that is to be seen.
        view: The camera.
        background: Red, green, blue where nothing is, from 0 to 1.

    Raises:
        ValueError: The picture is larger than 8192 pixels along a side.
    """
    if not (0 < view.width <= _MAX_SIDE and 0 < view.rows <= _MAX_SIDE):
        raise ValueError(f"a picture has 1 to {_MAX_SIDE} pixels along each side, got {view.width} x {view.rows}")
    result = _project(splats, view)
    pixels = view.width * view.rows
    color = np.zeros((pixels, 3), dtype=np.float64)
    through = np.ones(pixels, dtype=np.float64)
    areas = (result.box[:, 1] - result.box[:, 0] + 1).astype(np.int64) * (result.box[:, 3] - result.box[:, 2] + 1)
    ends = np.cumsum(areas)
    first = 0
    while first < len(areas):
        before = int(ends[first - 1]) if first else 0
        last = max(first + 1, int(np.searchsorted(ends, before + _PAIRS, side="right")))
        _blend(result, first, last, areas[first:last], view.width, color, through)
        first = last
        if through.max() < _FULL:
            break
    color += through[:, None] * np.array(background)
    return np.round(255 * np.clip(color, 0, 1)).astype(np.uint8).reshape(view.rows, view.width, 3)


def _project(splats: Splats, view: View) -> _Ellipses:
    """The ellipses of all splats that are in the picture."""
    to_camera = inverse(view.matrix)
    turn = to_camera[:3, :3].astype(np.float32)
    place = splats.center @ turn.T + to_camera[:3, 3].astype(np.float32)
    half = np.array([view.width, view.rows], dtype=np.float32) / 2
    reach = 3 * splats.scale.max(axis=1)
    depth = place[:, 2]
    slope = half / view.focal
    beside = np.abs(place[:, :2]) - np.maximum(depth, 0)[:, None] * slope
    seen = (depth > _NEAR) & (splats.opacity > _LEAST) & (beside < reach[:, None] * (1 + slope)).all(axis=1)
    rows = np.flatnonzero(seen)
    rows = rows[np.argsort(depth[rows], kind="stable")]
    place, depth = place[rows], depth[rows]
    cover = covariance_of(splats.scale[rows], splats.rotation[rows], to_camera[:3, :3])
    tangent = np.clip(place[:, :2] / depth[:, None], -_WIDE * slope, _WIDE * slope)
    jacobian = np.zeros((len(rows), 2, 3), dtype=np.float32)
    jacobian[:, 0, 0] = jacobian[:, 1, 1] = view.focal / depth
    jacobian[:, :, 2] = -view.focal * tangent / depth[:, None]
    flat = jacobian @ cover @ jacobian.transpose(0, 2, 1)
    xx, xy, yy = flat[:, 0, 0] + _BLUR, flat[:, 0, 1], flat[:, 1, 1] + _BLUR
    area = np.maximum(xx * yy - xy * xy, 1e-12)
    opacity = np.minimum(splats.opacity[rows], _MOST)
    center = view.focal * place[:, :2] / depth[:, None] + half
    # The ellipse on which a splat has the least opacity that counts.
    stretch = np.sqrt(2 * np.log(np.maximum(opacity / _LEAST, 1.0)))
    size = stretch[:, None] * np.sqrt(np.stack([xx, yy], axis=1))
    last = np.array([view.width, view.rows]) - 1
    low = np.clip(np.ceil(center - size - 0.5), 0, last + 1)
    high = np.clip(np.floor(center + size - 0.5), -1, last)
    kept = (high >= low).all(axis=1)
    box = np.stack([low[:, 0], high[:, 0], low[:, 1], high[:, 1]], axis=1)[kept].astype(np.int32)
    rows = rows[kept]
    direction = splats.center[rows] - view.matrix[:3, 3].astype(np.float32)
    direction /= np.maximum(np.linalg.norm(direction, axis=1, keepdims=True), 1e-12)
    harmonics = None if splats.harmonics is None else splats.harmonics[rows]
    form = np.stack([yy / area, -xy / area, xx / area], axis=1)[kept]
    seen_color = colors_seen(splats.color[rows], harmonics, direction)
    return _Ellipses(center[kept], form.astype(np.float32), opacity[kept], seen_color, box)


def _blend(
    ellipses: _Ellipses, first: int, last: int, areas: NDArray[np.int64], width: int, color: Floats, through: Floats
) -> None:
    """Blend some ellipses, which are behind all that were blended before.

    Pairs of an ellipse and a pixel are sorted by pixel; within a pixel they stay in the order of depth, so that the
    light that comes through is a running product.
    """
    which = np.repeat(np.arange(first, last, dtype=np.int32), areas)
    within = np.arange(len(which), dtype=np.int64) - np.repeat(np.cumsum(areas) - areas, areas)
    columns = (ellipses.box[which, 1] - ellipses.box[which, 0] + 1).astype(np.int64)
    down = within // columns
    x = ellipses.box[which, 0] + (within - down * columns).astype(np.int32)
    y = ellipses.box[which, 2] + down.astype(np.int32)
    pixel = y.astype(np.int32) * np.int32(width) + x
    dx = x.astype(np.float32) + np.float32(0.5) - ellipses.center[which, 0]
    dy = y.astype(np.float32) + np.float32(0.5) - ellipses.center[which, 1]
    form = ellipses.form[which]
    power = -0.5 * (form[:, 0] * dx * dx + form[:, 2] * dy * dy) - form[:, 1] * dx * dy
    alpha = ellipses.opacity[which] * np.exp(np.minimum(power, 0))
    kept = np.flatnonzero((alpha >= _LEAST) & (through[pixel] > _FULL))
    if not len(kept):
        return
    kept = kept[np.argsort(pixel[kept], kind="stable")]
    pixel, alpha = pixel[kept], alpha[kept].astype(np.float64)
    begins = np.flatnonzero(np.concatenate([[True], pixel[1:] != pixel[:-1]]))
    lengths = np.diff(np.concatenate([begins, [len(pixel)]]))
    shade = np.log1p(-alpha)
    total = np.cumsum(shade)
    start = np.repeat((total - shade)[begins], lengths)
    light = through[pixel] * np.exp(total - shade - start)
    hues = ellipses.color[which[kept]]
    at = pixel[begins]
    for channel in range(3):
        color[at, channel] += np.add.reduceat(light * alpha * hues[:, channel], begins)
    through[at] *= np.exp(np.add.reduceat(shade, begins))
