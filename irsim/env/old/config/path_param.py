"""``path_param`` of the environment used last; see :class:`irsim.env.parameters.PathParam`."""

from irsim.env.parameters import PathParam
from irsim.simulation.active_env import follow

__all__ = ["PathManager", "PathParam"]

PathManager = PathParam

follow(__name__, "path_param", PathParam())
