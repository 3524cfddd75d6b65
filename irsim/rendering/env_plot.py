"""The picture of one environment: figure, window, saved frames. Nothing is made before something is drawn."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any
from weakref import finalize, ref

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

from irsim.diagnostics.diagnostic import nearest
from irsim.graphics.encoding.picture_files import picture_path, replacing
from irsim.graphics.encoding.pixels import Pixels, from_image, to_image
from irsim.graphics.encoding.png import png_bytes
from irsim.graphics.figure.figure import SceneFigure, fitting_size, inches
from irsim.graphics.figure.layers import opaque_colors
from irsim.graphics.figure.live_figure import LiveCanvas, LiveFigure
from irsim.graphics.figure.overlay import Overlay
from irsim.graphics.figure.pictures import Pictures
from irsim.graphics.figure.pyplot_entry import PyplotEntry, activate, active
from irsim.graphics.scene.palette import Palette
from irsim.graphics.scene.scene import Scene, region_extent
from irsim.graphics.scene.style import STYLE_KEYS
from irsim.objects.drawing.scene_builder import MODES, SceneBuilder
from irsim.objects.views import views
from irsim.rendering.plot_steps import PlotSteps
from irsim.rendering.recording import Pictured, Recording
from irsim.rendering.user_sensors import UserSensors

if TYPE_CHECKING:
    from irsim.graphics.figure.window import Window

__all__ = ["EnvPlot"]

_PAD_INCHES = 0.1
_SAVE_OPTIONS = frozenset(
    [
        "dpi",
        "bbox_inches",
        "pad_inches",
        "transparent",
        "facecolor",
        "edgecolor",
        "metadata",
        "bbox_extra_artists",
        "pil_kwargs",
        "orientation",
        "papertype",
        "backend",
    ]
)
_QUICK_OPTIONS = frozenset({"dpi", "bbox_inches", "pad_inches"})


class EnvPlot(PlotSteps):
    """Draws one environment.

    Pictures show the state at the moment they are made, whenever that is and whoever makes them; ``update`` only notes
    how to draw it. Artists are brought up to date when the figure is drawn, saved or asked for.

    Args:
        env: What to draw.
        display: Open a window where that is possible.
        full: Fill the screen with it.
        palette: Default colours.
        attach: Told the axes once they are made.

    Attributes:
        title: Fixed title, or None for time and status.
        show_title: Whether there is a title.
        viewpoint: Point or name of the object that the view follows, or None.
        saved_figure_kwargs: Options of saved figures; those given to ``save_figure`` are added.
    """

    def __init__(
        self,
        env: Pictured,
        *,
        display: bool = False,
        full: bool = False,
        palette: Palette | None = None,
        attach: Callable[[Axes], None] | None = None,
    ) -> None:
        self.env = env
        self.palette = palette or Palette()
        self._display, self._full, self._attach = display, full, attach
        source = env.simulation.scenario.source
        self._pictures = Pictures(Path(source).parent if source else None, env.logger.warning)
        self._options = env.simulation.scenario.world.plot
        self.saved_figure_kwargs: dict[str, Any] = {"dpi": 100, "bbox_inches": "tight", **_saved_figure(self._options)}
        self._format: str | None = self.saved_figure_kwargs.pop("format", None)
        self._dpi = float(self.saved_figure_kwargs["dpi"])
        width, height = self._options.figure_pixels
        self._size = float(width), float(height)
        self._builder = SceneBuilder(env.simulation, palette=self.palette, has_picture=self._has_picture)
        self._overlay = Overlay(self.palette)
        self._user_sensors = UserSensors()
        self._figure: SceneFigure | None = None
        self._window: Window | None = None
        self._recording = Recording(env)
        self._unknown: set[str] = set()
        self._hidden: set[int] = set()
        self._region: tuple[float, float, float, float] | None = None
        self._saved_size: tuple[int, int] | None = None
        self._entry: PyplotEntry | None = None
        self._frame = 0
        self._looking = False
        self._shown_at: tuple[Any, ...] | None = None
        self._drawn_at: tuple[Any, ...] | None = None
        self._begin()

    def _begin(self) -> None:
        self.title: str | None = self._options.title
        self.show_title: bool = self._options.show_title
        self.viewpoint: Any = self._options.viewpoint
        self._mode = "all"
        self._hidden.clear()
        self._overrides: dict[str, Any] = {}

    # the figure ------------------------------------------------------------------------------------------------------
    @property
    def fig(self) -> Figure:
        """The Matplotlib figure, made when first asked for."""
        return self._present().figure

    @property
    def ax(self) -> Axes:
        """Its axes, in world coordinates [m]."""
        return self._present().ax

    @property
    def made(self) -> bool:
        """Whether there is a figure."""
        return self._figure is not None

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the last saved picture [px]; of the figure before that."""
        return self._saved_size or (int(self._size[0]), int(self._size[1]))

    def set_size(self, longer_side: float) -> None:
        """Make the longer side of pictures this long [px], the other one as the world asks for.

        Raises:
            ValueError: Not positive, or the figure exists.
        """
        if not longer_side > 0:
            raise ValueError(f"the size must be positive, not {longer_side}")
        if self._figure is not None:
            raise ValueError("the size can only be set before the first drawing")
        world = self.env.simulation.scenario.world
        x0, x1, y0, y1 = self._region or (0.0, world.width, 0.0, world.height)
        self._size = fitting_size(x1 - x0, y1 - y0, longer_side, self._dpi, axis=not self._options.no_axis)
        self.saved_figure_kwargs["bbox_inches"] = None

    def set_region(self, region: Sequence[float]) -> None:
        """Show only a part of the world: x_min, y_min, x_max, y_max [m]; call it before ``set_size``.

        Raises:
            ValueError: It is none.
        """
        self._region = region_extent(region)

    def _made(self) -> SceneFigure:
        if self._figure is None:
            entry = self.list_in_pyplot()
            if self._display:
                from irsim.graphics.figure.window import open_window

                name, current = self.env.simulation.scenario.name, active()
                self._window = open_window(self._size, self._dpi, full=self._full, title=name)
                if self._window is not None:
                    entry.give_way(self._window.figure.canvas)
                    if current is not None and current is not entry:
                        activate(current)
            figure = self._window.figure if self._window is not None else self._without_window()
            if isinstance(figure, LiveFigure):
                figure.shown = ref(self)
            self._figure = self._new_figure(figure)
            if self._window is None:
                entry.adopt(figure.canvas)
            self._show(self._figure)
            if self._attach is not None:
                self._attach(self._figure.ax)
        return self._figure

    def _without_window(self) -> Figure:
        figure = LiveFigure(figsize=inches(self._size, self._dpi), dpi=self._dpi)
        LiveCanvas(figure)
        return figure

    def list_in_pyplot(self) -> PyplotEntry:
        """Let ``plt.gcf()`` find the figure, which is made on demand (:mod:`irsim.graphics.figure.pyplot_entry`)."""
        if self._entry is None:
            plot = ref(self)
            self._entry = PyplotEntry(lambda: _canvas_of(plot()))
            finalize(self, self._entry.leave)
        return self._entry

    # the present -----------------------------------------------------------------------------------------------------
    def _moment(self) -> tuple[Any, ...]:
        """What tells one picture from the next, cheaply."""
        simulation = self.env.simulation
        return int(simulation.count[0]), simulation.revision, self._frame, self.env.status, self.title

    def _present(self) -> SceneFigure:
        """The figure, its artists as of now."""
        figure = self._made()
        if not self._looking and self._shown_at != self._moment():
            self._show(figure)
        return figure

    def before_drawing(self) -> None:
        """Bring the artists up to date; called by the figure when somebody draws or saves it."""
        if self._figure is not None and not self._looking:
            self._show(self._figure)
            self._figure.compositor.forget()
            self._drawn_at = self._shown_at

    def is_outdated(self) -> bool:
        """Whether the pixels of the canvas show another moment than this one."""
        return self._figure is not None and not self._looking and self._drawn_at != self._moment()

    @contextmanager
    def _as_shown(self) -> Iterator[None]:
        """Draw and read the artists as they are."""
        before, self._looking = self._looking, True
        try:
            yield
        finally:
            self._looking = before

    def _show(self, figure: SceneFigure) -> None:
        with self._as_shown():
            figure.show(self.scene(), self._title())
            if self.env.simulation.measurements:
                objects = views(self.env.simulation)
                shown = [view for view in objects if self._builder.style(view, {}).show_sensor]
                self._user_sensors.show(figure.ax, shown)
        self._shown_at = self._moment()

    def _has_picture(self, name: str) -> bool:
        """Whether an image is drawn in place of bodies."""
        return self._pictures.has(name)

    def _new_figure(self, figure: Figure | None) -> SceneFigure:
        return SceneFigure(
            self._size,
            self._dpi,
            axis=not self._options.no_axis,
            tight=self._options.tight,
            figure=figure,
            pictures=self._pictures,
        )

    def scene(self) -> Scene:
        """What the picture shows, as data."""
        scene = self._builder.build(
            status=self.env.status, viewpoint=self.viewpoint, mode=self._mode, overrides=self._overrides
        )
        if self._region is not None:
            scene.look_at(self._region)
        return self._without_hidden(scene)

    def _title(self) -> str | None:
        if not self.show_title:
            return None
        if self.title is not None:
            return self.title
        simulation = self.env.simulation
        time = int(simulation.count[0]) * float(simulation.scenario.world.step_time)
        return f"Simulation Time: {time:.2f}s, Status: {self.env.status}"

    def _synced(self) -> SceneFigure:
        figure = self._made()
        self._show(figure)
        return figure

    # per step --------------------------------------------------------------------------------------------------------
    def update(self, mode: str = "dynamic", **overrides: Any) -> None:
        """Begin the next frame.

        Args:
            mode: Objects that ``overrides`` apply to: ``dynamic``, ``static`` or ``all``.
            **overrides: Object plot keys that hold until the next call.

        Raises:
            ValueError: Unknown mode.
        """
        if mode not in MODES:
            raise ValueError(f"unknown render mode {mode!r}: choose one of {', '.join(MODES)}")
        self._note_unknown(overrides)
        self._mode, self._overrides = mode, overrides
        self._frame += 1
        self._hidden.clear()
        self._overlay.next_frame()

    def _note_unknown(self, overrides: Mapping[str, Any]) -> None:
        for key in overrides.keys() - STYLE_KEYS - self._unknown:
            self._unknown.add(key)
            near = nearest(key, STYLE_KEYS)
            hint = f": did you mean {near!r}?" if near else ""
            self.env.logger.warning(f"render: {key!r} is not a plot option and is ignored{hint}")

    def pause(self, interval: float) -> None:
        """Show the present state in the window for ``interval`` seconds; returns at once where there is none."""
        if not self._display:
            return
        figure = self._synced()
        if self._window is not None and self._window.open:
            with self._as_shown():
                figure.draw()
            self._window.refresh(interval)

    def show(self) -> None:
        """Show the window until the user closes it; returns at once where there is none."""
        self.pause(0.001)
        if self._window is not None:
            self._window.wait()

    def frame(self) -> Image.Image:
        """The picture as it would be saved."""
        return to_image(self._pixels({})[0])

    def _pixels(self, options: Mapping[str, Any]) -> tuple[Pixels, tuple[int, int, int, int] | None]:
        options = {**self.saved_figure_kwargs, **options}
        figure = self._synced()
        tight = options.get("bbox_inches") == "tight"
        with self._as_shown():
            if _is_quick(options, figure.figure.dpi):
                self._drawn_at = self._shown_at
                return figure.pixels(tight=tight, pad_inches=options.get("pad_inches", _PAD_INCHES))
            data = io.BytesIO()
            figure.figure.savefig(data, **{**options, "format": "png"})
        with Image.open(data) as image:
            return from_image(image), None

    # files -----------------------------------------------------------------------------------------------------------
    def save_figure(
        self,
        save_name: str | Path | None = None,
        *,
        include_index: bool = False,
        save_gif: bool = False,
        **options: Any,
    ) -> Path:
        """Save the present picture.

        Args:
            save_name: Name with format (default ``<world>.png``), in ``fig_path`` unless absolute.
            include_index: Append ``_<step, 4 digits>``.
            save_gif: Save into ``ani_buffer_path``, with the index, and keep it as a frame of the animation.
            **options: Of Matplotlib's ``savefig``; they hold for later saves too, ``format`` excepted.

        Returns:
            The file.

        Raises:
            ValueError: A format nothing writes.
        """
        wanted = options.pop("format", None)
        _check_save_options(options)
        self.saved_figure_kwargs.update(options)
        count = int(self.env.simulation.count[0])
        paths = self.env.path_param
        path = picture_path(
            paths.ani_buffer_path if save_gif else paths.fig_path,
            save_name,
            self.env.simulation.scenario.name,
            count=count if include_index or save_gif else None,
            format=wanted,
            default_format=self._format,
        )
        figure = self._synced()
        with replacing(path) as temporary:
            if path.suffix == ".png" and _is_quick(self.saved_figure_kwargs, figure.figure.dpi):
                pixels, _ = self._pixels({})
                temporary.write_bytes(png_bytes(pixels, figure.figure.dpi))
                self._saved_size = pixels.shape[1], pixels.shape[0]
            else:
                with self._as_shown():
                    figure.figure.savefig(temporary, format=path.suffix[1:], **self.saved_figure_kwargs)
        if save_gif and count != self._recording.last_count:
            self.add_frame()
        return path

    def add_frame(self, **options: Any) -> None:
        """Keep the present picture for the animation; all frames are cut like the first.

        Args:
            **options: Of ``savefig``; they hold for later frames too.
        """
        _check_save_options(options)
        self.saved_figure_kwargs.update(options)
        kwargs, crop = self.saved_figure_kwargs, self._recording.crop
        if crop is not None and kwargs.get("bbox_inches") == "tight" and _is_quick(kwargs, self._made().figure.dpi):
            figure = self._synced()
            with self._as_shown():
                figure.draw()
                pixels = figure.compositor.pixels(crop)
            self._drawn_at = self._shown_at
        else:
            pixels, self._recording.crop = self._pixels({})
        self._recording.add(pixels, self._colors)
        self._saved_size = pixels.shape[1], pixels.shape[0]

    def save_animation(self, path: str | Path | None = None, **options: Any) -> Path | None:
        """Write the animation of the frames kept so far, and forget them.

        Args:
            path: File to write; default ``<ani_path>/<ani_name><suffix>``.
            **options: See :meth:`irsim.rendering.recording.Recording.save`.

        Returns:
            The file; None, with a warning, when there are no frames.

        Raises:
            ValueError: A suffix that nothing writes.
        """
        return self._recording.save(path, **options)

    @property
    def frames_written(self) -> int:
        """Frames of the animation saved last."""
        return self._recording.frames_written

    def _colors(self) -> list[tuple[int, int, int]]:
        """Colours that a reduced palette must keep: those of opaque bodies, paper and ink."""
        return opaque_colors(self.scene())

    # life ------------------------------------------------------------------------------------------------------------
    def reset(self) -> None:
        """Draw everything anew: drawings, titles and views of scripts are gone; kept frames stay."""
        self._options = self.env.simulation.scenario.world.plot
        self._begin()
        self._builder = SceneBuilder(self.env.simulation, palette=self.palette, has_picture=self._has_picture)
        self._overlay.forget()
        self._user_sensors.forget()
        if self._figure is not None:
            self._figure.clear()
            self._synced()

    def close(self) -> None:
        """Close the window and forget figure and frames."""
        if self._window is not None:
            self._window.close()
            self._window = None
        self._overlay.forget()
        self._user_sensors.forget()
        if self._entry is not None:
            self._entry.leave()
            self._entry = None
        if self._figure is not None:
            self._figure.compositor.forget()
        self._figure = None
        self._recording.forget()

    # drawings of scripts ---------------------------------------------------------------------------------------------
    def set_title(self, title: str | None) -> None:
        """Fixed title until the next reset; None shows time and status again."""
        self.title = title

    def draw_trajectory(self, traj: Any, traj_type: str = "-", **kwargs: Any) -> None:
        """A path; see :meth:`Overlay.trajectory`."""
        self._overlay.trajectory(self._made().ax, traj, traj_type, **kwargs)

    def draw_points(self, points: Any, s: float = 30, c: Any = None, refresh: bool = True, **kwargs: Any) -> None:
        """Dots; see :meth:`Overlay.points`."""
        if points is not None:
            self._overlay.points(self._made().ax, points, s, c, refresh, **kwargs)

    def draw_box(self, vertex: Any, refresh: bool = False, color: str = "-") -> None:
        """A closed outline; see :meth:`Overlay.box`."""
        self._overlay.box(self._made().ax, vertex, refresh, color)

    def draw_quiver(self, point: Any, refresh: bool = False, color: Any = None, **kwargs: Any) -> None:
        """One arrow (x, y, u, v)."""
        if point is not None:
            self._overlay.quivers(self._made().ax, [point], refresh, color, **kwargs)

    def draw_quivers(self, points: Any, refresh: bool = False, color: Any = None, **kwargs: Any) -> None:
        """Arrows (x, y, u, v)."""
        self._overlay.quivers(self._made().ax, points, refresh, color, **kwargs)


def _canvas_of(plot: EnvPlot | None) -> Any:
    """The canvas of a figure that pyplot asks for; an empty one if its environment has just gone."""
    return LiveFigure().canvas if plot is None else plot.fig.canvas


def _saved_figure(options: Any) -> dict[str, Any]:
    values: dict[str, Any] = options.saved_figure.model_dump(exclude_unset=True)
    return {key: value for key, value in values.items() if value is not None or key == "bbox_inches"}


def _check_save_options(options: Mapping[str, Any]) -> None:
    """Refuse a misspelt option before it is kept for later saves."""
    for name in options:
        if name not in _SAVE_OPTIONS:
            near = nearest(name, _SAVE_OPTIONS)
            hint = f"did you mean {near!r}?" if near else f"known are {', '.join(sorted(_SAVE_OPTIONS))}"
            raise TypeError(f"unknown option {name!r} of a saved figure; {hint}")


def _is_quick(options: Mapping[str, Any], dpi: float) -> bool:
    """Whether options of ``savefig`` can be served from the canvas as it is."""
    same_dpi = options.get("dpi") in (dpi, "figure", None)
    return same_dpi and set(options) <= _QUICK_OPTIONS and options.get("bbox_inches") in ("tight", None)
