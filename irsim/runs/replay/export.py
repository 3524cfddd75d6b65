"""``irsim.replay``: write the HTML page of a recorded run."""

from __future__ import annotations

from pathlib import Path

from irsim.common.files import check_suffix, code_of, write_atomically
from irsim.common.keywords import answers_misspelt
from irsim.common.notebook import SUFFIXES
from irsim.common.text import clean
from irsim.results.run import ReplayResult
from irsim.runs.files import RunError
from irsim.runs.reading import Run, open_run
from irsim.runs.replay.data import pack_run
from irsim.runs.replay.page import page
from irsim.scenario.limits import Limits

__all__ = ["replay"]


@answers_misspelt
def replay(
    run: str | Path | Run,
    out: str | Path | None = None,
    *,
    workspace: str | Path | None = None,
    title: str | None = None,
    limits: Limits | None = None,
) -> ReplayResult:
    """Write a recorded run as one HTML page that plays in any browser, without a network.

    Args:
        run: Id of the run, its folder, or ``last``.
        out: File to write; default: ``<id>.html`` in the current directory. An existing file is replaced.
        workspace: Folder whose ``.irsim/runs`` holds the run; default: the current directory.
        title: Title of the page; default: the name of the scenario.
        limits: Limits of the reader of the scenario.

    Raises:
        RunError: There is no such run, it cannot be read, or the file cannot be written.
        TargetError: The file has an unsupported suffix.
        ScenarioError: The scenario has errors, for example because another file of it has changed.
    """
    opened = run if isinstance(run, Run) else open_run(run, workspace)
    target = Path(f"{opened.id}.html") if out is None else Path(out)
    check_suffix(target, SUFFIXES)
    packed = pack_run(opened, title=title, limits=limits)
    text = page(packed.data, title=f"{clean(packed.head['title'])} · irsim replay")
    try:
        write_atomically(target, text)
    except OSError as error:
        what = f"'{target}' cannot be written: {error.strerror or error}"
        raise RunError(code_of(error), what, "name another file with -o") from None
    return ReplayResult(
        run_id=opened.id,
        file=str(target),
        bytes=len(text.encode()),
        objects=len(packed.head["objects"]),
        last_step=packed.head["last_step"],
        every=packed.head["every"],
        scans=packed.head["scans"],
        notes=packed.head["notes"],
    )
