"""Methods of an environment that draw its figure, which is made at the first drawing and never in headless mode."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.common.screen import has_screen
from irsim.env.live import attach_live, carry_out_requests, detach_live
from irsim.env.state import EnvState

if TYPE_CHECKING:
    from irsim.env.old.env_plot import EnvPlot
    from irsim.gui import MouseControl


def start_drawing(env: EnvState) -> None:
    """Start without a figure; if pyplot is in use, announce the figure there, so that ``plt.gcf()`` returns it."""
    env._plot = None
    env._title = None
    if not env.headless and "matplotlib.pyplot" in sys.modules:
        env_plot(env).list_in_pyplot()


def status(env: EnvState) -> str:
    """Return the status word of the title: Arrived, Collision, Pause, Running, …."""
    if env._written_status is not None:
        return env._written_status
    if env.pause_flag:
        return "Pause"
    simulation = env._simulation
    if simulation.robots.any():
        if simulation.arrived[simulation.robots].all():
            return "Arrived"
        if simulation.collided[simulation.robots].any():
            return "Collision"
    if env._label is not None:
        return env._label
    for word in ("Reset", "Reload", "Save Figure", "Quit"):
        if getattr(env, f"{word.lower().replace(' ', '_')}_flag"):
            return word
    if env.debug_flag:
        return "Pause (Debugging)"
    return "Running (keyboard)" if env.world_param.control_mode == "keyboard" else "Running"


def set_status(env: EnvState, status: str) -> None:
    """Show this status word in the title until the next step."""
    env._written_status = str(status)


def disable_all_plot(env: EnvState) -> bool:
    """Return whether nothing is drawn; the same as ``headless``."""
    return env.headless


def env_plot(env: EnvState) -> EnvPlot:
    """Return the figure, which the first call makes."""
    if env._plot is None:
        env._plot = env._make_plot(lambda ax: attach_live(env, ax))
        if env._title is not None:
            env._plot.set_title(env._title)
    return env._plot


def render(
    env: EnvState,
    interval: float = 0.01,
    figure_kwargs: Mapping[str, Any] | None = None,
    mode: str = "dynamic",
    **kwargs: Any,
) -> None:
    """Update the figure, at most once per ``sample_time``, then carry out the requests of the keyboard.

    In headless mode nothing is drawn.

    Args:
        interval: Time of the clock for which a window or a cell of a notebook shows the frame before the program goes
            on [s]; ``env.step_time`` is about as fast as the simulated time. Without either, nothing waits.
        figure_kwargs: Options of the frame that is kept for the animation.
        mode: Which objects the plot options below apply to: ``dynamic``, ``static`` or ``all``.
        **kwargs: Plot options of objects that hold for this frame only.
    """
    env._unseen = False
    if env._world.sampling and not env.headless:
        plot = env_plot(env)
        plot.update(mode, **kwargs)
        if env.save_ani:
            plot.add_frame(**dict(figure_kwargs or {}))
        if env.display:
            plot.pause(interval)
    carry_out_requests(env)


def save_figure(
    env: EnvState,
    save_name: str | Path | None = None,
    include_index: bool = False,
    save_gif: bool = False,
    **kwargs: Any,
) -> Path | None:
    """Save the figure as an image file.

    Args:
        save_name: File name with suffix, by default ``<world>.png``; a relative name lies in the folder ``figure``
            beside the script.
        include_index: Append the step number to the name, as ``_0042``.
        save_gif: Save to the folder of animation frames instead.
        **kwargs: Options of Matplotlib's ``savefig``: ``dpi``, ``bbox_inches``, ``transparent``, …

    Returns:
        Path of the file; None in headless mode.
    """
    if env.headless:
        return None
    return env_plot(env).save_figure(save_name, include_index=include_index, save_gif=save_gif, **kwargs)


def show(env: EnvState) -> None:
    """Show the window and wait until it is closed."""
    env._unseen = False
    if not env.headless:
        env_plot(env).show()


def note_unseen(env: EnvState, steps: int = 1) -> None:
    """Say once how to see the steps of an environment that was asked for a window, if there is a screen.

    Args:
        env: An environment that has shown nothing yet.
        steps: Number of steps of the episode after which it is said.
    """
    if env._world.count < steps:
        return
    env._unseen = False
    if has_screen():
        env.logger.hint(
            "nothing has been drawn: display=True opens its window at the first env.render(); call it after each "
            "env.step(), or pass display=False"
        )


def set_title(env: EnvState, title: str) -> None:
    """Set the title of the figure, which stays until the next reset."""
    env._title = title
    if env._plot is not None:
        env._plot.set_title(title)


def reset_plot(env: EnvState) -> None:
    """Draw the whole figure again."""
    if env._plot is not None:
        env._plot.reset()


def draw_trajectory(env: EnvState, traj: Any, traj_type: str = "-", **kwargs: Any) -> None:
    """Draw a path, a list of columns or an array (2 or more, N) [m]; ``refresh=True`` removes it at the next frame."""
    if not env.headless:
        env_plot(env).draw_trajectory(traj, traj_type, **kwargs)


def draw_points(env: EnvState, points: Any, s: float = 30, c: Any = None, refresh: bool = True, **kwargs: Any) -> None:
    """Draw points, a list of points or an array (2, N) [m]; ``s`` is their area [typographic points squared]."""
    if not env.headless:
        env_plot(env).draw_points(points, s, c, refresh, **kwargs)


def draw_box(env: EnvState, vertex: Any, refresh: bool = False, color: str = "-") -> None:
    """Draw a closed outline with the vertices (2, N) [m]."""
    if not env.headless:
        env_plot(env).draw_box(vertex, refresh, color)


def draw_quiver(env: EnvState, point: Any, refresh: bool = False, **kwargs: Any) -> None:
    """Draw an arrow at (x, y) with the components (u, v), given as (x, y, u, v) [m]."""
    if not env.headless:
        env_plot(env).draw_quiver(point, refresh, **kwargs)


def draw_quivers(env: EnvState, points: Any, refresh: bool = False, **kwargs: Any) -> None:
    """Draw arrows, each given as (x, y, u, v) [m]."""
    if not env.headless:
        env_plot(env).draw_quivers(points, refresh, **kwargs)


def redraw(env: EnvState) -> None:
    """Draw the whole figure again with the default title and zoom."""
    env._title = None
    if env._plot is not None:
        env._plot.reset()
    if env._mouse is not None:
        env._mouse.forget_zoom()


def finish_drawing(env: EnvState, ending_time: float, **kwargs: Any) -> None:
    """Write the animation if frames were kept, and close the figure."""
    detach_live(env)
    if env.headless:
        return
    if env.save_ani:
        env_plot(env).save_animation(**{**env.ani_kwargs, **kwargs})
    if env._plot is not None:
        if env.display and env._plot.made and not env._plot.show_in_cell():  # a notebook keeps its picture anyway
            env._plot.pause(ending_time)
        env._plot.close()
        env._plot = None


def mouse(env: EnvState) -> MouseControl | None:
    """Return the mouse control of the figure, which the call makes if necessary; None in headless mode."""
    if env._mouse is None and not env.headless:
        _ = env_plot(env).ax
    return env._mouse
