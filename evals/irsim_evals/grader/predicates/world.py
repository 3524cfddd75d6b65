"""``world``: size, origin, times and modes of the world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import model_validator

from irsim_evals.grader.matching import Kind, Match, matches, show
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene

KINDS: dict[str, Kind] = {
    "width": "length",
    "height": "length",
    "left": "length",
    "bottom": "length",
    "step_time": "time",
    "sample_time": "time",
    "time_limit": "time",
    "control_mode": "name",
    "collision_mode": "name",
    "step_mode": "name",
    "boundary": "name",
    "seed": "count",
    "fog_map": "flag",
    "fog_map_resolution": "size",
    "map": "name",
}
"""Property of the world → what it measures."""


@register("world")
class World(ScenePredicate):
    """The world has some properties: ``width``, ``height``, ``left``, ``bottom`` (its lower left corner), …"""

    has: dict[str, Match]
    """Property → accepted values."""

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> Any:
        """The properties may be written without ``has``."""
        found = handler.resolve_ref_schema(handler(core_schema))
        return {**found["properties"]["has"], "description": found.get("description", "")}

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return value if isinstance(value, dict) and set(value) == {"has"} else {"has": value}

    @model_validator(mode="after")
    def _known(self) -> World:
        for name in self.has:
            if name not in KINDS:
                raise ValueError(f"no property of the world is called {name!r}; there are {', '.join(KINDS)}")
        return self

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Compare them."""
        values = {name: _value(scene, name) for name in self.has}
        off = [name for name, match in self.has.items() if not matches(match, values[name], KINDS[name])]
        expected = ", ".join(f"{name} {match.words()}" for name, match in self.has.items())
        observed = ", ".join(f"{name} {show(value)}" for name, value in values.items())
        return Observation(not off, expected, observed, f"world.{_KEYS.get(off[0], off[0])}" if off else None)


_KEYS = {"left": "offset", "bottom": "offset", "map": "obstacle_map"}


def _value(scene: Scene, name: str) -> Any:
    world = scene.world
    if name in ("left", "bottom"):
        return scene.bounds[0 if name == "left" else 1]
    if name == "map":
        given = world.obstacle_map
        return None if given is None else str(getattr(given, "name", given))
    return getattr(world, name)
