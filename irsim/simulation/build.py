"""Builds the world of the core from a resolved scenario, and passes all options to the kernels that use them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

import irsim._core as core
from irsim.common.outline import Outline, part_of
from irsim.components.kinematics._handler import handler_class
from irsim.components.kinematics._presets import SURFACES
from irsim.components.options import BehaviorOptions
from irsim.options.registry import BEHAVIORS, CUSTOM_GROUP_BEHAVIORS
from irsim.scenario.model.actuation import MOST_CONTROLS, PER_CONTROL, per_control
from irsim.scenario.resolve.kernels import Kernels, kernels_of, parts_of, placement_kernel
from irsim.simulation.fog import build_fog

if TYPE_CHECKING:
    from irsim.scenario.model.actuation import Actuation
    from irsim.scenario.resolve.resolved import ObjectRecord, Placement, ResolvedScenario, Variation

__all__ = [
    "COLLISION_MODES",
    "PLACEMENT_ATTEMPTS",
    "build_world",
    "compound_body",
    "group_behaviors",
    "is_watching",
    "padded",
    "speed_controls",
    "static_shapes_are_random",
    "steps_until",
    "steps_within",
]


AFTER_ARRIVAL = {None: 0, "freeze": 1, "yield": 2}
CONTACTS = {"step_end": 0, "swept": 1}
INTEGRATIONS = {"euler": 0, "exact": 1}
COLLISION_MODES = {"stop": 0, "unobstructed": 1, "reactive": 1, "unobstructed_obstacles": 2, "contact": 3}
"""Name of a collision mode -> its number in the core."""
PLACEMENT_ATTEMPTS = 1000
"""Number of positions that are tried for a randomly placed object before the placement fails."""
CORE_CONTROLS = 3
"""Number of controls of an object that the core keeps."""
_ROUNDING = 1e-9
"""Share of a step by which a time may differ from a multiple of the step time because it is rounded."""
_ROLES = {"robot": 0, "obstacle": 1}
_TARGETS = {"all": 0, "robot": 1, "obstacle": 2}
_ARRIVE = {"position": 0, "state": 1}


def steps_until(time: float, step_time: float) -> int:
    """Number of the first step that ends at a time [s] or after it."""
    return math.ceil(time / step_time - _ROUNDING)


def steps_within(time: float, step_time: float) -> int:
    """Number of the last step that ends at a time [s] or before it."""
    return math.floor(time / step_time + _ROUNDING)


def padded(values: Sequence[float], fill: float = 0.0) -> list[float]:
    """Return three numbers: ``values``, cut off or padded with ``fill``."""
    row = [float(v) for v in values[:3]]
    return row + [fill] * (3 - len(row))


def speed_controls(record: ObjectRecord) -> tuple[int, ...]:
    """Return the indices of the controls of an object that are speeds [m/s]; empty without a drive."""
    known = getattr(record.kinematics, "speeds", 0)
    speeds: Iterable[int] = range(known)
    if not known and record.kinematics is not None:
        drive = handler_class(str(getattr(record.kinematics, "name", "")))  # a drive written in Python
        speeds = () if drive is None else drive.translation_rows
    return tuple(control for control in speeds if control < record.vel_dim)


def group_behaviors(records: Sequence[ObjectRecord]) -> dict[int, BehaviorOptions]:
    """Return, for each group that a native behavior drives as a whole, the `group_behavior` of its first member.

    Groups without a `group_behavior`, or with one written by the user in Python, are not in the result: their members
    follow their own `behavior`.
    """
    leaders: dict[int, ObjectRecord] = {}
    for record in records:
        if record.joined:
            leaders.setdefault(record.group, record)
    behaviors: dict[int, BehaviorOptions] = {}
    for group, leader in leaders.items():
        options = leader.group_behavior
        if not isinstance(options, BehaviorOptions) or not options.in_group:
            continue
        feature = BEHAVIORS.get(options.name)
        own = CUSTOM_GROUP_BEHAVIORS.has(getattr(leader.kinematics, "name", None), options.name)
        if feature is not None and feature.kernel is not None and not own:
            behaviors[group] = options
    return behaviors


def build_object(
    record: ObjectRecord,
    kernels: Kernels,
    group_behavior: BehaviorOptions | None = None,
    *,
    step_time: float,
    contact: bool = False,
) -> core.ObjectSpec:
    """Build one object of the core.

    Args:
        record: The object.
        kernels: Its options of the core.
        group_behavior: Behavior that drives its group (:func:`group_behaviors`); it replaces the object's own.
        step_time: Period of a step [s].
        contact: Whether the core resolves contacts, which needs the centroid of compounds.
    """
    return core.ObjectSpec(
        number=record.id,
        role=_ROLES[record.role],
        group=record.group if record.joined else -1 - record.id,
        drive=kernels.drive,
        parts=kernels.parts,
        static=record.static,
        unobstructed=record.unobstructed,
        wander=record.wander,
        loop=record.loop,
        pose=padded(record.state),
        extra=[float(v) for v in record.state[3:]],
        control=padded(record.velocity),
        vel_min=padded(record.vel_min),
        vel_max=padded(record.vel_max),
        acce=padded(record.acce, float("inf")),
        angle_range=record.angle_range,
        goals=record.goals,
        goal_threshold=record.goal_threshold,
        arrive_mode=_ARRIVE[record.arrive_mode],
        range_low=padded(record.range_low),
        range_high=padded(record.range_high),
        target_roles=_TARGETS[record.target_roles if group_behavior is None else group_behavior.target_roles],
        behavior=kernels.behavior,
        grouped=group_behavior is not None,
        route=kernels.route,
        sensors=kernels.sensors,
        timing=kernels.timing,
        centroid=compound_body(kernels.parts) if contact and len(kernels.parts) > 1 else [],
        mass=record.mass,
        friction=record.friction,
        inertia=math.nan if record.inertia is None else record.inertia,
        restitution=record.restitution,
        tau=record.drive_tau,
        driven=record.kinematics is not None,
        start_step=steps_until(max(record.start_time, record.appear_time), step_time),
        appear_step=steps_until(record.appear_time, step_time),
        actuation=None if record.actuation is None else _actuation(record.actuation),
        vanish_step=0 if record.vanish_time is None else 1 + steps_within(record.vanish_time, step_time),
        reflectivity=record.reflectivity,
        material=record.material,
        perceives_estimate=record.perceives in ("estimate", "both"),
        perceives_tracks=record.perceives in ("tracks", "both"),
    )


def _actuation(options: Actuation) -> core.Actuation:
    """Build the actuators of an object."""
    values = {key: per_control(getattr(options, key), MOST_CONTROLS) for key in PER_CONTROL if key != "jerk"}
    jerk = per_control(options.jerk, MOST_CONTROLS, math.inf)
    return core.Actuation(command_period=options.command_period, jerk=jerk, **values)


def _keeps(placement: Placement, row: dict[int, int]) -> dict[str, Any]:
    """Fields of the kernel for the objects that a random placement keeps clear of.

    Args:
        placement: The placement.
        row: Id of an object -> its index in the world.
    """
    if placement.distribution != "random":
        return {}
    kept = [(row[number], radius) for number, radius in placement.kept if number in row]
    return {"keep_objects": [index for index, _ in kept], "keep_radii": [radius for _, radius in kept]}


Built = dict[int, tuple["ObjectRecord", BehaviorOptions | None, core.ObjectSpec, float]]
"""Cache of built objects: identity of the record -> record, behavior of its group, object of the core, step time."""


def build_world(scenario: ResolvedScenario, copies: int = 1, built: Built | None = None) -> core.World:
    """Build ``copies`` worlds of a scenario, ready for a :class:`irsim._core.State`.

    Args:
        scenario: The scenario.
        copies: Number of worlds.
        built: Cache of an earlier call, whose objects are reused for records that still exist; it is updated.
    """
    groups = group_behaviors(scenario.objects)
    contact, step_time = scenario.world.collision_mode == "contact", scenario.world.step_time
    zones = [zone.name for zone in scenario.world.zones]
    row = {record.id: index for index, record in enumerate(scenario.objects)}
    before = {} if built is None else built
    now: Built = {}
    changed = []
    for record in scenario.objects:
        group_behavior = groups.get(record.group) if record.joined else None
        known = before.get(id(record))
        if known is None or known[0] is not record or known[1] is not group_behavior or known[3] != step_time:
            changed.append((record, kernels_of(record, group_behavior, zones), group_behavior))
        else:
            now[id(record)] = known
    for record, kernels, group_behavior in changed:
        spec = build_object(record, kernels, group_behavior, step_time=step_time, contact=contact)
        now[id(record)] = record, group_behavior, spec, step_time
    if built is not None:
        built.clear()
        built.update(now)
    world = core.World(
        step_time=scenario.world.step_time,
        collision_mode=COLLISION_MODES[scenario.world.collision_mode],
        gravity=scenario.world.gravity,
        objects=[now[id(record)][2] for record in scenario.objects],
        placements=[
            placement_kernel(placement.distribution)(
                objects=[row[number] for number in placement.objects if number in row],
                attempts=PLACEMENT_ATTEMPTS,
                **_keeps(placement, row),
                **placement.options,
            )
            for placement in scenario.placements
        ],
        copies=copies,
        fog=build_fog(scenario),
        perturbations=[
            core.Perturbation(
                object=index,
                **asdict(record.spreads),
                speeds=[control for control in speed_controls(record) if control < CORE_CONTROLS],
                attempts=PLACEMENT_ATTEMPTS,
            )
            for index, record in enumerate(scenario.objects)
            if record.spreads is not None
        ],
        zones=_zones(scenario),
        views=_views(scenario),
        targets=_targets(scenario),
        grounds=_grounds(scenario),
    )
    world.after_arrival = AFTER_ARRIVAL[scenario.world.after_arrival]
    world.contacts = CONTACTS[scenario.world.contacts]
    world.integration = INTEGRATIONS[scenario.world.integration]
    x0, y0, x1, y1 = scenario.world.bounds
    world.extent = x0, y0, x1, y1
    if scenario.variation is not None:
        speeds = [[k for k in speed_controls(record) if k < CORE_CONTROLS] for record in scenario.objects]
        _let_vary(world, scenario.variation, row, speeds)
    return world


def _let_vary(world: core.World, variation: Variation, row: dict[int, int], speeds: Sequence[Sequence[int]]) -> None:
    """Set what is drawn for each scene."""
    world.set_variants([build_world(variant) for variant in variation.variants])
    levels = []
    for level in variation.levels:
        drawn = [
            core.Variation(
                quantity=one.quantity,
                objects=[row[number] for number in one.objects if number in row],
                low=one.low,
                high=one.high,
                same=one.same,
            )
            for one in level.drawn
        ]
        levels.append(core.Level(variations=drawn, first_variant=level.first_variant, variants=level.variants))
    world.set_levels(levels, speeds)


def _zones(scenario: ResolvedScenario) -> list[core.Part]:
    """Build the zones of a scenario: a line is a linestring, an area a circle or a polygon."""
    parts: list[core.Part] = []
    for zone in scenario.world.zones:
        if zone.circle is not None:
            parts.append(core.Circle(radius=zone.circle.radius, center=zone.circle.center))
        elif zone.is_line:
            parts.append(core.Linestring(vertices=zone.points))
        else:
            parts.append(core.Polygon(vertices=zone.points))
    return parts


def _grounds(scenario: ResolvedScenario) -> list[core.Ground]:
    """Build the ground of the areas that have one of their own."""
    grounds = []
    for index, zone in enumerate(scenario.world.zones):
        if not zone.has_ground:
            continue
        surface = {"spread": 0.0, "traction": 1.0} if zone.surface is None else SURFACES[zone.surface].values
        slip = {key: getattr(zone, key) for key in ("slip", "slip_std", "slip_time", "grip")}
        grounds.append(core.Ground(zone=index, **slip, **surface))
    return grounds


def is_watching(record: ObjectRecord) -> bool:
    """Whether an object has a watched field of view: one that the scenario gives, not just the one of a lidar."""
    return record.watches and record.fov is not None and record.fov_radius is not None


def _views(scenario: ResolvedScenario) -> list[core.View]:
    """Build the fields of view that are watched."""
    return [
        core.View(object=index, angle=record.fov, reach=record.fov_radius, occlusion=record.fov_occlusion)
        for index, record in enumerate(scenario.objects)
        if is_watching(record) and record.fov is not None and record.fov_radius is not None
    ]


def _targets(scenario: ResolvedScenario) -> list[int]:
    """Indices of the objects that count as seen: movable ones, robots, and obstacles with tags.

    Plain static obstacles, maps and walls do not count: a turning robot would see and lose them all the time.
    """
    return [
        index
        for index, record in enumerate(scenario.objects)
        if not record.static or record.role == "robot" or record.tags
    ]


def static_shapes_are_random(scenario: ResolvedScenario) -> bool:
    """Return whether the shape of a static object is drawn for each scene."""
    if scenario.variation is not None:
        return True
    return any(_is_drawn(record) for record in scenario.objects if record.static)


def _is_drawn(record: ObjectRecord) -> bool:
    parts = parts_of(record.shape)
    return any(isinstance(part, (core.RandomCircle, core.RandomPolygon, core.PerlinCells)) for part in parts)


def compound_body(parts: Sequence[Any]) -> list[float]:
    """Return centroid and squared radius of gyration of the area that the parts of a compound cover together.

    Returns:
        x, y of the centroid [m, body frame]; if the area is in one piece, also the square of its radius of gyration
        [m^2], where holes count as filled. An empty list if a part is random, because its shape changes with each
        scene.
    """
    known = [part for part in map(part_of, parts) if part is not None]
    if len(known) < len(parts):
        return []
    area = Outline(known).shapely()
    centre = [area.centroid.x, area.centroid.y]
    return [*centre, _gyration2(area.exterior.coords, centre)] if area.geom_type == "Polygon" else centre


def _gyration2(ring: Any, centre: Sequence[float]) -> float:
    """Return the second moment of the area inside a closed ring about ``centre``, divided by the area [m^2]."""
    a = np.asarray(ring, dtype=np.float64)[:-1] - centre
    b = np.roll(a, -1, axis=0)
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return float(np.sum(cross * np.sum(a * a + a * b + b * b, axis=1)) / (6.0 * np.sum(cross)))
