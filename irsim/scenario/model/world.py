"""The ``world`` section."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, PlainValidator, WithJsonSchema

from irsim.common.arguments import is_number
from irsim.options.base import Options, problem
from irsim.options.colors import Color
from irsim.options.registry import MAPS
from irsim.options.selection import Select
from irsim.options.units import MAX_METERS, Bool, Fraction, Meters, Number, Seconds, Seed
from irsim.options.vectors import OrNull, Point, vector
from irsim.scenario.model.zones import Zone

__all__ = ["SavedFigure", "WorldModel", "WorldPlot"]

Text = Annotated[str, Field(strict=True)]


def _normalize_word(value: Any) -> Any:
    return value.strip().lower() if isinstance(value, str) else value


_VIEWPOINT = {
    "anyOf": [
        {
            "type": "array",
            "items": {"type": "number", "minimum": -MAX_METERS, "maximum": MAX_METERS},
            "minItems": 2,
            "maxItems": 2,
        },
        {"type": "string"},
        {"type": "null"},
    ],
    "x-unit": "m",
}


def _viewpoint(value: Any) -> list[float] | str | None:
    if value is None or isinstance(value, str):
        return value
    if (
        isinstance(value, (list, tuple))
        and len(value) == 2
        and all(is_number(v) and abs(v) <= MAX_METERS for v in value)
    ):
        return [float(v) for v in value]
    raise problem(
        "wrong-type", "a viewpoint must be [x, y] or the name of an object", allowed="[x, y] in metres, or a name"
    )


class SavedFigure(Options):
    """How figures and animation frames are saved."""

    dpi: Annotated[Number, Field(gt=0, le=2400, json_schema_extra={"x-unit": "px/inch"})] = 100
    """Resolution of saved pictures and of the window."""
    bbox_inches: Text | None = "tight"
    """`tight` removes empty margins; null keeps the whole figure."""
    format: Text | None = None
    """File format; null takes it from the file name."""
    transparent: Bool = False
    """Make the background transparent."""
    facecolor: Color | None = None
    """Background colour."""
    edgecolor: Color | None = None
    """Border colour."""
    pad_inches: Annotated[Number, Field(ge=0, json_schema_extra={"x-unit": "inch"})] = 0.1
    """Margin that `bbox_inches: tight` keeps."""
    metadata: dict[str, Any] | None = None
    """Metadata written into the file, if its format allows it."""


class WorldPlot(Options):
    """How the world is drawn."""

    style: Literal["modern", "classic"] | None = None
    """Style of pictures: `modern`, or `classic` as in IR-SIM 2.12; null is `classic` for `env.render()` of programs,
    `modern` for commands and tools."""
    theme: Literal["light", "dark"] = "light"
    """Colours of the style `modern`."""
    fog: Literal["veil", "hide"] = "veil"
    """Fog of the style `modern`: dotted outlines show through it (`veil`), or it covers everything that no sensor has
    seen (`hide`)."""
    figure_pixels: Annotated[list[Annotated[Number, Field(ge=1, le=20_000)]], vector(("px", "px"), 2)] = [1000, 800]
    """Size of the figure: [width, height]."""
    saved_figure: SavedFigure = SavedFigure()
    """How figures and animation frames are saved."""
    show_title: Bool = True
    """Show a title: time and status, or `title`."""
    title: Text | None = None
    """A fixed title instead of time and status."""
    no_axis: Bool = False
    """Hide the axes."""
    tight: Bool = True
    """Fill the whole figure with the world, without margins."""
    show_zones: Bool = False
    """Draw `world.zones` with their names. Snapshots draw them anyway."""
    viewpoint: Annotated[Any, PlainValidator(_viewpoint), WithJsonSchema(_VIEWPOINT)] = None
    """Centre of the view: a point [x, y], or the name of an object to follow."""


class _MapSelect(Select):
    """A selection that also accepts an array from Python."""

    def validate(self, value: Any) -> Any:
        if not isinstance(value, (Mapping, list, tuple)) and hasattr(value, "__array__"):
            return value
        return super().validate(value)


class WorldModel(Options):
    """Extent, time, modes and map of the world."""

    also_called: ClassVar[dict[str, str]] = {
        "dt": "step_time",
        "integrator": "integration",
        "integration_method": "integration",
        "timestep": "step_time",
        "contact_detection": "contacts",
        "continuous_collision": "contacts",
        "swept": "contacts",
        "origin": "offset",
        "map": "obstacle_map",
        "grid_map": "obstacle_map",
        "walls": "boundary",
        "border": "boundary",
        "max_time": "time_limit",
        "duration": "time_limit",
        "horizon": "time_limit",
        "timeout": "time_limit",
        "random_seed": "seed",
        "regions": "zones",
        "areas": "zones",
        "gates": "zones",
    }

    name: Text | None = None
    """Name of the world; null is the name of the file."""
    description: Text | None = None
    """Free text about the scenario, kept as it is."""
    metadata: dict[str, Any] | None = None
    """Free data about the scenario, kept as it is."""
    height: Annotated[Meters, Field(gt=0)] = 10
    """Extent in y, not a vertical height: the world is flat."""
    width: Annotated[Meters, Field(gt=0)] = 10
    """Extent in x."""
    depth: Annotated[Meters, Field(gt=0)] = 10
    """Extent in z, used only to draw the 3D view: the world is flat."""
    offset: Annotated[Point, OrNull([0.0, 0.0])] = [0.0, 0.0]
    """Lower left corner of the world: [x, y]. Objects do not move with it."""
    step_time: Annotated[Seconds, Field(ge=1e-6, le=1e4)] = 0.1
    """Period of one simulation step, within which controls are constant. It also sets the accuracy of motion: see
    `integration`."""
    integration: Annotated[Literal["euler", "exact"], BeforeValidator(_normalize_word)] = "euler"
    """How drives move within a step: straight along the heading at its start, then the turn (`euler`, as in IR-SIM
    2.12), or on the arc of the control (`exact`). Of a circle at 1 m/s and 0.8 rad/s, Euler's position is off by 0.10 m
    after 4 s with a `step_time` of 0.1 s, and by 1.0 m with 1 s; arcs are exact at any step."""
    sample_time: Annotated[Seconds, Field(ge=1e-6)] | None = None
    """Period of drawing and recording; null is every step."""
    time_limit: Annotated[Seconds, Field(gt=0)] | None = None
    """Longest duration of a run, unless its caller gives one; null derives it from distances and speeds."""
    seed: Seed | None = None
    """Seed of everything random, unless the caller gives one; null draws a new seed."""
    step_mode: Annotated[Literal["internal", "external"], BeforeValidator(_normalize_word)] = "internal"
    """Who moves the objects: the simulator (`internal`), or the calling program (`external`), which sets their
    states."""
    control_mode: Annotated[Literal["auto", "keyboard"], OrNull("auto")] = "auto"
    """Driver of the robot chosen in `gui.keyboard`: its behavior (`auto`) or the `keyboard`."""
    collision_mode: Literal["stop", "unobstructed", "unobstructed_obstacles", "reactive", "contact"] = "stop"
    """Effect of a collision: it stops both objects (`stop`), has no effect (`unobstructed`, `reactive`), stops robots
    only (`unobstructed_obstacles`): a robot stands as long as the two touch and goes on when the obstacle has moved
    away, or lets bodies push and slide (`contact`)."""
    contacts: Annotated[Literal["step_end", "swept"], BeforeValidator(_normalize_word)] = "step_end"
    """Which contacts are collisions: those at the ends of steps, as in IR-SIM 2.12 (`step_end`), or those within steps,
    too, where objects that stop at a collision stop where they first touch (`swept`). Contacts within a step are found
    and reported in any case."""
    after_arrival: Literal["freeze", "yield"] | None = None
    """Behavior of a robot at its last goal: it stands still for good (`freeze`), or it stays controlled, so that it can
    make room, and counts as arrived for good (`yield`); null is as `yield`, but the robot counts as arrived
    only while it is at its goal."""
    boundary: Literal["none", "walls"] = "none"
    """Edge of the world: nothing, or four walls that objects collide with, see and avoid."""
    obstacle_map: Annotated[Any, _MapSelect(MAPS, null=True, short=("image", "path"))] = None
    """Occupancy grid over the world: an image file name, or a mapping with a generator's name and options."""
    mdownsample: Annotated[int, Field(strict=True, ge=1, le=10_000), OrNull(1)] = 1
    """Merge blocks of N x N cells of the grid; a block is occupied if one of its cells is."""
    zones: Annotated[list[Zone], Field(max_length=1000), OrNull([])] = []
    """Named lines and areas that are watched: who crosses, enters and leaves them, and when. An area may also have
    slippery ground (`slip`, `grip`, `surface`)."""
    fog_map: Annotated[Bool, OrNull(False)] = False
    """Cover the world with fog that lidars and fields of view of robots clear, up to the first thing that blocks them;
    the first scan clears it when the run begins."""
    fog_map_resolution: Annotated[Meters, Field(gt=0)] | None = None
    """Cell size of the fog; null is the map's, or 0.1 m without a map."""
    gravity: Annotated[Number, Field(gt=0, json_schema_extra={"x-unit": "m/s^2"})] = 9.81
    """Gravity for `collision_mode: contact`."""
    friction: Annotated[Number, Field(ge=0, json_schema_extra={"x-unit": "1"})] = 0.5
    """Default friction of objects with the ground, for `collision_mode: contact`."""
    restitution: Fraction = 0.0
    """Default coefficient of restitution of objects, for `collision_mode: contact`."""
    drive_tau: Annotated[Seconds, Field(ge=0)] = 0.0
    """Default lag of the drives, for `collision_mode: contact`; `lag` under `actuation` works in every mode."""
    status: Annotated[Text, OrNull("None")] = "None"
    """Label shown before the first step."""
    plot: Annotated[WorldPlot, OrNull({})] = WorldPlot()
    """How the world is drawn."""

    @property
    def has_grounds(self) -> bool:
        """Whether a zone changes what wheels do."""
        return any(zone.has_ground for zone in self.zones)

    @property
    def center(self) -> list[float]:
        """Middle of the world [m]."""
        return [self.offset[0] + self.width / 2, self.offset[1] + self.height / 2]

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """xmin, ymin, xmax, ymax [m]."""
        x, y = self.offset
        return x, y, x + self.width, y + self.height
