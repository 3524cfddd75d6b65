"""``irsim-mcp``: serve over standard input and output, or over HTTP."""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from irsim_mcp.limits import ServerLimits

if TYPE_CHECKING:
    from irsim_mcp.hosts import Address

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> None:
    """Serve until standard input is closed or, over HTTP, until the process is terminated.

    Args:
        arguments: Arguments of the command line.
    """
    options = _parser().parse_args(arguments)
    workspace: Path = options.workspace
    if not workspace.is_dir():
        _parser().error(f"--workspace: there is no folder {workspace}")
    limits = replace(ServerLimits(), robots=options.max_robots, objects=options.max_objects, work=options.max_work)
    limits = replace(limits, bridges=options.enable_bridges)

    from irsim_mcp.call_log import CallLog, CallLogRefused
    from irsim_mcp.hosts import HttpRefused
    from irsim_mcp.http import serve, token_from
    from irsim_mcp.log import log_to_stderr
    from irsim_mcp.server import build_server
    from irsim_mcp.worker import missing_limits

    for missing in missing_limits():
        print(f"irsim-mcp: {missing}", file=sys.stderr)
    try:
        calls = None if options.log_calls is None else CallLog(options.log_calls)
    except CallLogRefused as refused:
        _parser().error(str(refused))
    log_to_stderr()
    server = build_server(workspace, limits, writing=options.enable_write, calls=calls)
    if options.http is not None:
        try:
            serve(server, options.http, token_from(options.token_file), options.allow_host)
        except HttpRefused as refused:
            _parser().error(str(refused))
        return
    # Ctrl-C ends the process at once, without waiting for the thread that reads input; workers then end, too.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    server.run("stdio")


def _parser() -> argparse.ArgumentParser:
    standard = ServerLimits()
    parser = argparse.ArgumentParser(
        prog="irsim-mcp",
        description="MCP server of the robot-navigation simulator irsim, over standard input and output or HTTP.",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and exit")
    parser.add_argument(
        "--workspace",
        type=Path,
        default=Path(),
        metavar="DIR",
        help="folder that scenarios are read from; no file outside it is read (default: the current folder)",
    )
    parser.add_argument(
        "--enable-write",
        action="store_true",
        help="offer the tool write_scenario, which saves valid scenarios in the workspace",
    )
    parser.add_argument(
        "--enable-bridges",
        action="store_true",
        help="let run_episode open the bridges of a scenario, which connect to other programs, also over the network",
    )
    parser.add_argument(
        "--log-calls",
        type=Path,
        metavar="FILE",
        help="append one line of JSON to FILE for each call of a tool: arguments, whether it failed, and the size of "
        "the answer in characters, pictures and tokens",
    )
    parser.add_argument(
        "--http",
        type=_address,
        metavar="[HOST:]PORT",
        help="serve over streamable HTTP at http://HOST:PORT/mcp (default host: 127.0.0.1, which only this machine "
        "reaches; any other needs a token, and 0.0.0.0 and [::] need --allow-host, too); port 0 chooses a free port",
    )
    parser.add_argument(
        "--token-file",
        type=Path,
        metavar="FILE",
        help="file with the token that HTTP clients must send as 'Authorization: Bearer TOKEN' (or set "
        "IRSIM_MCP_TOKEN)",
    )
    parser.add_argument(
        "--allow-host",
        action="append",
        default=[],
        metavar="NAME",
        help="name or address that HTTP clients connect to, besides HOST: required if HOST is 0.0.0.0 or [::], since "
        "requests that name another host are refused; may be given several times",
    )
    for name, most, what in (
        ("--max-robots", standard.robots, "robots of a scenario"),
        ("--max-objects", standard.objects, "robots and obstacles of a scenario"),
        ("--max-work", standard.work, "steps times objects of one run"),
    ):
        parser.add_argument(
            name, type=_positive, default=most, metavar="N", help=f"maximum number of {what} (default: {most})"
        )
    return parser


class _Version(argparse.Action):
    """Imports the version only when it is requested."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from irsim import __version__

        print(f"irsim-mcp {__version__}")
        parser.exit()


def _address(text: str) -> Address:
    from irsim_mcp.hosts import address

    try:
        return address(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _positive(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"must be positive, got {text}")
    return number


if __name__ == "__main__":
    main()
