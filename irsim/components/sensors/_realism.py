"""How the ranges of a lidar err: the key ``realism`` of lidars."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

import irsim._core as core
from irsim.options.base import Options, problem
from irsim.options.units import Bool, Fraction, Integer, Meters, Number, Radians
from irsim.options.vectors import Component, vector

__all__ = ["LidarRealism"]

Share = Annotated[Fraction, Field(lt=1)]
Sector = Annotated[list[Component], vector(("rad", "rad"), 2)]

_DARK, _WHITE = 0.1, 0.9
"""Reflectivities of the surfaces for which ranges are told."""


class LidarRealism(Options):
    """How the ranges of a lidar differ from exact ones; each key is off unless it is given.

    Draws are seeded, and `noise`, `std` and `angle_std` of the lidar work beside them. A beam that nothing returns
    reads `range_max` and is not valid. Surfaces return light by `reflectivity` and `material` of their object.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"std_per_meter": 0.01, "dropout": 0.02, "range_dark": 4.0, "incidence_max": 1.3}]
    }

    std_per_meter: Annotated[Number, Field(ge=0, le=1)] = 0.0
    """Growth of the noise with the range: the standard deviation is sqrt(std² + (std_per_meter · range)²), where `std`
    counts with `noise: true`."""
    bias_std: Annotated[Meters, Field(ge=0)] = 0.0
    """Standard deviation of an offset of all ranges that is drawn once per episode."""
    scale_std: Annotated[Number, Field(ge=0, le=0.5)] = 0.0
    """Standard deviation of a relative error of all ranges that is drawn once per episode."""
    resolution: Annotated[Meters, Field(ge=0)] = 0.0
    """Ranges are multiples of this; 0 does not round."""
    resolution_growth: Annotated[Number, Field(ge=0, json_schema_extra={"x-unit": "1/m"})] = 0.0
    """Growth of the resolution with the square of the range, as of lidars that triangulate."""
    dropout: Share = 0.0
    """Share of beams that return nothing."""
    short_share: Share = 0.0
    """Share of beams that something unseen returns before the surface: dust, rain, an insect."""
    short_rate: Annotated[Number, Field(ge=0, json_schema_extra={"x-unit": "1/m"})] = 1.0
    """How the ranges of such beams fall off: exponentially, by this rate; 0 spreads them evenly up to the surface."""
    random_share: Share = 0.0
    """Share of beams that read any range."""
    range_dark: Annotated[Meters, Field(gt=0)] | None = None
    """Range at which a surface of 10 % reflectivity returns half of the beams; one of 90 % does so at `range_max`, and
    others in between by a power of reflectivity and cosine of the incidence. Null: the reflectivity does not matter."""
    fade: Annotated[Meters, Field(ge=0)] = 0.2
    """How gradually detection ceases with the range, for `range_dark`: the width of a logistic curve."""
    incidence_max: Annotated[Radians, Field(gt=0, le=1.5708)] | None = None
    """Largest angle between a beam and the normal of the surface at which it is returned; null: any."""
    blind: Annotated[list[Sector], Field(max_length=100)] = []
    """Sectors in which nothing is seen, as [first, last] angles in the frame of the lidar: struts, its own body."""
    divergence: Annotated[Radians, Field(ge=0, le=0.2)] = 0.0
    """Full angle of the cone of a beam; 0 is a line."""
    rays: Annotated[Integer, Field(ge=2, le=9)] = 3
    """Rays that stand for the cone, for `divergence`."""
    mixed: Literal["mean", "nearest", "farthest"] = "mean"
    """The reading of a beam whose cone meets surfaces more than 5 cm apart: a range between them, weighted by the light
    that comes back (a mixed pixel), the nearest or the farthest."""

    sweep: Bool = False
    """A scan takes time: beams are spread evenly over the `scan_time` of the lidar (of a full turn), the last one at
    the end of the step, and each sees the world as it was then, from where the lidar was then."""
    segments: Annotated[Integer, Field(ge=2, le=64)] = 8
    """Parts of a scan, for `sweep`: within one the lidar stays in its place, while directions of beams are exact."""

    @model_validator(mode="after")
    def _check(self) -> LidarRealism:
        shares = self.dropout + self.short_share + self.random_share
        if shares > 1:
            raise problem(
                "out-of-range",
                f"dropout, short_share and random_share are {shares:g} together",
                allowed="at most 1 together",
                fix="make one of them smaller",
            )
        return self

    def range_of(self, reflectivity: float, range_max: float) -> float:
        """The range at which half of the beams come back from a surface that they hit at right angles [m].

        Args:
            reflectivity: Share of the light that the surface throws back.
            range_max: Range of the lidar [m].
        """
        dark = range_max if self.range_dark is None else min(self.range_dark, range_max)
        growth = math.log(range_max / dark) / math.log(_WHITE / _DARK)
        return min(range_max, dark * math.pow(reflectivity / _DARK, growth))

    def kernel(self, range_max: float, spacing: float, scan_time: float) -> core.LidarErrors:
        """The options of the core.

        Args:
            range_max: Range of the lidar [m].
            spacing: Angle between neighboring beams [rad].
            scan_time: Duration of a full turn [s].
        """
        given = {name: getattr(self, name) for name in core.LidarErrors.fields if name != "beam_time"}
        given["beam_time"] = scan_time * spacing / (2 * math.pi) if self.sweep else 0.0
        given["range_dark"] = math.inf if self.range_dark is None else min(self.range_dark, range_max)
        given["incidence_max"] = math.inf if self.incidence_max is None else self.incidence_max
        return core.LidarErrors(**given)
