"""``contact2d``: draws the contact forces of ``collision_mode: contact``."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.components.options import SensorOptions
from irsim.options.colors import Color
from irsim.options.registry import SENSORS
from irsim.options.units import Fraction, Number, Points


class Contact2d(SensorOptions):
    """Records the contacts of the object and draws their forces as arrows; only the first of several records."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "contact2d"}]}

    name: Literal["contact2d"] = "contact2d"
    force_scale: Annotated[Number, Field(gt=0, json_schema_extra={"x-unit": "m/N"})] = 0.05
    """Length of an arrow per newton."""
    marker_size: Annotated[Points, Field(ge=0)] = 6.0
    """Size of the contact marks."""
    linewidth: Annotated[Points, Field(ge=0)] = 1.5
    """Width of the arrows."""
    alpha: Fraction = 0.9
    """Opacity of marks and arrows."""
    color: Color = "#CC79A7"
    """Colour of marks and arrows."""


@SENSORS.register(Contact2d)
def contact2d(parent: Any, options: Contact2d, rng: Any) -> Any:
    """List of :class:`irsim.objects.sensors.contact.ContactReport`: of the contacts of the last step."""
    return parent.contact.reports
