"""The command line ``irsim``: one module per command.

Each command only reads its options, calls a function of another package that does the work, and prints the result.
"""

from __future__ import annotations

import sys

from irsim.common.installed import ConflictError, refuse_conflicts

__all__ = ["main"]


def main() -> None:
    """Run the command line and exit: 0 finished, 1 could not finish, 2 invalid input, 130 interrupted."""
    try:
        refuse_conflicts()  # irsim/__init__.py calls it too, but an installed ir-sim may have replaced that file
        from irsim.cli.app import app
        from irsim.cli.output import prepare_streams

        prepare_streams()
        app(prog_name="irsim")
    except ConflictError as error:
        raise SystemExit(f"irsim: {error}") from None
    except KeyboardInterrupt:  # during an import, before a command can handle it
        print("interrupted before it began", file=sys.stderr)
        raise SystemExit(130) from None
    except OSError as error:  # while printing outside a command, such as --help to a full disk
        from irsim.cli.output import silence_stdout

        silence_stdout()
        raise SystemExit(f"irsim: {error.strerror or error}") from None
