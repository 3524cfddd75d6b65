"""The interface of everything that decides for robots."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal

from irsim.common.arguments import as_given, is_number, is_whole_number
from irsim.common.arrays import Floats
from irsim.common.notebook import facts, section
from irsim.diagnostics.errors import ArgumentError
from irsim.options.knowledge import Fact, knowledge_class

if TYPE_CHECKING:
    import numpy as np

    from irsim.policies.observations import Observations

__all__ = ["Episode", "FunctionPolicy", "Needs", "Output", "Policy"]

Output = Literal["control", "velocity"]
"""Result of a policy: controls of the drive, or velocities in the world frame, which every drive follows."""
MAX_COUNT = 100_000
"""Largest number of neighbors or beams."""


@dataclass(frozen=True)
class Needs:
    """Observations of a policy besides the state and the goal of the robot itself.

    Attributes:
        neighbors: Number of nearest other objects; 0 for none.
        neighbor_range: Distance beyond which others are not seen [m], between bounding circles.
        static_neighbors: Whether static objects count as neighbors; each is then seen as its bounding circle.
        neighbor_extents: Whether it needs to know how far footprints reach toward each other.
        footprints: Whether it needs to know the footprints of its robots, which are found at the start of each episode.
        scan: Whether it needs the ranges of a lidar; every robot must then carry one, with equal beams.
        beams: Number of beams that this lidar must have; None: any.
        map: Whether it needs the grid of static objects.
        map_resolution: Side of the cells of this grid [m]; larger in worlds that have more than 4 million such cells.
    """

    neighbors: int = 0
    neighbor_range: float = float("inf")
    static_neighbors: bool = False
    neighbor_extents: bool = False
    footprints: bool = False
    scan: bool = False
    beams: int | None = None
    map: bool = False
    map_resolution: float = 0.1

    def __post_init__(self) -> None:
        """Refuse what cannot be observed.

        Raises:
            ArgumentError: A number is not of its kind, or out of range.
        """
        for name in ("neighbors", "beams"):
            value = getattr(self, name)
            if value is not None and not (is_whole_number(value) and 0 <= value <= MAX_COUNT):
                what = f"{name} must be a whole number from 0 to {MAX_COUNT:,}, got {as_given(value)}"
                raise ArgumentError(what, "give a number such as 5")
        for name in ("neighbor_range", "map_resolution"):
            value = getattr(self, name)
            if not (is_number(value) and value > 0):  # also refuses NaN
                raise ArgumentError(f"{name} must be a distance [m] above 0, got {as_given(value)}", "give metres")


@dataclass(frozen=True)
class Episode:
    """Facts for a policy at the start of an episode.

    Attributes:
        world: Index of the world among all that the policy object drives, also in other simulations. Where a policy of
            controls drives robots with different drives, the robots of each drive have an index of their own, as if
            they were in another world.
        robots: Ids of the robots that the policy drives.
        step_time: Period of the simulation [s].
        decision_steps: Number of steps between two decisions.
        drive: Name of the drive of these robots; ``mixed`` where robots with different drives follow velocities.
        footprints: (K, 2) corners of the convex hull of each robot, counterclockwise, in its own frame [m], if the
            policy needs them; circles and round parts are polygons with 16 corners around them.
    """

    world: int
    robots: tuple[int, ...]
    step_time: float
    decision_steps: int
    drive: str
    footprints: tuple[Floats, ...] = ()


class Policy(ABC):
    """Decides for all robots of all worlds that run together.

    Decisions in one world must not depend on the other worlds: whatever a policy remembers belongs to a world.

    Attributes:
        name: Name in tables.
        needs: Its observations.
        output: Kind of the result of :meth:`act`.
        drives: Names of the drives that it can control; None: all of them (for ``output = "velocity"``).
        decision_dt: Time between two decisions [s]; None: every step. Rounded to whole steps, at least one. The robot
            keeps its control (or follows its velocity) in between.
        stochastic: Whether its decisions may differ between seeds where everything else is equal. A benchmark runs a
            deterministic policy only once in a scenario that leaves nothing to chance.
        batch_invariant: Whether its decision for a robot has the same bits whatever other robots a call decides for.
            Benchmarks then step many worlds at once; else one after another.
        may_be_lost: Whether it lives in another process, so that ``act`` may raise :class:`PolicyLostError`.
        package: Python package that it needs and that irsim does not depend on, and how to install it.
        text: How it is written in commands, such as ``orca`` or ``model.npz``; None: only this program has it.
        source: Text that opens it from any folder, with the full path of its file; None as for ``text``.
        digest: SHA-256 of the file that it was read from; None without one.
        parts: Name or tag of robots -> the policy that drives them; empty for a policy that drives all robots.
    """

    name: str
    needs: Needs = Needs()
    output: Output = "control"
    drives: frozenset[str] | None = None
    decision_dt: float | None = None
    stochastic: bool = True
    batch_invariant: bool = False
    may_be_lost: bool = False
    package: tuple[str, str] | None = None
    text: str | None = None
    source: str | None = None
    digest: str | None = None
    parts: Mapping[str, Policy] = MappingProxyType({})

    def reset(self, episode: Episode, rng: np.random.Generator) -> None:  # noqa: B027 - most policies remember nothing
        """Begin an episode in one world.

        Args:
            episode: The world and the robots in it.
            rng: The policy's own random stream in this world and episode; the scenario never draws from it.
        """

    def memory(self) -> dict[str, Any] | None:
        """The part of the policy that snapshots keep: its attributes if it has a ``reset``, else nothing."""
        if type(self).reset is Policy.reset:
            return None
        return {name: value for name, value in vars(self).items() if name != "_worlds_in_use"}

    def recall(self, memory: dict[str, Any]) -> None:
        """Continue from what :meth:`memory` returned."""
        vars(self).update(memory)

    def _repr_html_(self) -> str:
        known = {
            "kind": type(self).__name__,
            "result": "velocities in the world" if self.output == "velocity" else "controls of the drive",
            "drives": "all" if self.drives is None else ", ".join(sorted(self.drives)),
            "information": self.knowledge() or "not known",
            "decides every": "step" if self.decision_dt is None else f"{self.decision_dt:g} s",
            "same decisions for each seed": not self.stochastic,
            "SHA-256": self.digest,
            "written": self.text,
        }
        return section(f"Policy {self.name}", facts(known))

    @abstractmethod
    def act(self, observations: Observations) -> Floats:
        """Decide for all robots that need a decision now.

        Robots that stand still because of a collision, because they have arrived for good or because their start is
        delayed are not among them, nor are robots that the caller steers.

        Args:
            observations: Observations of these B robots.

        Returns:
            (B, 2) velocities in the world frame [m/s] for ``output = "velocity"``; else (B, C) controls in the command
            frame of the drive, with at least as many columns as it has controls. Limits are applied by the simulation.
        """

    def known(self) -> frozenset[Fact] | None:
        """Its information besides the state and goal of its own robot: by default all that its ``needs`` bring.

        None if it cannot be told, as for the behaviors of a scenario.
        """
        known: set[Fact] = set()
        if self.needs.neighbors:
            known |= {"circles", "headings", "arrivals"}
        if self.needs.neighbor_extents:
            known.add("outlines")
        if self.needs.scan:
            known.add("scan")
        if self.needs.map:
            known.add("map")
        return frozenset(known)

    def knowledge(self) -> str | None:
        """The class of its information, see ``irsim.options.knowledge.knowledge_class``; None if it cannot be told."""
        known = self.known()
        return None if known is None else knowledge_class(known, self.needs.neighbors, self.needs.neighbor_range)

    def remarks(self) -> Mapping[int, str]:
        """Why it stands still with robots, for the reason of a run that fails: id of a robot -> clause."""
        return {}


_COPIED = ("output", "needs", "drives", "decision_dt", "stochastic")


class FunctionPolicy(Policy):
    """Calls a function of the observations; it remembers nothing.

    Attributes of the function with the names of the arguments below count as these arguments.

    Args:
        function: ``f(observations)``, which returns what :meth:`irsim.policies.Policy.act` does.
        name: Name in tables; default: the function's.
        output, needs, drives, decision_dt, stochastic: As for :class:`irsim.policies.Policy`.
    """

    def __init__(
        self,
        function: Callable[[Observations], Any],
        *,
        name: str | None = None,
        output: Output | None = None,
        needs: Needs | None = None,
        drives: frozenset[str] | None = None,
        decision_dt: float | None = None,
        stochastic: bool | None = None,
    ) -> None:
        self.function = function
        self.name = name or str(getattr(function, "name", None) or getattr(function, "__name__", "function"))
        given = {"output": output, "needs": needs, "drives": drives, "decision_dt": decision_dt}
        given["stochastic"] = stochastic
        for key in _COPIED:
            value = given[key] if given[key] is not None else getattr(function, key, None)
            if value is not None:
                setattr(self, key, value)

    def act(self, observations: Observations) -> Any:
        """Call the function."""
        return self.function(observations)
