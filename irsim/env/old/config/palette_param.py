"""Default colours of the environment used last; see :class:`irsim.graphics.scene.style.Palette`."""

from irsim.env.old.config._follow import follow
from irsim.graphics.scene.style import Palette
from irsim.options.colors import CYCLE

__all__ = ["DEFAULT_CYCLE", "PaletteParam"]

DEFAULT_CYCLE = CYCLE
PaletteParam = Palette

follow(__name__, "palette_param", Palette())
