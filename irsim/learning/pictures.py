"""Pictures of worlds for learning libraries."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from irsim.learning.workers.divided import AnyWorlds

__all__ = ["Camera"]

_DPI = 100.0
_NO_TRACKS = {"show_trajectory": False, "show_trail": False}
_SIZE = 480
"""Longer side of a picture [px]."""


class Camera:
    """Makes pictures of one world, and shows them in a window if asked.

    Args:
        worlds: The worlds.
        world: Index of the world.
        human: Whether pictures are shown.
    """

    def __init__(self, worlds: AnyWorlds, world: int = 0, *, human: bool = False) -> None:
        self._worlds, self._world, self._human = worlds, world, human
        self._figure: Any = None
        self._window: Any = None

    def __getstate__(self) -> dict[str, Any]:
        return vars(self) | {"_figure": None, "_window": None, "_human": False}

    def picture(self) -> NDArray[np.uint8]:
        """(H, W, 3) the present state."""
        from irsim.graphics.figure.figure import SceneFigure, fitting_size  # Matplotlib, which training does not need
        from irsim.rendering.snapshot import default_title, legible_scene

        simulation = self._worlds.simulation
        scene, pictures = legible_scene(simulation, self._world, overrides=_NO_TRACKS)
        if self._figure is None:
            x0, x1, y0, y1 = scene.extent
            width, height = fitting_size(x1 - x0, y1 - y0, _SIZE, _DPI)
            self._figure = SceneFigure((_even(width), _even(height)), _DPI, pictures=pictures, halo=True)
        self._figure.show(scene, default_title(simulation, scene))
        pixels, _ = self._figure.pixels(tight=False)
        return np.ascontiguousarray(np.asarray(pixels)[..., :3])

    def show(self) -> None:
        """Show the present state in a window."""
        import matplotlib.pyplot as plt

        pixels = self.picture()
        if self._window is None:
            figure, axes = plt.subplots(num="irsim")
            axes.set_axis_off()
            self._window = figure, axes.imshow(pixels)
        figure, image = self._window
        image.set_data(pixels)
        figure.canvas.draw_idle()
        plt.pause(0.001)

    def close(self) -> None:
        """Close the window."""
        if self._window is not None:
            import matplotlib.pyplot as plt

            plt.close(self._window[0])
            self._window = None


def _even(inches: float) -> float:
    """A length of an even number of pixels, which video encoders ask for."""
    return 2 * max(1, round(inches * _DPI / 2)) / _DPI
