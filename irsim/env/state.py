"""The attributes of an environment; the functions of this folder use them, and :class:`irsim.env.Env` lists these."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from irsim.env.parameters import EnvParam, PathParam, WorldParam, WorldView

if TYPE_CHECKING:
    from irsim.common.log import Logger
    from irsim.compat.objects.view import ScriptObject
    from irsim.env.old.env_plot import EnvPlot
    from irsim.graphics.scene.style import Palette
    from irsim.gui import KeyboardControl, MouseControl
    from irsim.policies.policy import Policy
    from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario
    from irsim.simulation.simulation import Simulation

__all__ = ["EnvState"]


class EnvState:
    """The parts of an environment, and the requests that were made to it.

    Attributes:
        id: Number of the environment in this process.
        world_name: Name of the scenario file as the caller wrote it.
        scenario: The resolved scenario.
        logger: Logger of the environment.
        world_param, env_param, path_param, palette_param: Parameter objects with the names of IR-SIM.
        display, headless, save_ani, ani_kwargs, full: Settings of the figure; see :class:`irsim.env.Env`.
        pause_flag, quit_flag, debug_flag, reset_flag, reload_flag, save_figure_flag: Requests by keys or scripts, which
            the next step or frame carries out.
        debug_count: Number of single steps that were requested in debugging.
        _simulation: The simulation behind the environment.
        _policy: The policy that drives the robots instead of their behaviors, or None.
        _written: Id -> record, of the robots whose behavior a policy has replaced, as the scenario has them.
        _objects: The present objects, in the order of their rows.
        _originals: The objects of the scenario file.
        _exchanged: Whether objects have been added or deleted since the file was read.
        _world: The world with the names of IR-SIM.
        _plot: The figure; None before something is drawn.
        _title: Title set by a script; None shows the status.
        _label: Status of the start of an episode, until the next step.
        _written_status: Status set by a script, until the next step, pause or reset.
        _keyboard, _mouse: Live control of the figure.
        _seed: Seed of the present scenes.
        _next_seed: Seed with which the next random reset starts; None goes on with the present one.
        _wanted_seed, _wanted_mode, _strict: Arguments of ``make``.
        _unseen: Whether a window was asked for, and nothing has been shown yet.
        _ended: Whether ``end`` was called, without a step after it.
        _limit_warnings: Ids of the objects for which the cut of an action has been logged.
        _events_seen, _events_logged: Number of events at the last look at them, and number of events checked for
            logging.
    """

    id: int
    world_name: str | Path | ResolvedScenario | None
    scenario: ResolvedScenario
    logger: Logger
    world_param: WorldParam
    env_param: EnvParam
    path_param: PathParam
    palette_param: Palette
    display: bool
    headless: bool
    save_ani: bool
    ani_kwargs: dict[str, Any]
    full: bool
    pause_flag: bool
    quit_flag: bool
    debug_flag: bool
    reset_flag: bool
    reload_flag: bool
    save_figure_flag: bool
    debug_count: int

    _simulation: Simulation
    _policy: Policy | None
    _written: dict[int, ObjectRecord]
    _objects: list[ScriptObject]
    _originals: list[ScriptObject]
    _exchanged: bool
    _world: WorldView
    _plot: EnvPlot | None
    _title: str | None
    _label: str | None
    _written_status: str | None
    _keyboard: KeyboardControl | None
    _mouse: MouseControl | None
    _seed: int
    _next_seed: int | None
    _wanted_seed: int | None
    _wanted_mode: str | None
    _strict: bool
    _unseen: bool
    _ended: bool
    _limit_warnings: set[int]
    _events_seen: int
    _events_logged: int

    _world_class: ClassVar[type[WorldView]] = WorldView
    """The class of ``_world``."""

    def _make_plot(self, attach: Callable[[Any], None]) -> EnvPlot:
        """Make the figure, which calls ``attach`` with its axes."""
        raise NotImplementedError
