"""Actors of CARLA: which object is which kind of actor, and how actors are found, made and destroyed."""

from __future__ import annotations

import fnmatch
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from irsim.bridges.base import BridgeError
from irsim.bridges.solids import box_of
from irsim.common.text import clean
from irsim.components.bridges.carla import Carla
from irsim.diagnostics.diagnostic import suggestion
from irsim.simulation.scene import Lidar, SceneDescription, SceneObject

__all__ = ["Ground", "Role", "Spawner", "cast", "find_actor", "place"]

USUAL_WHEELBASE = 1.0
"""Wheelbase of a car whose shape has no wheelbase [m], as its drive has it."""


@dataclass(frozen=True)
class Role:
    """An object and what it is in the town.

    Attributes:
        agent: The object.
        kind: ``walker``, ``vehicle``, or ``followed``: an existing actor.
        external: Whether CARLA moves it.
        ahead: How far the middle of its body is ahead of its origin [m]; actors have their origin in the middle.
        lidars: Its lidars that CARLA measures.
        wheelbase: Of the vehicle in CARLA [m]; only of vehicles that are steered.
        followed: Role name or id of an existing actor.
    """

    agent: SceneObject
    kind: Literal["walker", "vehicle", "followed"]
    external: bool = False
    ahead: float = 0.0
    lidars: tuple[Lidar, ...] = ()
    wheelbase: float = USUAL_WHEELBASE
    followed: str | int = 0


def cast(scene: SceneDescription, options: Carla) -> tuple[Role, ...]:
    """Decide what the objects are.

    Raises:
        BridgeError: A name is unknown, given twice, or an object cannot be what it should be.
    """
    vehicles = options.vehicles
    if vehicles is None:
        vehicles = [a.name for a in scene.agents if a.moves and a.steered and a.name not in options.follow]
    walkers = options.walkers
    if walkers is None:
        taken = {*vehicles, *options.follow}
        walkers = [agent.name for agent in scene.agents if agent.moves and agent.name not in taken]
    _check_names(scene, {"walkers": walkers, "vehicles": vehicles, "follow": list(options.follow)})
    seen = _robots_with_lidars(scene, options, {*walkers, *vehicles})
    roles = []
    for agent in scene.agents:
        lidars = agent.lidars if agent.name in seen else ()
        if agent.name in vehicles:
            roles.append(_vehicle(agent, options, lidars))
        elif agent.name in walkers:
            roles.append(Role(agent, "walker", lidars=lidars))
        elif agent.name in options.follow:
            ahead = box_of(agent).ahead
            roles.append(Role(agent, "followed", True, ahead, followed=options.follow[agent.name]))
    if not roles:
        fix = "name objects under walkers or vehicles; without names, all objects that can move are in the town"
        raise BridgeError("bridge-mismatch", "no object of the scenario is in the town of CARLA", fix)
    return tuple(roles)


def _vehicle(agent: SceneObject, options: Carla, lidars: tuple[Lidar, ...]) -> Role:
    external = options.command != "transform"
    wheelbase = options.wheelbase or agent.wheelbase or (USUAL_WHEELBASE if agent.steered else None)
    if options.command == "ackermann":
        if agent.drive in ("omni", "omni_angular"):
            what = f"'{agent.name}' moves sideways, which a steered vehicle cannot"
            raise BridgeError("bridge-mismatch", what, "command: velocity")
        if wheelbase is None:
            what = f"'{agent.name}' has no wheelbase, so that its turns are not steering angles"
            raise BridgeError("bridge-mismatch", what, "wheelbase: 2.87, or command: velocity")
    return Role(agent, "vehicle", external, box_of(agent).ahead, lidars, wheelbase or USUAL_WHEELBASE)


def _check_names(scene: SceneDescription, given: dict[str, Sequence[str]]) -> None:
    seen: dict[str, str] = {}
    for key, names in given.items():
        for name in names:
            if name not in scene.names:
                fix = suggestion(name, scene.names, f"the objects are {', '.join(scene.names[:5])}")
                raise BridgeError("bridge-mismatch", f"{key} of the bridge carla has no object {clean(name)!r}", fix)
            if name in seen:
                what = f"'{name}' is named under {seen[name]} and under {key}"
                raise BridgeError("bridge-mismatch", what, "name each object once")
            seen[name] = key


def _robots_with_lidars(scene: SceneDescription, options: Carla, present: Iterable[str]) -> set[str]:
    """Names of the objects whose lidars CARLA measures."""
    if options.lidar is None:
        return set()
    known = {name for name in present if scene.agent(name).lidars}
    if options.lidar.robots is None:
        chosen = known
    else:
        chosen = set(options.lidar.robots)
        for name in sorted(chosen - known):
            fix = suggestion(name, sorted(known), f"those with lidars are {', '.join(sorted(known)) or 'none'}")
            what = f"{clean(name)!r} is not an object in the town with a lidar"
            raise BridgeError("bridge-mismatch", what, fix)
    if not chosen:
        fix = "give a robot a sensor lidar2d, or leave out the key lidar"
        raise BridgeError("bridge-mismatch", "no object in the town has a lidar that CARLA could measure", fix)
    return chosen


LIFTS = (0.5, 1.0, 1.5, 2.0)
"""Heights above the ground [m] from which actors are dropped, one after the other until one has room."""
_ABOVE, _BELOW = 2.0, 20.0
"""The ray that finds the ground starts this much above the road and ends this much below [m]."""
_FAR_ROAD = 30.0
"""A road farther away than this [m] says nothing about the ground."""


def place(carla: Any, at: Iterable[float], height: float) -> Any:
    """A transform of CARLA for x, y [m], yaw [deg], and a height [m]."""
    x, y, yaw = (float(value) for value in at)
    return carla.Transform(carla.Location(x=x, y=y, z=float(height)), carla.Rotation(pitch=0.0, yaw=yaw, roll=0.0))


class Ground:
    """Heights of the ground.

    Args:
        carla: The module.
        world: The world of the server.
        choice: ``project``, ``road`` or one height [m].
    """

    def __init__(self, carla: Any, world: Any, choice: str | float) -> None:
        self._carla, self._world, self._choice = carla, world, choice
        self._map: Any = None
        if isinstance(choice, str):
            try:
                self._map = world.get_map()
            except RuntimeError:  # some towns have no roads
                if choice == "road":
                    what = "the town of the server has no roads (no OpenDRIVE)"
                    raise BridgeError("bridge-mismatch", what, "ground: project") from None

    def under(self, x: float, y: float) -> float:
        """Height of the ground at a place where nothing stands yet [m].

        Raises:
            BridgeError: There is no ground or road there.
        """
        road = self.road(x, y)
        if self._choice != "project":
            if road is None:
                what = f"there is no road within {_FAR_ROAD:g} m of x={x:.1f}, y={y:.1f} of CARLA"
                raise BridgeError("bridge-mismatch", what, "move the scenario with transform, or write ground: project")
            return road
        start = (0.0 if road is None else road) + _ABOVE
        result = self._world.ground_projection(self._carla.Location(x=x, y=y, z=start), _ABOVE + _BELOW)
        if result is not None:
            return float(result.location.z)
        if road is not None:
            return road
        what = f"there is no ground at x={x:.1f}, y={y:.1f} of CARLA"
        fix = "move the scenario into the town with transform, or write ground: 0.0"
        raise BridgeError("bridge-mismatch", what, fix)

    def road(self, x: float, y: float) -> float | None:
        """Height of the nearest road [m], or the height that was given; None without a road near by."""
        if not isinstance(self._choice, str):
            return float(self._choice)
        if self._map is None:
            return None
        location = self._carla.Location(x=x, y=y, z=0.0)
        waypoint = self._map.get_waypoint(location, project_to_road=True, lane_type=self._carla.LaneType.Any)
        if waypoint is None:
            return None
        result = waypoint.transform.location
        return float(result.z) if abs(result.x - x) + abs(result.y - y) <= _FAR_ROAD else None


class Spawner:
    """Spawns actors and remembers them.

    Args:
        carla: The module.
        world: The world of the server.

    Attributes:
        spawned: Ids of the actors, in order.
    """

    def __init__(self, carla: Any, world: Any) -> None:
        self._carla, self._world = carla, world
        self._library = world.get_blueprint_library()
        self.spawned: list[int] = []

    def blueprint(self, pattern: str, turn: int, attributes: Mapping[str, str]) -> Any:
        """A blueprint.

        Args:
            pattern: Its name, or a pattern.
            turn: Index among the blueprints that fit; it wraps around.
            attributes: Attributes to set; the ones that the blueprint lacks are ignored.

        Raises:
            BridgeError: No blueprint fits.
        """
        names = sorted(str(blueprint.id) for blueprint in self._library)
        fitting = [name for name in names if fnmatch.fnmatchcase(name, pattern)]
        if not fitting:
            family = [name for name in names if name.split(".")[0] == pattern.split(".")[0]] or names
            fix = suggestion(pattern, family, f"such as {', '.join(family[:3])}")
            raise BridgeError("bridge-mismatch", f"the server has no blueprint {clean(pattern)!r}", fix)
        result = self._library.find(fitting[turn % len(fitting)])
        for key, value in attributes.items():
            if result.has_attribute(key):
                result.set_attribute(key, value)
        return result

    def drop(self, name: str, blueprint: Any, at: Iterable[float], ground: float) -> Any:
        """Spawn an actor a little above the ground, higher if there is no room.

        Args:
            name: Its name in messages.
            blueprint: Its blueprint.
            at: x, y [m], yaw [deg] of CARLA.
            ground: Height of the ground [m].

        Raises:
            BridgeError: There is no room.
        """
        x, y, yaw = (float(value) for value in at)
        for lift in LIFTS:
            actor = self._world.try_spawn_actor(blueprint, place(self._carla, (x, y, yaw), ground + lift))
            if actor is not None:
                self.spawned.append(int(actor.id))
                return actor
        what = f"there is no room in the town for '{clean(name)}' at x={x:.1f}, y={y:.1f} of CARLA, z={ground:.1f}"
        raise BridgeError("bridge-mismatch", what, "move it, or move the scenario with transform")

    def attach(self, blueprint: Any, transform: Any, parent: Any) -> Any:
        """Spawn an actor on another one."""
        actor = self._world.spawn_actor(blueprint, transform, attach_to=parent)
        self.spawned.append(int(actor.id))
        return actor

    def destroy(self, actor: Any) -> None:
        """Destroy one actor."""
        self.spawned.remove(int(actor.id))
        actor.destroy()


def find_actor(world: Any, wanted: str | int, name: str) -> Any:
    """The existing actor with a role name or an id.

    Raises:
        BridgeError: No actor or several actors match.
    """
    actors = list(world.get_actors())
    if isinstance(wanted, int):
        result = [actor for actor in actors if actor.id == wanted]
    else:
        result = [actor for actor in actors if actor.attributes.get("role_name") == wanted]
    if len(result) == 1:
        return result[0]
    roles = sorted({str(actor.attributes.get("role_name")) for actor in actors if actor.attributes.get("role_name")})
    if result:
        numbers = ", ".join(str(actor.id) for actor in result[:5])
        what = f"'{clean(name)}' cannot follow {clean(str(wanted))!r}: {len(result)} actors have this role name"
        raise BridgeError("bridge-mismatch", what, f"write the id of one: {numbers}")
    what = f"'{clean(name)}' cannot follow {clean(str(wanted))!r}: the town has no such actor"
    raise BridgeError("bridge-mismatch", what, f"role names in the town are {clean(', '.join(roles[:8])) or 'none'}")
