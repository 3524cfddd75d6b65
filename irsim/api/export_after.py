"""Files of other programs that are written when a run is over."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from irsim.common.extras import require

__all__ = ["check_exports", "export_all", "kept_or_temporary"]


def check_exports(files: Sequence[str | Path], *, overwrite: bool) -> list[Path]:
    """The files to write after a run, checked before it.

    Raises:
        RunError: A suffix selects no format.
        TargetError: A file exists, and ``overwrite`` is not set.
        ExtraError: A library is missing.
    """
    if not files:
        return []  # as for most runs, which load no formats
    from irsim.bridges.export.export import check_target
    from irsim.bridges.export.registry import find_format

    targets = [Path(file) for file in files]
    for target in targets:
        form = find_format(None, target)
        require(form.extra, *form.libraries)
        check_target(form, target, overwrite=overwrite)
    return targets


@contextmanager
def kept_or_temporary(record: bool | str | Path, exports: Sequence[Path]) -> Iterator[bool | str | Path]:
    """Where to record a run: where the caller wants it, else in a temporary folder if files are made of it."""
    if record is not False or not exports:
        yield record
        return
    folder = Path(tempfile.mkdtemp(prefix="irsim-"))
    try:
        yield folder / "run"
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def export_all(run: Path, targets: Sequence[Path], *, overwrite: bool) -> tuple[list[str], list[str]]:
    """Write the files; return their paths, and notes on what they leave out."""
    from irsim.bridges.export.export import export_run

    written = [export_run(run, target, overwrite=overwrite) for target in targets]
    return [one.file for one in written], [note for one in written for note in one.notes]
