"""Scenes that irsim writes for other programs come back as maps with the same occupied area."""

from __future__ import annotations

import pytest

from tests.bridges.maps.round_trips import MAP, SHAPES, WALLS, differing_share


@pytest.mark.parametrize("scene", [SHAPES, WALLS, MAP], ids=["shapes", "walls", "map"])
def test_worlds_of_gazebo_come_back(scene) -> None:
    assert differing_share(scene, "out/world.sdf", to="sdf", thick=0.02, wall=0.1) <= 0.01


@pytest.mark.parametrize("scene", [SHAPES, WALLS, MAP], ids=["shapes", "walls", "map"])
def test_models_of_mujoco_come_back(scene) -> None:
    assert differing_share(scene, "out.xml", to="mjcf", thick=0.01, wall=0.1) <= 0.01
