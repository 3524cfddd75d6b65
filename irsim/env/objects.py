"""Objects of an environment while it runs: made, added, taken out, moved about."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import count
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.env.drawing import EnvDrawing
from irsim.env.parameters import EnvParam
from irsim.objects.lifecycle import admit, alone, dismiss, restore
from irsim.objects.shapely_geometry import touching
from irsim.objects.view import ObjectView
from irsim.objects.views import views
from irsim.scenario.single_object import read_object

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["EnvObjects"]

Floats = NDArray[np.float64]
_TRIES = 100
"""Draws per obstacle before one that overlaps is taken."""


class EnvObjects(EnvDrawing):
    """Exchange of objects, and what draws new places and shapes for obstacles."""

    env_param: EnvParam
    _originals: list[ObjectView]
    _exchanged: bool

    # making ----------------------------------------------------------------------------------------------------------
    def create_robot(self, kinematics: Any = None, **keys: Any) -> ObjectView:
        """Make a robot without adding it.

        Args:
            kinematics: As in a scenario entry, ``{"name": "diff"}``.
            **keys: The other keys of a scenario entry. Without ``state`` it stands at the origin, without ``goal`` it
                has none.

        Raises:
            ScenarioError: The keys cannot be used; what IR-SIM would ignore is a warning.
        """
        return self._create("robot", kinematics, keys)

    def create_obstacle(self, kinematics: Any = None, **keys: Any) -> ObjectView:
        """Make an obstacle without adding it; see :meth:`create_robot`."""
        return self._create("obstacle", kinematics, keys)

    def _create(self, role: Literal["robot", "obstacle"], kinematics: Any, keys: dict[str, Any]) -> ObjectView:
        number = next(self.env_param.id_iter)
        record, found = read_object(role, {"kinematics": kinematics, **keys}, self.scenario.world, number)
        for item in found:
            self.logger.warning(f"{record.name}: {item.message} [{item.code}]")
        simulation = alone(self._simulation.scenario, record, self._simulation.key()[0])
        (view,) = views(simulation)
        view.surroundings = self._objects
        return view

    # coming and going ------------------------------------------------------------------------------------------------
    def add_object(self, obj: ObjectView) -> None:
        """Put an object into the world, as its last one; it takes part from the next step on.

        Raises:
            ValueError: Its name is taken, or it is in a world already.
        """
        self.add_objects([obj])

    def add_objects(self, objs: Iterable[ObjectView]) -> None:
        """Put several objects into the world; all or none."""
        newcomers = list(objs)
        names = set(self.names)
        for view in newcomers:
            if not isinstance(view, ObjectView):
                raise TypeError(f"only objects can be added, as create_robot makes them, not {view!r}")
            if view.name in names:
                raise ValueError(f"object name {view.name!r} already exists: give this one another `name`")
            if view._simulation.objects != 1 or view._simulation is self._simulation:
                raise ValueError(f"{view.name!r} is in a world already: take it out there first")
            names.add(view.name)
        taken = {view.id for view in self._objects}
        for view in newcomers:
            if view.id in taken:  # made elsewhere
                view.renumber(next(number for number in self.env_param.id_iter if number not in taken))
            taken.add(view.id)
        if newcomers:
            admit(self._simulation, newcomers)
            self._note_exchange()

    def delete_object(self, target_id: int | str) -> None:
        """Take the object with this id (or name) out of the world; it stays usable. Unknown ones are ignored."""
        self.delete_objects([target_id])

    def delete_objects(self, target_ids: Iterable[int | str]) -> None:
        """Take several objects out of the world."""
        targets = set(target_ids)
        leaving = [view for view in self._objects if view.id in targets or view.name in targets]
        if leaving:
            dismiss(self._simulation, leaving)
            self._note_exchange()

    def _note_exchange(self) -> None:
        self._exchanged = True
        self._objects[:] = views(self._simulation)
        for view in self._objects:
            view.surroundings = None

    def _restore_objects(self) -> None:
        """The objects of the file again, in its next scene."""
        restore(self._simulation, replace(self.scenario, world=self._simulation.scenario.world), self._originals)
        self._objects[:] = self._originals
        self._exchanged = False
        self._count_ids()

    def _count_ids(self) -> None:
        """New objects get the ids after those of the file."""
        self.env_param.id_iter = count(len(self.scenario.objects))

    # names and geometry ----------------------------------------------------------------------------------------------
    def validate_unique_names(self) -> None:
        """Check that no two objects share a name.

        Raises:
            ValueError: Some do.
        """
        names = self.names
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ValueError(f"object names must be unique; used more than once: {', '.join(twice)}")

    def build_tree(self) -> None:
        """Nothing to do: where objects are is always known."""

    # places and shapes of obstacles ----------------------------------------------------------------------------------
    def random_obstacle_position(
        self,
        range_low: Sequence[float] | Floats | None = None,
        range_high: Sequence[float] | Floats | None = None,
        ids: Iterable[int] | None = None,
        non_overlapping: bool = False,
    ) -> None:
        """Put obstacles somewhere else, at random; resets return to these places.

        Args:
            range_low: Lower bounds of x, y [m] and heading [rad]; default [0, 0, -3.14].
            range_high: Upper bounds; default [10, 10, 3.14].
            ids: Ids of the obstacles; default: all. The map and the walls round the world stay.
            non_overlapping: Draw up to 100 times until an obstacle touches neither those that stay nor those that have
                been placed.
        """
        low = np.array([0.0, 0.0, -3.14] if range_low is None else range_low, dtype=np.float64).reshape(3)
        high = np.array([10.0, 10.0, 3.14] if range_high is None else range_high, dtype=np.float64).reshape(3)
        wanted = None if ids is None else set(ids)
        chosen = [o for o in self.obstacle_list if o.record.path[0] != "world" and (wanted is None or o.id in wanted)]
        standing = [view for view in self._objects if view not in chosen]
        for view in chosen:
            rest = view.state[3:, 0]
            for _ in range(_TRIES if non_overlapping else 1):
                view.set_state(np.concatenate([self.rng.uniform(low, high), rest]), init=True)
                if not any(touching(view, other) for other in standing):
                    break
            else:
                if non_overlapping:
                    self.logger.warning(f"{view.name}: no free place in {_TRIES} draws; the last one is taken")
            if non_overlapping:
                standing.append(view)

    def random_polygon_shape(
        self,
        center_range: Sequence[float] | None = None,
        avg_radius_range: Sequence[float] | None = None,
        irregularity_range: Sequence[float] | None = None,
        spikeyness_range: Sequence[float] | None = None,
        num_vertices_range: Sequence[int] | None = None,
    ) -> None:
        """Give every polygon obstacle a new random outline; poses stay.

        Args:
            center_range: [xmin, ymin, xmax, ymax] of the centre in the body frame [m], default [0, 0, 10, 10].
            avg_radius_range: Of the mean radius [m], default [0.1, 1].
            irregularity_range: Of the unevenness of the angles between vertices, default [0, 1].
            spikeyness_range: Of the spread of the radii, default [0, 1].
            num_vertices_range: Of the number of vertices, default [4, 10].
        """
        part = core.RandomPolygon(
            center_range=[float(v) for v in center_range or (0, 0, 10, 10)],
            avg_radius_range=[float(v) for v in avg_radius_range or (0.1, 1)],
            irregularity_range=[float(v) for v in irregularity_range or (0, 1)],
            spikeyness_range=[float(v) for v in spikeyness_range or (0, 1)],
            num_vertices_range=[int(v) for v in num_vertices_range or (4, 10)],
            closed=True,
        )
        for view in self.obstacle_list:
            if view.shape == "polygon":
                self._simulation.reshape(view.row, [part], seed=int(self.rng.integers(2**63)))

    # -----------------------------------------------------------------------------------------------------------------
    if TYPE_CHECKING:
        scenario: ResolvedScenario

        @property
        def rng(self) -> np.random.Generator:
            """See :class:`irsim.env.Env`."""
