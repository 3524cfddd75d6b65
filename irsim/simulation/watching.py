"""Watched parts of a world: its zones, and the fields of view that the scenario gives to objects."""

from __future__ import annotations

from typing import TYPE_CHECKING

import irsim._core as core

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

__all__ = ["build_targets", "build_views", "build_zones", "is_watching"]


def build_zones(scenario: ResolvedScenario) -> list[core.Part]:
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


def is_watching(record: ObjectRecord) -> bool:
    """Whether an object has a watched field of view: one that the scenario gives, not just the one of a lidar."""
    return record.watches and record.fov is not None and record.fov_radius is not None


def build_views(scenario: ResolvedScenario) -> list[core.View]:
    """Build the fields of view that are watched."""
    return [
        core.View(object=index, angle=record.fov, reach=record.fov_radius, occlusion=record.fov_occlusion)
        for index, record in enumerate(scenario.objects)
        if is_watching(record) and record.fov is not None and record.fov_radius is not None
    ]


def build_targets(scenario: ResolvedScenario) -> list[int]:
    """Indices of the objects that count as seen: movable ones, robots, and obstacles with tags.

    Plain static obstacles, maps and walls do not count: a turning robot would see and lose them all the time.
    """
    return [
        index
        for index, record in enumerate(scenario.objects)
        if not record.static or record.role == "robot" or record.tags
    ]
