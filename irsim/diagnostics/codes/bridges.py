"""Codes of errors of bridges: files and programs of others."""

from __future__ import annotations

from irsim.diagnostics.codes.code import Code

__all__ = ["BRIDGES"]

BRIDGES: dict[str, Code] = {
    "bridge-file": Code(
        "file of another program not usable",
        "A file that another program has written is truncated, too large, or not what its name says. The message has "
        "the place in the file. Nothing was written.",
    ),
    "bridge-mismatch": Code(
        "scenario does not fit a bridge",
        "A bridge cannot represent something of the scenario, or its options name an object that there is none of.",
    ),
    "bridge-lost": Code(
        "program at the other end lost",
        "The program that a bridge talks to cannot be reached, has ended, or did not answer in time. Robots that were "
        "driven by the bridge have got the command to stand still.",
    ),
    "bridge-failed": Code(
        "bridge failed",
        "A bridge raised an error, or the program at its other end sent values that are not usable, such as NaN.",
    ),
    "bridges-disabled": Code(
        "bridges are not opened here",
        "The scenario has bridges to other programs, which open connections. The MCP server opens them only if it was "
        "started with --enable-bridges; without that, leave out the key bridges.",
    ),
}
