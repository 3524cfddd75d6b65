"""The tools of an agent: files of its folder for every arm, and MCP servers for some."""

from __future__ import annotations

import base64
import sys
from pathlib import Path
from typing import Any

from inspect_ai.model import ContentImage
from inspect_ai.tool import ToolDef, ToolError, mcp_server_stdio, mcp_tools

from irsim_evals.harness.folder import Folder, FolderError

__all__ = ["file_tools", "picture_url", "server_tools"]


def file_tools(folder: Folder) -> list[Any]:
    """Tools that write, read and list the files of a folder."""

    async def write_file(path: str, content: str) -> str:
        return _tried(lambda: folder.write(path, content))  # type: ignore[no-any-return]

    async def read_file(path: str, start: int = 0) -> Any:
        found = _tried(lambda: folder.read(path, start))
        return found if isinstance(found, str) else [ContentImage(image=picture_url(*found))]

    async def list_files(path: str = ".") -> str:
        names: list[str] = _tried(lambda: folder.names(path))
        return "\n".join(names) or "there are no files"

    where = {"path": "Path in your folder, such as scenario.yaml."}
    return [
        ToolDef(
            write_file, "write_file", "Write a text file in your folder; an existing file is replaced.",
            where | {"content": "The whole text of the file."}, parallel=False,
        ),
        ToolDef(
            read_file, "read_file", "Read a text file, or look at a picture.",
            where | {"start": "Character at which to begin, for a file that was cut."},
        ),
        ToolDef(list_files, "list_files", "List the files below a folder.", {"path": "Folder; the default is yours."}),
    ]  # fmt: skip


def server_tools(arm: str, folder: Path) -> list[Any]:
    """The MCP servers of an arm, each a process of its own.

    They start in the folder above that of the agent and do not import from there, so that no file of the agent takes
    the place of one of their modules. The process gets no environment but the usual paths, hence no key.
    """
    found = []
    if "+mcp" in arm:
        found.append(_server("irsim", folder, "irsim_mcp", "--workspace", str(folder)))
    if "+distractors" in arm:
        found.append(_server("office", folder, "irsim_evals.harness.distractors"))
    return found


def picture_url(kind: str, data: bytes) -> str:
    """A picture as a ``data:`` URL."""
    return f"data:{kind};base64,{base64.b64encode(data).decode('ascii')}"


def _server(name: str, folder: Path, module: str, *arguments: str) -> Any:
    command = ["-P", "-m", module, *arguments]
    return mcp_tools(mcp_server_stdio(name=name, command=sys.executable, args=command, cwd=folder.parent))


def _tried(work: Any) -> Any:
    try:
        return work()
    except FolderError as error:
        raise ToolError(str(error)) from None
