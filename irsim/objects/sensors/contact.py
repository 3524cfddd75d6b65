"""Contacts of ``collision_mode: contact``: the contacts of the last step, and the contact sensor of each object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.components.sensors.contact2d import Contact2d
from irsim.diagnostics.errors import InputError
from irsim.objects.sensors.drawing import draw_forces

if TYPE_CHECKING:
    from irsim.objects.base import SimObject
    from irsim.simulation.simulation import Simulation

__all__ = ["Contact", "Contact2D", "ContactReport", "contact_step", "contacts_of"]


@dataclass(eq=False)
class Contact:
    """Contact of two objects that were pushed apart, or rested against each other, in the last step.

    Attributes:
        a, b: The objects; ``a`` has the lower id.
        normal: Unit vector from ``b`` to ``a`` in the world frame, (2,).
        depth: Largest overlap in the step [m].
        point: Centre of the overlap in the world frame, (2,) [m].
        force: Contact force [N].
    """

    a: SimObject
    b: SimObject
    normal: Floats
    depth: float
    point: Floats
    force: float


@dataclass(eq=False)
class ContactReport:
    """A contact as one of its objects sees it: ``normal`` points to that object."""

    other: SimObject
    point: Floats
    normal: Floats
    depth: float
    force: float


class Contact2D:
    """Contact sensor, which reports the contacts of the last step; every object has one as ``contact``.

    Attributes:
        parent: The object.
        force_scale, marker_size, linewidth, alpha, color: How a ``contact2d`` of the scenario is drawn.
    """

    sensor_type = "contact2d"

    def __init__(self, parent: SimObject, options: Any = None) -> None:
        self.parent, self.obj_id = parent, parent.id
        self.options = options = Contact2d() if options is None else options
        self.force_scale: float = options.force_scale
        self.marker_size: float = options.marker_size
        self.linewidth: float = options.linewidth
        self.alpha: float = options.alpha
        self.color: Any = options.color
        self._axes: Any = None
        self._drawn: list[Any] = []

    @property
    def records(self) -> list[Contact]:
        """The contacts of the last step that involve the object."""
        return [c for c in contacts_of(self.parent._simulation, self.parent.world) if self.parent in (c.a, c.b)]

    @property
    def reports(self) -> list[ContactReport]:
        """The contacts of the last step, with normals that point to the object."""
        mine = self.parent
        return [
            ContactReport(c.b, c.point, c.normal, c.depth, c.force)
            if c.a is mine
            else ContactReport(c.a, c.point, -c.normal, c.depth, c.force)
            for c in self.records
        ]

    @property
    def partners(self) -> list[SimObject]:
        """The objects that this one touched, each once."""
        return list(dict.fromkeys(report.other for report in self.reports))

    @property
    def force(self) -> Floats:
        """Sum of the contact forces on the object in the world frame, (2, 1) [N]."""
        total = np.zeros((2, 1))
        for report in self.reports:
            total[:, 0] += report.force * report.normal
        return total

    @property
    def in_contact(self) -> bool:
        """Whether the object touched something in the last step."""
        return bool(self._touching & 1)

    @property
    def started(self) -> bool:
        """Whether the object touched something in the last step but not in the step before."""
        return self._touching & 3 == 1

    @property
    def ended(self) -> bool:
        """Whether the object touched something in the step before the last but not in the last step."""
        return self._touching & 3 == 2

    @property
    def contact_time(self) -> float:
        """Time for which the object has touched something without interruption [s]."""
        return float(self.parent._simulation.state.contact_time[self.parent.row])

    @property
    def air_time(self) -> float:
        """Time since the object last touched something [s]."""
        return float(self.parent._simulation.state.air_time[self.parent.row])

    def step(self, state: Any = None) -> None:
        """Do nothing; kept for compatibility, because the step of the world finds contacts."""

    # drawing by hand: environments draw ``contact2d`` of the scenario by themselves -----------------------------------
    def plot(self, ax: Any, state: Any = None, **kwargs: Any) -> None:
        """Draw the contact forces into axes.

        Args:
            ax: Matplotlib axes in world coordinates.
            state: Ignored, accepted as for other sensors.
            **kwargs: ``force_scale``, ``marker_size``, ``linewidth``, ``alpha``, ``color``, which later drawings keep.
        """
        from irsim.graphics.figure.artists import add_dots, add_mark

        self.plot_clear()
        for name in ("force_scale", "marker_size", "linewidth", "alpha", "color"):
            setattr(self, name, kwargs.get(name, getattr(self, name)))
        marks, dots = draw_forces(self)
        self._axes = ax
        self._drawn = [add_mark(ax, mark) for mark in marks]
        self._drawn += [add_dots(ax, beams.dots) for beams in dots if beams.dots is not None]

    def step_plot(self) -> None:
        """Update what ``plot`` has drawn."""
        if self._axes is not None:
            self.plot(self._axes)

    def plot_clear(self) -> None:
        """Remove what ``plot`` has drawn."""
        for artist in self._drawn:
            artist.remove()
        self._drawn, self._axes = [], None

    @property
    def _touching(self) -> int:
        return int(self.parent._simulation.state.touching[self.parent.row])


def contacts_of(simulation: Simulation, world: int = 0) -> list[Contact]:
    """Return the contacts of the last step of one world, in the order in which they were found."""
    objects = simulation.views(world)
    return [
        Contact(objects[a], objects[b], np.array([nx, ny]), depth, np.array([x, y]), force)
        for a, b, nx, ny, depth, x, y, force in simulation.state.contacts(world)
    ]


def contact_step(
    pairs: Sequence[tuple[SimObject, SimObject]],
    iterations: int = 32,
    slop: float = 1e-6,
    margin: float = 0.0,
    step_time: float | None = None,
) -> list[Contact]:
    """Push apart pairs of objects where they overlap, as a step with ``collision_mode: contact`` does.

    Args:
        pairs: Pairs of objects of one environment. Pairs that are equally many contacts away from an object that
            cannot be pushed keep this order.
        iterations: Largest number of sweeps over the pairs.
        slop: Gap that is left between the objects [m].
        margin: Ignored, accepted for compatibility.
        step_time: Period in which the objects are pushed apart, which determines their velocities [s]; None is the step
            time of the world.

    Raises:
        ValueError: The objects belong to several environments.
    """
    if not pairs:
        return []
    first = pairs[0][0]
    simulation, world = first._simulation, first.world
    if any((o._simulation, o.world) != (simulation, world) for pair in pairs for o in pair):
        raise InputError("contact_step takes objects of one environment")
    numbers = [(a.row % simulation.objects, b.row % simulation.objects) for a, b in pairs]
    dt = simulation.world.step_time if step_time is None else float(step_time)
    with simulation.resolving_contacts():
        core.contact_step(simulation.world, simulation.state, world, numbers, int(iterations), float(slop), dt)
    return contacts_of(simulation, world)
