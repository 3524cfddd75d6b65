"""Default colours of the environment used last; see :class:`irsim.render.palette.Palette`."""

from irsim.colors import CYCLE
from irsim.config._follow import follow
from irsim.render.palette import Palette

__all__ = ["DEFAULT_CYCLE", "PaletteParam"]

DEFAULT_CYCLE = CYCLE
PaletteParam = Palette

follow(__name__, "palette_param", Palette())
