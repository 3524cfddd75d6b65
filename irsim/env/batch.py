"""Many worlds of one scenario, stepped together; each is bit-identical to the same world alone.

``irsim.batch(…)``, the function, and this module have the same name: calling the module calls the function.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arguments import check_steps, check_whole_number
from irsim.common.arrays import Floats
from irsim.common.keywords import answers_misspelt
from irsim.compat.objects.view import make_view
from irsim.diagnostics.errors import InputError
from irsim.env.notebook import batch_html
from irsim.objects.lifecycle import attach_python
from irsim.policies.behavior import with_policy
from irsim.policies.catalog import PolicySource, open_policy
from irsim.policies.driver import attach_policy
from irsim.policies.policy import Policy
from irsim.scenario.open import open_scenario
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.simulation.events import Event, read_events
from irsim.simulation.random_streams import check_seed, fresh_seed
from irsim.simulation.simulation import Simulation
from irsim.simulation.snapshot import load_simulation, save_simulation

__all__ = ["Batch", "batch"]

MAX_BATCH_OBJECTS = 10_000_000
"""Largest number of objects in all worlds of a batch; each object takes about 1 kB of memory."""


class Batch:
    """``n`` worlds of N objects each, stepped together.

    World i equals ``irsim.make(scenario, seed=seeds[i])`` bit for bit, whatever the number of threads. The k-th reset
    of world i through a mask equals the k-th ``reset(random=True)`` of that environment. Arrays are views of the
    engine's memory: they show the present state and change with the next step, so copy what you keep.

    Attributes:
        pose: (n, N, 3) x, y [m], heading [rad], world frame.
        extra: (n, N, E) extra state rows (steering angle of Ackermann drives first).
        velocity: (n, N, 3) executed controls, command frame, zero padded.
        twist: (n, N, 3) true velocity [m/s], world frame, and yaw rate [rad/s].
        goal: (n, N, 3) present goals: x, y [m], heading [rad], world frame; NaN for objects without a goal, and for
            the heading of goals without one.
        arrived, collided, stopped: (n, N) uint8 flags.
        between_steps: (n, N) number of contacts of the episode between two steps, in which the object touched something
            that it touched at neither end of the step.
        infeasible: (n, N) number of steps of the episode in which the behavior (`orca`, `avocado`) found no velocity
            that avoids all objects.
        ranges: (n, B) ranges of all lidars of a world, one after another [m].
        explored: (n, nx, ny) uint8, 1 for cells of the fog map that robots have seen; empty without ``fog_map``.
        count: (n,) number of steps executed in each episode.
        seeds: Seed of each world.
        names: Names of the N objects.
        robots: Ids of the robots.
    """

    def __init__(
        self,
        scenario: ResolvedScenario,
        seeds: Sequence[int],
        threads: int,
        policy: Policy | None = None,
        *,
        crowded: bool = False,
    ) -> None:
        self.scenario = scenario = with_policy(scenario, policy)
        self.seeds = [check_seed(seed) for seed in seeds]
        self._simulation = Simulation(scenario, self.seeds, threads=threads, crowded=crowded)
        self._policy = policy
        self._simulation.make_view = make_view
        attach_python(self._simulation)
        attach_policy(self._simulation, policy)
        simulation, n, objects = self._simulation, len(self.seeds), self._simulation.objects
        self.n = n
        self.names = tuple(record.name for record in scenario.objects)
        self.robots = np.flatnonzero(simulation.robots)
        self.pose = simulation.pose.reshape(n, objects, 3)
        self.extra = simulation.extra.reshape(n, objects, -1)
        self.velocity = simulation.control.reshape(n, objects, 3)
        self.twist = simulation.twist.reshape(n, objects, 3)
        self.goal = simulation.goal.reshape(n, objects, 3)
        self.arrived = simulation.arrived.reshape(n, objects)
        self.collided = simulation.collided.reshape(n, objects)
        self.stopped = simulation.stopped.reshape(n, objects)
        self.between_steps = simulation.between_steps.reshape(n, objects)
        self.infeasible = simulation.infeasible.reshape(n, objects)
        self.ranges = simulation.ranges.reshape(n, simulation.world.beams_per_world)
        self.explored = simulation.state.explored
        self.count = simulation.count
        self._command = simulation.command.reshape(n, objects, 3)
        self._given = simulation.given.reshape(n, objects)

    _repr_html_ = batch_html

    @property
    def simulation(self) -> Simulation:
        """The simulation behind the batch."""
        return self._simulation

    @property
    def done(self) -> NDArray[np.bool_]:
        """Whether every robot of a world has arrived or stopped, (n,)."""
        return self._simulation.done()

    def events(self, world: int) -> list[Event]:
        """Return the events of a world since its last reset, in order of time.

        Args:
            world: Index of the world.
        """
        return read_events(self._simulation, world)

    def step(self, actions: Any = None) -> None:
        """Advance every world by one period.

        Args:
            actions: (n, k, c) controls of the first k robots, in the command frame of each drive. c must be at least
                the number of control components of each of these robots; surplus columns are ignored. NaN in the first
                component leaves a robot to its behavior. None leaves all robots to their behaviors.

        Raises:
            ValueError: The actions have another shape, or are not finite.
        """
        if actions is not None:
            self._impose(np.asarray(actions, dtype=np.float64))
        self._simulation.step()

    def _impose(self, actions: Floats) -> None:
        robots = len(self.robots)
        if actions.ndim != 3 or actions.shape[0] != self.n or not 1 <= actions.shape[1] <= robots:
            raise InputError(f"actions are ({self.n}, up to {robots}, controls), not {actions.shape}")
        if actions.shape[2] > 3 or actions.shape[2] < max(
            self.scenario.objects[i].vel_dim for i in range(actions.shape[1])
        ):
            raise InputError(f"actions have {actions.shape[2]} numbers each; these drives take another number")
        acting, width = actions.shape[1], actions.shape[2]
        given = ~np.isnan(actions[:, :, 0])
        if not np.isfinite(actions[given]).all():
            raise InputError("an action is not finite; only NaN in its first component (no action) has a meaning")
        self._command[:, :acting, :width] = np.where(given[:, :, None], actions, 0.0)
        self._given[:, :acting] = given

    def snapshot(self) -> bytes:
        """The present state of all worlds, from which :meth:`restore` goes on bit for bit; see ``Env.snapshot``.

        Raises:
            InputError: Code in Python keeps something that pickle cannot store.
        """
        return save_simulation(self._simulation)

    def restore(self, data: bytes) -> None:
        """Return to the state of a snapshot, which was taken of a batch of the same scenario and size.

        Raises:
            InputError: It is of another one.
        """
        load_simulation(self._simulation, data)

    def __reduce__(self) -> tuple[Any, ...]:
        made = self.scenario, self.seeds, self._simulation.threads, self._policy
        return _remake, (type(self), made, self.snapshot())

    def advance(self, steps: int, *, until_done: bool = False) -> int:
        """Advance every world by ``steps`` periods in one call, driven by behaviors.

        Args:
            steps: Largest number of periods.
            until_done: Stop each world as soon as every robot in it has arrived or stopped. Where Python code takes
                part, such as a policy, all worlds go on until this is so in each of them.

        Returns:
            Largest number of periods that any world executed.

        Raises:
            InputError: ``steps`` is not a whole number from 0 on.
        """
        return self._simulation.advance(check_steps(steps), until_done=until_done)

    def reset(self, mask: Any = None, *, random: bool | None = None) -> None:
        """Start new episodes.

        Args:
            mask: (n,) True for each world to reset, which then starts its next scene. None resets every world to the
                start of its present scene.
            random: True draws the next scene, False repeats the present one; None decides as described for ``mask``.

        Raises:
            ValueError: ``mask`` does not have the shape (n,).
            PlacementError: No free space was found for a random object.
        """
        chosen = None if mask is None else np.asarray(mask, dtype=bool)
        if chosen is not None and chosen.shape != (self.n,):
            raise InputError(f"mask is ({self.n},), not {chosen.shape}")
        self._simulation.reset(chosen, next_scene=mask is not None if random is None else random)


@answers_misspelt
def batch(
    scenario: str | Path | ResolvedScenario,
    n: int,
    *,
    seeds: Sequence[int] | None = None,
    threads: int | None = None,
    strict: bool = False,
    policy: PolicySource | None = None,
) -> Batch:
    """Open ``n`` worlds of a scenario.

    Args:
        scenario: YAML file or resolved scenario.
        n: Number of worlds.
        seeds: One seed per world. By default consecutive numbers, which start at the scenario's seed or, without one,
            at a number from fresh entropy.
        threads: Number of threads; by default one per core.
        strict: Treat what IR-SIM would ignore as errors, as for ``irsim.make``.
        policy: The policy that drives all robots instead of their behaviors; see :func:`irsim.open_policy`.

    Raises:
        InputError: ``n`` is below 1, or too many.
        ValueError: The number of seeds is not ``n``.
        ScenarioError: The file cannot be used.
        PolicyError: The policy cannot drive the robots.
    """
    if isinstance(scenario, ResolvedScenario):
        resolved = scenario
    else:
        resolved, _ = open_scenario(scenario, strict=strict)
    n = check_worlds(n, resolved)
    if seeds is None:
        first = resolved.world.seed if resolved.world.seed is not None else fresh_seed()
        seeds = [first + i for i in range(n)]
    if len(seeds) != n:
        raise InputError(f"{len(seeds)} seeds for {n} worlds")
    driver = None if policy is None else open_policy(policy)
    return Batch(resolved, list(seeds), threads or os.cpu_count() or 1, driver)


def check_worlds(n: int, scenario: ResolvedScenario) -> int:
    """The number of worlds of a batch.

    Raises:
        InputError: It is not a whole number from 1, or the worlds have more than :data:`MAX_BATCH_OBJECTS` objects.
    """
    n, each = check_whole_number("the number of worlds", n, 1), max(1, len(scenario.objects))
    if n * each > MAX_BATCH_OBJECTS:
        what = f"{n:,} worlds of {each:,} objects are more than {MAX_BATCH_OBJECTS:,} objects in all"
        raise InputError(what, f"ask for at most {MAX_BATCH_OBJECTS // each:,} worlds")
    return n


def _remake(kind: type[Batch], made: tuple[Any, ...], data: bytes) -> Batch:
    """A batch in the state of a snapshot."""
    copy = kind(*made, crowded=True)
    copy.restore(data)
    return copy


class _CallableModule(ModuleType):
    def __call__(self, *args: Any, **kwargs: Any) -> Batch:
        """Open worlds: ``irsim.batch(…)`` after something has imported this module, which then has that name."""
        return batch(*args, **kwargs)


sys.modules[__name__].__class__ = _CallableModule
