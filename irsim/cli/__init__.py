"""The command line ``irsim``: run, validate, render, describe, new, templates, schema, demo.

One module per verb; each only reads options, calls the function below it that knows the rules, and prints the result.
"""

from __future__ import annotations

__all__ = ["main"]


def main() -> None:
    """Run the command line and exit: 0 finished, 1 could not finish, 2 invalid input, 130 interrupted."""
    from irsim.common.conflict import ConflictError, refuse_conflicts

    try:
        refuse_conflicts()  # again, since ir-sim may have replaced irsim/__init__.py, which does it too
    except ConflictError as error:
        raise SystemExit(f"irsim: {error}") from None
    try:
        from irsim.cli.app import app
        from irsim.cli.output import prepare_streams

        prepare_streams()
        app(prog_name="irsim")
    except KeyboardInterrupt:  # while something was being imported
        raise SystemExit(130) from None
    except OSError as error:  # of what is printed outside the verbs, such as --help to a disk that is full
        from irsim.cli.output import silence_stdout

        silence_stdout()
        raise SystemExit(f"irsim: {error.strerror or error}") from None
