"""Lets a policy decide for the robots of a simulation, in the steps in which a decision is due."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from weakref import ref

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.common.outline import outline
from irsim.diagnostics.errors import CodedError, PolicyError
from irsim.policies.behavior import BehaviorPolicy
from irsim.policies.fit import check_declaration, check_fit, drive_of
from irsim.policies.observe import Observer
from irsim.policies.parts import part_of
from irsim.policies.policy import Episode, Policy
from irsim.simulation.build import CORE_CONTROLS
from irsim.simulation.random_streams import generator

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["PolicyDriver", "attach_policy", "decision_steps", "drivers_of"]

_NEVER = np.iinfo(np.int64).max
_MEMORY = ("_numbers", "_begun", "_last", "_keys", "_held", "_next", "_first", "_active")
"""Attributes of a driver that change from step to step."""
MAX_DRIVES = 16
"""Number of different drives of the robots that a policy of controls drives in one world."""


def decision_steps(policy: Policy, step_time: float) -> int:
    """Number of steps between two decisions of a policy, at least one."""
    return 1 if policy.decision_dt is None else max(1, math.floor(policy.decision_dt / step_time + 0.5))


@dataclass(frozen=True)
class _Group:
    """Robots that a policy drives together: all, or those with one drive.

    Attributes:
        number: Number of the group.
        drive: Name of their drive, or ``mixed``.
        columns: Number of values that a decision has for each.
        places: Indices of the robots among the driven ones.
    """

    number: int
    drive: str
    columns: int
    places: NDArray[np.int64]


class PolicyDriver:
    """Part of the steps of a simulation: asks a policy, and keeps what it decided until the next decision.

    It drives every robot that can move, or the robots of one part of a mixed policy. Scenario draws, obstacles and
    noise do not depend on it.

    Args:
        simulation: The simulation, with one world or many.
        policy: The policy, or a part of one.
        whole: The policy of several that it is a part of.
        part: The selection of the robots that this part drives.

    Attributes:
        policy: The policy.
        whole: The policy of several that it is a part of; None for one that drives all robots.
        seconds: Wall-clock time of each call of ``act`` [s], for timings only.
        decided: Number of robots that each of these calls decided for.

    Raises:
        PolicyError: The policy cannot drive a robot (``policy-mismatch``).
    """

    def __init__(
        self, simulation: Simulation, policy: Policy, whole: Policy | None = None, part: str | None = None
    ) -> None:
        check_declaration(policy)
        self.policy = policy
        self.whole, self._part = whole, part
        self._stream = 0 if whole is None or part is None else MAX_DRIVES * list(whole.parts).index(part)
        self.seconds: list[float] = []
        self.decided: list[int] = []
        self._steps = decision_steps(policy, float(simulation.scenario.world.step_time))
        self._ids: list[int] = []
        self._seen: Any = None
        worlds = simulation.copies
        self._numbers: dict[str, int] = {}
        self._begun = np.zeros((MAX_DRIVES, worlds), dtype=bool)
        self._base = claim_worlds(policy, MAX_DRIVES * worlds, self)
        self._last = np.full(worlds, _NEVER)
        self._keys = np.zeros((3, worlds), dtype=np.uint64)
        self._held: Floats = np.zeros((worlds, 0, 0))
        self._next = np.zeros((worlds, 0), dtype=np.int64)
        self._first = np.zeros((worlds, 0), dtype=bool)
        self._active = np.zeros((worlds, 0), dtype=bool)
        self._find(simulation)

    # the objects --------------------------------------------------------------------------------------------------
    def _find(self, simulation: Simulation) -> None:
        """Find the robots again if objects were added, removed or changed; the others keep what was decided."""
        seen = simulation.revision, simulation.scenario
        if self._seen is not None and seen[0] == self._seen[0] and seen[1] is self._seen[1]:
            return
        records = simulation.scenario.objects
        robots = [
            index
            for index, record in enumerate(records)
            if record.role == "robot"
            and record.kinematics is not None
            and not record.static
            and (self.whole is None or part_of(self.whole, record) == self._part)
        ]
        check_fit(self.policy, simulation, robots)
        self._robots = np.array(robots, dtype=np.int64)
        self._groups = self._grouped(simulation, robots)
        self._observer = Observer(simulation, self.policy.needs, self._robots)
        in_python = [] if simulation.drives is None else simulation.drives.objects
        self._python = np.array([index in in_python for index in robots], dtype=bool)
        before, self._ids = self._ids, [records[index].id for index in robots]
        old = [before.index(number) if number in before else -1 for number in self._ids]
        columns = max([group.columns for group in self._groups], default=0)
        held = np.zeros((simulation.copies, len(robots), columns))
        fresh = np.array(old, dtype=np.int64) < 0
        kept, width = np.flatnonzero(~fresh), min(columns, self._held.shape[2])
        taken = np.array(old, dtype=np.int64)[kept]
        held[:, kept, :width] = self._held[:, taken, :width]
        following = np.zeros((simulation.copies, len(robots)), dtype=np.int64)
        following[:, kept] = self._next[:, taken]
        first = np.ones((simulation.copies, len(robots)), dtype=bool)
        first[:, kept] = self._first[:, taken]
        self._held, self._next, self._first = held, following, first
        self._active = np.zeros_like(first)
        self._seen = seen  # a policy that does not fit is refused in every step

    def _grouped(self, simulation: Simulation, robots: list[int]) -> list[_Group]:
        drives = [drive_of(simulation, index) for index in robots]
        names = list(dict.fromkeys(drives))
        if self.policy.output == "velocity":
            return [_Group(0, names[0] if len(names) == 1 else "mixed", 2, np.arange(len(robots)))] if robots else []
        sizes = {name: simulation.scenario.objects[robots[drives.index(name)]].vel_dim for name in names}
        for name in names:
            self._numbers.setdefault(name, len(self._numbers))
        if len(self._numbers) > MAX_DRIVES:
            what = f"robots with more than {MAX_DRIVES} different drives are driven in one world"
            raise PolicyError("policy-mismatch", what, "use a policy of velocities, or fewer drives")
        return [
            _Group(self._numbers[name], name, sizes[name], np.flatnonzero(np.array(drives) == name)) for name in names
        ]

    # a step -------------------------------------------------------------------------------------------------------
    def claim(self, simulation: Simulation) -> None:
        """Take the robots that can move now and that the caller does not steer; no behavior decides for them."""
        self._find(simulation)
        self._begin_episodes(simulation)
        rows = self._rows(simulation)
        idle = (simulation.stopped[rows] | simulation.given[rows]).astype(bool)
        idle |= (simulation.count[:, None] < simulation.start_step[rows]) | (simulation.appeared[rows] < 0)
        self._active = ~idle
        self._next[idle] = 0  # such a robot decides as soon as it can
        simulation.given[rows[self._active]] = 1

    def __call__(self, simulation: Simulation) -> None:
        """Decide where a decision is due, and command all robots that were taken."""
        rows = self._rows(simulation)
        due = self._active & (simulation.count[:, None] >= self._next)
        for group in self._groups:
            self._decide(simulation, group, rows, due)
        if self.policy.output == "velocity":
            self._follow(simulation, rows)
        else:
            self._control(simulation, rows)

    def memory(self) -> Any:
        """Decisions for steps to come, and the memory of the policy."""
        return [getattr(self, name) for name in _MEMORY], self._base, self.policy.memory()

    def recall(self, memory: Any) -> None:
        """Continue from what :meth:`memory` returned."""
        values, base, remembered = memory
        vars(self).update(zip(_MEMORY, values, strict=True))
        if remembered is not None:
            self._base = base
            self.policy.recall(remembered)

    def _rows(self, simulation: Simulation) -> NDArray[np.int64]:
        """(W, n) rows of the driven robots."""
        starts = np.arange(simulation.copies, dtype=np.int64) * simulation.objects
        rows: NDArray[np.int64] = starts[:, None] + self._robots
        return rows

    def _slot(self, world: Any, group: _Group) -> Any:
        """World index passed to the policy; unique for each drive, and for each simulation."""
        return self._base + group.number * len(self._last) + world

    def _begin_episodes(self, simulation: Simulation) -> None:
        state, count = simulation.state, simulation.count
        keys = np.stack([state.seed, state.scene.astype(np.uint64), state.noise.astype(np.uint64)])
        new = (count <= self._last) | (keys != self._keys).any(axis=0)
        self._keys, self._last = keys, count.copy()
        self._next[new], self._first[new], self._held[new] = 0, True, 0.0
        self._begun[:, new] = False
        if type(self.policy).reset is Policy.reset:
            return
        step_time = float(simulation.scenario.world.step_time)
        for group in self._groups:
            for world in np.flatnonzero(~self._begun[group.number]).tolist():
                robots = tuple(simulation.ids[self._robots[group.places]].tolist())
                footprints = self._footprints(simulation, world, group) if self.policy.needs.footprints else ()
                slot = int(self._slot(world, group))
                episode = Episode(slot, robots, step_time, self._steps, group.drive, footprints)
                rng = generator(*simulation.key(world), stream="policy", object_id=self._stream + group.number)
                self._guarded(self.policy.reset, episode, rng)
                self._begun[group.number, world] = True

    def _footprints(self, simulation: Simulation, world: int, group: _Group) -> tuple[Floats, ...]:
        """The footprints of the robots of a group in a world."""
        rows = self._rows(simulation)[world, group.places].tolist()
        return tuple(outline(simulation.state, row).hull() for row in rows)

    def _decide(self, simulation: Simulation, group: _Group, rows: NDArray[np.int64], due: NDArray[np.bool_]) -> None:
        world, place = np.nonzero(due[:, group.places])
        if not world.size:
            return
        place = group.places[place]
        slot = self._slot(world, group)
        chosen = rows[world, place]
        observations = self._observer.observe(chosen, self._first[world, place], slot)
        begin = time.perf_counter()
        result = self._guarded(self.policy.act, observations)
        self.seconds.append(time.perf_counter() - begin)
        self.decided.append(len(chosen))
        self._held[world, place, : group.columns] = self._checked(simulation, group, chosen, result)
        self._next[world, place] = simulation.count[world] + self._steps
        self._first[world, place] = False

    def _follow(self, simulation: Simulation, rows: NDArray[np.int64]) -> None:
        native = self._active & ~self._python
        core.follow_rows(simulation.world, simulation.state, rows[native], self._held[native])
        if simulation.drives is None:
            return
        for world, place in np.argwhere(self._active & self._python).tolist():
            row = int(rows[world, place])
            simulation.state.commanded[row] = self._held[world, place]
            control = simulation.drives.control_for(row, self._held[world, place])
            if control is not None:
                simulation.impose(row, control)

    def _control(self, simulation: Simulation, rows: NDArray[np.int64]) -> None:
        width = min(CORE_CONTROLS, self._held.shape[2])
        chosen = rows[self._active]
        simulation.command[chosen] = 0.0
        simulation.command[chosen, :width] = self._held[self._active][:, :width]
        if simulation.drives is None or self._held.shape[2] <= CORE_CONTROLS:
            return
        for world, place in np.argwhere(self._active & self._python).tolist():
            row, robot = int(rows[world, place]), int(self._robots[place])
            size = simulation.scenario.objects[robot].vel_dim
            simulation.impose(row, self._held[world, place, :size])

    # what the policy does -------------------------------------------------------------------------------------------
    def _guarded(self, call: Any, *arguments: Any) -> Any:
        try:
            return call(*arguments)
        except CodedError:
            raise
        except Exception as error:
            what = f"policy {self.policy.name!r} raised {type(error).__name__}: {error}"
            raise PolicyError(
                "policy-failed", what, "repair the policy; the error above this one says where"
            ) from error

    def _checked(
        self, simulation: Simulation, group: _Group, rows: NDArray[np.int64], answer: Any
    ) -> NDArray[np.float64]:
        """The answer of a policy, as one row of finite numbers for each robot."""
        count, columns = len(rows), group.columns
        what = "velocities in the world frame" if self.policy.output == "velocity" else f"controls of {group.drive}"
        advice = f"return an array of shape ({count}, {columns}): {what}, one row for each robot"
        try:
            values = np.asarray(answer, dtype=np.float64)
        except (TypeError, ValueError):
            values = np.zeros(0)
        exact = self.policy.output == "velocity"
        fits = values.ndim == 2 and values.shape[0] == count and values.shape[1] >= columns
        if not fits or (exact and values.shape[1] != columns):
            given = "None" if answer is None else type(answer).__name__ if not values.size else f"shape {values.shape}"
            raise PolicyError("policy-failed", f"policy {self.policy.name!r} returned {given}", advice)
        values = values[:, :columns]
        wrong = np.flatnonzero(~np.isfinite(values).all(axis=1))
        if wrong.size:
            world, robot = divmod(int(rows[wrong[0]]), simulation.objects)
            name = simulation.scenario.objects[robot].name
            where = f" of world {world}" if simulation.copies > 1 else ""
            numbers = values[wrong[0]].tolist()
            message = f"policy {self.policy.name!r} returned {numbers} for {name!r}{where}, which is not finite"
            raise PolicyError("policy-failed", message, advice)
        return values


def claim_worlds(policy: Policy, count: int, driver: PolicyDriver) -> int:
    """The first of ``count`` indices of worlds that no other living driver of the policy uses."""
    known = vars(policy).get("_worlds_in_use", ())
    used = sorted([item for item in known if item[2]() is not None], key=lambda item: item[0])
    free = 0
    for first, size, _ in used:
        if free + count <= first:
            break
        free = max(free, first + size)
    vars(policy)["_worlds_in_use"] = [*used, (free, count, ref(driver))]
    return free


def drivers_of(simulation: Simulation) -> list[PolicyDriver]:
    """The drivers of a simulation: one for each policy in Python that drives robots of it."""
    return [part for part in simulation.decisions if isinstance(part, PolicyDriver)]


def attach_policy(simulation: Simulation, policy: Policy | None) -> None:
    """Let a policy drive the robots of a simulation from the next step on, instead of an earlier one.

    The parts of a policy of several that drives them already go on.

    Args:
        simulation: The simulation, with its Python drives attached.
        policy: The policy; None leaves the robots to the behaviors of the scenario, and so does a policy that is a
            behavior, because it is part of the scenario then (:func:`irsim.policies.behavior.with_policy`).

    Raises:
        PolicyError: The policy cannot drive a robot (``policy-mismatch``).
    """
    if policy is not None and policy.parts and any(one.whole is policy for one in drivers_of(simulation)):
        return
    drivers = []
    if policy is not None and policy.parts:
        named = [(part, one) for part, one in policy.parts.items() if not isinstance(one, BehaviorPolicy)]
        drivers = [PolicyDriver(simulation, one, policy, part) for part, one in named]
    elif policy is not None and not isinstance(policy, BehaviorPolicy):
        drivers = [PolicyDriver(simulation, policy)]
    simulation.decisions[:] = [part for part in simulation.decisions if not isinstance(part, PolicyDriver)]
    simulation.decisions.extend(drivers)
