"""Parameters of the environment used last, under the module names of IR-SIM 2.12."""

from irsim.env.old.config import env_param, palette_param, path_param, world_param

__all__ = ["env_param", "palette_param", "path_param", "world_param"]
