"""Skills over MCP (SEP-2640): the folders of ``skills/``, with a digest of each file, for hosts that load them."""

from __future__ import annotations

import functools
import mimetypes
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mcp import MCPError
from mcp.server.context import ServerRequestContext
from mcp.server.extension import Extension, MethodBinding, ResourceBinding
from mcp.server.mcpserver.resources import FunctionResource
from mcp.types import INVALID_PARAMS, PaginatedRequestParams, RequestParams

from irsim.common import data_files as resources
from irsim.common.hashing import digest
from irsim.common.text import clean
from irsim_mcp.answers import failure

__all__ = ["Skills", "skill_files"]

_MAIN = "SKILL.md"
_TYPES = {
    ".hpp": "text/x-c++",
    ".md": "text/markdown",
    ".py": "text/x-python",
    ".toml": "application/toml",
    ".yaml": "application/yaml",
    ".yml": "application/yaml",
}
_TEXT = ("text/", "application/yaml", "application/json", "application/toml")
_CACHED: dict[str, Any] = {"ttlMs": 3_600_000, "cacheScope": "public"}
_HEAD = re.compile(r"---\n(.*?)\n---\n", re.DOTALL)
_DESCRIPTION = re.compile(r"^description:[ \t]*(?:[>|][-+]?[ \t]*)?((?:.*)(?:\n[ \t]+.*)*)", re.MULTILINE)


class _Get(RequestParams):
    uri: str


class Skills(Extension):
    """Lists the skills and serves their files.

    Args:
        folder: Folder with one folder per skill; default: the skills of this package.
    """

    identifier = "io.modelcontextprotocol/skills"

    def __init__(self, folder: Path | None = None) -> None:
        self._folders = skill_folders(folder or resources.skills_directory())

    def resources(self) -> Sequence[ResourceBinding]:
        """Each file of each skill, at ``skill://<name>/<path>``."""
        return [
            ResourceBinding(_resource(folder, name, path))
            for folder in self._folders
            for name, path in skill_files(folder).items()
        ]

    def methods(self) -> Sequence[MethodBinding]:
        """``skills/list`` and ``skills/get``."""
        return [
            MethodBinding("skills/list", PaginatedRequestParams, self._list),
            MethodBinding("skills/get", _Get, self._get),
        ]

    async def _list(self, context: ServerRequestContext[Any, Any], params: PaginatedRequestParams) -> dict[str, Any]:
        if params.cursor:
            refused = failure("bad-argument", "there is only one page of skills", where="cursor", fix="leave it out")
            raise MCPError(INVALID_PARAMS, str(refused))
        return {"skills": [_entry(folder) for folder in self._folders], **_CACHED}

    async def _get(self, context: ServerRequestContext[Any, Any], params: _Get) -> dict[str, Any]:
        for folder in self._folders:
            if params.uri == _uri(folder, _MAIN):
                return {"skill": _entry(folder), **_CACHED}
        names = ", ".join(_uri(folder, _MAIN) for folder in self._folders)
        refused = failure("unknown-skill", f"there is no skill {clean(params.uri)!r}", fix=f"the skills are {names}")
        raise MCPError(INVALID_PARAMS, str(refused))


def skill_folders(folder: Path) -> list[Path]:
    """The folders that contain a skill, sorted by name."""
    return sorted(path.parent for path in folder.glob(f"*/{_MAIN}"))


def skill_files(folder: Path) -> dict[str, Path]:
    """Files of a skill by path relative to it; ``SKILL.md`` first."""
    files = {
        path.relative_to(folder).as_posix(): path
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not any(part.startswith((".", "__")) for part in path.relative_to(folder).parts)
    }
    return {_MAIN: files.pop(_MAIN), **files}


def _uri(folder: Path, name: str) -> str:
    return f"skill://{folder.name}/{name}"


def _media_type(name: str) -> str:
    known = _TYPES.get(Path(name).suffix)
    return known or mimetypes.guess_type(name)[0] or "application/octet-stream"


def _content(path: Path, media_type: str) -> str | bytes:
    """The unchanged content of a file; text keeps its line endings, so that it matches the digest."""
    data = path.read_bytes()
    return data.decode("utf-8") if media_type.startswith(_TEXT) else data


def _resource(folder: Path, name: str, path: Path) -> FunctionResource:
    media_type = _media_type(name)
    main = name == _MAIN
    return FunctionResource.from_function(
        functools.partial(_content, path, media_type),
        uri=_uri(folder, name),
        name=folder.name if main else f"{folder.name}/{name}",
        description=_description(path) if main else f"File of the skill {folder.name}.",
        mime_type=media_type,
    )


def _description(main: Path) -> str:
    """The description in the head of a skill, read without a YAML parser, whose import would slow down the start."""
    head = _HEAD.match(main.read_text(encoding="utf-8"))
    match = _DESCRIPTION.search(head[1]) if head else None
    return " ".join(match[1].split()).strip("\"'") if match else ""


def _entry(folder: Path) -> dict[str, Any]:
    """A skill as clients get it: its URI, its head, and all its files with digests."""
    head = _HEAD.match((folder / _MAIN).read_text(encoding="utf-8"))
    frontmatter = resources.read_yaml(head[1]) if head else {}
    files = []
    for name, path in skill_files(folder).items():
        data = path.read_bytes()
        files.append({"uri": _uri(folder, name), "digest": f"sha256:{digest(data)}", "size": len(data)})
    return {"uri": _uri(folder, _MAIN), "frontmatter": frontmatter, "resources": files}
