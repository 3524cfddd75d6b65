"""Libraries that only some users need: the extras of pyproject.toml."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import Any

from irsim.diagnostics.errors import CodedError

__all__ = ["ExtraError", "library", "require"]


_TORCH = (
    "without a GPU first run pip install torch --index-url https://download.pytorch.org/whl/cpu (1 GB in all, with "
    "CUDA 5.6 GB); "
)
"""The advice before the command that installs torch, which otherwise brings CUDA."""


class ExtraError(CodedError, ImportError):
    """A library that an extra installs is missing."""


def require(extra: str, *modules: str) -> None:
    """Check that libraries are installed, without importing them.

    Args:
        extra: The extra of pyproject.toml that installs them.
        *modules: Their top-level modules.

    Raises:
        ExtraError: Some are missing; the message has the command that installs them.
    """
    missing = [module for module in modules if find_spec(module) is None]
    if missing:
        be = "is" if len(missing) == 1 else "are"
        what = f"{' and '.join(missing)} {be} not installed"
        first = _TORCH if "torch" in missing else ""
        raise ExtraError("missing-extra", what, f"{first}install the extra: pip install 'irsim-mcp[{extra}]'")


def library(name: str) -> Any:
    """A library that no extra installs, imported: programs that call this usually have it.

    Args:
        name: The library, whose package has the same name.

    Raises:
        ExtraError: It is missing; the message has the command that installs it.
    """
    if find_spec(name) is None:
        raise ExtraError("missing-extra", f"{name} is not installed", f"install it: pip install {name}")
    return import_module(name)
