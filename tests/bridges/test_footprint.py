"""Boxes around footprints."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irsim.bridges.solids import BoundingBox, box_of
from irsim.common.outline import Circle, Line, Polygon
from irsim.simulation.scene import SceneObject


def _agent(*parts: Any) -> SceneObject:
    return SceneObject(0, "a", "robot", None, True, (0, 0, 0), (), parts, 0.5, (), (), (), None, 1.0, (0, 0, 0))


@pytest.mark.parametrize(
    ("parts", "box"),
    [
        ((Circle((0.0, 0.0), 0.2),), BoundingBox(0, 0, 0.4, 0.4)),
        ((Polygon(np.array([[-1.0, -1], [3, -1], [3, 1], [-1, 1]])),), BoundingBox(1, 0, 4, 2)),
        ((Circle((0.0, 1.0), 0.5), Circle((2.0, 0.0), 0.5)), BoundingBox(1, 0.5, 3, 2)),
        ((Line(np.array([[0.0, 0], [4, 0]])),), BoundingBox(2, 0, 4, 0.01)),
        ((), BoundingBox(0, 0, 1, 1)),
    ],
)
def test_box(parts: Any, box: BoundingBox) -> None:
    assert vars(box_of(_agent(*parts))) == pytest.approx(vars(box))
