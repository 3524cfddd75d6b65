"""Default colours of the environment used last; see :class:`irsim.graphics.scene.style.Palette`."""

from irsim.graphics.scene.style import Palette
from irsim.options.colors import CYCLE
from irsim.simulation.active_env import follow

__all__ = ["DEFAULT_CYCLE", "PaletteParam"]

DEFAULT_CYCLE = CYCLE
PaletteParam = Palette

follow(__name__, "palette_param", Palette())
