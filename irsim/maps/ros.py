"""``ros``: maps as the ROS map server stores them."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.maps._options import MapOptions
from irsim.registry import MAPS


class RosMap(MapOptions):
    """A picture with a YAML file that gives resolution, origin and thresholds, as the ROS map server reads them."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "ros", "path": "map.yaml"}]}

    name: Literal["ros"] = "ros"
    path: Annotated[str, Field(strict=True, min_length=1)]
    """The map's YAML file."""
    unknown: Literal["free", "occupied"] = "free"
    """What cells count as that are neither."""


MAPS.register(RosMap)
