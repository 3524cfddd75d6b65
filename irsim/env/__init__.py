"""``irsim.make`` and the environment."""

from typing import TYPE_CHECKING, Any

from irsim.env.env_base import Env, EnvBase, make

if TYPE_CHECKING:
    from irsim.env.env_base3d import EnvBase3D

__all__ = ["Env", "EnvBase", "EnvBase3D", "make"]


def __getattr__(name: str) -> Any:
    if name == "EnvBase3D":
        from irsim.env.env_base3d import EnvBase3D

        return EnvBase3D
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
