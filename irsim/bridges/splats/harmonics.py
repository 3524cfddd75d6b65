"""Colors that change with the view direction: real spherical harmonics of the degrees 1 to 3."""

from __future__ import annotations

import numpy as np

from irsim.bridges.splats.splats import Singles

__all__ = ["colors_seen"]


def colors_seen(color: Singles, harmonics: Singles | None, direction: Singles) -> Singles:
    """Colors as they are seen.

    Args:
        color: (N, 3) colors without a view direction.
        harmonics: (N, K, 3) coefficients; None without any.
        direction: (N, 3) unit vectors from the camera to the splats, frame of the scene.

    Returns:
        (N, 3) colors, not below 0.

    References:
        The constants and signs are those of the real harmonics without the Condon-Shortley phase, with y, z, x as the
        order of degree 1 and alternating signs, as Kerbl et al. (2023) write them to files.
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
    found: Singles = np.maximum(color + np.einsum("nk,nkc->nc", weights, harmonics[:, : len(terms)]), 0)
    return found
