"""The way from a command to the control that a drive executes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar

from pydantic import Field

from irsim.options.base import Options
from irsim.options.units import Number, Seconds
from irsim.options.vectors import PerObject

__all__ = ["MAX_DELAY", "MOST_CONTROLS", "PER_CONTROL", "Actuation", "per_control"]

MOST_CONTROLS = 3
"""Number of controls of a drive up to which its commands pass through actuators."""
MAX_DELAY = 2.0
"""Longest dead time [s]."""
Time = Annotated[Seconds, Field(ge=0, le=10)]
DeadTime = Annotated[Seconds, Field(ge=0, le=MAX_DELAY)]
Size = Annotated[Number, Field(ge=0, le=1e6, json_schema_extra={"x-unit": "control units"})]
Jerk = Annotated[Number, Field(gt=0, le=1e9, json_schema_extra={"x-unit": "control units / s^2"})]


class Actuation(Options):
    """The way of commands to the drive that executes them; each key is off unless it is given.

    Commands pass, in this order: `command_period`, `delay`, `resolution`, the limits `vel_min`, `vel_max` and `acce` of
    the object with `jerk`, `lag`, `dead_band`, `noise`. At the end is the executed control, which sensors,
    behaviors, policies and recorded runs see. Values are one number for all controls, or a list with one per control,
    in the order of `vel_max`. An object without a command in a step is commanded to stop. Behaviors do not reckon with
    it: they decide as if commands were executed at once.
    """

    also_called: ClassVar[dict[str, str]] = {
        "period": "command_period",
        "hold": "command_period",
        "control_period": "command_period",
        "dead_time": "delay",
        "latency": "delay",
        "command_delay": "delay",
        "transport_delay": "delay",
        "quantization": "resolution",
        "quantisation": "resolution",
        "step": "resolution",
        "tau": "lag",
        "time_constant": "lag",
        "deadband": "dead_band",
        "dead_zone": "dead_band",
        "static_friction": "dead_band",
        "std": "noise",
        "sigma": "noise",
    }
    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"delay": 0.1, "lag": 0.15}, {"command_period": 0.2, "delay": [0.05, 0.1], "jerk": [2.0, 10.0]}]
    }

    command_period: Time = 0.0
    """Time for which a command is held before the next one is taken (zero-order hold); 0 takes one in each step."""
    delay: Annotated[Any, PerObject(DeadTime, "number", "control")] = 0.0
    """Dead time from a command to its effect, exact for multiples of `step_time` and linear between two steps. An
    object that departs later has `start_time`."""
    resolution: Annotated[Any, PerObject(Size, "number", "control")] = 0.0
    """Commands are rounded to multiples of this; 0 does not round."""
    jerk: Annotated[Any, PerObject(Jerk, "number", "control")] | None = None
    """Largest change of the rate of change; the control nears its target so that it does not overshoot. Null is
    unlimited."""
    lag: Annotated[Any, PerObject(Time, "number", "control")] = 0.0
    """Time constant of a first-order lag: after this time, 63.2 % of a step has been executed. Works in every
    `collision_mode`, unlike `tau` of the drive."""
    dead_band: Annotated[Any, PerObject(Size, "number", "control")] = 0.0
    """Controls smaller than this are executed as 0: static friction that a motor does not overcome."""
    noise: Annotated[Any, PerObject(Size, "number", "control")] = 0.0
    """Standard deviation of white noise of the executed control, drawn for each step or, with `command_period`, for
    each command. An object that stands does not tremble."""

    @property
    def has_delay(self) -> bool:
        """Whether commands take effect after a dead time."""
        return any(per_control(self.delay, MOST_CONTROLS))

    @property
    def is_noisy(self) -> bool:
        """Whether executed controls are random."""
        return any(per_control(self.noise, MOST_CONTROLS))


PER_CONTROL = ("delay", "resolution", "jerk", "lag", "dead_band", "noise")
"""Keys whose value may be a list with one number per control."""


def per_control(value: float | Sequence[float] | None, size: int, missing: float = 0.0) -> list[float]:
    """(size,) one number per control of a key of :data:`PER_CONTROL`.

    Args:
        value: Its value; None stands for ``missing``.
        size: Number of controls.
        missing: Value of controls that a list is too short for.
    """
    if isinstance(value, Sequence):
        return [*map(float, value[:size]), *[missing] * (size - len(value))]
    return [missing if value is None else float(value)] * size
