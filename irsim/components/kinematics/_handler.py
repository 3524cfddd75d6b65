"""Drives written in Python: the base class for users, and its registration as part of the language."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, TypeVar

import numpy as np

from irsim.common.arrays import Floats
from irsim.components.options import CustomKinematics
from irsim.options.colors import ACKER_COLOR, OBSTACLE_COLOR, PUSHABLE_COLOR, ROBOT_COLOR
from irsim.options.registry import KINEMATICS

__all__ = ["KinematicsHandler", "handler_class", "register_kinematics"]

Handler = TypeVar("Handler", bound="type[KinematicsHandler]")
_PALETTE = {"robot": ROBOT_COLOR, "robot_acker": ACKER_COLOR, "obstacle": OBSTACLE_COLOR}


class KinematicsHandler(ABC):
    """A drive: how the state follows from a control. Attributes and methods default to a differential drive.

    States are columns (state_dim, 1): x, y [m], heading [rad], further rows as the drive needs them; controls are
    columns (action_dim, 1).

    Args:
        name: Name it is registered under.
        noise: Whether the scenario asks for motion noise; :meth:`step` applies it.
        alpha: Parameters of the noise.

    Attributes:
        action_dim, state_dim, min_state_dim: Rows of control and state.
        vel_max, vel_min, acce: Limits if the scenario gives none.
        color, obstacle_color, color_key, description, show_arrow: How objects with this drive are drawn by default.
        passive: Whether the object only coasts, in ``collision_mode: contact``.
        default_mass: Mass if the scenario gives none [kg].
        translation_rows, yaw_rate_row: Which control rows are speeds [m/s] and which is the yaw rate, for contacts.
        tau: Lag of the drive in ``collision_mode: contact`` [s]; None is the world's.
        integration: ``world.integration`` of the scenario, ``euler`` or ``exact``, for :meth:`step` of a drive that
            turns. The functions of ``irsim.compat.functions`` take it as an argument.
    """

    action_dim: ClassVar[int] = 2
    state_dim: ClassVar[int] = 3
    min_state_dim: ClassVar[int] = 3
    vel_max: ClassVar[Sequence[float]] = [1, 1]
    vel_min: ClassVar[Sequence[float]] = [-1, -1]
    acce: ClassVar[Sequence[float]] = [math.inf, math.inf]
    color: ClassVar[str | None] = None
    obstacle_color: ClassVar[str | None] = None
    color_key: ClassVar[str] = "robot"
    description: ClassVar[str | None] = None
    show_arrow: ClassVar[bool] = True
    passive: ClassVar[bool] = False
    default_mass: ClassVar[float] = 1.0
    translation_rows: ClassVar[tuple[int, ...]] = (0,)
    yaw_rate_row: ClassVar[int | None] = None
    tau: float | None = None
    integration: str = "euler"

    def __init__(self, name: str, noise: bool = False, alpha: Sequence[float] | None = None) -> None:
        self.name = name
        self.noise = noise
        self.alpha = [0.03, 0, 0, 0.03] if alpha is None else alpha

    @classmethod
    def default_color(cls, role: str, pushable: bool = False) -> str:
        """Colour of an object if the scenario gives none."""
        if role == "robot":
            return cls.color or _PALETTE.get(cls.color_key, ROBOT_COLOR)
        return cls.obstacle_color or (PUSHABLE_COLOR if pushable else OBSTACLE_COLOR)

    @abstractmethod
    def step(self, state: Floats, velocity: Floats, step_time: float) -> Floats:
        """The state one period later.

        Args:
            state: (state_dim, 1).
            velocity: (action_dim, 1) control, limited.
            step_time: Period [s].

        Returns:
            (state_dim, 1); missing rows keep their values.
        """

    def velocity_to_xy(self, state: Floats, velocity: Floats) -> Floats:
        """(2, 1) velocity in the world frame [m/s] that follows from a control."""
        theta, forward = float(state[2, 0]), float(np.asarray(velocity)[0, 0])
        return np.array([[forward * math.cos(theta)], [forward * math.sin(theta)]])

    def velocity_from_xy(self, state: Floats, velocity_xy: Floats) -> Floats:
        """(action_dim, 1) control for a velocity in the world frame: its part along the heading."""
        theta = float(state[2, 0])
        vx, vy = (float(v) for v in np.asarray(velocity_xy, dtype=np.float64).reshape(-1)[:2])
        control = np.zeros((self.action_dim, 1))
        control[0, 0] = vx * math.cos(theta) + vy * math.sin(theta)
        return control

    def coast(
        self, velocity: Floats, step_time: float, friction: float, gyration: float = 0.0, gravity: float = 9.81
    ) -> Floats:
        """(action_dim, 1) control of the next period when nothing drives the object, for contacts; zero by default."""
        return np.zeros_like(np.asarray(velocity, dtype=np.float64))

    def compute_max_speed(self, vel_max: Floats) -> float:
        """Highest speed that limits allow [m/s]."""
        return float(np.asarray(vel_max).reshape(-1)[0])

    def compute_heading(self, state: Floats, velocity: Floats) -> float:
        """Direction of travel [rad], world frame."""
        return float(state[2, 0])


def register_kinematics(name: str) -> Callable[[Handler], Handler]:
    """Register a subclass of :class:`KinematicsHandler` as the drive ``name`` of scenarios; names are in lower case.

    The class is instantiated once per object with ``name``, ``noise``, ``alpha`` and the other keys of its mapping.

    Raises:
        TypeError: The class is not such a subclass.
        ValueError: Another class already has the name.
    """
    key = name.lower()

    def add(handler: Handler) -> Handler:
        if not issubclass(handler, KinematicsHandler):
            raise TypeError(f"kinematics {key!r}: derive the class from KinematicsHandler")
        known = KINEMATICS.get(key)
        if known is not None and known.function is not handler:
            raise ValueError(f"kinematics {key!r} is already registered")
        if known is None:
            KINEMATICS.register(_options_of(key, handler), name=key, function=handler)
        return handler

    return add


def handler_class(name: str | None) -> type[KinematicsHandler] | None:
    """The class that user code has registered for a drive; None if there is no such class."""
    feature = KINEMATICS.get(name) if name is not None else None
    made = feature.function if feature is not None else None
    return made if isinstance(made, type) and issubclass(made, KinematicsHandler) else None


def _options_of(name: str, handler: type[KinematicsHandler]) -> type[CustomKinematics]:
    """The options model of a handler: it accepts any key and holds the facts that the language needs."""
    rows = ("x", "y", "theta", *(f"state{row}" for row in range(3, max(3, handler.state_dim))))
    members = {
        "__doc__": handler.__doc__ or f"The drive {name!r} of user code.",
        "__module__": handler.__module__,
        "state_rows": rows,
        "control_rows": tuple(f"control{row}" for row in range(handler.action_dim)),
        "control_units": ("control units",) * handler.action_dim,
        "usual_vel_max": tuple(map(float, handler.vel_max)),
        "usual_vel_min": tuple(map(float, handler.vel_min)),
        "usual_acce": tuple(map(float, handler.acce)),
        "usual_colors": (handler.default_color("robot"), handler.default_color("obstacle")),
        "picture": handler.description,
        "arrow": handler.show_arrow,
    }
    made: type[CustomKinematics] = type(handler.__name__, (CustomKinematics,), members)
    return made


def construct(options: Any, integration: str = "euler") -> KinematicsHandler:
    """The handler of one object.

    Args:
        options: The options of its drive.
        integration: ``world.integration`` of the scenario.

    Raises:
        TypeError: The constructor does not accept a key of the mapping.
    """
    maker = handler_class(options.name)
    if maker is None:
        raise LookupError(f"kinematics {options.name!r} is not a drive of user code")
    given: dict[str, Any] = options.model_dump(exclude_unset=True)
    extra = {key: value for key, value in given.items() if key not in ("name", "noise", "alpha", "tau")}
    handler: KinematicsHandler = maker(options.name, options.noise, given.get("alpha"), **extra)
    handler.tau = options.tau
    handler.integration = integration
    return handler
