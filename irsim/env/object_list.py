"""The objects of an environment: methods that make, add and delete them while it runs, and the list of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import count
from typing import Any, Literal, NoReturn

from irsim.compat.objects.view import ScriptObject, views
from irsim.env.policies import drive_again
from irsim.env.state import EnvState
from irsim.objects.lifecycle import lone_simulation, move_in, move_out, renumber, restore
from irsim.objects.view import ObjectView
from irsim.scenario.single_object import read_object


def create_robot(env: EnvState, kinematics: Any = None, **keys: Any) -> ScriptObject:
    """Make a robot and return it; :func:`add_object` puts it into the world.

    Args:
        kinematics: Drive as in a scenario entry, such as ``{"name": "diff"}``.
        **keys: The other keys of a scenario entry. Without ``state`` the robot stands at the origin; without ``goal``
            it has no goal.

    Raises:
        ScenarioError: A key or value is not valid. A key that IR-SIM would ignore is logged as a warning instead.
    """
    return _create(env, "robot", kinematics, keys)


def create_obstacle(env: EnvState, kinematics: Any = None, **keys: Any) -> ScriptObject:
    """Make an obstacle and return it; it takes the arguments of :func:`create_robot`."""
    return _create(env, "obstacle", kinematics, keys)


def _create(env: EnvState, role: Literal["robot", "obstacle"], kinematics: Any, keys: dict[str, Any]) -> ScriptObject:
    number = next(env.env_param.id_iter)
    record, findings = read_object(role, {"kinematics": kinematics, **keys}, env.scenario.world, number)
    for item in findings:
        env.logger.warning(f"{record.name}: {item.message} [{item.code}]")
    simulation = lone_simulation(env._simulation.scenario, record, env._simulation.key()[0])
    (view,) = views(simulation)
    view._made_beside = env._objects
    return view


def add_object(env: Any, obj: ScriptObject) -> None:
    """Add an object to the world, as the last one; it takes part from the next step on.

    Raises:
        ValueError: The name of the object is taken, or it is already in a world.
    """
    env.add_objects([obj])


def add_objects(env: EnvState, objs: Iterable[ScriptObject]) -> None:
    """Add several objects to the world; if one of them is not valid, none is added."""
    newcomers = list(objs)
    names = {view.name for view in env._objects}
    for view in newcomers:
        if not isinstance(view, ObjectView):
            raise TypeError(f"only objects can be added, as create_robot makes them, not {view!r}")
        if view.name in names:
            raise ValueError(f"object name {view.name!r} already exists: give this one another `name`")
        if view._simulation.objects != 1 or view._simulation is env._simulation:
            raise ValueError(f"{view.name!r} is in a world already: take it out there first")
        names.add(view.name)
    taken = {view.id for view in env._objects}
    for view in newcomers:
        if view.id in taken:  # made elsewhere
            renumber(view, next(number for number in env.env_param.id_iter if number not in taken))
        taken.add(view.id)
    if newcomers:
        move_in(env._simulation, newcomers)
        _note_exchange(env)
        drive_again(env)


def delete_object(env: Any, target_id: int | str) -> None:
    """Delete the object with this id or name from the world; it remains usable. An unknown id is ignored."""
    env.delete_objects([target_id])


def delete_objects(env: EnvState, target_ids: Iterable[int | str]) -> None:
    """Delete the objects with these ids or names from the world; unknown ones are ignored."""
    targets = set(target_ids)
    leaving = [view for view in env._objects if view.id in targets or view.name in targets]
    if leaving:
        move_out(env._simulation, leaving)
        _note_exchange(env)


def _note_exchange(env: EnvState) -> None:
    env._exchanged = True
    env._objects[:] = views(env._simulation)
    for view in env._objects:
        view._made_beside = None


def restore_objects(env: EnvState) -> None:
    """Start the next scene with the objects of the file, without added objects and with the deleted ones."""
    restore(env._simulation, replace(env.scenario, world=env._simulation.scenario.world), env._originals)
    env._objects[:] = env._originals
    env._exchanged = False
    count_ids(env)


def count_ids(env: EnvState) -> None:
    """Give new objects ids after the ids of the file."""
    env.env_param.id_iter = count(len(env.scenario.objects))


def validate_unique_names(env: EnvState) -> None:
    """Check that no two objects have the same name.

    Raises:
        ValueError: Two objects have the same name.
    """
    names = [view.name for view in env._objects]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError(f"object names must be unique; used more than once: {', '.join(twice)}")


def build_tree(env: EnvState) -> None:
    """Do nothing; kept for compatibility, because the engine keeps its spatial index up to date."""


class ObjectList(list[ScriptObject]):
    """The present objects of an environment.

    ``append`` calls ``env.add_object``, and ``remove`` calls ``env.delete_object``.

    Args:
        env: The environment.
    """

    def __init__(self, env: Any) -> None:
        super().__init__(env._objects)
        self._env = env

    def _reread(self) -> None:
        super().__init__(self._env._objects)

    def append(self, obj: ScriptObject) -> None:
        """Put an object into the world."""
        self.extend([obj])

    def extend(self, objs: Iterable[ScriptObject]) -> None:
        """Put objects into the world; if one is not valid, none is added."""
        self._env.add_objects(objs)
        self._reread()

    def __iadd__(self, objs: Iterable[ScriptObject]) -> ObjectList:  # type: ignore[misc,override]
        self.extend(objs)
        return self

    def remove(self, obj: ScriptObject) -> None:
        """Take an object out of the world.

        Raises:
            ValueError: The object is not in the world.
        """
        del self[self.index(obj)]

    def pop(self, index: Any = -1) -> ScriptObject:
        """Take the object at an index out of the world and return it; it remains usable."""
        removed: ScriptObject = self[index]
        del self[index]
        return removed

    def clear(self) -> None:
        """Take all objects out of the world."""
        del self[:]

    def __delitem__(self, index: Any) -> None:
        chosen = self[index] if isinstance(index, slice) else [self[index]]
        self._env.delete_objects([view.id for view in chosen])
        self._reread()

    def _refused(self, *args: Any, **kwargs: Any) -> NoReturn:
        raise TypeError("`env.objects` has the order of the world: objects can only be appended or removed")

    insert = sort = reverse = __setitem__ = __imul__ = _refused

    def __reduce__(self) -> Any:
        return list, (list(self),)
