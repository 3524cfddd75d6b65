"""Writing files so that nobody ever sees half of one, and nothing is overwritten by accident."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from irsim.diagnostics.errors import CodedError

__all__ = ["TargetError", "check_suffix", "write_atomically", "write_new"]


class TargetError(CodedError, ValueError):
    """A file cannot be written under the given name."""


def check_suffix(target: Path, known: Iterable[str]) -> None:
    """Refuse a file whose suffix nothing writes, before any work is done.

    Args:
        target: The file.
        known: Suffixes, with or without the dot.

    Raises:
        TargetError: The suffix is not among them.
    """
    suffixes = [suffix.lstrip(".") for suffix in known]
    if target.suffix.lower().lstrip(".") not in suffixes:
        raise TargetError("unknown-format", f"{target} has none of the suffixes {', '.join(suffixes)}")


def write_new(target: Path, text: str, *, overwrite: bool = False) -> None:
    """Write a text file, all at once.

    Args:
        target: Where to; its directory must exist.
        text: What to write.
        overwrite: Replace a file that exists.

    Raises:
        TargetError: There is one and ``overwrite`` is not set.
    """
    if not overwrite:
        try:
            target.open("x").close()  # claims the name, also against another process
        except FileExistsError:
            raise TargetError("file-exists", f"{target} exists; --force overwrites it, -o names another file") from None
    try:
        write_atomically(target, text)
    except BaseException:
        if not overwrite:
            with suppress(OSError):
                target.unlink()
        raise


def write_atomically(target: Path, text: str) -> None:
    """Replace a text file in one step, by way of a temporary one beside it; links are followed, modes kept."""
    target = target.resolve()
    descriptor, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
    try:
        with os.fdopen(descriptor, "w", encoding="utf-8", newline="") as file:
            file.write(text)
        os.chmod(temporary, target.stat().st_mode & 0o7777 if target.exists() else 0o666 & ~_umask())
        os.replace(temporary, target)
    except BaseException:
        with suppress(OSError):
            os.unlink(temporary)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
