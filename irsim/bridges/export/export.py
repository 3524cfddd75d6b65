"""``irsim.export_run``: write recorded runs as files of other tools."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from irsim.bridges.export.episode import open_episode
from irsim.bridges.export.registry import Format, chosen_options, find_format
from irsim.common.extras import require
from irsim.common.files import TargetError, check_new, check_suffix, code_of, new_folder, replacing
from irsim.common.keywords import answers_misspelt
from irsim.common.text import clean
from irsim.episodes.episode import Progress
from irsim.results.records import ExportResult
from irsim.runs.files import RunError
from irsim.runs.reading import Run, open_run
from irsim.scenario.limits import Limits

__all__ = ["check_target", "export_run"]


@answers_misspelt
def export_run(
    run: str | Path | Run | Sequence[str | Path | Run],
    out: str | Path | None = None,
    *,
    to: str | None = None,
    objects: str | Sequence[str] | None = None,
    ranges: bool | None = None,
    options: Mapping[str, Any] | None = None,
    overwrite: bool = False,
    workspace: str | Path | None = None,
    limits: Limits | None = None,
    progress: Progress | None = None,
) -> ExportResult:
    """Write recorded runs as a file that other tools open.

    ``irsim describe exports`` names the formats and the programs that they are for. Tables and bags are read piece by
    piece, so that runs need not fit in memory. A format that needs a library says which extra installs it:
    ``pip install 'irsim-mcp[records]'``.

    Args:
        run: Id of a run, its folder, or ``last``; or several of them for a table or a dataset.
        out: File or folder to write; folders above it are made. Default: the id of the run with the suffix of the
            format, in the current directory.
        to: Name of the format. Default: as the suffix of ``out`` says.
        objects: ``movers`` (robots, and obstacles that can move), ``robots``, ``people`` (obstacles that can move),
            ``all``, or a list of names. Default: ``robots`` for cameras, ``people`` for ``isaac_people``, else
            ``movers``.
        ranges: Whether to write the ranges of lidars. Default: in all formats but ``csv``.
        options: Options of the format, such as the height of cameras.
        overwrite: Replace a file that exists; a folder is never replaced.
        workspace: Folder whose ``.irsim/runs`` holds the runs; default: the current directory.
        limits: Limits of the reader of the scenario.
        progress: Callback ``(rows_done, rows_total)``.

    Raises:
        RunError: There is no such run, object or format, or the format does not hold these runs or their objects.
        ExtraError: A library is missing.
        ArgumentError: The format has no such option, or the value is not allowed.
        TargetError: The file has another suffix than files of the format, or exists.
        ScenarioError: The scenario of the run has errors now (only ``mcap`` reads it).
    """
    names = [run] if isinstance(run, (str, os.PathLike, Run)) else list(run)
    runs = [one if isinstance(one, Run) else open_run(one, workspace) for one in names]
    if not runs:
        raise RunError("bad-argument", "no run was given", "give the id of a run, its folder, or 'last'", where="run")
    form = find_format(to, None if out is None else Path(out))
    if len(runs) > 1 and not form.several:
        what = f"a file of the format {form.name} holds one run, got {len(runs)}"
        raise RunError("bad-argument", what, "export each run to a file of its own", where="run")
    require(form.extra, *form.libraries)
    chosen = chosen_options(form.options, options or {}, f"the format {form.name}")
    target = _target(form, runs, out)
    check_target(form, target, overwrite=overwrite)
    total, done = sum(one.last_step + 1 for one in runs), 0

    def count(rows: int) -> None:
        nonlocal done
        done += rows
        if progress is not None:
            progress(min(done, total), total)

    with_ranges = form.ranges if ranges is None else ranges
    who = form.objects if objects is None else objects
    episodes = [
        open_episode(one, who, with_ranges=with_ranges, limits=limits, progress=count, options=chosen, none=form.scene)
        for one in runs
    ]
    try:
        with new_folder(target) if form.folder else replacing(target, overwrite=overwrite) as path:
            notes = form.write(episodes, path, target.name)
    except OSError as error:
        if form.folder and os.path.lexists(target):
            what = f"'{target}' was written by another program meanwhile"
            raise RunError("file-exists", what, "export again, to a folder that does not exist") from None
        what = f"'{target}' cannot be written: {error.strerror or error}"
        raise RunError(code_of(error), what, "check permissions and the space left, or name another file") from None
    return ExportResult(
        run_ids=[one.id for one in runs],
        format=form.name,
        file=str(target),
        bytes=_size_of(target),
        objects=list(dict.fromkeys(actor.name for episode in episodes for actor in episode.actors)),
        steps=sum(episode.last_step for episode in episodes),
        notes=[*dict.fromkeys(note for one in runs for note in one.notes), *notes],
    )


def _target(form: Format, runs: Sequence[Run], out: str | Path | None) -> Path:
    """The file or folder to write."""
    if out is None:
        if len(runs) > 1:
            raise RunError("bad-argument", "several runs need a name for their file", "name it with -o", where="out")
        out = f"{runs[0].id}{form.suffix}"
    return Path(out)


def check_target(form: Format, target: Path, *, overwrite: bool) -> None:
    """Refuse a file or folder that a format cannot write, before any work is done.

    Raises:
        TargetError: The file has another suffix than files of the format, or exists.
    """
    if not form.folder:
        check_suffix(target, (form.suffix, *form.more_suffixes))
        check_new(target, overwrite=overwrite)
    elif os.path.lexists(target):
        what = f"'{clean(target, 200)}' exists, and folders are not replaced"
        raise TargetError("file-exists", what, "name another folder with -o, or delete this one")


def _size_of(target: Path) -> int:
    """Size of a file, or of all files in a folder [bytes]."""
    files = [target] if target.is_file() else [path for path in target.rglob("*") if path.is_file()]
    return sum(path.stat().st_size for path in files)
