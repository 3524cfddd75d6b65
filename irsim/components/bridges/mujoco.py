"""``mujoco``: MuJoCo moves robots with wheels, masses and contacts; irsim decides."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.components.options import BridgeOptions, opened_by
from irsim.options.registry import BRIDGES
from irsim.options.units import Fraction, Integer, Kilograms, Meters, Number, Seconds


class Mujoco(BridgeOptions):
    """Let MuJoCo, a simulator of rigid bodies, move robots: irsim decides; wheels, masses and contacts act there.

    At the end of the run it reports contacts, slip, and the difference between the lidars of both simulators. Needs
    `pip install 'irsim-mcp[mujoco]'`.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "mujoco"}, {"name": "mujoco", "slip": 0.2, "latency": 0.15, "video": "run.mp4"}]
    }

    files: ClassVar[tuple[str, ...]] = ("video", "report")

    objects: ClassVar[tuple[str, ...]] = ("agents",)

    name: Literal["mujoco"] = "mujoco"
    agents: list[str] | None = None
    """Names of the objects that MuJoCo moves; null is all robots whose drive is diff, omni, omni_angular or acker, and
    all obstacles that can be pushed. An empty list moves none and compares the lidars only."""
    timestep: Annotated[Seconds, Field(gt=0, le=0.05)] = 0.005
    """Longest period of the physics; `step_time` is divided into equal periods."""
    friction: Annotated[Number, Field(gt=0, le=10)] = 1.0
    """Coefficient of friction between wheels and ground; 0.1 is ice. It also limits the acceleration of omnidirectional
    robots."""
    mass: Annotated[Kilograms, Field(gt=0)] | None = None
    """Mass of each robot; null is its mass in the scenario, by default 1 kg."""
    lag: Annotated[Seconds, Field(gt=0, le=10)] = 0.02
    """Time constant of motors: how fast wheels take on the speed that is wanted."""
    slip: Fraction = 0.0
    """Wheels lose up to this share of their speed, a random share for each wheel in each step; for omnidirectional
    robots, each component of the velocity does."""
    latency: Annotated[Seconds, Field(ge=0, le=10)] = 0.0
    """Time until a command reaches the motors; until the first one arrives they stand still."""
    command_noise: Annotated[Number, Field(ge=0, le=10)] = 0.0
    """Standard deviation of the noise of the motors' speeds, relative to the speed."""
    lidar: Literal["compare", "replace", "off"] = "compare"
    """Use of MuJoCo's rays: `compare` reports their difference to irsim's ranges, with all robots upright;
    `replace` gives robots MuJoCo's ranges, in which robots on wheels pitch a little; `off` casts none."""
    range_noise: Annotated[Meters, Field(ge=0)] = 0.0
    """Standard deviation of the noise of ranges, with `lidar: replace`."""
    height: Annotated[Meters, Field(ge=0.3)] = 1.0
    """Height of obstacles and walls."""
    video: str | None = None
    """File of a video: .mp4, .gif, .webm or another suffix of `irsim render`; null writes none."""
    camera: str = "corner"
    """Where the video is seen from: `top`, `corner`, or behind the robot of this name."""
    size: Annotated[list[Annotated[Integer, Field(ge=16, le=4096)]], Field(min_length=2, max_length=2)] = [640, 480]
    """Width and height of the video in pixels."""
    report: Annotated[str, Field(pattern=r"\.json$")] | None = Field(default=None, examples=["report.json"])
    """File for the report as JSON; null writes none. The main numbers are logged in any case."""


BRIDGES.register(Mujoco)(opened_by("mujoco"))
