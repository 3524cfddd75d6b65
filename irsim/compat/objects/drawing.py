"""Methods that draw one object into given axes; environments draw all of their objects without them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.graphics.scene.scene import Line, Picture, Region
from irsim.graphics.scene.style import tint_of
from irsim.objects.view import ObjectView

if TYPE_CHECKING:
    from irsim.graphics.figure.pictures import Pictures
    from irsim.objects.drawing.scene_builder import SceneBuilder

__all__ = ["OldDrawing"]


class PlotKeys(dict[str, Any]):
    """The plot keys of one object as written; setting a key changes how the object is drawn.

    Args:
        view: The object.
    """

    def __init__(self, view: Any) -> None:
        super().__init__(view.record.plot.model_dump(exclude_unset=True))
        self._view = view

    def __setitem__(self, key: str, value: Any) -> None:
        super().__setitem__(key, value)
        self._apply()

    def __delitem__(self, key: str) -> None:
        super().__delitem__(key)
        self._apply()

    def update(self, *args: Any, **kwargs: Any) -> None:
        """Set several keys."""
        super().update(*args, **kwargs)
        self._apply()

    def _apply(self) -> None:
        record = self._view.record
        self._view.record = replace(record, plot=type(record.plot).model_validate(dict(self)))


class OldDrawing(ObjectView):
    """Drawing of one object by hand; part of :class:`irsim.compat.objects.view.ScriptObject`.

    Every ``plot_*`` method draws into axes, by default the axes of the environment, and lists its artists here until
    ``plot_clear``. ``state`` is the pose at which to draw, x, y [m] and heading [rad] in any shape, by default the
    present one. Other keywords are plot keys that hold for this drawing only.

    Attributes:
        ax: The axes used last; before the first drawing the axes of the environment, None without one.
        plot_patch_list, plot_line_list, plot_text_list, plot_trail_list: Artists by kind.
        object_patch, object_img, goal_patch, arrow_patch, fov_patch, trajectory_line: Artist drawn last, or None.
    """

    object_patch: Any = None
    object_img: Any = None
    goal_patch: Any = None
    arrow_patch: Any = None
    fov_patch: Any = None
    trajectory_line: Any = None

    @property
    def plot_kwargs(self) -> PlotKeys:
        """The plot keys as written; a key that is set takes effect at the next frame."""
        return PlotKeys(self)

    @property
    def plot_patch_list(self) -> list[Any]:
        """Patches and images that were drawn by hand."""
        return self._artists("patch")

    @property
    def plot_line_list(self) -> list[Any]:
        """Lines that were drawn by hand."""
        return self._artists("line")

    @property
    def plot_text_list(self) -> list[Any]:
        """Texts that were drawn by hand."""
        return self._artists("text")

    @property
    def plot_trail_list(self) -> list[Any]:
        """Snapshots that were drawn by hand."""
        return self._artists("trail")

    @property
    def ax(self) -> Any:
        """The axes used last; before the first drawing the axes of the environment, None without one."""
        own = self.__dict__.get("_ax")
        if own is not None:
            return own
        env = self._simulation.owner()
        return None if env is None or getattr(env, "headless", True) else env._env_plot.ax

    @ax.setter
    def ax(self, ax: Any) -> None:
        self.__dict__["_ax"] = ax

    # parts -----------------------------------------------------------------------------------------------------------
    def plot(self, ax: Any = None, state: Any = None, vertices: Any = None, **kwargs: Any) -> None:
        """Draw everything that the plot keys show, with ``show_sensor`` also the sensors.

        An object that is not in the world is only drawn if ``state`` says where.

        Args:
            ax: Matplotlib axes.
            state: Pose at which to draw.
            vertices: Outline to draw in place of the body, (2, N), in the world frame [m].
            **kwargs: Plot keys in place of the object's own.
        """
        axes = self._on(ax)
        if axes is None or (state is None and self._simulation.appeared[self.row] < 0):
            return
        if self.record.is_map:
            self.plot_object(axes)
            return
        style = self._builder().style(self, kwargs)
        if self.description is None or not self.plot_object_image(axes, state, **kwargs):
            self.plot_object(axes, state, vertices, **kwargs)
        for wanted, draw in (
            (style.show_goal, self.plot_goal),
            (style.show_trajectory, self.plot_trajectory),
            (style.show_fov, self.plot_fov),
        ):
            if wanted:
                draw(axes, **kwargs)
        for wanted, draw_at in (
            (style.show_text, self.plot_text),
            (style.show_arrow, self.plot_arrow),
            (style.show_trail, self.plot_trail),
        ):
            if wanted:
                draw_at(axes, state, **kwargs)
        for sensor in self.sensors if style.show_sensor else ():
            if hasattr(sensor, "plot"):
                sensor.plot(axes, self.state if state is None else state)

    def plot_object(self, ax: Any = None, state: Any = None, vertices: Any = None, **kwargs: Any) -> None:
        """Draw the body, or the cells of a map; the arguments are as for :meth:`plot`."""
        axes = self._on(ax)
        if axes is None:
            return
        if self.record.is_map:
            from irsim.graphics.figure.artists import add_grid

            self.object_img = add_grid(axes, self._builder().grid(self))
            self.plot_patch_list.append(self.object_img)
            return
        mark = self._mark("body", state, kwargs)
        if vertices is not None:
            mark.geometry = _region(vertices)
        self.object_patch = self._add(axes, mark)

    def plot_object_image(
        self, ax: Any = None, state: Any = None, vertices: Any = None, description: str | None = None, **kwargs: Any
    ) -> bool:
        """Draw the image that ``description`` names, by default the object's own, in place of the body.

        Returns:
            Whether the image exists.
        """
        from irsim.graphics.figure.artists import add_picture
        from irsim.graphics.scene.bodies import read_body

        axes, name = self._on(ax), self.description if description is None else description
        images = self._images()
        if axes is None or name is None or not images.has(name):
            return False
        style = self._builder().style(self, kwargs)
        body, pose = read_body(self._simulation.state, self.row), self._pose_of(state)
        box = (*body.low, body.length, body.width)
        tint = tint_of(self.record, name, style.obj_color)
        picture = Picture(0, name, box, pose, style.obj_alpha, style.image_zorder, tint)
        self.object_img = add_picture(axes, picture, images)
        self.plot_patch_list.append(self.object_img)
        return True

    def plot_goal(
        self,
        ax: Any = None,
        goal_state: Any = None,
        vertices: Any = None,
        goal_color: Any = None,
        goal_zorder: float | None = None,
        goal_alpha: float | None = None,
        **kwargs: Any,
    ) -> None:
        """Draw the outline of the body at ``goal_state``, by default at the present goal if the object has one."""
        axes = self._on(ax)
        if axes is None:
            return
        goal = None
        if goal_state is not None:
            goal = (*np.asarray(goal_state, dtype=float).reshape(-1).tolist(), 0.0)[:3]
        elif np.isnan(self._simulation.goal[self.row, 0]):
            return
        keys = {"goal_color": goal_color, "goal_zorder": goal_zorder, "goal_alpha": goal_alpha}
        mark = self._mark("goal", None, {**kwargs, **keys, "show_goal": True}, goal)
        if vertices is not None:
            mark.geometry = _region(vertices)
        self.goal_patch = self._add(axes, mark)

    def plot_arrow(
        self,
        ax: Any = None,
        state: Any = None,
        velocity: Any = None,
        arrow_theta: float | None = None,
        arrow_length: float | None = None,
        arrow_width: float | None = None,
        arrow_color: Any = None,
        arrow_zorder: float | None = None,
        **kwargs: Any,
    ) -> None:
        """Draw an arrow in the direction of the heading, or of ``arrow_theta`` [rad].

        Args:
            ax: Matplotlib axes.
            state: Pose at which to draw.
            velocity: Control whose direction the arrow of an ``omni`` drive shows; by default the present one.
            arrow_theta: Direction [rad].
            arrow_length: Length [m].
            arrow_width: Width [m].
            arrow_color: Colour.
            arrow_zorder: Drawing layer.
            **kwargs: Plot keys in place of the object's own.
        """
        axes = self._on(ax)
        if axes is None:
            return
        keys = {"arrow_length": arrow_length, "arrow_width": arrow_width, "arrow_color": arrow_color}
        keys = {**kwargs, **keys, "arrow_zorder": arrow_zorder, "show_arrow": True}
        where = state
        if arrow_theta is None and velocity is not None and not getattr(self.record.kinematics, "turns", True):
            forward, lateral = np.asarray(velocity, dtype=float).reshape(-1)[:2]
            arrow_theta = float(np.arctan2(lateral, forward)) + self._pose_of(state)[2]
        if arrow_theta is not None:
            where = (*self._pose_of(state)[:2], float(arrow_theta))
        self.arrow_patch = self._add(axes, self._mark("arrow", where, keys))

    def plot_fov(self, ax: Any = None, **kwargs: Any) -> None:
        """Draw the field of view, if the object has one."""
        axes = self._on(ax)
        has_fov = None not in (getattr(self, "fov", None), getattr(self, "fov_radius", None))
        if axes is not None and has_fov:
            self.fov_patch = self._add(axes, self._mark("fov", None, {**kwargs, "show_fov": True}))

    def plot_text(self, ax: Any = None, state: Any = None, **kwargs: Any) -> None:
        """Write the label of the object, and the label of the goal if the plot keys show it."""
        from irsim.graphics.figure.artists import add_label

        axes = self._on(ax)
        if axes is None:
            return
        pose = None if state is None else self._pose_of(state)
        keys = {**kwargs, "show_text": True}
        labels = self._builder().drawn_alone(self, keys, pose)[1]
        self.plot_text_list.extend(add_label(axes, label) for label in labels)

    def plot_trajectory(
        self,
        ax: Any = None,
        trajectory: Sequence[Any] | None = None,
        keep_traj_length: int | None = None,
        **kwargs: Any,
    ) -> None:
        """Draw a line through the states of ``trajectory``, by default of the object; fewer than two draw nothing."""
        axes = self._on(ax)
        states = self._simulation.state.trajectory(self.row) if trajectory is None else trajectory
        rows = np.array([np.asarray(state, dtype=float).reshape(-1)[:3] for state in states])
        if axes is None or len(rows) < 2:
            return
        if rows.shape[1] < 3:
            rows = np.hstack([rows, np.zeros((len(rows), 1))])
        keys = {**kwargs, "keep_traj_length": keep_traj_length}
        self.trajectory_line = self._add(axes, self._builder().path_of(self, rows, keys))

    def plot_trail(
        self,
        ax: Any = None,
        state: Any = None,
        vertices: Any = None,
        keep_trail_length: int | None = None,
        **kwargs: Any,
    ) -> None:
        """Draw a snapshot of the body, and remove all but the newest ``keep_trail_length`` snapshots (0 keeps all)."""
        axes = self._on(ax)
        if axes is None:
            return
        builder: Any = self._builder()
        mark = builder.trail_mark(self, self._pose_of(state), kwargs)
        if vertices is not None:
            mark.geometry = _region(vertices)
        from irsim.graphics.figure.artists import add_mark

        trail = self.plot_trail_list
        trail.append(add_mark(axes, mark))
        keep = builder.style(self, kwargs).keep_trail_length if keep_trail_length is None else keep_trail_length
        while keep and len(trail) > keep:
            _remove(trail.pop(0))

    def plot_uncertainty(self, ax: Any = None, **kwargs: Any) -> None:
        """Do nothing; kept for compatibility."""

    def plot_clear(self, all: bool = False) -> None:
        """Remove everything that was drawn by hand.

        Args:
            all: Also remove the snapshots of the trail.
        """
        for kind in ("patch", "line", "text", *(("trail",) if all else ())):
            artists = self._artists(kind)
            for artist in artists:
                _remove(artist)
            artists.clear()
        for sensor in self.sensors:
            if hasattr(sensor, "plot_clear"):
                sensor.plot_clear()

    # -----------------------------------------------------------------------------------------------------------------
    def _artists(self, kind: str) -> list[Any]:
        lists: dict[str, list[Any]] = self.__dict__.setdefault("_plotted", {})
        return lists.setdefault(kind, [])

    def _on(self, ax: Any) -> Any:
        if ax is not None:
            self.ax = ax
        return self.ax

    def _builder(self) -> SceneBuilder:
        from irsim.objects.drawing.scene_builder import SceneBuilder

        palette = getattr(self._simulation.owner(), "palette_param", None)
        return SceneBuilder(self._simulation, world=self.world, palette=palette)

    def _images(self) -> Pictures:
        from irsim.graphics.figure.pictures import Pictures

        if "_pictures" not in self.__dict__:
            source = self._simulation.scenario.source
            self.__dict__["_pictures"] = Pictures(Path(source).parent if source else None)
        return self.__dict__["_pictures"]  # type: ignore[no-any-return]

    def _pose_of(self, state: Any) -> tuple[float, float, float]:
        given = self._simulation.pose[self.row] if state is None else np.asarray(state, dtype=float).reshape(-1)
        x, y, theta = (*given.tolist(), 0.0)[:3]
        return x, y, theta

    def _mark(self, part: str, state: Any, keys: dict[str, Any], goal: Any = None) -> Any:
        pose = None if state is None else self._pose_of(state)
        marks = self._builder().drawn_alone(self, keys, pose, goal)[0]
        return next(mark for mark in marks if mark.part == part)

    def _add(self, axes: Any, mark: Any) -> Any:
        from irsim.graphics.figure.artists import add_mark

        artist = add_mark(axes, mark)
        (self.plot_line_list if isinstance(mark.geometry, Line) else self.plot_patch_list).append(artist)
        return artist


def _region(vertices: Any) -> Any:
    return Region([np.asarray(vertices, dtype=float)[:2].T])


def _remove(artist: Any) -> None:
    if artist.axes is not None and artist in artist.axes.get_children():
        artist.remove()
