"""``path_param`` of the environment used last; see :class:`irsim.parameters.PathParam`."""

from irsim.config._follow import follow
from irsim.parameters import PathParam

__all__ = ["PathManager", "PathParam"]

PathManager = PathParam

follow(__name__, "path_param", PathParam())
