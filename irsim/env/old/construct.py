"""Classes of objects and worlds that scripts construct directly, with keywords."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Literal

from irsim.compat.objects.view import ScriptObject
from irsim.env.parameters import WorldView
from irsim.objects.lifecycle import lone_simulation, set_views
from irsim.objects.view import ObjectView
from irsim.scenario.model.scenario import Scenario, WorldModel
from irsim.scenario.read import or_raise, read
from irsim.scenario.resolve.expand import resolve
from irsim.scenario.single_object import read_object
from irsim.simulation.active_env import last_used
from irsim.simulation.simulation import Simulation

__all__ = [
    "ObjectBase",
    "ObjectGroup",
    "ObjectStatic",
    "ObstacleAcker",
    "ObstacleDiff",
    "ObstacleOmni",
    "RobotAcker",
    "RobotDiff",
    "RobotOmni",
    "World",
]

_FURTHER = (
    *("static", "mass", "friction", "inertia", "restitution", "vel_min", "vel_max", "acce", "angle_range", "behavior"),
    *("group_behavior", "goal_threshold", "sensors", "arrive_mode", "description", "group", "group_name"),
    *("state_dim", "vel_dim", "unobstructed", "fov", "fov_radius", "name"),
)
"""Keys that ``ObjectBase`` also takes by position after ``color``, in the order of IR-SIM 2.12."""


class _AnyObject(type):
    """Metaclass for which every object of an environment is an ``ObjectBase``, however it was made."""

    def __instancecheck__(cls, instance: Any) -> bool:
        return isinstance(instance, ObjectView) if cls.__name__ == "ObjectBase" else super().__instancecheck__(instance)


class ObjectBase(ScriptObject, metaclass=_AnyObject):
    """An object made from the keys of a scenario entry; ``env.add_object`` puts it into a world.

    Subclasses may override ``pre_process``, ``mid_process``, ``post_process``, ``gen_behavior_vel`` and ``step``.

    Args:
        shape: Shape, such as ``{"name": "circle", "radius": 0.2}``; by default a circle of 1 m.
        kinematics: Drive, such as ``{"name": "diff"}``; an object without one never moves.
        state: Initial state; by default zeros.
        velocity: Initial control.
        goal: A goal, a list of goals, or None.
        role: ``robot`` or ``obstacle``.
        color: Colour; by default black.
        *further: Values of ``static``, ``mass`` and the other keys of :data:`_FURTHER`, in this order.
        **keys: The other keys of a scenario entry.

    Raises:
        ScenarioError: A key or value is not valid.
    """

    def __init__(
        self,
        shape: Any = None,
        kinematics: Any = None,
        state: Any = None,
        velocity: Any = None,
        goal: Any = None,
        role: Literal["robot", "obstacle"] = "obstacle",
        color: Any = "k",
        *further: Any,
        **keys: Any,
    ) -> None:
        if len(further) > len(_FURTHER):
            raise TypeError(f"ObjectBase takes at most {7 + len(_FURTHER)} arguments without a name")
        for name, value in zip(_FURTHER, further, strict=False):
            if name in keys:
                raise TypeError(f"ObjectBase got two values for {name!r}")
            keys[name] = value
        env = last_used()
        given = dict(shape=shape, kinematics=kinematics, state=state, velocity=velocity, goal=goal, color=color, **keys)
        scenario = resolve(Scenario(world=WorldModel())) if env is None else env.simulation.scenario
        number = 0 if env is None else next(env.env_param.id_iter)
        record, findings = read_object(role, given, scenario.world, number)
        for item in findings:
            if env is not None:
                env.logger.warning(f"{record.name}: {item.message} [{item.code}]")
        simulation = lone_simulation(scenario, record, 0 if env is None else env.simulation.key()[0])
        super().__init__(simulation, 0)
        set_views(simulation, [self])
        if env is not None:
            self._made_beside = env._objects


class World(WorldView):
    """A world without objects and without an environment.

    Args:
        name: Name of the world.
        height: Extent along y [m].
        width: Extent along x [m].
        step_time: Period of a step [s].
        sample_time: Period of the drawn frames [s]; None draws every step.
        offset: [x, y] of the lower left corner [m]; None is the origin.
        step_mode, control_mode, collision_mode: As in a scenario.
        gravity, friction, restitution, drive_tau: Settings of ``collision_mode: contact``, as in a scenario.
        obstacle_map: An array (nx, ny) of occupancies, a picture file, or the mapping of a generator.
        mdownsample: Merge blocks of N x N cells of the map.
        fog_map, fog_map_resolution: Whether to record the cells that robots have seen, and the size of a cell [m].
        plot: Keys of the figure.
        status: Word shown in titles.
        world_param_instance: Ignored, accepted for compatibility: each world has its own parameters.
        **keys: Other keys of the ``world`` section.

    Raises:
        ScenarioError: A key or value is not valid.
    """

    def __init__(
        self,
        name: str | None = "world",
        height: float = 10,
        width: float = 10,
        step_time: float = 0.1,
        sample_time: float | None = None,
        offset: Sequence[float] | None = None,
        step_mode: str = "internal",
        control_mode: str = "auto",
        collision_mode: str = "stop",
        gravity: float = 9.81,
        friction: float = 0.5,
        restitution: float = 0.0,
        drive_tau: float = 0.0,
        obstacle_map: Any = None,
        mdownsample: int = 1,
        fog_map: bool = False,
        fog_map_resolution: float | None = None,
        plot: dict[str, Any] | None = None,
        status: str | None = None,
        world_param_instance: Any = None,
        **keys: Any,
    ) -> None:
        given = {key: value for key, value in locals().items() if key in WorldModel.model_fields and value is not None}
        scenario, _ = or_raise(read({"world": {**given, **keys}}, strict=True, name="World"))
        super().__init__(Simulation(scenario, [0]))


class ObjectGroup(Sequence[ScriptObject]):
    """Objects that belong together; the settings of the first member hold for the group.

    Args:
        members: The objects.
        group_id: Number of the group; by default the group of the first member.
    """

    def __init__(self, members: Iterable[ScriptObject], group_id: int | None = None) -> None:
        self.members = list(members)
        self.group_id = group_id if group_id is not None or not self.members else self.members[0].group

    def __len__(self) -> int:
        return len(self.members)

    def __getitem__(self, index: Any) -> Any:
        return self.members[index]

    def __iter__(self) -> Iterator[ScriptObject]:
        return iter(self.members)

    @property
    def number(self) -> int:
        """Number of members."""
        return len(self.members)

    @property
    def role(self) -> str | None:
        """Role of the first member."""
        return self.members[0].role if self.members else None

    @property
    def kinematics(self) -> str | None:
        """Drive of the first member."""
        return self.members[0].kinematics if self.members else None

    @property
    def group_behavior(self) -> dict[str, Any]:
        """Keys of the group behavior of the first member; empty without one."""
        return self.members[0].group_behavior_dict if self.members else {}

    @property
    def logger(self) -> Any:
        """The logger of the environment of the first member; None without one."""
        return self.members[0].logger if self.members else None

    def gen_group_vel(self) -> list[Any]:
        """Return the control that each member would choose now, (vel_dim, 1) each; None for static members."""
        return [None if view.static else view.gen_behavior_vel() for view in self.members]

    def step(self, actions: Sequence[Any] | None = None, sensor_step: bool = True) -> None:
        """Advance each member by one period, without the other objects of the world.

        Args:
            actions: One control per member; None in place of a control, or of the list, lets the behavior choose.
            sensor_step: Also update the sensors.
        """
        wanted = [None] * len(self.members) if actions is None else list(actions)
        for view, action in zip(self.members, wanted, strict=True):
            view.step(action, sensor_step=sensor_step)


class _Old(ObjectBase):
    """Base of the object classes that IR-SIM has deprecated."""

    _fixed: tuple[Literal["robot", "obstacle"], str | None, Any] = ("obstacle", None, "k")

    def __init__(self, color: Any = None, state_dim: int | None = None, **keys: Any) -> None:
        role, drive, own_color = self._fixed
        warnings.warn(
            f"{type(self).__name__} is deprecated: use ObjectFactory or ObjectBase", DeprecationWarning, stacklevel=2
        )
        keys.pop("role", None)
        kinematics = keys.pop("kinematics", None) or (None if drive is None else {"name": drive})
        chosen = own_color if color is None else color
        super().__init__(kinematics=kinematics, role=role, color=chosen, state_dim=state_dim, **keys)


class ObjectStatic(_Old):
    """An obstacle that never moves."""


class ObstacleDiff(_Old):
    """An obstacle with a differential drive."""

    _fixed = ("obstacle", "diff", "k")


class ObstacleOmni(_Old):
    """An obstacle with an omnidirectional drive."""

    _fixed = ("obstacle", "omni", "k")


class ObstacleAcker(_Old):
    """An obstacle with an Ackermann drive."""

    _fixed = ("obstacle", "acker", "k")


class RobotDiff(_Old):
    """A robot with a differential drive."""

    _fixed = ("robot", "diff", "g")


class RobotOmni(_Old):
    """A robot with an omnidirectional drive."""

    _fixed = ("robot", "omni", "g")


class RobotAcker(_Old):
    """A robot with an Ackermann drive."""

    _fixed = ("robot", "acker", "y")
