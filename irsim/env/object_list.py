"""The objects of an environment: methods that make, add, delete and move them while it runs, and the list of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import count
from typing import Any, Literal, NoReturn

import numpy as np

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.compat.objects.view import ScriptObject, views
from irsim.diagnostics.errors import InputError, InputTypeError
from irsim.env.policies import drive_again
from irsim.env.state import EnvState
from irsim.objects.lifecycle import lone_simulation, move_in, move_out, renumber, restore
from irsim.objects.shapely_geometry import body_parts, is_taken
from irsim.objects.view import ObjectView
from irsim.scenario.single_object import read_object

MAX_DRAWS = 100
"""Largest number of draws per obstacle; after that, a pose that overlaps another object is accepted."""


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
            raise InputTypeError(f"only objects can be added, as create_robot makes them, not {view!r}")
        if view.name in names:
            raise InputError(f"object name {view.name!r} already exists", "give this one another `name`")
        if view._simulation.objects != 1 or view._simulation is env._simulation:
            raise InputError(f"{view.name!r} is in a world already", "take it out there first")
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
        raise InputError(f"object names must be unique; used more than once: {', '.join(twice)}")


def build_tree(env: EnvState) -> None:
    """Do nothing; kept for compatibility, because the engine keeps its spatial index up to date."""


def random_obstacle_position(
    env: EnvState,
    range_low: Sequence[float] | Floats | None = None,
    range_high: Sequence[float] | Floats | None = None,
    ids: Iterable[int] | None = None,
    non_overlapping: bool = False,
) -> None:
    """Move obstacles to random poses, to which later resets return.

    Args:
        range_low: Lower bounds of x, y [m] and heading [rad]; by default [0, 0, -3.14].
        range_high: Upper bounds of x, y [m] and heading [rad]; by default [10, 10, 3.14].
        ids: Ids of the obstacles to move; by default all. The map and the walls round the world never move.
        non_overlapping: Draw the pose of an obstacle up to 100 times, until it touches no other object.
    """
    low = np.array([0.0, 0.0, -3.14] if range_low is None else range_low, dtype=np.float64).reshape(3)
    high = np.array([10.0, 10.0, 3.14] if range_high is None else range_high, dtype=np.float64).reshape(3)
    wanted = None if ids is None else set(ids)
    obstacles = [view for view in env._objects if view.role == "obstacle" and view.record.path[0] != "world"]
    chosen = [view for view in obstacles if wanted is None or view.id in wanted]
    standing = [view for view in env._objects if view not in chosen]
    for view in chosen:
        rest = view.state[3:, 0]
        for _ in range(MAX_DRAWS if non_overlapping else 1):
            view.set_state(np.concatenate([env._simulation.rng.uniform(low, high), rest]), init=True)
            pose = view.state[:3, 0].tolist()
            if not any(is_taken(other, body_parts(view), pose) for other in standing):
                break
        else:
            if non_overlapping:
                env.logger.warning(f"{view.name}: no free place in {MAX_DRAWS} draws; the last one is taken")
        if non_overlapping:
            standing.append(view)


def random_polygon_shape(
    env: EnvState,
    center_range: Sequence[float] | None = None,
    avg_radius_range: Sequence[float] | None = None,
    irregularity_range: Sequence[float] | None = None,
    spikeyness_range: Sequence[float] | None = None,
    num_vertices_range: Sequence[int] | None = None,
) -> None:
    """Give every polygon obstacle a new random outline, without moving it.

    Args:
        center_range: [xmin, ymin, xmax, ymax] of the centre in the body frame [m]; by default [0, 0, 10, 10].
        avg_radius_range: Bounds of the mean radius [m]; by default [0.1, 1].
        irregularity_range: Bounds of the unevenness of the angles between vertices; by default [0, 1].
        spikeyness_range: Bounds of the spread of the radii; by default [0, 1].
        num_vertices_range: Bounds of the number of vertices; by default [4, 10].
    """
    part = core.RandomPolygon(
        center_range=[float(v) for v in center_range or (0, 0, 10, 10)],
        avg_radius_range=[float(v) for v in avg_radius_range or (0.1, 1)],
        irregularity_range=[float(v) for v in irregularity_range or (0, 1)],
        spikeyness_range=[float(v) for v in spikeyness_range or (0, 1)],
        num_vertices_range=[int(v) for v in num_vertices_range or (4, 10)],
        closed=True,
    )
    for view in [view for view in env._objects if view.role == "obstacle"]:
        if view.shape == "polygon":
            env._simulation.reshape(view.row, [part], seed=int(env._simulation.rng.integers(2**63)))


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
        raise InputTypeError("`env.objects` has the order of the world: objects can only be appended or removed")

    insert = sort = reverse = __setitem__ = __imul__ = _refused

    def __reduce__(self) -> Any:
        return list, (list(self),)
