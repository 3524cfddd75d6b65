"""``depth_scan``: a depth camera as a planar scan."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

import irsim._core as core
from irsim.components.sensors._devices import DEPTH_CAMERAS, with_card
from irsim.components.sensors._realism import LidarRealism
from irsim.components.sensors.lidar2d import Lidar2d
from irsim.options.registry import SENSORS
from irsim.options.units import Meters, Number, SpanAngle


class DepthScan(Lidar2d):
    """Depth camera as a planar scan: a lidar whose noise grows with the square of the depth along its axis.

    The standard deviation of a depth is `depth_std` + `depth_growth` (depth - `depth_from`)². All keys of `lidar2d`
    hold; edges fatten with `realism: {divergence: 0.01, mixed: nearest}`.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "depth_scan", "device": "d435"}]}

    name: Literal["depth_scan"] = "depth_scan"  # type: ignore[assignment]  # a lidar2d with another name
    device: Literal["d435", "kinect_v1"] | None = None  # type: ignore[assignment]  # its own cards
    """A depth camera that one can buy: columns, ranges and noise of its card; keys beside it win."""
    angle_range: Annotated[SpanAngle, Field(le=3)] = 1.5184
    """Total opening angle, symmetric about the axis of the camera."""
    depth_min: Annotated[Meters, Field(ge=0)] = 0.0
    """Smallest depth that it measures; nearer surfaces return nothing."""
    depth_std: Annotated[Meters, Field(ge=0)] = 0.0
    """Standard deviation of the depth at `depth_from`."""
    depth_growth: Annotated[Number, Field(ge=0, le=1, json_schema_extra={"x-unit": "1/m"})] = 0.0
    """Growth of the standard deviation with the square of the depth; of a stereo camera it is the error of matching
    [pixels] over focal length [pixels] and base [m]."""
    depth_from: Annotated[Meters, Field(ge=0)] = 0.0
    """Depth from which the growth counts."""
    realism: LidarRealism = LidarRealism()
    """How ranges err beyond that, as a lidar does."""

    @model_validator(mode="before")
    @classmethod
    def _take_device(cls, given: Any) -> Any:
        return with_card(given, DEPTH_CAMERAS)


SENSORS.register(DepthScan, kernel=core.DepthScanOptions)
