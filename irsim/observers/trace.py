"""Everything that happened in a rollout, as arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irsim import _core as core

if TYPE_CHECKING:
    from irsim.simulation import Simulation

__all__ = ["Rollout", "record_rollout"]


@dataclass(frozen=True)
class Rollout:
    """Arrays over T executed steps and N objects; row t is the state after step t + 1 of the rollout.

    Attributes:
        time: (T,) simulated time [s].
        pose: (T, N, 3) x, y [m], heading [rad], world frame.
        control: (T, N, 3) executed controls, command frame, zero padded.
        arrived, collided: (T, N) flags.
        names: Names of the objects, in order.
    """

    time: NDArray[np.float64]
    pose: NDArray[np.float64]
    control: NDArray[np.float64]
    arrived: NDArray[np.bool_]
    collided: NDArray[np.bool_]
    names: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.time)


def record_rollout(simulation: Simulation, steps: int, *, until_done: bool) -> Rollout:
    """Advance the only world of ``simulation`` by up to ``steps`` periods and keep everything."""
    if steps < 0:
        raise ValueError(f"steps is 0 or more, not {steps}")
    begin = int(simulation.count[0])
    pose: NDArray[np.float64]
    control: NDArray[np.float64]
    arrived: NDArray[np.uint8]
    collided: NDArray[np.uint8]
    if simulation.in_python:
        rows = []
        for _ in range(steps):
            if until_done and simulation.state.done(0):
                break
            simulation.step()
            rows.append(
                (
                    simulation.pose.copy(),
                    simulation.control.copy(),
                    simulation.arrived.copy(),
                    simulation.collided.copy(),
                )
            )
        count = simulation.objects
        pose, control = (np.array([row[i] for row in rows]).reshape(-1, count, 3) for i in (0, 1))
        arrived, collided = (np.array([row[i] for row in rows], dtype=np.uint8).reshape(-1, count) for i in (2, 3))
    else:
        trace = core.rollout(simulation.world, simulation.state, steps, until_done=until_done)
        pose, control, arrived, collided = trace.pose, trace.control, trace.arrived, trace.collided
    time = np.arange(begin + 1, begin + 1 + len(pose), dtype=np.float64) * simulation.scenario.world.step_time
    names = tuple(record.name for record in simulation.scenario.objects)
    return Rollout(time, pose, control, arrived.astype(bool), collided.astype(bool), names)
