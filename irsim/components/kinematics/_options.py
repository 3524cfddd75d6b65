"""Options that all drives have in common."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import ConfigDict, Field

from irsim.options.base import Options
from irsim.options.units import Bool, Meters, Seconds

__all__ = ["CustomKinematics", "KinematicsOptions"]


class KinematicsOptions(Options):
    """Keys that every drive takes."""

    any_case: ClassVar[bool] = True

    state_rows: ClassVar[tuple[str, ...]] = ("x", "y", "theta")
    """Names of the state rows."""
    control_rows: ClassVar[tuple[str, ...]] = ("linear", "angular")
    """Names of the control components, in the order of ``vel_max``, ``velocity`` and actions. Checks of units look for
    ``angular``, ``yaw``, ``steer`` and ``lateral`` in them."""
    control_units: ClassVar[tuple[str, ...]] = ("m/s", "rad/s")
    speeds: ClassVar[int] = 0
    """Number of leading controls that are speeds of the body: 1 is forward, 2 are forward and sideways. It is 0 if
    unknown, as for drives of user code: nothing is then checked about their limits."""
    turns: ClassVar[bool] = True
    """Whether a control changes the heading."""
    steered: ClassVar[bool] = False
    """Whether the second control steers wheels: the heading changes only while they roll, and the wheelbase matters."""
    usual_vel_max: ClassVar[tuple[float, ...]] = ()
    usual_vel_min: ClassVar[tuple[float, ...]] = ()
    usual_acce: ClassVar[tuple[float, ...]] = ()
    """Limits if a scenario gives none; empty means 1, -1 and infinity, in this order, for each control."""
    usual_colors: ClassVar[tuple[str, str] | None] = None
    """Colours of robots and obstacles if a scenario gives none; None means the common colours."""
    picture: ClassVar[str | None] = None
    """Image that robots are drawn with if a scenario gives none."""
    arrow: ClassVar[bool] = True
    """Whether the heading is drawn if a scenario does not say."""

    name: str
    """Name of the drive, which is the motion model."""
    noise: Bool = False
    """Add Gaussian noise to the executed velocity, drawn in each step for each object."""
    mode: str | None = None
    """Only `acker` uses it; the other drives accept and ignore it."""
    tau: Annotated[Seconds, Field(ge=0)] | None = None
    """Lag of the drive in `collision_mode: contact`; null is `world.drive_tau`."""
    wheelbase: Annotated[Meters, Field(ge=0)] | None = None
    """Distance between the axles for the motion model; null is the `wheelbase` of the shape."""


class CustomKinematics(KinematicsOptions):
    """A drive registered by user code: its own keys reach the registered function as they are."""

    model_config = ConfigDict(extra="allow")
