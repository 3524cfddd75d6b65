"""``diff_dynamic``: differential drive with mass and motors."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import KinematicsOptions
from irsim.options.registry import KINEMATICS
from irsim.options.units import Meters, Number, Seconds

Positive = Annotated[Number, Field(ge=1e-6, le=1e6)]


class DiffDynamic(KinematicsOptions):
    """Differential drive with mass and motors: controls are the wanted forward speed and yaw rate, as of `diff`.

    A controller asks both motors for the torques that would bring the speeds to the wanted ones within `response`. It
    gets at most `torque_max`, and what `voltage` drives against the voltage that a turning motor makes itself. So a
    heavy robot starts and stops slowly, and its top speed follows from its motors. The wheels roll without slip, except
    on `world.zones` with `slip`, and their forces end at `friction` times the load of each. Each step is integrated in
    small parts, whatever `world.integration`. The fourth and fifth state rows are the rates of the left and the right
    wheel in rad/s. The usual numbers describe a base of 10 kg, no particular robot. Contacts cannot push it.
    """

    state_rows: ClassVar[tuple[str, ...]] = ("x", "y", "theta", "left", "right")
    speeds: ClassVar[int] = 1
    slips: ClassVar[bool] = True
    feels: ClassVar[tuple[str, ...]] = ("slip", "grip")
    coasts: ClassVar[bool] = True
    usual_acce: ClassVar[tuple[float, ...]] = (2.0, 4.0)

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "diff_dynamic", "mass": 40.0, "inertia": 2.0}]}

    name: Literal["diff_dynamic"] = "diff_dynamic"
    alpha: Annotated[list[Annotated[Number, Field(ge=0)]], Field(min_length=4, max_length=4)] = [0.03, 0.0, 0.0, 0.03]
    """Noise variances: linear from v², linear from ω², angular from v², angular from ω²."""
    mass: Positive = 10.0
    """Mass with wheels and rotors [kg]."""
    inertia: Positive = 0.3
    """Moment of inertia about the vertical axis through the middle of the axle [kg m²]."""
    wheel_radius: Annotated[Meters, Field(ge=1e-3, le=1e3)] = 0.08
    """Radius of the wheels."""
    track: Annotated[Meters, Field(ge=1e-3, le=1e3)] = 0.4
    """Distance of the wheels."""
    drag: Annotated[Number, Field(ge=0, le=1e6)] = 1.0
    """Force that slows the body per speed [N s/m]."""
    turn_drag: Annotated[Number, Field(ge=0, le=1e6)] = 0.05
    """Torque that slows its turn per yaw rate [N m s]."""
    torque_max: Positive | None = 2.0
    """Largest torque of a wheel [N m]; null leaves it to the voltage."""
    voltage: Positive | None = 12.0
    """Largest voltage of a motor [V]; null is unlimited."""
    resistance: Positive = 2.0
    """Resistance of a motor [Ω]."""
    torque_constant: Positive = 0.03
    """Torque of a motor per current [N m/A], which is its own voltage per rate [V s]."""
    gear: Positive = 20.0
    """Turns of the motor per turn of the wheel."""
    response: Annotated[Seconds, Field(ge=0.001)] = 0.05
    """Time constant with which the controller of the speeds works."""
    friction: Positive | None = None
    """Coefficient of friction of the wheels: it limits the force of each to this share of half the weight, which
    `grip` of a zone changes. Null sets no limit; in a zone the coefficient is then `grip` itself."""
    slip_stiffness: Positive | None = None
    """Slope k of the force of a wheel over its slip: force = friction · load · tanh(k · slip). Wheels that pull turn
    faster than they roll, and wheels that brake slower, which odometry reports. Null lets no wheel slip under force."""


KINEMATICS.register(DiffDynamic, kernel=core.DiffDynamicOptions)
