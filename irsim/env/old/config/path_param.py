"""``path_param`` of the environment used last; see :class:`irsim.env.parameters.PathParam`."""

from irsim.env.old.config._follow import follow
from irsim.env.parameters import PathParam

__all__ = ["PathManager", "PathParam"]

PathManager = PathParam

follow(__name__, "path_param", PathParam())
