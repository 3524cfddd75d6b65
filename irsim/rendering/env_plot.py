"""The picture of one environment: its figure and window. Nothing is made before the first drawing."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any
from weakref import finalize, ref

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

from irsim.common.notebook import Cell, draws_inline
from irsim.diagnostics.diagnostic import nearest
from irsim.diagnostics.errors import InputError
from irsim.graphics.encoding.pixels import to_image
from irsim.graphics.encoding.png import png_bytes
from irsim.graphics.figure import window
from irsim.graphics.figure.figure import SceneFigure, inches
from irsim.graphics.figure.pyplot_entry import PyplotEntry, activate, active
from irsim.graphics.figure.window import LiveCanvas, LiveFigure
from irsim.graphics.scene.scene import Scene
from irsim.graphics.scene.style import STYLE_KEYS, Palette
from irsim.objects.drawing.scene_builder import MODES, SceneBuilder
from irsim.objects.sensors.user_drawings import UserDrawings
from irsim.objects.views import views
from irsim.rendering.plot_format import PlotFormat
from irsim.rendering.recording import Pictured
from irsim.rendering.saving import Saving

if TYPE_CHECKING:
    from irsim.graphics.figure.window import Window
    from irsim.rendering.modern.live import LiveStyle

__all__ = ["EnvPlot"]


class EnvPlot(PlotFormat):
    """Draws one environment.

    A picture always shows the state at the moment it is made; ``update`` only notes how to draw it. Artists are brought
    up to date when the figure is drawn, saved or requested.

    Args:
        env: The environment.
        display: Open a window where that is possible.
        full: Let the window fill the screen.
        palette: Default colours.
        attach: Called with the axes when they are made.

    Attributes:
        title: Fixed title, or None for time and status.
        show_title: Whether a title is drawn.
        viewpoint: Point that the view is centred on, or name of the object that it follows, or None.
        saved_figure_kwargs: Options of saved figures; options given to ``save_figure`` are added.
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
        super().__init__(env, palette)
        self._display, self._full, self._attach = display, full, attach
        self._builder = SceneBuilder(env.simulation, palette=self.palette, has_picture=self._pictures.has)
        self._user_sensors = UserDrawings()
        self._window: Window | None = None
        self._inline = draws_inline()
        self._cell = Cell() if display and self._inline else None
        self._saving = Saving(self, self.saved_figure_kwargs.pop("format", None))
        self._unknown: set[str] = set()
        self._hidden: set[int] = set()
        self._entry: PyplotEntry | None = None
        self._frame = 0
        self._looking = False
        self._shown_at: tuple[Any, ...] | None = None
        self._drawn_at: tuple[Any, ...] | None = None
        self._begin()
        self.set_style(self._options.style or "classic")

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
        """The Matplotlib figure, which is made when it is first needed."""
        return self._present().figure

    @property
    def ax(self) -> Axes:
        """The axes of the figure, in world coordinates [m]."""
        return self._present().ax

    @property
    def made(self) -> bool:
        """Whether the figure has been made."""
        return self._figure is not None

    def made_figure(self) -> SceneFigure:
        """Return the figure, which is made when it is first needed."""
        if self._figure is None:
            entry = self.list_in_pyplot()
            if self._display and self._cell is None:
                name, current = self.env.simulation.scenario.name, active()
                self._window = window.open_window(self._size, self._dpi, full=self._full, title=name)
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
        """Let ``plt.gcf()`` find the figure, which is made on demand (:mod:`irsim.graphics.figure.pyplot_entry`).

        Not in a notebook, which would show every listed figure below the cell once more.
        """
        if self._entry is None:
            plot = ref(self)
            self._entry = PyplotEntry(lambda: _canvas_of(plot()))
            finalize(self, self._entry.leave)
            if self._inline:
                self._entry.leave()
        return self._entry

    # the present -----------------------------------------------------------------------------------------------------
    def _moment(self) -> tuple[Any, ...]:
        """Return what distinguishes one picture from the next, which is cheap to compare."""
        simulation = self.env.simulation
        return int(simulation.count[0]), simulation.revision, self._frame, self.env.status, self.title

    def _present(self) -> SceneFigure:
        """Return the figure with its artists up to date."""
        figure = self.made_figure()
        if not self._looking and self._shown_at != self._moment():
            self._show(figure)
        return figure

    def note_drawn(self) -> None:
        """Note that the canvas shows what the artists show."""
        self._drawn_at = self._shown_at

    def before_drawing(self) -> None:
        """Bring the artists up to date; the figure calls this before it is drawn or saved."""
        if self._figure is not None and not self._looking:
            self._show(self._figure)
            self._figure.compositor.forget()
            self.note_drawn()

    def is_outdated(self) -> bool:
        """Whether the pixels of the canvas show an earlier moment."""
        return self._figure is not None and not self._looking and self._drawn_at != self._moment()

    @contextmanager
    def as_shown(self) -> Iterator[None]:
        """Draw and read the artists as they are, without bringing them up to date."""
        before, self._looking = self._looking, True
        try:
            yield
        finally:
            self._looking = before

    def _show(self, figure: SceneFigure) -> None:
        with self.as_shown():
            if self._modern is not None:
                figure.show(self._modern_now(self._modern), None)
                self._show_measurements(figure)
                self._shown_at = self._moment()
                return
            scene, tracks = self._builder.frame(
                status=self.env.status, viewpoint=self.viewpoint, mode=self._mode, overrides=self._overrides
            )
            left = [track for track in tracks if track.object not in self._hidden]
            figure.show(self._completed(scene), self._title(), left)
            self._show_measurements(figure)
        self._shown_at = self._moment()

    def _show_measurements(self, figure: SceneFigure) -> None:
        simulation = self.env.simulation
        if simulation.measurements:
            present = [view for view in views(simulation) if simulation.appeared[view.row] >= 0]
            self._user_sensors.show(figure.ax, [view for view in present if self._builder.style(view, {}).show_sensor])

    def _modern_now(self, modern: LiveStyle) -> Scene:
        title = self.title if self.show_title else ""
        return self._modern_scene(modern, self._overrides, self.viewpoint, self._hidden, title)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the last saved picture, or of the figure before the first [px]."""
        return self._saving.size or (int(self._size[0]), int(self._size[1]))

    def scene(self) -> Scene:
        """Return what the picture shows, as data."""
        if self._modern is not None:
            return self._modern_now(self._modern)
        scene = self._builder.build(
            status=self.env.status, viewpoint=self.viewpoint, mode=self._mode, overrides=self._overrides
        )
        return self._completed(scene)

    def _completed(self, scene: Scene) -> Scene:
        if self._region is not None:
            scene.look_at(self._region)
        if self._options.show_zones:
            self._builder.add_zones(scene)
        return self._without_hidden(scene)

    def _without_hidden(self, scene: Scene) -> Scene:
        for name in ("marks", "beams", "labels", "pictures", "grids") if self._hidden else ():
            setattr(scene, name, [item for item in getattr(scene, name) if item.object not in self._hidden])
        return scene

    def _title(self) -> str | None:
        if not self.show_title:
            return None
        if self.title is not None:
            return self.title
        simulation = self.env.simulation
        time = int(simulation.count[0]) * float(simulation.scenario.world.step_time)
        return f"Simulation Time: {time:.2f}s, Status: {self.env.status}"

    def synced_figure(self) -> SceneFigure:
        """Return the figure with its artists brought up to date."""
        figure = self.made_figure()
        self._show(figure)
        return figure

    # per step --------------------------------------------------------------------------------------------------------
    def update(self, mode: str = "dynamic", **overrides: Any) -> None:
        """Begin the next frame.

        Args:
            mode: Objects that ``overrides`` apply to: ``dynamic``, ``static`` or ``all``.
            **overrides: Object plot keys that hold until the next call.

        Raises:
            ValueError: The mode is unknown.
        """
        if mode not in MODES:
            raise InputError(f"unknown render mode {mode!r}", f"choose one of {', '.join(MODES)}")
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

    def show_in_cell(self, seconds: float = 0.0) -> bool:
        """Show the picture below the present cell of a notebook; False where figures do not appear in cells.

        Args:
            seconds: Time to wait then, so that a loop does not replace the picture before anyone has seen it.
        """
        if self._cell is not None:
            self._cell.show(png_bytes(self._saving.pixels()[0], self._dpi))
            time.sleep(max(seconds, 0.0))
        return self._cell is not None

    def frame(self) -> Image.Image:
        """Return the picture as it would be saved."""
        return to_image(self._saving.pixels()[0])

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
            save_name: File name with format (default ``<world>.png``), in ``fig_path`` unless absolute.
            include_index: Append ``_<step, 4 digits>``.
            save_gif: Save into ``ani_buffer_path``, with the index, and store it as a frame of the animation.
            **options: Options of Matplotlib's ``savefig``; except ``format`` they hold for later saves too.

        Returns:
            The file.

        Raises:
            ValueError: The format is not supported.
        """
        return self._saving.save_figure(save_name, include_index=include_index, save_gif=save_gif, options=options)

    def add_frame(self, **options: Any) -> None:
        """Store the present picture for the animation; all frames are cut like the first.

        Args:
            **options: Options of ``savefig``; they hold for later frames too.
        """
        self._saving.add_frame(options)

    def add_last_frame(self) -> None:
        """Store the present picture for the animation unless its last frame shows it."""
        if self._saving.recording.last_count != int(self.env.simulation.count[0]):
            self.update()
            self.add_frame()

    def save_animation(self, path: str | Path | None = None, **options: Any) -> Path | None:
        """Write the animation of the stored frames and drop them.

        Args:
            path: File to write; default ``<ani_path>/<ani_name><suffix>``.
            **options: See :meth:`irsim.rendering.recording.Recording.save`.

        Returns:
            The file; None, with a warning, if no frames are stored.

        Raises:
            ValueError: The suffix is not supported.
        """
        return self._saving.recording.save(path, **options)

    @property
    def frames_written(self) -> int:
        """Number of frames of the last saved animation."""
        return self._saving.recording.frames_written

    # life ------------------------------------------------------------------------------------------------------------
    def reset(self) -> None:
        """Draw everything again without the drawings, titles and viewpoints of scripts; stored frames stay."""
        self._options = self.env.simulation.scenario.world.plot
        self._begin()
        self._builder = SceneBuilder(self.env.simulation, palette=self.palette, has_picture=self._pictures.has)
        self._renew_style()
        self._overlay.forget()
        self._user_sensors.forget()
        if self._figure is not None:
            self._figure.clear()
            self.synced_figure()

    def close(self) -> None:
        """Close the window and drop figure and frames."""
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
        self._saving.recording.forget()


def _canvas_of(plot: EnvPlot | None) -> Any:
    """Return the canvas that pyplot requests; an empty one if the environment has just been deleted."""
    return LiveFigure().canvas if plot is None else plot.fig.canvas
