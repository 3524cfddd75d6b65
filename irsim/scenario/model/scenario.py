"""The model of a whole scenario file."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from irsim.options.base import Options
from irsim.options.registry import BRIDGES
from irsim.options.selection import Select
from irsim.options.vectors import LIST, MAPPING, any_of
from irsim.scenario.model.entry import Entry
from irsim.scenario.model.gui import Gui, Keyboard, Mouse
from irsim.scenario.model.plot import ObjectPlot
from irsim.scenario.model.world import SavedFigure, WorldModel, WorldPlot

__all__ = ["Entry", "Gui", "Keyboard", "Mouse", "ObjectPlot", "SavedFigure", "Scenario", "WorldModel", "WorldPlot"]


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
