"""``ros``: maps as the ROS map server stores them."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.components.maps._site import UNKNOWN_AS, MapSite, Raster
from irsim.components.options import MapOptions
from irsim.options.registry import MAPS


class RosMap(MapOptions):
    """A picture with a YAML file that gives resolution, origin and thresholds, as the ROS map server reads them."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "ros", "path": "map.yaml"}]}

    sets_extent: ClassVar[bool] = True
    """Whether the world takes its extent and offset from the map if the scenario gives none."""

    name: Literal["ros"] = "ros"
    path: Annotated[str, Field(strict=True, min_length=1)]
    """YAML file of the map."""
    unknown: Literal["free", "occupied", "unknown"] = "free"
    """How to take cells that are neither free nor occupied; pictures show them in grey. ``unknown``: beams, sight and
    bodies pass through them, while planners, ``follow`` and random starts and goals keep out."""


_SAID = 0.005
"""Share of unknown cells from which on the user hears what they count as."""


@MAPS.register(RosMap)
def ros(options: RosMap, site: MapSite) -> Raster:
    """The map at the place that its file gives; a rotated map is resampled.

    Raises:
        MapProblem: A file is missing or wrong.
    """
    from irsim.components.maps._rosmap import ros_raster

    path = site.find(options.path)
    raster = ros_raster(path, options.path, site, UNKNOWN_AS[options.unknown])
    if raster.unknown_share > _SAID and "unknown" not in options.model_fields_set:
        said = f"{raster.unknown_share:.0%} of its cells are unknown and count as free"
        site.notes.append(("map-read-as", f"{said}: write 'unknown: free', 'unknown: occupied' or 'unknown: unknown'"))
    return raster
