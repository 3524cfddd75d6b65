"""A bridge of a package of its own, from one import."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

import pytest
from pydantic import Field

import irsim
from irsim.plugins import BRIDGES, Bridge, BridgeOptions, Feedback, Meters, SceneDescription, WorldState

SCENE = """
world: {width: 9, height: 9}
robot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [8, 1], behavior: {name: dash}}
"""


class Leash(BridgeOptions):
    """Calls robots back that are too far from where they began."""

    name: Literal["leash"] = "leash"
    length: Annotated[Meters, Field(gt=0)] = 1.0
    """Length of the leash."""


class Called(Bridge):
    """Gives the start as a new goal."""

    def __init__(self, options: Leash) -> None:
        self.name, self.options, self.far = "leash", options, False

    def open(self, scene: SceneDescription, start: WorldState) -> None:
        self.start = scene.robots[0].pose

    def push(self, state: WorldState) -> None:
        self.far = self.far or bool(state.pose[0, 0] - self.start[0] > self.options.length)

    def pull(self) -> Feedback | None:
        return Feedback(goals={"robot_0": self.start}) if self.far else None

    def notes(self) -> list[str]:
        return ["the leash was tight"] if self.far else []


@pytest.fixture(autouse=True)
def registered() -> Iterator[None]:
    BRIDGES.register(Leash)(Called)
    yield
    BRIDGES._features.pop("leash")


def test_it_is_a_bridge_like_any_other() -> None:
    result = irsim.run(text=SCENE + "bridges: [{name: leash, length: 0.5}]\n", seed=0, steps=30)
    assert 0.5 < result.robots[0].path_length < 2
    assert result.notes == ["the leash was tight"]


def test_its_options_are_checked() -> None:
    wrong: Any = {"name": "leash", "length": 0}
    with pytest.raises(Exception, match="length"):
        irsim.run(text=SCENE, seed=0, bridges=[wrong])
