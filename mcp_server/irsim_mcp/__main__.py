"""``irsim-mcp``: serve over standard input and output."""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from irsim_mcp.limits import ServerLimits

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> None:
    """Serve until standard input ends.

    Args:
        arguments: Of the command line.
    """
    options = _parser().parse_args(arguments)
    workspace: Path = options.workspace
    if not workspace.is_dir():
        _parser().error(f"--workspace: there is no folder {workspace}")
    limits = replace(ServerLimits(), robots=options.max_robots, objects=options.max_objects, work=options.max_work)

    from irsim_mcp.server import build_server
    from irsim_mcp.worker import missing_limits

    for missing in missing_limits():
        print(f"irsim-mcp: {missing}", file=sys.stderr)
    # Ctrl-C ends the process at once, without waiting for input that a thread is reading; workers notice and end too.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    build_server(workspace, limits).run("stdio")


def _parser() -> argparse.ArgumentParser:
    standard = ServerLimits()
    parser = argparse.ArgumentParser(
        prog="irsim-mcp",
        description="MCP server of the robot-navigation simulator irsim, over standard input and output.",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and exit")
    parser.add_argument(
        "--workspace",
        type=Path,
        default=Path(),
        metavar="DIR",
        help="folder that scenarios are read from; nothing outside it is (default: the current one)",
    )
    for name, most, what in (
        ("--max-robots", standard.robots, "robots of a scenario"),
        ("--max-objects", standard.objects, "robots and obstacles of a scenario"),
        ("--max-work", standard.work, "steps times objects of one run"),
    ):
        parser.add_argument(name, type=_positive, default=most, metavar="N", help=f"most {what} (default: {most})")
    return parser


class _Version(argparse.Action):
    """Reads the version only when it is asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from irsim import __version__

        print(f"irsim-mcp {__version__}")
        parser.exit()


def _positive(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} is not positive")
    return number


if __name__ == "__main__":
    main()
