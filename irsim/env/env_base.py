"""``irsim.make`` and the environment: the loop make / step / render / done / reset / end."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn
from weakref import ref

from irsim.common.log import LEVELS, Logger
from irsim.diagnostics.diagnostic import Diagnostic, format_path
from irsim.env.live import EnvLive
from irsim.env.load_behavior import EnvCustom
from irsim.env.maps import EnvMaps
from irsim.env.messages import EnvMessages
from irsim.env.objects import EnvObjects
from irsim.env.parameters import EnvParam, PathParam, WorldParam, WorldView, checked_step_mode
from irsim.graphics.scene.palette import Palette
from irsim.objects.actions import assign_actions, beyond_limits
from irsim.objects.extensions.attach import attach_python
from irsim.objects.views import make_view, views
from irsim.scenario.open import open_scenario
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.simulation.active_env import use
from irsim.simulation.events import Event, read_events
from irsim.simulation.outcome import Outcome, outcome_of
from irsim.simulation.random_streams import check_seed, fresh_seed
from irsim.simulation.simulation import Simulation
from irsim.simulation.trace import Rollout, record_rollout

if TYPE_CHECKING:
    import numpy as np

    from irsim.env.factory import EnvConfig, ObjectFactory
    from irsim.objects.base import SimObject
    from irsim.objects.view import ObjectView
    from irsim.simulation.episode_recorder import EpisodeRecorder

__all__ = ["Env", "EnvBase", "make"]

_IDS = count()


def make(
    world_name: str | Path | None = None, projection: str | None = None, step_mode: str | None = None, **kwargs: Any
) -> Env:
    """Open a scenario file as an environment.

    Args:
        world_name: YAML file; searched as given, beside the script, in the current directory. Default: the name of the
            running script with ``.yaml``.
        projection: ``"2d"`` (default) or ``"3d"``: the same simulation, drawn in space.
        step_mode: ``"internal"`` or ``"external"``, over the file's.
        **kwargs: Those of :class:`Env`: display, headless, save_ani, seed, strict, log_level, …

    Raises:
        ScenarioNotFoundError: No such file; names the places searched and near matches.
        ScenarioError: The file cannot be used; holds every problem with its line and fix.
        TypeError: Unknown keyword.
    """
    chosen = (projection or "2d").lower()
    if chosen == "3d":
        from irsim.env.env_base3d import EnvBase3D

        return EnvBase3D(world_name, step_mode=step_mode, **kwargs)
    if chosen != "2d":
        raise ValueError(f"unknown projection {projection!r}: choose '2d' or '3d'")
    return Env(world_name, step_mode=step_mode, **kwargs)


class Env(EnvObjects, EnvMaps, EnvCustom, EnvLive, EnvMessages):
    """One world, stepped from Python.

    Args:
        world_name: YAML file (None: named like the running script), or an already resolved scenario.
        step_mode: ``internal`` (irsim moves the objects) or ``external`` (the caller does).
        display: Show a window where there is a screen.
        headless: No drawing at all; ``disable_all_plot`` is the same.
        save_ani: Keep a frame at each sampled ``render`` and write the animation in ``end``.
        ani_kwargs: Defaults of the animation writer.
        full: Full-screen window.
        log_file, log_level: Where and how much to log.
        seed: Overrides ``world.seed``; without either, fresh entropy (``env.seed`` tells which).
        strict: Treat what IR-SIM would ignore (misspelt keys, unknown behaviors) as errors.
    """

    def __init__(
        self,
        world_name: str | Path | ResolvedScenario | None = None,
        *,
        step_mode: str | None = None,
        display: bool = True,
        disable_all_plot: bool = False,
        headless: bool = False,
        save_ani: bool = False,
        ani_kwargs: Mapping[str, Any] | None = None,
        full: bool = False,
        log_file: str | Path | None = None,
        log_level: str = "INFO",
        seed: int | None = None,
        strict: bool = False,
    ) -> None:
        self.id = next(_IDS)
        self.logger = Logger(log_level, log_file)
        self.path_param = PathParam()
        self.palette_param = Palette()
        use(self)
        self._strict, self._wanted_mode, self._wanted_seed = strict, step_mode, seed
        self.world_name = world_name
        self._open(world_name)
        self.headless = headless or disable_all_plot
        self.display = display and not self.headless
        self.save_ani = save_ani
        self.ani_kwargs = dict(ani_kwargs or {})
        self.full = full
        self.pause_flag = self.quit_flag = self.debug_flag = False
        self.reset_flag = self.reload_flag = self.save_figure_flag = False
        self.debug_count = 0
        self._ended = False
        self._start_drawing()
        self._start_live()
        self._log_collisions()

    def _open(self, world_name: str | Path | ResolvedScenario | None) -> None:
        """Read a scenario and build its first scene."""
        if isinstance(world_name, ResolvedScenario):
            scenario = world_name
        else:
            scenario, warnings = open_scenario(world_name, strict=self._strict)
            for warning in warnings:
                self.logger.warning(_one_line(warning))
        mode = checked_step_mode(self._wanted_mode if self._wanted_mode is not None else scenario.world.step_mode)
        chosen = self._wanted_seed if self._wanted_seed is not None else scenario.world.seed
        seed = fresh_seed() if chosen is None else check_seed(chosen)
        simulation = Simulation(scenario, [seed], history=True)
        simulation.report = self.logger.error_once
        simulation.owner = ref(self)
        simulation.make_view = make_view
        attach_python(simulation)
        self.scenario, self._seed, self._simulation = scenario, seed, simulation
        self._originals = views(simulation)
        self._objects = list(self._originals)
        self._exchanged = False
        self._world = self._view_of_world(simulation)
        self.world_param = WorldParam(simulation, mode)
        here = ref(self)
        self.env_param = EnvParam(lambda: _objects_of(here()), self.logger)
        self._count_ids()
        self._told_of_limits: set[int] = set()
        self._events_seen = self._events_told = 0
        self._label: str | None = scenario.world.status

    def _view_of_world(self, simulation: Simulation) -> WorldView:
        return WorldView(simulation)

    @property
    def env_config(self) -> EnvConfig:
        """The scenario as parsed, and what loads it."""
        from irsim.env.factory import EnvConfig

        return EnvConfig(self)

    @property
    def object_factory(self) -> ObjectFactory:
        """Makes objects from scenario entries."""
        return self.env_config.object_factory

    # time ------------------------------------------------------------------------------------------------------------
    def step(self, action: Any = None, action_id: Any = None) -> None:
        """Advance by one period.

        Args:
            action: None lets behaviors drive. One control vector, a list of them (None inside = behavior), or a mapping
                ``{name or id: vector}``; vectors are in the command frame of the drive.
            action_id: Id or name of the target, or a list of them; default: the first robot, and on from there.

        Raises:
            ValueError: Unknown target, wrong number of numbers, or an action in external mode.
        """
        use(self)
        if (self.pause_flag or self.quit_flag or self.debug_flag or self._ended) and self._held():
            return
        simulation = self._simulation
        if self.world_param.step_mode == "external":
            if action is not None:
                raise ValueError("step_mode 'external' takes no actions: move the objects with set_state")
            simulation.step_external()
        else:
            if action is not None:
                for view, control in assign_actions(self._objects, action, action_id, self.logger.warning_once):
                    simulation.impose(view.row, control)
                    if view.id not in self._told_of_limits:
                        self._tell_of_limits(view, control)
            if self.world_param.control_mode == "keyboard":
                self._drive_by_keyboard()
            simulation.step()
        self._after_step()

    def _tell_of_limits(self, view: SimObject, control: list[float]) -> None:
        """Say, once per object, that its limits cut an action."""
        if view.static or not beyond_limits(view, control):
            return
        self._told_of_limits.add(view.id)
        low, high = (", ".join(f"{v:.6g}" for v in limit[:, 0]) for limit in view.get_vel_range())
        given = ", ".join(f"{v:.6g}" for v in control)
        self.logger.warning(
            f"{view.name}: action [{given}] is cut to the limits of its drive, now [{low}] to [{high}] "
            "(vel_min, vel_max, acce; said once per object)"
        )

    def _after_step(self) -> None:
        self._label = None
        if self._simulation.state.event_count != self._events_seen:
            self._log_collisions()

    def _held(self) -> bool:
        """What stands in the way of a step; True when the step is left out."""
        self._ended = False
        if self.quit_flag:
            self.quit()
        if self.pause_flag:
            return True
        if self.debug_flag:
            if self.debug_count <= 0:
                return True
            self.debug_count -= 1
        return False

    def rollout(self, steps: int, *, until_done: bool = True) -> Rollout:
        """Let behaviors drive for up to ``steps`` periods, in one go, and return everything that happened.

        The result is bit for bit what as many calls of :meth:`step` give.

        Args:
            steps: Periods at most.
            until_done: End as soon as every robot has arrived or stopped.
        """
        if self.world_param.step_mode == "external":
            raise ValueError("rollout needs step_mode 'internal'")
        self._ended = False
        result = record_rollout(self._simulation, steps, until_done=until_done)
        self._after_step()
        return result

    def advance(self, steps: int, *, until_done: bool = True, recorder: EpisodeRecorder | None = None) -> int:
        """Like :meth:`rollout`, keeping nothing here.

        Args:
            steps: Periods at most.
            until_done: End as soon as every robot has arrived or stopped.
            recorder: Keeps what happens.

        Returns:
            Periods executed.
        """
        self._ended = False
        if self.world_param.step_mode == "external":
            done = self._wait(steps, until_done, recorder)
        else:
            done = (recorder or self._simulation).advance(steps, until_done=until_done)
        self._after_step()
        return done

    def _wait(self, steps: int, until_done: bool, recorder: EpisodeRecorder | None) -> int:
        """Periods in which the caller, who alone could, moves nothing."""
        for done in range(steps):
            if until_done and self._simulation.state.done(0):
                return done
            self._simulation.step_external()
            if recorder is not None:
                recorder.write_if_due()
        return steps

    def done(self, mode: str = "all") -> bool | None:
        """Whether the robots are through: arrived, or stopped by a collision.

        Args:
            mode: ``all`` robots or ``any`` of them; another word gives None.
        """
        simulation = self._simulation
        if mode == "all":
            return simulation.state.done(0)
        ended = (simulation.arrived | simulation.stopped)[simulation.robots]
        return bool(ended.any()) if mode == "any" else None

    def reset(self, random: bool = False) -> None:
        """Back to the start.

        Args:
            random: Draw the next scene (random shapes, poses, goals) instead of repeating this one.

        Raises:
            PlacementError: The next scene has no room for a random object.
        """
        self._ended = False
        use(self)
        if random and self._exchanged:
            self._restore_objects()
        else:
            self._simulation.reset(next_scene=random)
        if random:
            self._count_ids()
        self._start_over("Reset")

    def reload(self, world_name: str | Path | None = None) -> None:
        """Read the scenario again, or another one, and begin it as ``make`` does with this environment's seed.

        Objects are new ones; views kept from before show what they last showed. The figure stays.

        Args:
            world_name: Another file; default: the present one.
        """
        self._ended = False
        name = self.world_name if world_name is None else world_name
        self._wanted_seed = self.seed
        self._open(name)
        self.world_name = name
        self._start_over(self.scenario.world.status)

    def _start_over(self, label: str | None) -> None:
        self.pause_flag = self.debug_flag = self.reset_flag = False
        self.debug_count = 0
        self.reload_flag = False
        self._events_told = 0
        self._label = label
        self._redraw()
        self._log_collisions()

    def refresh(self) -> None:
        """Evaluate collisions and sensors anew after objects were moved; time does not advance."""
        self._simulation.refresh()

    def end(self, ending_time: float = 3.0, **kwargs: Any) -> None:
        """Write the animation if there is one, and close the figure.

        A script may go on: what is stepped, reset or drawn after that has a figure and an animation of its own. Ending
        twice in a row does nothing more.

        Args:
            ending_time: Seconds a window stays open.
            **kwargs: Options of the animation: ``ani_name``, ``suffix``, ``last_frame_duration``, ``fps``, …
        """
        if self._ended and self._plot is None:
            return
        self._finish_drawing(ending_time, **kwargs)
        self._ended = True
        self.logger.info(f"{self} ended after {self.time} s")

    close = end

    def quit(self) -> NoReturn:
        """End and leave the program."""
        self.end(ending_time=1.0)
        raise SystemExit(0)

    def pause(self) -> None:
        """Let ``step`` do nothing until ``resume``."""
        self.pause_flag = True

    def resume(self) -> None:
        """Go on after ``pause`` or debugging."""
        self.pause_flag = self.debug_flag = False
        self._label = None

    # what happened ---------------------------------------------------------------------------------------------------
    @property
    def time(self) -> float:
        """Simulated time, rounded to 0.01 s."""
        return round(int(self._simulation.count[0]) * self._world.step_time, 2)

    @property
    def sim_time(self) -> float:
        """Simulated time, unrounded [s]."""
        return self._simulation.time

    @property
    def events(self) -> list[Event]:
        """Arrivals, waypoints and collisions since the last reset, in order."""
        return read_events(self._simulation)

    @property
    def outcome(self) -> Outcome:
        """How it ended: ``running``, ``success``, ``collision`` or ``timeout``.

        Success means that every robot arrived and none collided before, collision that one arrived after a collision or
        stands because of one; ``timeout`` needs ``world.time_limit``.
        """
        return outcome_of(self._simulation)

    @property
    def step_mode(self) -> str:
        """``internal`` (irsim moves the objects) or ``external`` (the caller does); may be set."""
        return self.world_param.step_mode

    @step_mode.setter
    def step_mode(self, mode: str) -> None:
        self.world_param.step_mode = mode

    # seeds -----------------------------------------------------------------------------------------------------------
    @property
    def seed(self) -> int:
        """The seed of the present scenes; another one by ``set_random_seed``."""
        return self._seed

    def set_random_seed(self, seed: int | None = None, reload: bool = False) -> None:
        """Change the seed; the next ``reset`` starts again from its first scene.

        Args:
            seed: 0 to 2**64 - 1; None draws a fresh one.
            reload: Also read the scenario again and begin it with this seed.
        """
        self._seed = fresh_seed() if seed is None else check_seed(seed)
        self._simulation.reseed([self.seed])
        self._wanted_seed = self.seed
        if reload:
            self.reload()

    @property
    def rng(self) -> np.random.Generator:
        """A NumPy generator for your own code; it starts anew with every reset, from this episode's key."""
        return self._simulation.rng

    def _log_collisions(self) -> None:
        self._events_seen = self._simulation.state.event_count
        if self.logger.level > LEVELS["WARNING"]:
            return
        events = read_events(self._simulation, start=self._events_told)
        self._events_told += len(events)
        for event in events:
            if event.kind != "collision":
                continue
            pair = [event.object, event.partner]
            for name, other in (pair, pair[::-1]):
                view = self.get_object_by_name(str(name))
                if view is not None and view.role == "robot" and view.collision:
                    state = [round(float(v), 3) for v in view.state[:, 0]]
                    self.logger.warning(f"{name} collided with {other} at state {state}")

    def __reduce_ex__(self, protocol: object) -> NoReturn:
        raise TypeError("an environment cannot be copied or pickled: make another from the same file and seed")

    def __str__(self) -> str:
        return f"Environment: {self.scenario.name} (id {self.id})"


EnvBase = Env


def _objects_of(env: Env | None) -> list[ObjectView]:
    return [] if env is None else env.objects


def _one_line(finding: Diagnostic) -> str:
    where = f"line {finding.line}: " if finding.line else ""
    fix = f" ({finding.fix})" if finding.fix else ""
    return f"{where}{format_path(finding.path)}: {finding.message}{fix} [{finding.code}]"
