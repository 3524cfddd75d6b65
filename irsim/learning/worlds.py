"""Worlds of a task, stepped together: what all environments of learning libraries are made of."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.common.keywords import answers_misspelt
from irsim.diagnostics.errors import ArgumentError, PlacementError
from irsim.env.batch import Batch, check_worlds
from irsim.learning.actions import Latency, read_actions
from irsim.learning.draws import Draws, check_observed
from irsim.learning.observing import Eyes
from irsim.learning.step import Result, Step
from irsim.learning.tasks.files import TaskSource, open_task
from irsim.learning.tasks.scene import open_scene
from irsim.learning.tasks.team import team_of
from irsim.learning.terms import PythonTerms, weighted_terms
from irsim.policies.networks.output import Present, are_finite, decide
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.simulation.random_streams import check_seed
from irsim.simulation.roles import kinds_of
from irsim.simulation.simulation import Simulation
from irsim.simulation.snapshot import dump, load, load_simulation, save_simulation

__all__ = ["Autoreset", "Worlds"]

Autoreset = Literal["over", "before"]
"""Worlds that start their next episode in a step: worlds that are over after it, or that were before it."""
_FLAGS = ("taking_part", "ended", "arrived", "collided", "over", "horizon")
"""Arrays of the core about the present episodes of learners."""
_OWN = ("_begun", "_low", "_high", "_bounded", "present", "level", "drawn", "_latency")
"""Attributes of worlds that change in a step or a reset."""
_OWNER = "learners"
_TRIES = 100
"""Number of scenes that are drawn for a world before it is an error that none has room for all objects."""


class Worlds:
    """``n`` worlds of a task with A learners each; learner a of world w has the slot ``w * A + a``.

    World i is bit for bit the same as it is alone with the same seed, on any number of threads. Its first episode is
    the first scene of its seed, the next one the second scene, and so on.

    Args:
        task: The task: its file, its data, or a task that was read.
        n: Number of worlds.
        seed: Seed of the first world, the next one has the next number; None: ``seeds.train`` of the task.
        threads: Number of threads.
        level: Level of the curriculum; None: the one that it starts with.

    Attributes:
        task: The task.
        scenario: Its scenario.
        n, learners: Number of worlds, and of learners in each.
        names: Names of the learners of a world.
        eyes: Their observations.
        width: Number of numbers of an action; 1 for the number of a choice.
        present: (n, A) whether the learner takes part in the present episode.
        level: (n,) level of the curriculum of the present episode.
        drawn: Draws of the present episodes, see :meth:`irsim.learning.draws.Draws.values`.

    Raises:
        TaskError: The task is not valid, or does not fit its scenario.
        ScenarioError: The scenario cannot be used.
        ArgumentError: There is no such level.
    """

    @answers_misspelt
    def __init__(
        self, task: TaskSource, n: int = 1, *, seed: int | None = None, threads: int = 1, level: int | None = None
    ) -> None:
        self.task, folder = open_task(task)
        scene = open_scene(self.task, folder)
        n = check_worlds(n, scene.scenario)
        self._made = os.path.abspath(task) if isinstance(task, str) and os.path.isfile(task) else task, n
        check_observed(self.task, scene)
        self.scenario: ResolvedScenario = scene.scenario
        self.n = n
        first = self.task.seeds.train if seed is None else check_seed(seed)
        check_seed(first + n - 1)
        seeds = [first + i for i in range(n)]
        self._batch = Batch(self.scenario, seeds, threads, crowded=True)  # reset() below skips such scenes
        self._simulation = simulation = self._batch.simulation
        self._threads = threads
        team = team_of(self.task, self.scenario)
        self.names, self.learners, self._meaning = team.names, len(team.indices), self.task.action.meaning()
        starts = np.arange(n, dtype=np.int64) * simulation.objects
        self.rows = (starts[:, None] + team.indices).reshape(-1)
        self._draws = Draws(self.task, scene, simulation, team.indices)
        self.eyes = Eyes(simulation, self.task.layout, team.indices, threads, self._draws)
        self.width = team.action_width
        step_time = self.scenario.world.step_time
        horizons = [max(1, round(self.task.horizon_of(k) / step_time)) for k in range(len(self.task.levels))]
        self._horizons = np.array(horizons, dtype=np.int64)
        kinds, reward = kinds_of(self.scenario.objects), self.task.reward
        self._terms = PythonTerms(simulation, reward, team.indices, self.rows, kinds, threads)
        self._stepper = core.Learners(
            simulation.world,
            simulation.state,
            indices=team.indices.tolist(),
            kinds=kinds,
            terms=weighted_terms(reward),
            arrival=self.task.ends_on_arrival,
            collision=self.task.ends.collision,
            ends=self.task.ends.world,
        )
        self._shape = (n, self.learners)
        self._begun = np.zeros(n, dtype=bool)
        self._low: Floats = np.zeros((len(self.rows), 3))
        self._high: Floats = np.zeros((len(self.rows), 3))
        self._bounded = True  # as far as is known; if not, each step finds out
        self.present = np.ones(self._shape, dtype=bool)
        self.level = np.zeros(n, dtype=np.int64)
        self.drawn: dict[str, NDArray[Any]] = {}
        self._last: NDArray[np.float32] | None = None
        self._latency = None if self._draws.latency == 0 else Latency(self._draws.latency, n, self.learners)
        self.set_level((self.task.curriculum.start if self.task.curriculum else 0) if level is None else level)
        self.reset(seeds=seeds if self.varies else None)

    # episodes ---------------------------------------------------------------------------------------------------------
    def reset(self, mask: NDArray[np.bool_] | None = None, *, seeds: Sequence[int] | None = None) -> None:
        """Start the next episode of worlds.

        Args:
            mask: (n,) worlds; None: all.
            seeds: New seeds of these worlds, one for each of the n worlds; they start with their first scene.

        Raises:
            PlacementError: No scene of a world has room for all objects.
        ValueError: A seed is negative or has more than 64 bits.
        """
        chosen = np.ones(self.n, dtype=bool) if mask is None else np.array(mask, dtype=bool)
        if chosen.shape != (self.n,):
            raise ArgumentError(f"a mask of {self.n} worlds has the shape ({self.n},), not {chosen.shape}", "give one")
        if seeds is not None:
            seeds = [check_seed(seed) for seed in seeds]
            self._simulation.reseed(np.asarray(seeds, dtype=np.uint64), chosen)
            self._begun[chosen] = False
        for next_scene in (False, True):
            these = chosen & (self._begun == next_scene)
            if these.any():
                self._draw(these, next_scene or seeds is not None)
        self._begun[chosen] = True
        if self._draws.varies:
            self._read_draws(chosen)
        self._begin(np.flatnonzero(chosen))

    def _begin(self, worlds: NDArray[np.int64]) -> None:
        """Set the flags and limits of the learners of worlds, (k,) of which a scene has begun."""
        stepper, state = self._stepper, self._simulation.state
        rows, present = self.rows.reshape(self._shape)[worlds], self.present[worlds]
        stepper.over[worlds] = False
        stepper.taking_part[worlds] = present
        stepper.ended[worlds] = ~present
        stepper.horizon[worlds] = self._horizons[self.level[worlds]]
        stepper.arrived[worlds] = state.arrived[rows] != 0
        stepper.collided[worlds] = state.collided[rows] != 0
        low, high = state.vel_min[rows], state.vel_max[rows]
        self._low.reshape(*self._shape, 3)[worlds] = low
        self._high.reshape(*self._shape, 3)[worlds] = high
        self._bounded &= are_finite(low.reshape(-1, 3), high.reshape(-1, 3), self.width)

    def set_level(self, level: int) -> None:
        """Set the level of the curriculum of the episodes that start from now on.

        Raises:
            ArgumentError: There is no such level.
        """
        if isinstance(level, bool) or not 0 <= level < len(self.task.levels):
            last = len(self.task.levels) - 1
            what = f"there is no level {level!r}"
            raise ArgumentError(what, f"give a level from 0 to {last}" if last else "the task has no curriculum")
        self._simulation.state.level[:] = level
        self._simulation.revision += 1  # what is kept for the scene of a seed belongs to a level

    @property
    def varies(self) -> bool:
        """Whether the task draws more for each episode than its scenario does."""
        return self._draws.varies

    @property
    def seeds(self) -> list[int]:
        """(n,) present seeds."""
        seeds: list[int] = self._simulation.state.seed.tolist()
        return seeds

    def _read_draws(self, chosen: NDArray[np.bool_]) -> None:
        """Find out what was drawn for the episodes that begin."""
        state = self._simulation.state
        self.present = (state.takes_part[self.rows] != 0).reshape(self._shape)
        self.level = np.where(chosen, state.level, self.level)
        self.drawn = self._draws.values()
        self.eyes.read_draws()
        if self._latency is not None:
            self._latency.steps = self._draws.latencies()

    @property
    def simulation(self) -> Simulation:
        """The simulation behind the worlds."""
        return self._simulation

    def _draw(self, these: NDArray[np.bool_], next_scene: bool) -> None:
        """Start scenes; a scene without room for all objects is skipped."""
        for attempt in range(_TRIES):
            try:
                self._simulation.reset(these, next_scene=next_scene)
                return
            except PlacementError:
                if attempt == _TRIES - 1:
                    raise
                these = these & (self._simulation.state.failed_placement >= 0)
                next_scene = True

    def buffer(self) -> NDArray[np.float32]:
        """(n * A, D) an array that observations can be written to."""
        return np.zeros((len(self.rows), self.eyes.size), dtype=np.float32)

    def close(self) -> None:
        """Do nothing: worlds of one process need no end."""

    def observe(self, out: NDArray[np.float32] | None = None) -> NDArray[np.float32]:
        """(n * A, D) what the learners observe now, written to ``out`` if it is given."""
        return self.eyes.observe(self.rows, out)

    # states to return to ----------------------------------------------------------------------------------------------
    def snapshot(self) -> bytes:
        """The present state of all worlds, from which :meth:`restore` goes on bit for bit; see ``Env.snapshot``.

        Raises:
            InputError: Code in Python keeps something that pickle cannot store.
        """
        flags = {name: getattr(self._stepper, name) for name in _FLAGS}
        own = {name: getattr(self, name) for name in _OWN}
        return dump((flags, own, save_simulation(self._simulation)), self._simulation, _OWNER)

    def restore(self, data: bytes) -> None:
        """Return to the state of a snapshot, which was taken of as many worlds of the same task.

        Raises:
            InputError: It is of other worlds.
        """
        flags, own, simulation = load(data, self._simulation, _OWNER)
        load_simulation(self._simulation, simulation)
        for name, values in flags.items():
            getattr(self._stepper, name)[...] = values
        vars(self).update(own)
        self.eyes.read_draws()

    def __reduce__(self) -> tuple[Any, ...]:
        return _remake, (*self._made, self._threads, self.snapshot())

    # a step -----------------------------------------------------------------------------------------------------------
    def step(self, actions: Any) -> Result:
        """Advance all worlds by one period.

        Args:
            actions: (n * A, C) numbers from -1 to 1, or (n * A,) numbers of choices; None leaves the learners to the
                behaviors of the scenario.

        Raises:
            ArgumentError: The actions have another shape, or are not finite.
        """
        return self._step(self.read(actions), None)

    def advance(
        self,
        numbers: Floats | None,
        reset: Autoreset | None = None,
        *,
        out: NDArray[np.float32] | None = None,
        last: NDArray[np.float32] | None = None,
        watch: Callable[[Result], None] | None = None,
    ) -> Step:
        """Advance all worlds by one period, observe, and start the next episodes of worlds that are over.

        Args:
            numbers: (n * A, F) what :meth:`read` made of actions; None leaves the learners to their behaviors.
            reset: Which worlds start their next episode: worlds that are ``over`` after the step, or that were over
                ``before`` it; None starts none.
            out: (n * A, D) array for observations; None: a new one.
            last: (n * A, D) array for the last observations of episodes; None: one that the next call overwrites.
            watch: Called with the result before worlds that are over after the step start their next episode.

        Returns:
            The result of the step, and the observations after it.
        """
        before = self._stepper.over.copy()
        seen = np.empty((len(self.rows), self.eyes.size), dtype=np.float32) if out is None else out
        result = self._step(numbers, seen)
        if reset == "before" and before.any():
            self.reset(before)
            self._observe_again(before, seen)
        if watch is not None:
            watch(result)
        if last is None:
            last = self._last = np.empty(seen.shape, dtype=np.float32) if self._last is None else self._last
        if reset == "over":
            self.renew(result.over, seen, last)
        return Step(result, seen, last)

    def renew(self, over: NDArray[np.bool_], seen: NDArray[np.float32], last: NDArray[np.float32]) -> None:
        """Start the next episode of worlds, keep what their learners observed, and observe again.

        Args:
            over: (n,) worlds.
            seen: (n * A, D) what all learners observe; changed in these worlds.
            last: (n * A, D) receives what it was in these worlds.
        """
        if not over.any():
            return
        slots = np.repeat(over, self.learners)
        last[slots] = seen[slots]
        self.reset(over)
        self._observe_again(over, seen)

    def _observe_again(self, these: NDArray[np.bool_], seen: NDArray[np.float32]) -> None:
        """Write what the learners of some worlds observe into their rows of what all do."""
        slots = np.flatnonzero(np.repeat(these, self.learners))
        seen[slots] = self.eyes.observe(self.rows[slots])

    def _step(self, numbers: Floats | None, seen: NDArray[np.float32] | None) -> Result:
        """Advance all worlds by one period, and write what the learners observe then, if that is wanted."""
        simulation, stepper, terms, eyes = self._simulation, self._stepper, self._terms, self.eyes
        world, state, velocities = simulation.world, simulation.state, self._meaning.returns == "velocity"
        wanted = None if numbers is None else self._wanted(numbers)
        if seen is not None and not terms and not simulation.in_python:  # all in one loop of the core
            outcome = stepper.step(world, state, wanted, velocities, eyes.looking, eyes.native, seen, self._threads)
            result = Result(*(*outcome, self._contacts_between_steps()))
            eyes.complete(self.rows, seen)
            return result
        stepper.begin(world, state, wanted, velocities)
        terms.look()
        simulation.step()
        outcome = stepper.end(world, state, self._threads)
        result = Result(*(*outcome, self._contacts_between_steps()))
        if terms:
            result = terms.add(result, self.present)
        if seen is not None:
            eyes.observe(self.rows, seen)
        return result

    def _contacts_between_steps(self) -> NDArray[np.int32]:
        """(n, A) number of such contacts of each learner in the present episode."""
        counts: NDArray[np.int32] = self._simulation.between_steps[self.rows]
        return counts.reshape(self.n, self.learners)

    # actions ----------------------------------------------------------------------------------------------------------
    def read(self, actions: Any) -> Floats | None:
        """(n * A, F) numbers that :meth:`advance` takes, from actions as :meth:`step` takes them.

        Raises:
            ArgumentError: The actions have another shape, or are not finite.
        """
        return None if actions is None else read_actions(actions, self._meaning.choices, len(self.rows), self.width)

    def _wanted(self, numbers: Floats) -> Floats:
        """(n * A, C) controls, or (n * A, 2) velocities, that actions command now."""
        simulation, rows, meaning = self._simulation, self.rows, self._meaning
        held = None
        if self._latency is not None:
            numbers, held = self._latency.pass_on(numbers, simulation.count)
        pose = goal = velocity = control = (
            self._low
        )  # placeholders: decide() reads them only for velocity and increment actions
        if meaning.returns == "velocity":
            pose, goal = simulation.pose.take(rows, axis=0), simulation.goal.take(rows, axis=0)
        if meaning.increment:
            velocity = simulation.twist.take(rows, axis=0)[:, :2]
            control = simulation.control.take(rows, axis=0)
        wanted = decide(meaning, numbers, Present(pose, goal, velocity, control, self._low, self._high, self._bounded))
        if held is not None:
            wanted[held] = 0.0
        return np.ascontiguousarray(wanted)


def _remake(task: TaskSource, n: int, threads: int, data: bytes) -> Worlds:
    """Worlds in the state of a snapshot."""
    made = Worlds(task, n, threads=threads)
    made.restore(data)
    return made
