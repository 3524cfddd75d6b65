"""``irsim.make`` and the environment."""

from typing import TYPE_CHECKING, Any

from irsim._names import submodule
from irsim.env.env_base import Env, EnvBase, make

if TYPE_CHECKING:
    from irsim.env.env_base3d import EnvBase3D

__all__ = ["Env", "EnvBase", "EnvBase3D", "make"]


def __getattr__(name: str) -> Any:
    if name == "EnvBase3D":
        from irsim.env.env_base3d import EnvBase3D

        return EnvBase3D
    if (module := submodule(__name__, name)) is not None:
        return module
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
