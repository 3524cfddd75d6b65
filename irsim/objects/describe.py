"""The scene of a simulation in plain data, for readers that know no simulation."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.common.installed import version
from irsim.common.outline import BodyPart, Cells, Polygon, outline
from irsim.components.maps._site import HALF, UNKNOWN
from irsim.components.sensors._gauges import GaugeOptions
from irsim.objects.drawing.kinds import kind_of
from irsim.objects.drawing.signs import distinct_colors, shows_motion
from irsim.objects.views import views
from irsim.options.colors import rgb
from irsim.scenario.resolve.resolved import ObjectRecord
from irsim.simulation.scene import Gauge, Grid, Lidar, Look, SceneDescription, SceneObject
from irsim.simulation.simulation import Simulation
from irsim.simulation.trace import mounted_gauges

if TYPE_CHECKING:
    from irsim.objects.drawing.scene_builder import SceneBuilder

__all__ = ["agent_rows", "describe_scene", "grid_values"]

_GREY = (0.5, 0.5, 0.5)


def describe_scene(simulation: Simulation) -> SceneDescription:
    """The scene of the first world of a simulation, with the bodies of the present scene.

    Args:
        simulation: The simulation, at the start of an episode.
    """
    scenario = simulation.scenario
    bounds = scenario.world.bounds
    from irsim.objects.drawing.scene_builder import SceneBuilder  # many modules, which few readers need

    builder = SceneBuilder(simulation)
    place = {row: index for index, row in enumerate(agent_rows(simulation).tolist())}
    colors = distinct_colors(views(simulation))
    objects = [_object(simulation, builder, colors, place.get(row, -1), row) for row in range(len(scenario.objects))]
    return SceneDescription(
        name=scenario.name,
        step_time=float(scenario.world.step_time),
        low=(float(bounds[0]), float(bounds[1])),
        high=(float(bounds[2]), float(bounds[3])),
        agents=tuple(one for one in objects if one.index >= 0),
        grid=_grid(simulation),
        walls=scenario.world.boundary == "walls",
        seed=int(simulation.state.seed[0]),
        about={"irsim": version(), "scenario": scenario.text or ""},
        maps=tuple(one for one in objects if one.index < 0),
    )


def agent_rows(simulation: Simulation) -> NDArray[np.int64]:
    """(N,) rows of the first world that are agents: all objects but the map."""
    records = simulation.scenario.objects
    return np.array([i for i, record in enumerate(records) if not record.is_map], dtype=np.int64)


def _object(
    simulation: Simulation, builder: SceneBuilder, colors: Mapping[int, Any], index: int, row: int
) -> SceneObject:
    record, state = simulation.scenario.objects[row], simulation.state
    pose = np.asarray(state.initial_state(row), dtype=np.float64)[:3]
    low, high = simulation.limits(row)
    goals = tuple(_pose(goal) for goal in state.goals(row)) if record.role == "robot" or not record.static else ()
    return SceneObject(
        index=index,
        name=record.name,
        role=record.role,
        drive=None if record.kinematics is None else str(record.kinematics.name),  # type: ignore[attr-defined]
        moves=not record.static and record.kinematics is not None,
        pose=_pose(pose),
        goals=goals,
        parts=() if record.is_map else _parts(state, row),
        radius=float(simulation.radius[row]),
        low=tuple(map(float, low)),
        high=tuple(map(float, high)),
        acceleration=tuple(float(value) for value in record.acce),
        wheelbase=record.wheelbase,
        mass=float(record.mass),
        color=_color(record),
        lidars=_lidars(simulation, row),
        solid=not record.unobstructed,
        row=row,
        static=record.static,
        threshold=record.goal_threshold,
        look=_look(simulation, builder, colors, row),
        gauges=_gauges(simulation, row),
    )


def _look(simulation: Simulation, builder: SceneBuilder, colors: Mapping[int, Any], row: int) -> Look:
    view = views(simulation)[row]
    if view.record.is_map:
        return Look((0.0, 0.0, 0.0))
    style = builder.style(view, {})
    return Look(
        rgb(colors[view.id]),
        float(style.obj_alpha),
        goal=view.record.role == "robot" or bool(style.show_goal),
        arrow=bool(style.show_arrow),
        kind=kind_of(view.record),
        motion=shows_motion(view.record),
    )


def _pose(values: Any) -> tuple[float, float, float]:
    x, y, *rest = (float(value) for value in values)
    yaw = rest[0] if rest else 0.0
    return x, y, 0.0 if np.isnan(yaw) else yaw


def _parts(state: core.State, row: int) -> tuple[BodyPart, ...]:
    parts = [part for part in outline(state, row).parts if not isinstance(part, Cells)]
    return tuple(Polygon(_counterclockwise(part.corners)) if isinstance(part, Polygon) else part for part in parts)


def _counterclockwise(corners: Floats) -> Floats:
    x, y = corners.T
    area = float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    return corners if area >= 0 else corners[::-1].copy()


def _lidars(simulation: Simulation, row: int) -> tuple[Lidar, ...]:
    record, lidars = simulation.scenario.objects[row], []
    own = [(first, count) for owner, first, count in simulation.scans if owner == row]
    beams = (item for item in record.sensors if not isinstance(item, GaugeOptions))
    options = [item for item in beams if hasattr(item, "angle_range") and hasattr(item, "range_max")]
    for number, ((first, count), item) in enumerate(zip(own, options, strict=False)):
        angles = simulation.state.beam_angles[first : first + count]
        chosen: Any = item
        between = chosen.angle_range / max(count - 1 if chosen.endpoint else count, 1) if count > 1 else 0.0
        sweeps = getattr(chosen, "realism", None) is not None and chosen.realism.sweep
        lidars.append(
            Lidar(
                key=f"{record.name}/{number}",
                number=number,
                mount=_pose(chosen.offset),
                angle_min=float(angles[0]),
                angle_max=float(angles[-1]),
                beams=count,
                range_min=float(chosen.range_min),
                range_max=float(chosen.range_max),
                period=float(chosen.scan_time),
                noise_std=float(chosen.std) if chosen.noise else 0.0,
                between=between,
                beam_time=float(chosen.scan_time) * between / (2 * math.pi) if sweeps else 0.0,
                rate=float(getattr(chosen, "rate", None) or 0.0),
                latency=float(getattr(chosen, "latency", 0.0)),
            )
        )
    return tuple(lidars)


def _gauges(simulation: Simulation, row: int) -> tuple[Gauge, ...]:
    counts: dict[str, int] = {}
    result = []
    for owner, key, options in mounted_gauges(simulation):
        if owner != row:
            continue
        number = counts[options.name] = counts.get(options.name, -1) + 1
        mount = _pose(getattr(options, "offset", (0.0, 0.0, 0.0)))
        settings = options.model_dump(mode="json")
        result.append(Gauge(key, options.name, number, mount, dict(options.numbers()), settings))
    return tuple(result)


def _grid(simulation: Simulation) -> Grid | None:
    values, grid = grid_values(simulation), simulation.scenario.grid
    if values is None or grid is None:
        return None
    cell, origin = (float(grid.cell[0]), float(grid.cell[1])), (float(grid.origin[0]), float(grid.origin[1]))
    return Grid(values > HALF, cell, origin, np.clip(values, UNKNOWN, 100).astype(np.int8))


def _color(record: ObjectRecord) -> tuple[float, float, float]:
    try:
        return rgb(record.color)
    except ValueError:
        return _GREY


def grid_values(simulation: Simulation, world: int = 0) -> Floats | None:
    """Return the occupancies of the map of one world, (nx, ny), 0 to 100, -1 where unknown; None without a map."""
    scenario = simulation.scenario
    if scenario.grid is None:
        return None
    if scenario.grid.raster is not None:
        return scenario.grid.values()
    for index, record in enumerate(scenario.objects):
        if record.is_map:
            cells = simulation.state.cells(world * simulation.objects + index)
            assert cells is not None
            return cells.occupied.astype(np.float64) * 100.0
    return np.zeros(scenario.grid.size)
