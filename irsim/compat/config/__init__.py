"""Parameters of the environment used last, under the names of IR-SIM."""

from irsim.compat.config import env_param, palette_param, path_param, world_param

__all__ = ["env_param", "palette_param", "path_param", "world_param"]
