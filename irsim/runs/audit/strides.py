"""How bodies move within the steps of a recorded run: along the twist that is constant in a step."""

from __future__ import annotations

import math

import numpy as np

from irsim.common.angles import wrap
from irsim.common.arrays import Floats
from irsim.runs.audit.artifact import Artifact

__all__ = ["Strides"]

_MAX_TURN = 6.0
"""Turn [rad] from which on the ends of an arc do not tell its radius."""


class Strides:
    """The motions of all bodies in all steps.

    With ``world.integration: exact`` the origin of a body that drives moves on the arc through its poses at both ends
    of a step, otherwise on the chord; its heading turns at a constant rate. A body that a contact stopped within a step
    (``world.contacts: swept``) comes to its recorded pose at the time of that contact and then rests.

    Args:
        artifact: The run.

    Attributes:
        stop: (T - 1, N) share of each step after which each body rests; 1 if it moves to the end of it.
    """

    def __init__(self, artifact: Artifact) -> None:
        before, after = artifact.pose[:-1], artifact.pose[1:]
        self._from = np.where(np.isnan(before[..., :1]), after, before)
        self._by = after[..., :2] - self._from[..., :2]
        self.turn = self._turns(artifact, wrap(after[..., 2] - self._from[..., 2]))
        driven = np.array([body.drive is not None and not body.options.static for body in artifact.bodies], dtype=bool)
        exact = artifact.world.integration == "exact"
        self._arc = exact & driven & (self.turn != 0) & (np.abs(self.turn) < _MAX_TURN)
        half = np.where(self._arc, 0.5 * self.turn, 1.0)
        with np.errstate(invalid="ignore"):
            length = np.hypot(self._by[..., 0], self._by[..., 1])
        self.length = np.where(self._arc, length * half / np.sin(half), length)
        self.stop = self._stops(artifact)

    @staticmethod
    def _turns(artifact: Artifact, least: Floats) -> Floats:
        """Turn of each body in each step [rad]; a recorded turn rate tells full turns apart."""
        turn = np.nan_to_num(least)
        for row, body in enumerate(artifact.bodies):
            column = {"diff": 1, "omni_angular": 2}.get(str(body.drive))
            if column is None or artifact.world.collision_mode == "contact":
                continue
            wanted = artifact.control[1:, row, column] * artifact.step_time
            full = np.round((wanted - turn[:, row]) / (2 * np.pi))
            turn[:, row] += np.where(np.abs(wanted) > np.pi, full, 0.0) * 2 * np.pi
        return turn

    @staticmethod
    def _stops(artifact: Artifact) -> Floats:
        stop = np.ones((len(artifact.pose) - 1, len(artifact.bodies)))
        if artifact.world.contacts != "swept":
            return stop
        rows = {name: row for row, name in enumerate(artifact.names)}
        for event in artifact.events:
            step = event.step - artifact.first
            if event.kind != "collision" or not 0 < step < len(artifact.pose):
                continue
            share = event.time / artifact.step_time - (event.step - 1)
            for name in (event.object, event.partner):
                row = rows.get(str(name))
                if row is not None and artifact.stopped[step, row] and 0 <= share < stop[step - 1, row]:
                    stop[step - 1, row] = share
        return stop

    def at(self, step: int, body: int, time: float, *, onward: bool = False) -> tuple[float, float, float]:
        """Pose of a body at a time (0 to 1) within the step from row ``step`` to the next one.

        Args:
            step: Row of the trace at the beginning of the step.
            body: Index of the body.
            time: Share of the step.
            onward: Whether a body goes on as if no contact had stopped it.
        """
        stop = self.stop[step, body]
        share = time / stop if stop > 0 else 1.0
        share = share if onward else min(share, 1.0)
        x, y, heading = self._from[step, body].tolist()
        by_x, by_y = self._by[step, body].tolist()
        turn = float(self.turn[step, body])
        if self._arc[step, body]:
            scale = math.sin(0.5 * turn * share) / math.sin(0.5 * turn)
            back = -0.5 * turn * (1.0 - share)
            cosine, sine = math.cos(back), math.sin(back)
            by_x, by_y = (by_x * cosine - by_y * sine) * scale, (by_x * sine + by_y * cosine) * scale
        else:
            by_x, by_y = by_x * share, by_y * share
        return x + by_x, y + by_y, heading + turn * share

    def speed(self, step: int, one: int, other: int, reaches: tuple[float, float]) -> float:
        """Upper bound of how fast points of two bodies approach each other in a step [m per step].

        Args:
            step: Row of the trace at the beginning of the step.
            one: Index of one body.
            other: Index of the other body.
            reaches: Largest distances of points of each from its origin [m].
        """
        pair = (one, other)
        stops = [max(float(self.stop[step, body]), 1e-12) for body in pair]
        swing = sum(
            abs(float(self.turn[step, body])) / stop * reach
            for body, stop, reach in zip(pair, stops, reaches, strict=True)
        )
        if stops == [1.0, 1.0] and not (self._arc[step, one] or self._arc[step, other]):
            return float(np.hypot(*(self._by[step, one] - self._by[step, other]))) + swing
        return sum(float(self.length[step, body]) / stop for body, stop in zip(pair, stops, strict=True)) + swing

    def boxes(self, reach: Floats) -> Floats:
        """(T - 1, N, 4) boxes x0, y0, x1, y1 that hold the bodies throughout the steps; NaN for absent ones [m].

        Args:
            reach: (N,) largest distance of a point of each body from its origin.
        """
        with np.errstate(invalid="ignore"):
            ends = self._from[..., :2] + self._by
            margin = (reach + np.where(self._arc, self.length, 0.0))[..., None]
            low, high = np.minimum(self._from[..., :2], ends) - margin, np.maximum(self._from[..., :2], ends) + margin
        return np.concatenate([low, high], axis=-1)
