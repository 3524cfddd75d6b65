"""The environment that ``irsim.make`` returns: a list of its methods, each with the file that implements it."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.common.keywords import answers_misspelt
from irsim.common.lazy import computed
from irsim.common.log import Logger
from irsim.env import drawing, lifetime, live, loop, messages, notebook, object_list, policies, queries, snapshots
from irsim.env.parameters import PathParam
from irsim.env.state import EnvState
from irsim.graphics.scene.style import Palette
from irsim.scenario.resolve.resolved import ResolvedScenario

if TYPE_CHECKING:
    from irsim.env.old.env_plot import EnvPlot
    from irsim.env.old.factory import EnvConfig, ObjectFactory
    from irsim.policies.catalog import PolicySource

__all__ = ["Env", "EnvBase"]

_IDS = count()


class Env(EnvState):
    """One world, stepped from Python.

    Args:
        world_name: YAML file or resolved scenario; None is the YAML file with the name of the running script.
        display: Show a window if there is a screen.
        disable_all_plot: Draw nothing at all; ``headless`` has the same effect.
        save_ani: Keep a frame at each sampled ``render`` and write the animation in ``end``.
        ani_kwargs: Default options of the animation.
        full: Show the window full-screen.
        log_file, log_level: File to log to, and lowest level that is logged.
        seed: Seed in place of ``world.seed``; without both it is drawn from fresh entropy. ``env.seed`` returns it.
        step_mode: ``internal`` (irsim moves the objects) or ``external`` (the caller moves them).
        headless: Draw nothing at all.
        strict: Treat what IR-SIM would ignore (misspelt keys, unknown behaviors) as errors.
        policy: The policy that drives the robots instead of their behaviors; see :meth:`set_policy`.
    """

    @answers_misspelt
    def __init__(
        self,
        world_name: str | Path | ResolvedScenario | None = None,
        display: bool = True,
        disable_all_plot: bool = False,
        save_ani: bool = False,
        ani_kwargs: Mapping[str, Any] | None = None,
        full: bool = False,
        log_file: str | Path | None = None,
        log_level: str = "INFO",
        seed: int | None = None,
        step_mode: str | None = None,
        headless: bool = False,
        *,
        strict: bool = False,
        policy: PolicySource | None = None,
    ) -> None:
        self.id = next(_IDS)
        self.path_param = PathParam()
        self.logger = Logger(log_level, log_file)
        self.palette_param = Palette()
        self._strict, self._wanted_mode, self._wanted_seed = strict, step_mode, seed
        self.world_name = world_name
        self._policy = policies.opened(policy)
        lifetime.open_world(self, world_name)
        self.headless = headless or disable_all_plot
        self.display = display and not self.headless
        self.save_ani = save_ani
        self.ani_kwargs = dict(ani_kwargs or {})
        self.full = full
        self.pause_flag = self.quit_flag = self.debug_flag = False
        self.reset_flag = self.reload_flag = self.save_figure_flag = False
        self.debug_count = 0
        self._ended = False
        self._unseen = self.display
        drawing.start_drawing(self)
        live.start_live(self)
        loop.log_collisions(self)

    # the loop: loop.py, lifetime.py
    step = loop.step
    rollout = loop.rollout
    advance = loop.advance
    done = loop.done
    refresh = loop.refresh
    pause = loop.pause
    resume = loop.resume
    reset = lifetime.reset
    reload = lifetime.reload
    end = lifetime.end
    close = lifetime.end
    quit = lifetime.quit_program

    # states to return to, and copies: snapshots.py
    snapshot = snapshots.snapshot
    restore = snapshots.restore

    # seeds: lifetime.py, queries.py
    set_random_seed = lifetime.set_random_seed
    seed = computed(queries.seed)
    rng = computed(queries.rng)

    # what happened: queries.py
    time = computed(queries.time)
    sim_time = computed(queries.sim_time)
    events = computed(queries.events)
    outcome = computed(queries.outcome)
    contacts = computed(queries.contacts)

    # the world and its objects: queries.py
    simulation = computed(queries.simulation)
    config = computed(queries.config)
    step_time = computed(queries.step_time)
    objects = computed(queries.objects)
    names = computed(queries.names)
    robot = computed(queries.robot)
    robot_list = computed(queries.robot_list)
    robot_number = computed(queries.robot_number)
    obstacle_list = computed(queries.obstacle_list)
    obstacle_number = computed(queries.obstacle_number)
    static_objects = computed(queries.static_objects)
    dynamic_objects = computed(queries.dynamic_objects)
    get_object_by_name = queries.get_object_by_name
    get_object_by_id = queries.get_object_by_id
    get_group_by_name = queries.get_group_by_name
    get_robot_state = queries.get_robot_state
    get_robot_info = queries.get_robot_info
    get_robot_info_list = queries.get_robot_info_list
    get_obstacle_info_list = queries.get_obstacle_info_list
    get_lidar_scan = queries.get_lidar_scan
    get_lidar_offset = queries.get_lidar_offset

    # adding and deleting objects: object_list.py
    create_robot = object_list.create_robot
    create_obstacle = object_list.create_obstacle
    add_object = object_list.add_object
    add_objects = object_list.add_objects
    delete_object = object_list.delete_object
    delete_objects = object_list.delete_objects
    validate_unique_names = object_list.validate_unique_names
    build_tree = object_list.build_tree
    random_obstacle_position = object_list.random_obstacle_position
    random_polygon_shape = object_list.random_polygon_shape

    # behaviors of scripts, policies, maps, messages: policies.py, queries.py, messages.py
    set_policy = policies.set_policy
    load_behavior = policies.load_behavior
    get_map = queries.get_map
    get_msg = messages.get_msg
    receive_msg = messages.receive_msg

    # the figure: drawing.py
    status = computed(drawing.status)
    disable_all_plot = computed(drawing.disable_all_plot)
    set_status = drawing.set_status
    set_title = drawing.set_title
    render = drawing.render
    show = drawing.show
    save_figure = drawing.save_figure
    reset_plot = drawing.reset_plot
    draw_trajectory = drawing.draw_trajectory
    draw_points = drawing.draw_points
    draw_box = drawing.draw_box
    draw_quiver = drawing.draw_quiver
    draw_quivers = drawing.draw_quivers
    _env_plot = computed(drawing.env_plot)

    # notebooks: notebook.py
    replay = notebook.replay
    _repr_html_ = notebook.env_html

    # keyboard and mouse: live.py
    keyboard = computed(live.keyboard)
    mouse = computed(drawing.mouse)
    key_vel = computed(live.key_vel)
    key_id = computed(live.key_id)
    mouse_pos = computed(live.mouse_pos)
    mouse_left_pos = computed(live.mouse_left_pos)
    mouse_right_pos = computed(live.mouse_right_pos)

    @property
    def step_mode(self) -> str:
        """``internal`` (irsim moves the objects) or ``external`` (the caller moves them); may be set."""
        return self.world_param.step_mode

    @step_mode.setter
    def step_mode(self, mode: str) -> None:
        self.world_param.step_mode = mode

    @property
    def env_config(self) -> EnvConfig:
        """The scenario as parsed, with methods that load it again: factory.py."""
        from irsim.env.old.factory import EnvConfig

        return EnvConfig(self)

    @property
    def object_factory(self) -> ObjectFactory:
        """The factory that makes objects from scenario entries: factory.py."""
        return self.env_config.object_factory

    def _make_plot(self, attach: Any) -> EnvPlot:
        from irsim.env.old.env_plot import EnvPlot

        return EnvPlot(self, display=self.display, full=self.full, palette=self.palette_param, attach=attach)

    def __reduce_ex__(self, protocol: object) -> tuple[Any, ...]:
        return snapshots.reduce(self)

    def __copy__(self) -> Env:
        return snapshots.copy_env(self, {})  # type: ignore[no-any-return]

    def __deepcopy__(self, memo: dict[int, Any]) -> Env:
        return snapshots.copy_env(self, memo)  # type: ignore[no-any-return]

    def __str__(self) -> str:
        return f"Environment: {self.scenario.name} (id {self.id})"


EnvBase = Env
