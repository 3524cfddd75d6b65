"""A scenario as it is built: one row for each entry, with what is random and its range over 20 seeds."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

import irsim._core as core
from irsim.common.outline import outline
from irsim.common.text import plural
from irsim.results.picture import LidarHits, SceneRow, SceneTable
from irsim.scenario.resolve.body_size import has_fixed_shape
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario, random_parts
from irsim.simulation.build import build_world
from irsim.validation.scene_passages import find_passages

__all__ = ["SEEDS", "scene_table"]

SEEDS = 20
"""Number of seeds that are tried if places are random."""
_MAX_OBJECTS = 6_000
"""Number of objects in all these worlds together; larger scenarios are tried with fewer seeds, at least two."""
_MAX_ROBOTS = 100
"""Number of robots up to which goals that overlap are counted."""
_MAX_KINDS = 4
"""Number of kinds of objects of an entry that have rows of their own."""
MAX_SHOWN = 6
"""Number of objects of an entry that are described one by one."""


def scene_table(scenario: ResolvedScenario, seed: int | None = None, driven: str | None = None) -> SceneTable:
    """Describe the objects of a scenario at its start.

    Args:
        scenario: The scenario.
        seed: Seed of the places that are described one by one; default: the scenario's own, else 0.
        driven: The policy that drives every robot that can move; None: their behaviors.
    """
    own = scenario.world.seed if seed is None else seed
    placed = bool(scenario.placements)
    count = max(2, min(SEEDS, _MAX_OBJECTS // max(1, len(scenario.objects)))) if placed else 0
    seeds = [own or 0, *range(count)]
    bare = [record.with_sensors([], behavior=None, group_behavior=None, appear_time=0.0) for record in scenario.objects]
    world = scenario.world.model_copy(update={"fog_map": False, "collision_mode": "unobstructed"})
    built = build_world(replace(scenario, objects=bare, world=world), len(seeds))
    state = core.State(built, np.array(seeds, dtype=np.uint64), False)
    crowded = [seed for w, seed in enumerate(seeds) if state.failed_placement[w] >= 0]
    good = [w for w, seed in enumerate(seeds) if seed not in crowded]
    shown = next((w for w in (0, *good) if w in good), 0)
    drawn = {index for placement in scenario.placements for index in placement.objects}
    entries = _alike(scenario.objects)
    rows = [_row(scenario, entry, state, built.objects, shown, good if drawn & set(entry) else []) for entry in entries]
    if driven is not None:
        rows = [
            row.model_copy(update={"behavior": f"policy {driven}"}) if row.role == "robot" and row.drive else row
            for row in rows
        ]
    return SceneTable(
        rows=rows,
        random=random_parts(scenario),
        seeds=max(1, count),
        crowded=sorted(set(crowded) & set(range(count))),
        overlapping_goals=_overlapping_goals(scenario, state, built.objects, [w for w in good if w > 0]),
        lidars=lidar_hits(scenario, seeds[shown]) if good else [],
        passages=find_passages(scenario, state, shown, seeds[shown]) if good else [],
    )


def _alike(records: Sequence[ObjectRecord]) -> list[list[int]]:
    """Objects of each row of the table: an entry's, or each kind's in it if there are a few kinds."""
    numbers = (k for k, record in enumerate(records) if not record.is_terrain)
    rows: list[list[int]] = []
    for _, entry in itertools.groupby(numbers, key=lambda k: records[k].path):
        kinds: dict[str, list[int]] = {}
        for k in entry:
            one = records[k]
            kinds.setdefault(repr((one.kinematics, one.behavior, one.sensors, one.static, one.vel_max)), []).append(k)
        rows += kinds.values() if len(kinds) <= _MAX_KINDS else [sorted(itertools.chain(*kinds.values()))]
    return rows


def _row(
    scenario: ResolvedScenario, entry: Sequence[int], state: core.State, objects: int, shown: int, worlds: list[int]
) -> SceneRow:
    """Describe an entry.

    Args:
        scenario: The scenario.
        entry: Ids of its objects.
        state: Worlds of several seeds.
        objects: Number of objects of each world.
        shown: World whose places are described one by one.
        worlds: Worlds over which places are ranges; empty if they are the same in all.
    """
    records = [scenario.objects[k] for k in entry]
    first, some = records[0], list(entry)[:MAX_SHOWN]
    behavior: Any = first.behavior or first.group_behavior
    starts = [state.pose[w * objects + k][:2] for w in worlds for k in entry]
    ends = [goals[0][:2] for w in worlds for k in entry if (goals := state.goals(w * objects + k))]
    ways = [_goals(scenario, scenario.objects[k], state.goals(shown * objects + k)) for k in some]
    differ = any(record.shape != first.shape for record in records)
    reference = _reference_point(first, state, shown * objects + entry[0])
    return SceneRow(
        names=[scenario.objects[k].name for k in some],
        count=len(records),
        role=first.role,
        drive=None if first.static or first.kinematics is None else str(getattr(first.kinematics, "name", "")),
        behavior=None if first.static or behavior is None else _behavior(behavior) + _task(first),
        footprint=footprint_of(first) + (", each its own" if differ else "") + reference,
        poses=[_pose(state.pose[shown * objects + k]) for k in some],
        goals=[
            None if not goals else _goal(scenario.objects[k], goals[0]) for k, goals in zip(some, ways, strict=True)
        ],
        waypoints=[len(goals) for goals in ways],
        ends_at=[
            None if not goals else _goal(scenario.objects[k], goals[-1]) for k, goals in zip(some, ways, strict=True)
        ],
        sensors=[_sensor(sensor) for sensor in first.sensors],
        appear_time=first.appear_time,
        start_time=first.start_time,
        vel_max=[] if first.static else list(first.vel_max),
        starts=_range(starts),
        ends=None if first.static else _range(ends),
    )


def _reference_point(record: ObjectRecord, state: core.State, row: int) -> str:
    """Where a car has the point that its pose is about, and how far its body reaches behind and ahead of it."""
    if not getattr(record.kinematics, "steered", False) and getattr(record.shape, "wheelbase", None) is None:
        return ""
    low, high = outline(state, row).box()
    return f" (its pose means the rear axle; body {low[0]:+.2f} to {high[0]:+.2f} m)"


def footprint_of(record: ObjectRecord) -> str:
    """Shape and size of an object in words: ``circle r 0.3``, ``rectangle 0.6 x 0.4``."""
    shape: Any = record.shape
    if not has_fixed_shape(shape) and shape.name == "circle":
        return "circle r {:g}..{:g} (random)".format(*shape.radius_range)
    if not has_fixed_shape(shape) and shape.name in ("polygon", "linestring"):
        return f"{shape.name} mean r {shape.avg_radius_range[0]:g}..{shape.avg_radius_range[1]:g} (random)"
    if shape.name == "circle":
        return f"circle r {shape.radius:g}"
    if shape.name == "rectangle":
        return f"rectangle {shape.length:g} x {shape.width:g}"
    if shape.name == "compound":
        return f"compound of {len(shape.parts)} parts"
    vertices = getattr(shape, "vertices", None)
    if not vertices:
        return str(shape.name)
    width, height = np.ptp(np.asarray(vertices, dtype=float), axis=0)[:2]
    return f"{shape.name} with {len(vertices)} vertices, {width:g} x {height:g}"


def _behavior(options: Any) -> str:
    """Name of a behavior, its local one, and whether they step aside."""
    local: Any = getattr(options, "local", None)
    aside = getattr(options, "sidestep", 0) or getattr(local, "sidestep", 0)
    inner = f"with {local.name}" if hasattr(local, "name") else ""
    return " ".join(filter(None, [str(options.name), inner, "sidestep" if aside else ""]))


def _task(record: ObjectRecord) -> str:
    return " wander" if record.wander else " loop" if record.loop else ""


def _pose(pose: Any) -> tuple[float, float, float]:
    x, y, heading = (float(value) for value in pose[:3])
    return x, y, heading


def _goals(scenario: ResolvedScenario, record: ObjectRecord, goals: Sequence[Any]) -> Sequence[Any]:
    """The goals of an object; none for one that cannot move."""
    return [] if record.static or scenario.is_parked(record) else goals


def _goal(record: ObjectRecord, goal: Any) -> tuple[float, float] | tuple[float, float, float]:
    x, y, *rest = (float(value) for value in goal)
    return (x, y, rest[0]) if record.heading_counts(goal) else (x, y)


def _overlapping_goals(scenario: ResolvedScenario, state: core.State, objects: int, worlds: Sequence[int]) -> int:
    """Number of worlds in which the goals of two robots overlap; 0 if they do in all of them."""
    rows = [k for k, record in enumerate(scenario.objects) if record.role == "robot" and not record.loop]
    if len(rows) < 2 or len(rows) > _MAX_ROBOTS or not worlds:
        return 0
    count = 0
    for world in worlds:
        ends = [
            (goals[-1][:2], state.radius[world * objects + k])
            for k in rows
            if (goals := state.goals(world * objects + k))
        ]
        count += any(math.dist(a, b) < r + q for (a, r), (b, q) in itertools.combinations(ends, 2))
    return count if count < len(worlds) else 0


def _range(places: Sequence[Any]) -> tuple[float, float, float, float] | None:
    if not places:
        return None
    (x0, y0), (x1, y1) = np.min(places, axis=0), np.max(places, axis=0)
    return float(x0), float(x1), float(y0), float(y1)


MAX_LIDARS = 6
"""Number of lidars whose beams are counted."""
_MAX_BEAMS = 200_000
"""Number of beams of a scenario beyond which none are counted."""


def _sensor(sensor: Any) -> str:
    """A sensor in words: ``fmcw_lidar2d 120 deg, 10 m, 241 beams, motion_compensate, velocity noise 0.05``."""
    x, y, turn = (*(float(value) for value in getattr(sensor, "offset", None) or ()), 0.0, 0.0, 0.0)[:3]
    place = f"mounted at ({x:+.2f}, {y:+.2f}) m, " if x or y else ""
    place += f"turned by {turn:+.2f} rad, " if turn else ""
    if not getattr(sensor, "is_lidar", False):
        return f"{sensor.name} {place}".rstrip(", ")
    facts = [f"{sensor.name} {np.degrees(sensor.angle_range):.3g} deg", f"{sensor.range_max:g} m"]
    facts.append(plural(sensor.number, "beam"))
    facts += [place.removesuffix(", ")] if place else []
    if getattr(sensor, "motion_compensate", False):
        facts.append("motion_compensate")
    if sensor.noise:
        facts.append(f"range noise {sensor.std:g}")
    if getattr(sensor, "velocity_noise_std", 0.0):
        facts.append(f"velocity noise {sensor.velocity_noise_std:g}")
    return ", ".join(facts)


def _plainly(record: ObjectRecord) -> str:
    """The name of an object without quotes, or ``the map``."""
    return record.called.removeprefix("the person ").strip("'")


def lidar_hits(scenario: ResolvedScenario, seed: int) -> list[LidarHits]:
    """Count the beams of each of the first lidars that hit each object at the start; empty if there are too many.

    Args:
        scenario: The scenario, in which there is room for every object.
        seed: Seed of the places.
    """
    carriers = [k for k, record in enumerate(scenario.objects) if _lidars(record.sensors)][:MAX_LIDARS]
    records = [
        record.with_sensors(_lidars(record.sensors) if k in carriers else [], behavior=None, group_behavior=None)
        for k, record in enumerate(scenario.objects)
    ]
    if not carriers or sum(sensor.number for record in records for sensor in _lidars(record.sensors)) > _MAX_BEAMS:
        return []
    world = scenario.world.model_copy(update={"fog_map": False})
    built = build_world(replace(scenario, objects=records, world=world), 1)
    state = core.State(built, np.array([seed], dtype=np.uint64), False)
    state.look()
    rows = list[LidarHits]()
    for row, first, count in built.scans():
        hits = Counter(state.hits[first : first + count].tolist())
        missed = hits.pop(-1, 0)
        names = [(_plainly(scenario.objects[k]), beams) for k, beams in hits.most_common()]
        sensors = scenario.objects[row].sensors
        place = sum(one.name == records[row].name for one in rows)
        which = sensors.index(_lidars(sensors)[place]) if len(sensors) > 1 else None
        rows.append(LidarHits(name=records[row].name, sensor=which, beams=count, hit=count - missed, hits=dict(names)))
    return rows[:MAX_LIDARS]


def _lidars(sensors: Iterable[Any]) -> list[Any]:
    return [sensor for sensor in sensors if getattr(sensor, "is_lidar", False)]
