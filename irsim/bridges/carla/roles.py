"""What each object of a scenario is in a town: a walker, a vehicle, the copy of an actor of others, or nothing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from irsim.bridges.base import BridgeError
from irsim.bridges.footprint import box_of
from irsim.common.text import clean
from irsim.components.bridges.carla import Carla
from irsim.diagnostics.diagnostic import suggestion
from irsim.simulation.scene import Lidar, SceneDescription, SceneObject

__all__ = ["Role", "cast"]

USUAL_WHEELBASE = 1.0
"""Of a car whose shape has none [m], as its drive has it."""


@dataclass(frozen=True)
class Role:
    """An object and what it is in the town.

    Attributes:
        agent: The object.
        kind: ``walker``, ``vehicle``, or ``followed``: an actor of others.
        external: Whether CARLA moves it.
        ahead: How far the middle of its body is ahead of its origin [m]; actors have their origin in the middle.
        lidars: Its lidars that CARLA measures.
        wheelbase: Of the vehicle in CARLA [m]; only of vehicles that are steered.
        followed: Role name or id of the actor of others.
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
        vehicles = [a.name for a in scene.agents if a.moves and a.drive == "acker" and a.name not in options.follow]
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
    wheelbase = options.wheelbase or agent.wheelbase or (USUAL_WHEELBASE if agent.drive == "acker" else None)
    if options.command == "ackermann":
        if agent.drive in ("omni", "omni_angular"):
            what = f"'{agent.name}' moves sideways, which a steered vehicle cannot"
            raise BridgeError("bridge-mismatch", what, "command: velocity")
        if wheelbase is None:
            what = f"'{agent.name}' has no wheelbase, so that its turns are no steering angles"
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
            what = f"{clean(name)!r} is no object in the town with a lidar"
            raise BridgeError("bridge-mismatch", what, fix)
    if not chosen:
        fix = "give a robot a sensor lidar2d, or leave out the key lidar"
        raise BridgeError("bridge-mismatch", "no object in the town has a lidar that CARLA could measure", fix)
    return chosen
