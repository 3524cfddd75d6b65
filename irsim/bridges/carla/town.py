"""The town of a server: its settings and its time while a scenario is in it, and how it is left."""

from __future__ import annotations

import math
from typing import Any

from irsim.bridges.base import BridgeError
from irsim.bridges.carla.actors import Ground, Spawner
from irsim.bridges.carla.client import connect
from irsim.components.bridges.carla import Carla

__all__ = ["Town"]

_LONGEST_TICK = 0.1
"""Longest tick [s] that the physics of CARLA takes with its own settings."""
_SETTLING = 0.5
"""Time for which actors fall to the ground and stand, before the scenario starts [s]."""
_LAST_TRY = 2.0
"""Time for which a server that is lost is asked to destroy the actors [s]."""


class Town:
    """A town that was connected to.

    Args:
        options: The options.
        period: Duration of a step of the scenario [s].

    Attributes:
        carla: The module.
        world: The world of the client.
        spawner: Spawns actors, and knows all that it has spawned.
        ground: Heights of the ground.
        tick: Period of CARLA [s].
        ticks: Number of ticks so far.

    Raises:
        BridgeError: No server answers, or it does not fit.
    """

    def __init__(self, options: Carla, period: float) -> None:
        self.options, self.period, self.ticks = options, period, 0
        self.carla, self._client, self.world = connect(options)
        self._settings: Any = None
        self._time: float | None = None
        self.tick = period
        self.spawner = Spawner(self.carla, self.world)
        self.ground = Ground(self.carla, self.world, options.ground)

    def take_over(self) -> None:
        """Make the server synchronous, or check that another client ticks it in a way that fits.

        Raises:
            BridgeError: Steps are not a whole number of ticks.
        """
        settings = self.world.get_settings()
        if self.options.clock == "external":
            result = settings.fixed_delta_seconds
            if not result or not _is_whole(self.period / result):
                what = f"CARLA has ticks of {result} s, and steps of {self.period:g} s are not a whole number of them"
                fix = (
                    f"let the program that ticks CARLA set fixed_delta_seconds to {self.period:g}, or change step_time"
                )
                raise BridgeError("bridge-mismatch", what, fix)
            self.tick = float(result)
            return
        usual = self.period / math.ceil(self.period / _LONGEST_TICK - 1e-9)
        self.tick = self.options.tick or usual
        if not _is_whole(self.period / self.tick):
            what = f"steps of {self.period:g} s are not a whole number of ticks of {self.tick:g} s"
            raise BridgeError("bridge-mismatch", what, f"tick: {usual:g}")
        self._settings = self.world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, self.tick
        settings.no_rendering_mode = not self.options.rendering
        self.world.apply_settings(settings)

    def settle(self) -> None:
        """Let actors fall to the ground."""
        if self.options.clock == "external":
            self._time = float(self.world.wait_for_tick(self.options.timeout).timestamp.elapsed_seconds)
            return
        for _ in range(math.ceil(_SETTLING / self.tick)):
            self._tick_once()

    def pass_time(self) -> int:
        """Let one step pass; the last frame of it."""
        if self.options.clock == "irsim":
            return max(self._tick_once() for _ in range(round(self.period / self.tick)))
        assert self._time is not None
        self._time += self.period
        snapshot = self.world.get_snapshot()
        while float(snapshot.timestamp.elapsed_seconds) < self._time - self.tick / 2:
            snapshot = self.world.wait_for_tick(self.options.timeout)
            self.ticks += 1
        return int(snapshot.frame)

    def _tick_once(self) -> int:
        self.ticks += 1
        return int(self.world.tick(self.options.timeout))

    def apply(self, commands: list[Any]) -> None:
        """Give all commands of a step in one message.

        Raises:
            BridgeError: The server refuses one.
        """
        if not commands:
            return
        for answer in self._client.apply_batch_sync(commands, False):
            if answer.error:
                raise BridgeError("bridge-failed", f"CARLA refused a command: {answer.error}", "look at its log")

    def leave(self, *, lost: bool) -> None:
        """Destroy all actors and restore the settings.

        Args:
            lost: Whether the server is lost: it is then asked once, for a short time.

        Raises:
            BridgeError: The server that is not lost does not do it.
        """
        if lost:
            self._client.set_timeout(min(_LAST_TRY, self.options.timeout))
        errors = []
        for undo in (self._destroy_all, self._restore):
            try:
                undo()
            except RuntimeError as error:
                errors.append(error)
                if lost:
                    return
        if errors:
            what = f"the CARLA server at {self.options.host}:{self.options.port} did not clean up: {errors[0]}"
            raise BridgeError("bridge-failed", what, "restart the server, or reload its town")

    def _destroy_all(self) -> None:
        doomed, self.spawner.spawned = list(reversed(self.spawner.spawned)), []
        if doomed:
            self._client.apply_batch_sync([self.carla.command.DestroyActor(number) for number in doomed], False)

    def _restore(self) -> None:
        settings, self._settings = self._settings, None
        if settings is not None:
            self.world.apply_settings(settings)


def _is_whole(number: float) -> bool:
    return round(number) >= 1 and abs(number - round(number)) < 1e-4
