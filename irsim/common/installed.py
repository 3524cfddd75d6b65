"""The installed packages: the version of this one, and PyPI's ``ir-sim``, which cannot be beside it.

Both distributions provide the import package ``irsim``: pip lets them overwrite each other's files without a warning.
"""

from __future__ import annotations

import os
import sys
import sysconfig
from collections.abc import Iterable
from functools import cache

__all__ = ["ConflictError", "find_conflicts", "refuse_conflicts", "script_folder", "version"]

_SCRIPTS = ("irsim", "irsim-mcp")


class ConflictError(ImportError):
    """The distribution ``ir-sim`` is installed beside ``irsim-mcp``."""


def find_conflicts(path: Iterable[str]) -> list[str]:
    """Metadata directories of an installed ``ir-sim``.

    Reads one directory listing per entry: no file is opened and ``importlib.metadata`` (15 ms) stays unloaded.

    Args:
        path: Import path entries, as in ``sys.path``.

    Returns:
        Paths such as ``…/site-packages/ir_sim-2.12.0.dist-info``, in the order of ``path``.
    """
    folders = []
    for entry in dict.fromkeys(path):
        try:
            names = os.listdir(entry or ".")
        except OSError:  # zip files, folders that do not exist
            continue
        folders += [os.path.join(entry, name) for name in names if name.endswith("-info") and _is_upstream(name)]
    return folders


def refuse_conflicts() -> None:
    """Raise if ``ir-sim`` is installed for this interpreter.

    Raises:
        ConflictError: ``ir-sim`` is installed; the message says where, and what to uninstall.
        SystemExit: ``ir-sim`` is installed, and a command of this package was called.
    """
    folders = find_conflicts(sys.path)
    if not folders:
        return
    message = (
        f"the package 'ir-sim' is installed too ({folders[0]}). It and 'irsim-mcp' both provide the Python package "
        "'irsim' and overwrite each other's files. Use separate environments, or remove both and install one "
        "again: pip uninstall -y ir-sim irsim-mcp"
    )
    script = os.path.basename(sys.argv[0] if sys.argv else "").removesuffix(".exe")
    if script in _SCRIPTS:  # at a shell prompt the sentence helps, a traceback does not
        raise SystemExit(f"{script}: {message}")
    raise ConflictError(message)


def _is_upstream(name: str) -> bool:
    """Whether ``….dist-info`` or ``….egg-info`` belongs to a distribution called ``ir-sim``."""
    return name[:6] in ("ir_sim", "ir-sim", "ir.sim") and name[6:7] in ("-", ".")


@cache
def version() -> str:
    """The version as the package's metadata have it, such as ``0.1.0``."""
    from importlib.metadata import version as version_of

    return version_of("irsim-mcp")


def script_folder() -> str | None:
    """The folder of the running script; None without one, as in a notebook, and for programs that are installed.

    Python puts it first in its path, where a script may put another folder, as for IR-SIM 2.12.
    """
    file = getattr(sys.modules.get("__main__"), "__file__", None)
    if file is None:
        return None
    places = (sys.path[0] if sys.path else "", os.path.dirname(os.path.abspath(file)))
    return next((place for place in places if place and not _is_installed(place)), None)


def _is_installed(place: str) -> bool:
    """Whether a folder or an archive of the path belongs to the installation of Python."""
    own = [sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib", "scripts")]
    folder = os.path.realpath(place)
    return place.endswith(".zip") or any(folder.startswith(os.path.realpath(one)) for one in own)
