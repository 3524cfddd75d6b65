"""The model of a whole scenario file."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from irsim.options.base import Options
from irsim.options.registry import BRIDGES
from irsim.options.selection import Select
from irsim.options.units import Bool, Count, MetersPerSecond, Number, RadiansPerSecond
from irsim.options.vectors import LIST, MAPPING, OrNull, any_of
from irsim.scenario.model.entry import Entry
from irsim.scenario.model.plot import ObjectPlot
from irsim.scenario.model.world import SavedFigure, WorldModel, WorldPlot

__all__ = ["Entry", "Gui", "Keyboard", "Mouse", "ObjectPlot", "SavedFigure", "Scenario", "WorldModel", "WorldPlot"]


class Keyboard(Options):
    """Keyboard control of one robot; on with `world.control_mode: keyboard` or after pressing the key `x`."""

    backend: Literal["pynput", "mpl"] = "pynput"
    """Where key presses come from: a global listener (package pynput) or the figure window."""
    global_hook: Bool = False
    """With `pynput`: react even when the window is not in front."""
    key_lv_max: Annotated[MetersPerSecond, Field(ge=0)] = 3.0
    """Linear speed while a key is held."""
    key_ang_max: Annotated[RadiansPerSecond, Field(ge=0)] = 1.0
    """Angular speed while a key is held."""
    key_lv: MetersPerSecond = 0.0
    """Initial linear speed."""
    key_ang: RadiansPerSecond = 0.0
    """Initial angular speed."""
    key_rot: RadiansPerSecond = 0.0
    """Initial yaw rate (`omni_angular`)."""
    key_id: Count = 0
    """Index of the robot that the keyboard drives."""


class Mouse(Options):
    """Mouse control of the view."""

    zoom_factor: Annotated[Number, Field(gt=0)] = 1.1
    """Zoom ratio per step of the scroll wheel."""


class Gui(Options):
    """Keyboard and mouse."""

    keyboard: Annotated[Keyboard, OrNull({})] = Keyboard()
    """Keyboard control of a robot."""
    mouse: Annotated[Mouse, OrNull({})] = Mouse()
    """Mouse control of the view."""


class _OneOrList:
    """Type metadata: one entry, or a list of entries."""

    def __init__(self, model: type[Options]) -> None:
        self.model = model

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        item = handler.generate_schema(self.model)
        return core_schema.tagged_union_schema(
            {MAPPING: item, LIST: core_schema.list_schema(item)},
            lambda value: LIST if isinstance(value, (list, tuple)) else MAPPING,
        )

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return any_of(handler(schema))


class Scenario(Options):
    """A scenario: one world with robots and obstacles in it."""

    world: WorldModel = WorldModel()
    """Extent, time, modes and map of the world."""
    robot: Annotated[Any, _OneOrList(Entry)] | None = None
    """Robots: one entry, or a list of entries."""
    obstacle: Annotated[Any, _OneOrList(Entry)] | None = None
    """Obstacles: one entry, or a list of entries. They may move like robots."""
    gui: Gui = Gui()
    """Keyboard and mouse."""
    bridges: list[Annotated[Any, Select(BRIDGES)]] = []
    """Connections to other programs, such as robots or simulators; `irsim run` and `irsim.connect` open them."""
    custom: Any = {}
    """Any data for user code, which reads it as `env.config["custom"]`."""

    def entries(self, role: Literal["robot", "obstacle"]) -> list[tuple[tuple[str | int, ...], Entry]]:
        """The entries of a section, each with its path: ("robot", 0), or ("robot",) if it is written without a list."""
        section = getattr(self, role)
        if section is None:
            return []
        if isinstance(section, Entry):
            return [((role,), section)]
        return [((role, index), entry) for index, entry in enumerate(section)]
