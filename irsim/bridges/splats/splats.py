"""Gaussian splats as arrays: fuzzy ellipsoids that together show a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.frames import quaternion_of
from irsim.common.arrays import Floats

__all__ = ["Singles", "Splats", "covariance_of", "join_splats", "moved", "rotation_matrices", "scale_of"]

Singles = NDArray[np.float32]
"""Array of floats in single precision, which halves the memory of millions of splats."""


@dataclass(frozen=True)
class Splats:
    """N fuzzy ellipsoids.

    Attributes:
        center: (N, 3) centers, frame of the scene.
        scale: (N, 3) standard deviations along the axes of each splat, in the unit of the scene.
        rotation: (N, 4) unit quaternions w, x, y, z of their axes.
        opacity: (N,) from 0 to 1.
        color: (N, 3) red, green, blue; without a view direction, from 0 to 1 if the file is a usual one.
        harmonics: (N, K, 3) coefficients of spherical harmonics of the degrees 1 to 3 (K is 3, 8 or 15), which change
            the color with the view direction in the frame of the scene; None without any.
    """

    center: Singles
    scale: Singles
    rotation: Singles
    opacity: Singles
    color: Singles
    harmonics: Singles | None = None

    def __len__(self) -> int:
        return len(self.opacity)

    def take(self, rows: NDArray[Any]) -> Splats:
        """Some of the splats, chosen by flags or indices."""
        harmonics = None if self.harmonics is None else self.harmonics[rows]
        return Splats(
            self.center[rows], self.scale[rows], self.rotation[rows], self.opacity[rows], self.color[rows], harmonics
        )


def rotation_matrices(quaternion: Singles) -> Singles:
    """(N, 3, 3) rotations of unit quaternions (N, 4) w, x, y, z."""
    w, x, y, z = np.moveaxis(quaternion, -1, 0)
    result = np.empty((*quaternion.shape[:-1], 3, 3), dtype=np.float32)
    result[..., 0, 0] = 1 - 2 * (y * y + z * z)
    result[..., 0, 1] = 2 * (x * y - w * z)
    result[..., 0, 2] = 2 * (x * z + w * y)
    result[..., 1, 0] = 2 * (x * y + w * z)
    result[..., 1, 1] = 1 - 2 * (x * x + z * z)
    result[..., 1, 2] = 2 * (y * z - w * x)
    result[..., 2, 0] = 2 * (x * z - w * y)
    result[..., 2, 1] = 2 * (y * z + w * x)
    result[..., 2, 2] = 1 - 2 * (x * x + y * y)
    return result


def covariance_of(scale: Singles, quaternion: Singles, linear: Floats | None = None) -> Singles:
    """(N, 3, 3) covariances of splats, after a linear map (3, 3) of space if one is given."""
    axes = rotation_matrices(quaternion)
    if linear is not None:
        axes = linear.astype(np.float32) @ axes
    stretched = axes * scale[:, None, :]
    result: Singles = stretched @ np.swapaxes(stretched, 1, 2)
    return result


def scale_of(transform: Floats) -> float:
    """Factor by which a transform (4, 4) stretches lengths."""
    return float(np.cbrt(abs(np.linalg.det(transform[:3, :3]))))


def moved(splats: Splats, transform: Floats) -> Splats:
    """Splats in another frame; colors that change with the view direction lose that change.

    Args:
        splats: The splats.
        transform: (4, 4) rotation, reflection, uniform scale and shift.
    """
    factor = scale_of(transform)
    turn = transform[:3, :3] / factor
    axes = turn @ rotation_matrices(splats.rotation).astype(np.float64)
    if np.linalg.det(turn) < 0:  # an ellipsoid looks the same with one of its axes reversed
        axes[:, :, 2] *= -1
    x, y, z, w = np.moveaxis(quaternion_of(axes), -1, 0)
    center = splats.center @ transform[:3, :3].T + transform[:3, 3]
    return Splats(
        center.astype(np.float32),
        (splats.scale * factor).astype(np.float32),
        np.stack([w, x, y, z], axis=-1).astype(np.float32),
        splats.opacity,
        splats.color,
    )


def join_splats(parts: Sequence[Splats]) -> Splats:
    """All splats of several groups, in order; groups without harmonics get zeros where others have some."""
    terms = max((0 if part.harmonics is None else part.harmonics.shape[1] for part in parts), default=0)
    harmonics = None
    if terms:
        harmonics = np.zeros((sum(map(len, parts)), terms, 3), dtype=np.float32)
        at = 0
        for part in parts:
            if part.harmonics is not None:
                harmonics[at : at + len(part), : part.harmonics.shape[1]] = part.harmonics
            at += len(part)
    names = ("center", "scale", "rotation", "opacity", "color")
    center, scale, rotation, opacity, color = (
        np.concatenate([getattr(part, name) for part in parts]) for name in names
    )
    return Splats(center, scale, rotation, opacity, color, harmonics)
