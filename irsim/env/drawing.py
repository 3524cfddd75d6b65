"""The figure of an environment: it is made when something is first drawn, and never in headless mode."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.env.live import attach_live, carry_out_requests, detach_live
from irsim.env.state import EnvState

if TYPE_CHECKING:
    from irsim.gui import MouseControl
    from irsim.rendering.env_plot import EnvPlot


def start_drawing(env: EnvState) -> None:
    """Begin without a figure; ``plt.gcf()`` finds it nevertheless where pyplot is in use."""
    env._plot = None
    env._title = None
    if not env.headless and "matplotlib.pyplot" in sys.modules:
        env_plot(env).list_in_pyplot()


def status(env: EnvState) -> str:
    """One word for titles: Arrived, Collision, Pause, Running, …."""
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
    """Label shown until the next step."""
    env._label = str(status)


def disable_all_plot(env: EnvState) -> bool:
    """Alias of ``headless``."""
    return env.headless


def env_plot(env: EnvState) -> EnvPlot:
    """The figure, made when first asked for."""
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
    """Bring the figure up to date (every ``sample_time``), then do what keys have asked for.

    Headless, nothing is drawn.

    Args:
        interval: Seconds to show the frame, where there is a window.
        figure_kwargs: Options of the saved frame.
        mode: Which objects to update: ``dynamic``, ``static`` or ``all``.
        **kwargs: Object plot options that hold for this frame.
    """
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
    """Save the present picture.

    Args:
        save_name: File name with format (default ``<world>.png``), in the folder ``figure`` beside the script
            unless it is an absolute path.
        include_index: Append ``_<step, 4 digits>``.
        save_gif: Save into the animation buffer folder instead.
        **kwargs: Options of Matplotlib's ``savefig``: ``dpi``, ``bbox_inches``, ``transparent``, …

    Returns:
        The file written; None in headless mode.
    """
    if env.headless:
        return None
    return env_plot(env).save_figure(save_name, include_index=include_index, save_gif=save_gif, **kwargs)


def show(env: EnvState) -> None:
    """Show the window and wait until it is closed."""
    if not env.headless:
        env_plot(env).show()


def set_title(env: EnvState, title: str) -> None:
    """Fixed title, until the next reset."""
    env._title = title
    if env._plot is not None:
        env._plot.set_title(title)


def reset_plot(env: EnvState) -> None:
    """Draw everything anew."""
    if env._plot is not None:
        env._plot.reset()


def draw_trajectory(env: EnvState, traj: Any, traj_type: str = "-", **kwargs: Any) -> None:
    """Draw a path: a list of columns or (2 or more, N) [m]; ``refresh=True`` removes it with the next frame."""
    if not env.headless:
        env_plot(env).draw_trajectory(traj, traj_type, **kwargs)


def draw_points(env: EnvState, points: Any, s: float = 30, c: Any = None, refresh: bool = True, **kwargs: Any) -> None:
    """Draw points: a list of points or (2, N) [m]; ``s`` in points squared."""
    if not env.headless:
        env_plot(env).draw_points(points, s, c, refresh, **kwargs)


def draw_box(env: EnvState, vertex: Any, refresh: bool = False, color: str = "-") -> None:
    """Draw a closed outline (2, N) [m]."""
    if not env.headless:
        env_plot(env).draw_box(vertex, refresh, color)


def draw_quiver(env: EnvState, point: Any, refresh: bool = False, **kwargs: Any) -> None:
    """Draw an arrow (x, y, u, v) [m]."""
    if not env.headless:
        env_plot(env).draw_quiver(point, refresh, **kwargs)


def draw_quivers(env: EnvState, points: Any, refresh: bool = False, **kwargs: Any) -> None:
    """Draw arrows (x, y, u, v) [m]."""
    if not env.headless:
        env_plot(env).draw_quivers(points, refresh, **kwargs)


def redraw(env: EnvState) -> None:
    """Draw everything again, without title and zoom, as at a beginning."""
    env._title = None
    if env._plot is not None:
        env._plot.reset()
    if env._mouse is not None:
        env._mouse.forget_zoom()


def finish_drawing(env: EnvState, ending_time: float, **kwargs: Any) -> None:
    """Write the animation if there is one, and close the figure."""
    detach_live(env)
    if env.headless:
        return
    if env.save_ani:
        env_plot(env).save_animation(**{**env.ani_kwargs, **kwargs})
    if env._plot is not None:
        if env.display and env._plot.made:
            env._plot.pause(ending_time)
        env._plot.close()
        env._plot = None


def mouse(env: EnvState) -> MouseControl | None:
    """The mouse over the figure (made if need be); None in headless mode."""
    if env._mouse is None and not env.headless:
        _ = env_plot(env).ax
    return env._mouse
