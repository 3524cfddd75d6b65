"""Signs of pictures: their shapes fit whatever body they are in."""

from __future__ import annotations

import math

import pytest

from irsim.graphics.scene.glyphs import DART, long_dart


@pytest.mark.parametrize(("width", "length"), [(0.5, 1.0), (1.0, 0.5), (0.0, 0.2), (0.0, 0.0), (1e-300, 1e300)])
def test_a_dart_stays_within_its_body(width: float, length: float) -> None:
    points = long_dart(width, length)
    assert len(points) == len(DART)
    assert all(math.isfinite(x) and math.isfinite(y) for x, y in points)
    assert max(abs(y) for _, y in points) <= width
    assert max(x for x, _ in points) <= length
