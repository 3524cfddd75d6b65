"""The only code that advances time: a scenario and its seeds as one or many worlds of the core."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.log import Logger
from irsim.diagnostics.errors import PlacementError
from irsim.simulation.build import COLLISION_MODES, Built, build_world, speed_controls
from irsim.simulation.no_room import no_room
from irsim.simulation.protocols import ExternalDrives, PythonDecision, PythonMeasurement, StepHooks
from irsim.simulation.random_streams import generator

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["PythonDecision", "PythonMeasurement", "Simulation"]

CONTACT = COLLISION_MODES["contact"]


def _no_owner() -> None:
    """Stand for the owner of a simulation that does not belong to an environment."""


class Simulation:
    """``copies`` worlds of one scenario; row ``w * objects + i`` is object i of world w.

    Args:
        scenario: The scenario.
        seeds: (W,) one seed per world.
        threads: Number of threads that the worlds are distributed over; results do not depend on it.
        history: Store the poses of all steps. crowded: Accept scenes without room for all, which the caller resets.

    Attributes:
        world, state: Constant and changing part of the core.
        pose: (R, 3) x, y [m], heading [rad], world frame. Like the arrays below, a writable view of the core's memory.
        extra: (R, E) extra state rows (steering angle of Ackermann drives first).
        control: (R, 3) executed control in the command frame, without noise.
        twist: (R, 3) true velocity in the world frame [m/s] and yaw rate [rad/s] of the last step.
        command, given: (R, 3), (R,) control wanted for the next step, and whether the caller has imposed it on the row.
        arrived, collided, stopped: (R,) flags, uint8.
        goal: (R, 3) present goals; NaN without a goal.
        pace: (R,) factor on the speeds of an object; 1 unless the scenario is perturbed.
        start_step: (R,) steps for which an object stands still at its start. appeared: -1 while it is not in the world.
        scans: (owner, first beam, number of beams) of each native sensor of a world.
        gauges: (owner, first reading, number of readings) of each sensor without beams of a world.
        velocity_slices: (first row, number of rows) of each native sensor in the measured velocities.
        between_steps: (R,) number of contacts of the episode between two steps, in which the object touched something
            that it touched at neither end of the step.
        infeasible: (R,) number of steps in which the behavior found no collision-free velocity (`orca`, `avocado`).
        ids: (N + 1,) id of each object of a world; the last entry, -1, stands for no object.
        names: Id -> name of every object that is or was in the simulation.
        passable: Ids of the objects that are ``unobstructed``.
        decisions: Python behaviors, called in every step.
        measurements: Python sensors, called after every step, reset and refresh.
        movers: Called after all drives have moved, before contacts: bridges place what other programs move.
        drives: Drives written in Python, or None.
        hooks: Objects that override a step or parts of it in Python, or None.
        scene_drawn: Callbacks that receive the indices of worlds that have begun their next scene.
        report: Callback for messages about faults in user code that do not end the run; each message comes once.
        revision: Number that grows whenever objects are added, removed or change their shape.
        log: Recorder of every step of the first world, or None.
        owner: Returns the environment that the simulation belongs to, or None.
        make_view: Makes the object at an index of a world for ``views``; None until one is set.
        user: Object id in the random stream of ``rng``: 0 for an environment, another number for a lone object.

    Raises:
        PlacementError: A random object could not be placed, unless ``crowded``.
    """

    def __init__(
        self,
        scenario: ResolvedScenario,
        seeds: Sequence[int] | NDArray[np.uint64],
        *,
        threads: int = 1,
        history: bool = False,
        crowded: bool = False,
    ) -> None:
        self.scenario = scenario
        self.threads = threads
        self.copies = len(seeds)
        self.decisions: list[PythonDecision] = []
        self.measurements: list[PythonMeasurement] = []
        self.movers: list[Callable[[Simulation], None]] = []
        self.drives: ExternalDrives | None = None
        self.hooks: StepHooks | None = None
        self.scene_drawn: list[Callable[[Sequence[int]], None]] = []
        self.report: Callable[[str], None] = Logger("ERROR").error_once
        self.names: dict[int, str] = {}
        self.passable: set[int] = set()
        self._built: Built = {}
        world = build_world(scenario, self.copies, self._built)
        self.revision = 0
        self._history = history
        self._reseeded = False
        self.user = 0
        self.log: core.Log | None = None
        self.owner: Callable[[], Any] = _no_owner
        self.make_view: Callable[[Simulation, int, int], Any] | None = None
        self._views: dict[int, list[Any]] = {}
        self._rng: tuple[tuple[int, int, int], np.random.Generator] | None = None
        self._bind(world, core.State(world, np.asarray(seeds, dtype=np.uint64), history))
        if not crowded:
            self._check_placement()

    def _bind(self, world: core.World, state: core.State) -> None:
        """Replace the world and the state of the core."""
        self.world, self.state = world, state
        self.objects = world.objects
        self.pose, self.extra, self.control, self.twist = state.pose, state.extra, state.control, state.twist
        self.command, self.given = state.command, state.given
        self.arrived, self.collided, self.stopped = state.arrived, state.collided, state.stopped
        self.goal, self.radius = state.goal, state.radius
        self.pace, self.start_step, self.appeared = state.pace, state.start_step, state.appeared
        self.infeasible, self.count, self.between_steps = state.infeasible, state.count, state.between_steps
        self.ranges, self.hits, self.valid = state.ranges, state.hits, state.valid
        self.scans, self.velocity_slices, self.gauges = world.scans(), world.velocity_slices(), world.gauges()
        self._first_scan: dict[int, int] = {}
        for number, (owner, _, _) in enumerate(self.scans):
            self._first_scan.setdefault(owner, number)
        self._all = np.ones(self.copies, dtype=np.uint8)
        records = self.scenario.objects
        self.robots = np.array([record.role == "robot" for record in records], dtype=bool)
        self.ids = np.array([*(record.id for record in records), -1], dtype=np.int32)
        self.names.update((record.id, record.name) for record in records)
        self.passable -= {record.id for record in records}
        self.passable |= {record.id for record in records if record.unobstructed}

    def exchange(self, scenario: ResolvedScenario, origins: Sequence[tuple[Simulation, int]]) -> None:
        """Continue with other objects.

        Args:
            scenario: The present scenario with other objects.
            origins: For each of these objects, a simulation and the row in it that holds the object's present state.
        """
        world = build_world(scenario, built=self._built)
        world.collision_mode = self.world.collision_mode
        state = core.State(world, self.state, [(source.state, row) for source, row in origins])
        self.scenario = scenario
        self.revision += 1
        self._bind(world, state)

    def restore(self, scenario: ResolvedScenario) -> None:
        """Start the next scene with the objects of a scenario; after a new seed, the first scene."""
        seed, scene, _ = self.key()
        world = build_world(scenario, built=self._built)
        world.collision_mode = self.world.collision_mode
        state = core.State(world, np.array([seed], dtype=np.uint64), self._history)
        self.scenario = scenario
        self.revision += 1
        self._bind(world, state)
        if not self._reseeded:
            state.scene[0] = scene
            state.reset(self._all, True)
        self._reseeded = False
        self._check_placement()

    def reshape(self, row: int, parts: Sequence[core.Part], seed: int = 0) -> None:
        """Replace the body of an object until the next scene is drawn; ``seed`` determines random parts."""
        self.state.reshape(row, parts, seed)
        self.revision += 1

    def step(self) -> None:
        """Advance every world by one period."""
        drives, hooks = self.drives, self.hooks
        if not self.decisions and not self.movers and drives is None and hooks is None:
            core.advance(self.world, self.state, 1, threads=self.threads)
            self.measure()
            return
        world, state = self.world, self.state
        for claim in filter(None, [getattr(part, "claim", None) for part in self.decisions]):
            claim(self)
        if hooks is None:
            core.decide(world, state)
        else:
            hooks.decide()
        for decide in self.decisions:
            decide(self)
        if drives is not None:
            drives.follow()
        if hooks is not None:
            hooks.before_motion()
        core.limit(world, state)
        core.integrate(world, state)
        if drives is not None:
            drives.move()
        for move in self.movers:
            move(self)
        if hooks is not None:
            hooks.after_motion()
        if world.collision_mode == CONTACT:
            with self.resolving_contacts():
                core.push_apart(world, state)
        core.finish(world, state)
        core.collide(world, state)
        core.arrive(world, state)
        core.sense(world, state)
        core.watch(world, state)
        self.measure()
        if self.log is not None:
            self.log.add(state)

    def step_external(self) -> None:
        """Advance by one period in which the caller has moved the objects: evaluate collisions, arrivals, sensors."""
        core.advance(self.world, self.state, 1, threads=self.threads, external=True)
        self.measure()

    def measure(self, mask: NDArray[np.bool_] | None = None) -> None:
        """Call the Python sensors, in the worlds of the mask."""
        for measure in self.measurements:
            measure(self, mask)

    def refresh(self) -> None:
        """Evaluate collisions and sensors again after objects were moved; time does not advance."""
        self.state.refresh()
        self.measure()

    @property
    def in_python(self) -> bool:
        """Whether Python code takes part in every step."""
        parts = self.decisions or self.measurements or self.movers
        return bool(parts or self.drives is not None or self.hooks is not None)

    # objects ---------------------------------------------------------------------------------------------------------
    def views(self, world: int = 0) -> list[Any]:
        """Return the objects of one world as scripts see them; the first call makes them with ``make_view``."""
        if world not in self._views:
            if self.make_view is None:
                raise RuntimeError("call irsim.objects.views.views(simulation) to get the objects of a simulation")
            self._views[world] = [self.make_view(self, index, world) for index in range(self.objects)]
        return self._views[world]

    def keep_views(self, shown: Sequence[Any]) -> None:
        """Replace the objects that scripts see, in a simulation with a single world."""
        self._views = {0: list(shown)}

    # one row ----------------------------------------------------------------------------------------------------------
    def impose(self, row: int, control: Sequence[float] | NDArray[np.float64]) -> bool:
        """Impose a control on a row for the next step, and return whether limits of speed or acceleration cut it."""
        cut = core.impose_row(self.world, self.state, row, control)
        wide = self.drives.wide(row) if self.drives is not None and len(control) > 3 else None
        return cut if wide is None else wide.impose(control, self.limits(row), self.scenario.world.step_time)

    def command_of(self, row: int, size: int) -> NDArray[np.float64]:
        """Return the (size,) command of a row."""
        wide = self.drives.wide(row) if self.drives is not None and size > 3 else None
        return self.command[row, :size] if wide is None else wide.command

    def control_of(self, row: int, size: int) -> NDArray[np.float64]:
        """Return the (size,) executed control of a row."""
        wide = self.drives.wide(row) if self.drives is not None and size > 3 else None
        return self.control[row, :size] if wide is None else wide.control

    def set_control(self, row: int, control: NDArray[np.float64]) -> None:
        """Set the executed control of a row, with all its components."""
        self.control[row, : min(3, control.size)] = control[:3]
        self.control_of(row, control.size)[:] = control

    def drive_of(self, row: int, size: int) -> NDArray[np.float64]:
        """Return the (size,) control of the drive of a row, before contacts (``collision_mode: contact``) change it."""
        wide = self.drives.wide(row) if self.drives is not None and size > 3 else None
        return self.state.drive[row, :size] if wide is None else wide.drive

    def resolving_contacts(self) -> AbstractContextManager[None]:
        """Return a context for resolving contacts, in which drives written in Python follow the changed velocities."""
        return nullcontext() if self.drives is None else self.drives.resolving_contacts()

    def is_waiting(self, row: int) -> bool:
        """Return whether a row stands still because its start is delayed, or is not in the world yet."""
        return bool(self.count[row // self.objects] < self.start_step[row] or self.appeared[row] < 0)

    def cannot_move(self, row: int) -> bool:
        """Return whether a row cannot move now: a collision has stopped it, or its start is delayed."""
        return bool(self.stopped[row]) or self.is_waiting(row)

    def limits(self, row: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the lower and upper limits of the controls of a row in the present scene, (vel_dim,) each."""
        record = self.scenario.objects[row % self.objects]
        low, high = np.array(record.vel_min, dtype=np.float64), np.array(record.vel_max, dtype=np.float64)
        for bound in (low, high):
            bound[list(speed_controls(record))] *= self.pace[row]
        return low, high

    def row_state(self, row: int, size: int) -> NDArray[np.float64]:
        """Return a copy of the (size,) pose and extra state of a row."""
        return np.concatenate([self.pose[row], self.extra[row, : size - 3]])

    def set_row_state(self, row: int, values: NDArray[np.float64]) -> None:
        """Set the pose and extra state of a row."""
        self.pose[row] = values[:3]
        self.extra[row, : len(values) - 3] = values[3:]

    def decide_alone(self, view: Any) -> NDArray[np.float64]:
        """Return the (vel_dim,) control that the behavior of one object decides now."""
        for decide in self.decisions:
            if view.index in getattr(decide, "objects", ()):
                return np.asarray(decide.control(view), dtype=np.float64).reshape(-1)  # type: ignore[attr-defined]
        core.decide_row(self.world, self.state, view.row)
        wanted = self.command[view.row, : view.vel_dim].copy()
        return wanted if self.drives is None else self.drives.control_alone(view.row, wanted)

    def move_alone(self, row: int) -> None:
        """Move one object by one period with its command."""
        core.limit_row(self.world, self.state, row)
        core.integrate_row(self.world, self.state, row)
        if self.drives is not None:
            self.drives.move_row(row)

    def first_scan(self, index: int) -> int:
        """Return the index in the world of the first native sensor of an object; its other sensors follow."""
        return self._first_scan.get(index, 0)

    # all rows ---------------------------------------------------------------------------------------------------------
    def advance(self, steps: int, *, until_done: bool = False) -> int:
        """Advance by up to ``steps`` periods, in a single call of the core if no Python code takes part.

        Args:
            steps: Largest number of periods.
            until_done: End a world once each of its robots has arrived or stopped.

        Returns:
            Number of periods that the last world to end has executed.
        """
        if not self.in_python:
            return core.advance(self.world, self.state, steps, threads=self.threads, until_done=until_done)
        for done in range(steps):
            if until_done and self.done().all():
                return done
            self.step()
        return steps

    def done(self) -> NDArray[np.bool_]:
        """(W,) whether every robot of a world has arrived or stopped; False without robots."""
        return self.state.all_done().view(bool)

    def reset(self, mask: NDArray[np.bool_] | None = None, *, next_scene: bool = False) -> None:
        """Return worlds to their initial state.

        Args:
            mask: (W,) worlds to reset; default: all.
            next_scene: Draw the next scene (random shapes, placements, goals) instead of keeping the present one.

        Raises:
            PlacementError: A random object could not be placed in the next scene.
        """
        self._reseeded = False
        chosen = self._all if mask is None else np.asarray(mask, dtype=np.uint8)
        self.state.reset(chosen, next_scene, self.threads)
        self._check_placement()
        if self.drives is not None:
            self.drives.reset(np.flatnonzero(chosen).tolist())
        if next_scene:
            for callback in self.scene_drawn:
                callback(np.flatnonzero(chosen).tolist())
        self.measure(mask)

    def reseed(self, seeds: Sequence[int] | NDArray[np.uint64], mask: NDArray[np.bool_] | None = None) -> None:
        """Set new seeds; the next reset of these worlds starts again with their first scene."""
        chosen = self._all if mask is None else np.asarray(mask, dtype=np.uint8)
        self._reseeded = True
        self.state.reseed(np.asarray(seeds, dtype=np.uint64), chosen)

    def key(self, world: int = 0) -> tuple[int, int, int]:
        """Return (seed, scene, noise episode) of a world."""
        return int(self.state.seed[world]), int(self.state.scene[world]), int(self.state.noise[world])

    @property
    def rng(self) -> np.random.Generator:
        """A NumPy generator for user code; each reset restarts it from the key of the first world."""
        if self._rng is None or self._rng[0] != self.key():
            self._rng = self.key(), generator(*self.key(), stream="user", object_id=self.user)
        return self._rng[1]

    def set_rng(self, rng: np.random.Generator) -> None:
        """Replace the generator of user code until the next reset."""
        self._rng = self.key(), rng

    @property
    def time(self) -> float:
        """Simulated time of the first world, unrounded [s]."""
        return float(self.count[0]) * self.scenario.world.step_time

    def _check_placement(self) -> None:
        failed = np.flatnonzero(self.state.failed_placement >= 0)
        if not failed.size:
            return
        index = int(self.state.failed_placement[failed[0]])
        raise PlacementError([no_room(self.scenario, index, int(self.state.seed[failed[0]]))], self.scenario.text)
