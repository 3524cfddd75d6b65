"""The command ``irsim-evals``."""

from __future__ import annotations

__all__ = ["main"]


def main() -> None:
    """Run the command line."""
    from irsim.cli.output import prepare_streams
    from irsim_evals.cli.app import app

    prepare_streams()
    app()
