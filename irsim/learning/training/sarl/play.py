"""Plays episodes with a value network and remembers what they were worth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.learning.training.sarl.task import Plan
from irsim.learning.training.success import Success
from irsim.learning.worlds import Worlds
from irsim.policies.networks.layout import layout_needs, observe
from irsim.policies.networks.lookahead import best_moves, look_ahead, straight, take_rows
from irsim.policies.observe import Observer

__all__ = ["Driver", "Experience", "Memory", "Played", "play"]


Rows = NDArray[np.float32]


class Experience:
    """Decisions of one or many episodes.

    Attributes:
        state: (N, D) joint states before the decisions.
        reward: (N,) rewards until the next decision, each step's discounted to the decision.
        following: (N, D) joint states at the next decision.
        discount: (N,) factor of the value of what follows; 0 where the episode of the learner has ended.
        gain: (N,) discounted sum of all rewards until the end of the episode.
    """

    def __init__(self, state: Rows, reward: Floats, following: Rows, discount: Floats, gain: Floats) -> None:
        self.state, self.following = state, following
        self.reward, self.discount, self.gain = (np.asarray(x, np.float32) for x in (reward, discount, gain))

    def __len__(self) -> int:
        return len(self.state)


class Memory:
    """The last decisions, a ring.

    Args:
        size: How many.
        width: Numbers of a state, D.
    """

    def __init__(self, size: int, width: int) -> None:
        self.state = np.zeros((size, width), dtype=np.float32)
        self.following = np.zeros((size, width), dtype=np.float32)
        self.reward = np.zeros(size, dtype=np.float32)
        self.discount = np.zeros(size, dtype=np.float32)
        self.count = self.place = 0

    def __len__(self) -> int:
        return self.count

    def add(self, experience: Experience) -> None:
        """Remember decisions, instead of the oldest ones."""
        size = len(self.state)
        kept = np.arange(max(0, len(experience) - size), len(experience))
        places = (self.place + kept) % size
        for name in ("state", "following", "reward", "discount"):
            getattr(self, name)[places] = getattr(experience, name)[kept]
        self.place = (self.place + len(experience)) % size
        self.count = min(self.count + len(experience), size)

    def contents(self) -> dict[str, Any]:
        """Everything, as arrays and numbers."""
        arrays = {name: getattr(self, name)[: self.count] for name in ("state", "following", "reward", "discount")}
        return {**arrays, "place": self.place}

    def restore(self, contents: dict[str, Any]) -> None:
        """Remember what :meth:`contents` has returned."""
        self.count, self.place = len(contents["state"]), int(contents["place"])
        for name in ("state", "following", "reward", "discount"):
            getattr(self, name)[: self.count] = contents[name]


Values = Callable[[NDArray[np.float32]], Floats]
_MOVES_AT_ONCE = 4_000
"""Moves that are valued together: as many as fit the caches."""


class Driver:
    """Chooses moves of learners by lookahead, and some of them at random.

    Args:
        worlds: The worlds.
        plan: How moves are chosen.
        values: Values of joint states.
    """

    def __init__(self, worlds: Worlds, plan: Plan, values: Values) -> None:
        self._plan, self._values, self._layout = plan, values, worlds.task.layout
        indices = np.unique(worlds.rows % worlds.simulation.objects)
        self._observer = Observer(worlds.simulation, layout_needs(self._layout), indices)
        self._objects = worlds.simulation.objects

    def moves(self, rows: NDArray[np.int64], explore: float, rng: np.random.Generator) -> Floats:
        """(B, 2) moves, as in :class:`irsim.policies.networks.lookahead.Futures`.

        Args:
            rows: (B,) rows of the learners.
            explore: Probability of a random move.
            rng: Where random moves are drawn from.
        """
        seen = self._observer.observe(rows, np.zeros(len(rows), dtype=bool), rows // self._objects)
        ahead = self._plan.lookahead
        chance, drawn = rng.random(len(rows)) < explore, rng.integers(ahead.moves.count, size=len(rows))
        chosen = straight(ahead, seen)
        sees = np.zeros(len(rows), dtype=bool) if seen.neighbors is None else seen.neighbors.mask.any(axis=1)
        if chance.any():
            some = np.flatnonzero(chance)
            chosen[some] = look_ahead(ahead, take_rows(seen, some)).move[np.arange(len(some)), drawn[some]]
        thinking = np.flatnonzero(sees & ~chance)
        portion = max(1, _MOVES_AT_ONCE // ahead.moves.count)
        for first in range(0, len(thinking), portion):
            some = thinking[first : first + portion]
            futures = look_ahead(ahead, take_rows(seen, some))
            parts = observe(self._layout, futures.observations)
            states = np.concatenate([value.flat() for value in parts.values()], axis=1).astype(np.float32)
            chosen[some] = best_moves(self._values(states).reshape(futures.reward.shape), futures)
        return chosen


@dataclass(frozen=True)
class Played:
    """Result of episodes.

    Attributes:
        experience: The decisions of all learners.
        success: Shares of the episodes.
    """

    experience: Experience
    success: Success


def play(worlds: Worlds, plan: Plan, driver: Driver | None, explore: float, rng: np.random.Generator) -> Played:
    """Run the present episode of every world to its end.

    Args:
        worlds: The worlds, whose episodes have just begun.
        plan: How the task is learnt.
        driver: Chooses moves; None lets the behaviors of the scenario decide.
        explore: Probability of a random move.
        rng: Where random moves are drawn from.
    """
    step_time, shape = float(worlds.scenario.world.step_time), (worlds.n, worlds.learners)
    held = max(1, int(plan.lookahead.dt / step_time + 0.5))
    speed = worlds.simulation.state.vel_max[worlds.rows, 0]
    fade = np.array([plan.lookahead.gamma ** (step_time * v) for v in speed.tolist()])
    moves: list[tuple[Any, ...]] = []
    arrived, collided = np.zeros(shape, dtype=bool), np.zeros(shape, dtype=bool)
    total, seconds = np.zeros(shape), np.zeros(worlds.n)
    active, going = worlds.present.copy(), np.ones(worlds.n, dtype=bool)
    while going.any():
        slots = np.flatnonzero(active.reshape(-1))
        before = worlds.observe()
        actions = np.zeros((len(worlds.rows), 2))
        if driver is not None and slots.size:
            chosen = driver.moves(worlds.rows[slots], explore, rng)
            actions[slots] = plan.numbers(worlds.task, chosen, held * step_time)
        reward, factor, ended = np.zeros(len(speed)), np.ones(len(speed)), ~active.reshape(-1)
        for _ in range(held):
            result = worlds.step(None if driver is None else actions)
            reward += factor * result.reward.reshape(-1)
            factor *= fade
            arrived |= result.arrived & going[:, None]
            collided |= result.collided & going[:, None]
            total += result.reward * going[:, None]
            seconds += step_time * going
            ended |= (result.terminated | result.truncated).reshape(-1)
            factor[result.terminated.reshape(-1)] = 0.0
            going &= ~result.over
            if not going.any():
                break
        active = ~ended.reshape(shape) & going[:, None]
        moves.append((slots, before[slots], reward[slots], worlds.observe()[slots], factor[slots]))
    good, there = arrived & ~collided, worlds.present
    success = Success(
        worlds=float((good | ~there).all(axis=1).mean()),
        learners=float(good[there].mean()),
        collided=float(collided[there].mean()),
        reward=float(total[there].mean()),
        time=float(seconds.mean()),
    )
    return Played(_joined(moves, len(speed)), success)


def _joined(moves: list[tuple[Any, ...]], count: int) -> Experience:
    """All decisions, with the sums of the rewards that follow."""
    gain, gains = np.zeros(count), []
    for slots, _, reward, _, factor in reversed(moves):
        gain[slots] = reward + factor * gain[slots]
        gains.append(gain[slots].copy())
    state, reward, following, discount = (np.concatenate([move[k] for move in moves]) for k in (1, 2, 3, 4))
    return Experience(state, reward, following, discount, np.concatenate(gains[::-1]))
