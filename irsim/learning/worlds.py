"""Worlds of a task, stepped together: what all environments of learning libraries are made of."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.diagnostics.errors import ArgumentError, PlacementError
from irsim.env.batch import Batch
from irsim.learning.actions import read_actions
from irsim.learning.draws import Draws, check_observed
from irsim.learning.features import REWARDS
from irsim.learning.latency import Latency
from irsim.learning.moment import Moment
from irsim.learning.observing import Eyes
from irsim.learning.result import Result, Step
from irsim.learning.tasks.files import TaskSource, open_task
from irsim.learning.tasks.scene import open_scene
from irsim.learning.tasks.team import team_of
from irsim.learning.threats import Threats
from irsim.metrics.roles import kinds_of
from irsim.policies.networks.output import Present, are_finite, decide
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.simulation.simulation import Simulation

__all__ = ["Autoreset", "Worlds"]

Autoreset = Literal["over", "before"]
"""Worlds that start their next episode in a step: those that are over after it, or those that were before it."""
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
        eyes: What they observe.
        width: Number of numbers of an action; 1 for the number of a choice.
        present: (n, A) whether the learner takes part in the present episode.
        level: (n,) level of the curriculum of the present episode.
        drawn: What was drawn for the present episodes, see :meth:`irsim.learning.draws.Draws.values`.

    Raises:
        TaskError: The task is not valid, or does not fit its scenario.
        ScenarioError: The scenario cannot be used.
        ArgumentError: There is no such level.
    """

    def __init__(
        self, task: TaskSource, n: int = 1, *, seed: int | None = None, threads: int = 1, level: int | None = None
    ) -> None:
        self.task, folder = open_task(task)
        scene = open_scene(self.task, folder)
        check_observed(self.task, scene)
        self.scenario: ResolvedScenario = scene.scenario
        self.n = n
        first = self.task.seeds.train if seed is None else seed
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
        self._controls = team.controls
        self._kinds = kinds_of(self.scenario.objects)
        step_time = self.scenario.world.step_time
        horizons = [max(1, round(self.task.horizon_of(k) / step_time)) for k in range(len(self.task.levels))]
        self._horizons = np.array(horizons, dtype=np.int64)
        self._terms: list[tuple[Any, Any]] = [(REWARDS.get(term.name), term) for term in self.task.reward]
        wary = any(term.name == "rvo" for term in self.task.reward)
        self._threats = Threats(simulation, team.indices, threads) if wary else None
        self._shape = (n, self.learners)
        self._begun = np.zeros(n, dtype=bool)
        self._over = np.zeros(n, dtype=bool)
        self._ended = np.zeros(self._shape, dtype=bool)
        self._arrived = np.zeros(self._shape, dtype=bool)
        self._collided = np.zeros(self._shape, dtype=bool)
        self._low: Floats = np.zeros((len(self.rows), 3))
        self._high: Floats = np.zeros((len(self.rows), 3))
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
        """
        chosen = np.ones(self.n, dtype=bool) if mask is None else np.array(mask, dtype=bool)
        if chosen.shape != (self.n,):
            raise ArgumentError(f"a mask of {self.n} worlds has the shape ({self.n},), not {chosen.shape}", "give one")
        if seeds is not None:
            self._simulation.reseed(np.asarray(seeds, dtype=np.uint64), chosen)
            self._begun[chosen] = False
        for next_scene in (False, True):
            these = chosen & (self._begun == next_scene)
            if these.any():
                self._draw(these, next_scene or seeds is not None)
        self._begun[chosen] = True
        self._over[chosen] = False
        state = self._simulation.state
        if self._draws.varies:
            self._read_draws(chosen)
        self._ended[chosen] = ~self.present[chosen]
        self._low, self._high = state.vel_min.take(self.rows, axis=0), state.vel_max.take(self.rows, axis=0)
        self._bounded = are_finite(self._low, self._high, self.width)
        flags = self._simulation
        self._arrived[chosen] = flags.arrived.take(self.rows).reshape(self._shape)[chosen] != 0
        self._collided[chosen] = flags.collided.take(self.rows).reshape(self._shape)[chosen] != 0

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

    # a step -----------------------------------------------------------------------------------------------------------
    def step(self, actions: Any) -> Result:
        """Advance all worlds by one period.

        Args:
            actions: (n * A, C) numbers from -1 to 1, or (n * A,) numbers of choices; None leaves the learners to the
                behaviors of the scenario.

        Raises:
            ArgumentError: The actions have another shape, or are not finite.
        """
        return self._step(self.read(actions))

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
            reset: Which worlds start their next episode: those that are ``over`` after the step, or those that were
                over ``before`` it; None: none.
            out: (n * A, D) array for observations; None: a new one.
            last: (n * A, D) array for the last observations of episodes; None: one that the next call overwrites.
            watch: Called with the result before worlds that are over after the step start their next episode.

        Returns:
            What has happened, and what the learners observe then.
        """
        before = self._over
        result = self._step(numbers)
        if reset == "before" and before.any():
            self.reset(before)
        seen = self.observe(out)
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
        slots = np.flatnonzero(np.repeat(over, self.learners))
        last[slots] = seen[slots]
        self.reset(over)
        seen[slots] = self.eyes.observe(self.rows[slots])

    def _step(self, numbers: Floats | None) -> Result:
        simulation, rows, shape = self._simulation, self.rows, self._shape
        goal, before = simulation.goal.take(rows, axis=0), simulation.pose.take(rows, axis=0)
        control_before = simulation.control.take(rows, axis=0)
        if numbers is not None:
            self._impose(numbers, before, goal, control_before)
        commanded = simulation.state.commanded.take(rows, axis=0)
        threat = None if self._threats is None else self._threats.urgency(rows)
        simulation.step()
        after, twist = simulation.pose.take(rows, axis=0), simulation.twist.take(rows, axis=0)
        reached = ~_same(simulation.goal.take(rows, axis=0), goal)
        arrived = (simulation.arrived.take(rows) != 0).reshape(shape)
        collided = (simulation.collided.take(rows) != 0).reshape(shape)
        active = ~self._ended & ~self._over[:, None]
        came, hit = arrived & ~self._arrived & active, collided & ~self._collided & active
        self._arrived |= arrived
        self._collided = collided
        moment = Moment(
            step_time=float(self.scenario.world.step_time),
            pose_before=before.reshape(*shape, 3),
            pose=after.reshape(*shape, 3),
            goal=goal.reshape(*shape, 3),
            reached=(reached.reshape(shape) & active) | came,
            arrived=came,
            collided=hit,
            control=simulation.control.take(rows, axis=0).reshape(*shape, 3),
            control_before=control_before.reshape(*shape, 3),
            low=self._low.reshape(*shape, 3),
            high=self._high.reshape(*shape, 3),
            velocity=twist[:, :2].reshape(*shape, 2),
            yaw_rate=twist[:, 2].reshape(shape),
            gaps=self._gaps(),
            commanded=commanded.reshape(*shape, 2),
            urgency=lambda: np.zeros(shape) if threat is None else threat.reshape(shape),
        )
        terms = np.empty((len(self._terms), *shape))
        for term, (feature, options) in zip(terms, self._terms, strict=True):
            np.multiply(options.weight, feature.function(moment, options), out=term)
        terms *= active
        if not self.present.all():
            terms[:, ~self.present] = 0.0  # their places are not numbers
        return self._close(terms, active, came, hit)

    def _close(self, terms: Floats, active: Any, came: Any, hit: Any) -> Result:
        """Find what has ended."""
        ends = self.task.ends
        terminated = np.zeros(self._shape, dtype=bool)
        if self.task.ends_on_arrival:
            terminated |= came
        if ends.collision:
            terminated |= hit
        done = self._simulation.done()
        terminated = active & (terminated | done[:, None])
        self._ended |= terminated
        over = self._over | _all(self._ended) | done | (self._simulation.count >= self._horizons[self.level])
        if ends.world == "any":
            over |= _any(terminated)
        elif ends.world == "collision":
            over |= _any(hit)
        truncated = active & ~terminated & over[:, None]
        self._ended |= truncated
        self._over = over.copy()
        return Result(terms.sum(axis=0), terminated, truncated, active, over, came, hit, terms)

    def _gaps(self) -> Callable[[float], Floats]:
        """The distances to others now, measured once for each reach."""
        known: dict[float, Floats] = {}

        def gaps(reach: float) -> Floats:
            if reach not in known:
                world, state = self._simulation.world, self._simulation.state
                found = core.gaps(world, state, self.rows, self._kinds, reach, self._threads)
                known[reach] = found.reshape(*self._shape, 3)
            return known[reach]

        return gaps

    # actions ----------------------------------------------------------------------------------------------------------
    def read(self, actions: Any) -> Floats | None:
        """(n * A, F) numbers that :meth:`advance` takes, from actions as :meth:`step` takes them.

        Raises:
            ArgumentError: The actions have another shape, or are not finite.
        """
        return None if actions is None else read_actions(actions, self._meaning.choices, len(self.rows), self.width)

    def _impose(self, numbers: Floats, pose: Floats, goal: Floats, control: Floats) -> None:
        """Command the learners whose episodes go on; the others stand still."""
        simulation, rows = self._simulation, self.rows
        held = None
        if self._latency is not None:
            numbers, held = self._latency.pass_on(numbers, simulation.count)
        velocity = simulation.twist.take(rows, axis=0)[:, :2]
        present = Present(pose, goal, velocity, control, self._low, self._high, self._bounded)
        wanted = decide(self._meaning, numbers, present)
        if self._ended.any():
            wanted[self._ended.reshape(-1)] = 0.0
        if held is not None:
            wanted[held] = 0.0
        simulation.given[rows] = 1
        if self._meaning.returns == "velocity":
            core.follow_rows(simulation.world, simulation.state, rows, wanted)
        else:
            for k in range(self._controls):
                simulation.command[:, k][rows] = wanted[:, k]


def _all(flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(n,) whether all flags of a world are set."""
    return flags[:, 0] if flags.shape[1] == 1 else np.asarray(np.logical_and.reduce(flags, axis=1))


def _any(flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(n,) whether any flag of a world is set."""
    return flags[:, 0] if flags.shape[1] == 1 else np.asarray(np.logical_or.reduce(flags, axis=1))


def _same(a: Floats, b: Floats) -> NDArray[np.bool_]:
    """Whether goals are equal, (B,)."""
    if a.tobytes() == b.tobytes():
        return np.ones(len(a), dtype=bool)
    equal: NDArray[np.bool_] = ((a == b) | (np.isnan(a) & np.isnan(b))).all(axis=1)
    return equal
