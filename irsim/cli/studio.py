"""``irsim studio``: write, see and run scenarios in the browser."""

from __future__ import annotations

import time
from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer

from irsim.bundled import templates
from irsim.cli.output import console
from irsim.diagnostics.errors import InputError
from irsim.runs.files import RunError
from irsim.runs.store import find_run
from irsim.studio.studio import Studio

__all__ = ["studio"]

_LOOK_S = 0.5


def studio(
    what: Annotated[
        str | None,
        typer.Argument(
            metavar="[FILE|TEMPLATE|RUN]",
            help="The scenario to open, or a recorded run (its id, or 'last'). Default: the page offers them.",
        ),
    ] = None,
    port: Annotated[
        int,
        typer.Option(
            "--port", metavar="N", min=0, max=65535, help="Port of the page on this machine. Default: a free one."
        ),
    ] = 0,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Print the address only, and open no browser.")
    ] = False,
) -> None:
    """Open a page with the text and the scene of a scenario side by side: write, drag, check, run.

    It reads and writes scenarios in the current directory, or beside FILE, and serves only this machine.
    """
    root, first = _place(what)
    made = Studio(root, port, first)
    try:
        shown = console()
        shown.print(f"studio: {made.address}", soft_wrap=True, highlight=False)
        shown.print(
            f"It reads and writes scenarios in {made.files.root}; Ctrl-C ends it.", soft_wrap=True, highlight=False
        )
        if not no_browser:
            made.show()
        while True:
            time.sleep(_LOOK_S)
    except KeyboardInterrupt:
        pass
    finally:
        made.close()


def _place(what: str | None) -> tuple[Path, dict[str, str] | None]:
    """The folder of the studio, and its first scenario: a file in it, a template, or a run."""
    here = Path.cwd()
    if what is None:
        return here, None
    file = Path(what)
    if file.is_file():
        inside = file.resolve().is_relative_to(here.resolve())
        root = here if inside else file.resolve().parent
        return root, {"name": file.resolve().relative_to(root.resolve()).as_posix()}
    if what in templates.names():
        return here, {"template": what}
    with suppress(RunError):
        return here, {"run": find_run(what, here).name}
    near = templates.meant(what)
    fix = f"irsim studio {near}" if near else "irsim templates lists the templates; name one, or a file that exists"
    raise InputError(f"'{what}' is neither a file nor a template nor a recorded run", fix, where="what")
