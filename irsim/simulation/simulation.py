"""The only code that advances time: a scenario and its seeds as one or many worlds of the core."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.log import Logger
from irsim.diagnostics.diagnostic import Diagnostic
from irsim.diagnostics.errors import PlacementError
from irsim.simulation.build import COLLISION_MODES, Built, build_world
from irsim.simulation.protocols import ExternalDrives, StepHooks
from irsim.simulation.random_streams import generator

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["PythonDecision", "PythonMeasurement", "Simulation"]

CONTACT = COLLISION_MODES["contact"]

PythonDecision = Callable[["Simulation"], None]
"""Fills ``command`` of the rows that are its own; called between the native decisions and the motion."""

PythonMeasurement = Callable[["Simulation", "NDArray[np.bool_] | None"], None]
"""Reads the sensors that are its own, in the worlds of the mask (None: all); called after the native sensors."""


def _no_owner() -> None:
    """The owner of a simulation that no environment has made."""


def _no_views(simulation: Simulation, index: int, world: int) -> NoReturn:
    raise RuntimeError("objects of a simulation are made by irsim.objects.views.views")


class Simulation:
    """``copies`` worlds of one scenario; row ``w * objects + i`` is object i of world w.

    Args:
        scenario: What to simulate.
        seeds: (W,) one seed per world.
        threads: Worlds are shared out over this many threads; results do not depend on it.
        history: Keep the poses of every step, for trajectories.

    Attributes:
        world, state: The core's fixed and changing part.
        pose: (R, 3) x, y [m], heading [rad], world frame. A writable view of the core's memory, as are all others.
        extra: (R, E) extra state rows (steering angle of Ackermann drives first).
        control: (R, 3) executed control in the command frame, without noise.
        twist: (R, 3) true velocity in the world frame [m/s] and yaw rate [rad/s] of the last step.
        command, given: (R, 3), (R,) control wanted for the next step, and which rows it is imposed on.
        arrived, collided, stopped: (R,) flags, uint8.
        goal: (R, 3) current goals; NaN where there is none.
        scans: (owner, first beam, beams) of each native sensor of a world.
        velocity_slices: (first, rows) of each among the measured velocities.
        infeasible: (R,) steps of the episode in which the behavior found no velocity that avoids everybody (`orca`).
        ids: (N + 1,) id of each object of a world; the last entry, -1, stands for none.
        names: Name of every object that ever was in it, by id.
        passable: Ids of those that are ``unobstructed``.
        decisions: Python behaviors, called in every step; empty in worlds that have none.
        measurements: Python sensors, called after every step, reset and refresh; empty in worlds that have none.
        drives: Drives written in Python; None where there are none.
        hooks: Objects with steps, or parts of steps, of their own; None where there are none.
        scene_drawn: Called with the indices of worlds that have begun their next scene.
        report: Told once about what goes wrong in code of users and does not end the run.
        revision: Grows whenever objects come, go or change their shape.
        log: Writes down every step of the first world while somebody records it.
        owner: Gives the environment it belongs to, or None.
        make_view: Makes the object of a place and a world for ``views``; set by :mod:`irsim.objects.views`.
        user: Whose draws ``rng`` gives: 0 those of an environment; an object on its own has a number of its own.

    Raises:
        PlacementError: A random object found no room.
    """

    def __init__(
        self,
        scenario: ResolvedScenario,
        seeds: Sequence[int] | NDArray[np.uint64],
        *,
        threads: int = 1,
        history: bool = False,
    ) -> None:
        self.scenario = scenario
        self.threads = threads
        self.copies = len(seeds)
        self.decisions: list[PythonDecision] = []
        self.measurements: list[PythonMeasurement] = []
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
        self.make_view: Callable[[Simulation, int, int], Any] = _no_views
        self._views: dict[int, list[Any]] = {}
        self._rng: tuple[tuple[int, int, int], np.random.Generator] | None = None
        self._bind(world, core.State(world, np.asarray(seeds, dtype=np.uint64), history))
        self._check_placement()

    def _bind(self, world: core.World, state: core.State) -> None:
        """Look at this part of the core from now on."""
        self.world, self.state = world, state
        self.objects = world.objects
        self.pose, self.extra, self.control, self.twist = state.pose, state.extra, state.control, state.twist
        self.command, self.given = state.command, state.given
        self.arrived, self.collided, self.stopped = state.arrived, state.collided, state.stopped
        self.goal, self.radius = state.goal, state.radius
        self.infeasible = state.infeasible
        self.ranges, self.hits, self.valid = state.ranges, state.hits, state.valid
        self.count = state.count
        self.scans, self.velocity_slices = world.scans(), world.velocity_slices()
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
        """Go on with other objects.

        Args:
            scenario: The present one but for its objects.
            origins: For each of them, the simulation of one world and the row that hold its present state.
        """
        world = build_world(scenario, built=self._built)
        world.collision_mode = self.world.collision_mode
        state = core.State(world, self.state, [(source.state, row) for source, row in origins])
        self.scenario = scenario
        self.revision += 1
        self._bind(world, state)

    def restore(self, scenario: ResolvedScenario) -> None:
        """Start the next scene with these objects; the first one if there is a new seed."""
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
        """Give an object another body until the next scene is drawn; ``seed`` is for random parts."""
        self.state.reshape(row, parts, seed)
        self.revision += 1

    def step(self) -> None:
        """Advance every world by one period."""
        drives, hooks = self.drives, self.hooks
        if not self.decisions and drives is None and hooks is None:
            core.advance(self.world, self.state, 1, threads=self.threads)
            self.measure()
            return
        world, state = self.world, self.state
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
        if hooks is not None:
            hooks.after_motion()
        if world.collision_mode == CONTACT:
            with self.feeling():
                core.push_apart(world, state)
        core.finish(world, state)
        core.collide(world, state)
        core.arrive(world, state)
        core.sense(world, state)
        self.measure()
        if self.log is not None:
            self.log.add(state)

    def step_external(self) -> None:
        """Count a period in which the caller moved the objects: collisions, arrivals and sensors are evaluated."""
        core.advance(self.world, self.state, 1, threads=self.threads, external=True)
        self.measure()

    def measure(self, mask: NDArray[np.bool_] | None = None) -> None:
        """Let Python sensors measure, in the worlds of the mask."""
        for measure in self.measurements:
            measure(self, mask)

    def refresh(self) -> None:
        """Evaluate collisions and sensors anew after objects were moved; time does not advance."""
        self.state.refresh()
        self.measure()

    @property
    def in_python(self) -> bool:
        """Whether Python code takes part in every step."""
        return bool(self.decisions or self.measurements or self.drives is not None or self.hooks is not None)

    # objects ---------------------------------------------------------------------------------------------------------
    def views(self, world: int = 0) -> list[Any]:
        """The objects of one world as scripts see them, made on the first call by ``make_view``."""
        if world not in self._views:
            self._views[world] = [self.make_view(self, index, world) for index in range(self.objects)]
        return self._views[world]

    def keep_views(self, shown: Sequence[Any]) -> None:
        """Let these be the objects of the only world from now on."""
        self._views = {0: list(shown)}

    # one row ----------------------------------------------------------------------------------------------------------
    def impose(self, row: int, control: NDArray[np.float64] | Sequence[float]) -> None:
        """Command a row in the next step, whatever its behavior."""
        self.command[row, : min(3, len(control))] = control[:3]
        if len(control) > 3 and self.drives is not None and (wide := self.drives.wide(row)) is not None:
            wide.command[:] = control
        self.given[row] = 1

    def command_of(self, row: int, size: int) -> NDArray[np.float64]:
        """(size,) the command of a row."""
        wide = self.drives.wide(row) if self.drives is not None and size > 3 else None
        return self.command[row, :size] if wide is None else wide.command

    def control_of(self, row: int, size: int) -> NDArray[np.float64]:
        """(size,) the executed control of a row."""
        wide = self.drives.wide(row) if self.drives is not None and size > 3 else None
        return self.control[row, :size] if wide is None else wide.control

    def drive_of(self, row: int, size: int) -> NDArray[np.float64]:
        """(size,) what the drive of a row does in ``collision_mode: contact``, before contacts interfere."""
        wide = self.drives.wide(row) if self.drives is not None and size > 3 else None
        return self.state.drive[row, :size] if wide is None else wide.drive

    def feeling(self) -> AbstractContextManager[None]:
        """While contacts change velocities: drives written in Python feel it."""
        return nullcontext() if self.drives is None else self.drives.feeling()

    def row_state(self, row: int, size: int) -> NDArray[np.float64]:
        """(size,) pose and extra rows of a row, a copy."""
        return np.concatenate([self.pose[row], self.extra[row, : size - 3]])

    def set_row_state(self, row: int, values: NDArray[np.float64]) -> None:
        """Put a row elsewhere."""
        self.pose[row] = values[:3]
        self.extra[row, : len(values) - 3] = values[3:]

    def decide_alone(self, view: Any) -> NDArray[np.float64]:
        """(vel_dim,) what the behavior of one object wants now."""
        for decide in self.decisions:
            if view.index in getattr(decide, "objects", ()):
                return np.asarray(decide.control(view), dtype=np.float64).reshape(-1)  # type: ignore[attr-defined]
        core.decide_row(self.world, self.state, view.row)
        wanted = self.command[view.row, : view.vel_dim].copy()
        if self.drives is None:
            return wanted
        return self.drives.control_alone(view.row, wanted)

    def move_alone(self, row: int) -> None:
        """One period of one object, as commanded."""
        core.limit_row(self.world, self.state, row)
        core.integrate_row(self.world, self.state, row)
        if self.drives is not None:
            self.drives.move_row(row)

    def first_scan(self, index: int) -> int:
        """Number of the first native sensor of an object among those of its world; its others follow."""
        return self._first_scan.get(index, 0)

    # all rows ---------------------------------------------------------------------------------------------------------

    def advance(self, steps: int, *, until_done: bool = False) -> int:
        """Advance by up to ``steps`` periods without coming back to Python in between where no Python takes part.

        Args:
            steps: Periods.
            until_done: Let a world rest once each of its robots has arrived or stopped.

        Returns:
            Periods executed by the world that went on longest.
        """
        if not self.in_python:
            return core.advance(self.world, self.state, steps, threads=self.threads, until_done=until_done)
        for done in range(steps):
            if until_done and self.copies == 1 and self.state.done(0):
                return done
            self.step()
        return steps

    def done(self) -> NDArray[np.bool_]:
        """(W,) whether every robot of a world has arrived or stopped; False without robots."""
        ended = (self.arrived | self.stopped).astype(bool).reshape(self.copies, self.objects)[:, self.robots]
        if not ended.shape[1]:
            return np.zeros(self.copies, dtype=bool)
        return np.asarray(ended.all(axis=1))

    def reset(self, mask: NDArray[np.bool_] | None = None, *, next_scene: bool = False) -> None:
        """Put worlds back to their start.

        Args:
            mask: (W,) which worlds; all by default.
            next_scene: Draw the next scene (random shapes, placements, goals) instead of keeping this one.

        Raises:
            PlacementError: A random object found no room in the next scene.
        """
        self._reseeded = False
        chosen = self._all if mask is None else np.asarray(mask, dtype=np.uint8)
        self.state.reset(chosen, next_scene)
        self._check_placement()
        if self.drives is not None:
            self.drives.reset(np.flatnonzero(chosen).tolist())
        if next_scene:
            for told in self.scene_drawn:
                told(np.flatnonzero(chosen).tolist())
        self.measure(mask)

    def reseed(self, seeds: Sequence[int] | NDArray[np.uint64], mask: NDArray[np.bool_] | None = None) -> None:
        """New seeds; the next reset of these worlds begins again at their first scene."""
        chosen = self._all if mask is None else np.asarray(mask, dtype=np.uint8)
        self._reseeded = True
        self.state.reseed(np.asarray(seeds, dtype=np.uint64), chosen)

    def key(self, world: int = 0) -> tuple[int, int, int]:
        """(seed, scene, noise episode) of a world."""
        return int(self.state.seed[world]), int(self.state.scene[world]), int(self.state.noise[world])

    @property
    def rng(self) -> np.random.Generator:
        """A NumPy generator for user code; it starts anew with every reset, from the key of the first world."""
        key = self.key()
        if self._rng is None or self._rng[0] != key:
            self._rng = key, generator(*key, stream="user", object_id=self.user)
        return self._rng[1]

    def set_rng(self, rng: np.random.Generator) -> None:
        """Give user code another generator, until the next reset."""
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
        raise PlacementError([self._crowded(index, int(self.state.seed[failed[0]]))], self.scenario.text)

    def _crowded(self, index: int, seed: int) -> Diagnostic:
        record = self.scenario.objects[index]
        placement: Any = next(p for p in self.scenario.placements if record.id in p.objects)
        low, high = placement.range_low, placement.range_high
        area = abs((high[0] - low[0]) * (high[1] - low[1]))
        return Diagnostic(
            code="placement-crowded",
            severity="error",
            path=(*record.path, "distribution"),
            message=(
                f"no room for {record.name!r} with seed {seed}: {len(placement.objects)} objects of this entry "
                f"share {area:.3g} m2"
            ),
            given=len(placement.objects),
            fix="lower `number` or `min_distance`, make the shapes smaller, or widen range_low/range_high",
            file=self.scenario.source,
        )
