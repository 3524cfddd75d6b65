"""Skills over MCP: the same files as in the folders, with digests."""

from __future__ import annotations

import base64
import hashlib
from pathlib import Path
from typing import Any

import pytest
import yaml
from mcp import MCPError
from mcp.server import MCPServer
from mcp.types import BlobResourceContents, Request, TextResourceContents
from pydantic import BaseModel, ConfigDict

from irsim.common.data_files import skills_directory
from irsim_mcp.skills import Skills, _description, skill_files
from tests.mcp.conftest import Caller, connected

pytestmark = pytest.mark.anyio

FOLDERS = sorted(path.parent for path in skills_directory().glob("*/SKILL.md"))


class Anything(BaseModel):
    model_config = ConfigDict(extra="allow")


async def asked(client: Any, method: str, **params: Any) -> dict[str, Any]:
    kind = Request[dict[str, Any], str]
    answer = await client.session.send_request(kind(method=method, params=params), Anything)
    return dict(answer.model_dump())


async def test_list_names_every_file_with_its_digest(client: Caller) -> None:
    answer = await asked(client, "skills/list")
    assert answer["cacheScope"] == "public"
    assert answer["ttlMs"] > 0
    assert [entry["uri"] for entry in answer["skills"]] == [f"skill://{f.name}/SKILL.md" for f in FOLDERS]
    for folder, entry in zip(FOLDERS, answer["skills"], strict=True):
        head = (folder / "SKILL.md").read_text(encoding="utf-8").split("---\n")[1]
        assert entry["frontmatter"] == yaml.safe_load(head)
        assert {item["uri"].removeprefix(f"skill://{folder.name}/") for item in entry["resources"]} == {
            path.relative_to(folder).as_posix()
            for path in folder.rglob("*")
            if path.is_file() and "__pycache__" not in path.parts
        }
        assert (await asked(client, "skills/get", uri=entry["uri"]))["skill"] == entry
        for item in entry["resources"]:
            (content,) = (await client.read_resource(item["uri"])).contents
            data = (
                content.text.encode() if isinstance(content, TextResourceContents) else base64.b64decode(content.blob)
            )
            assert len(data) == item["size"]
            assert item["digest"] == f"sha256:{hashlib.sha256(data).hexdigest()}"
            assert isinstance(content, BlobResourceContents) == item["uri"].endswith((".png", ".jpg"))


async def test_resources_tell_what_skills_are_for(empty: Path) -> None:
    async with connected(empty, "legacy") as client:
        listed = {str(item.uri): item for item in (await client.list_resources()).resources}
    for folder in FOLDERS:
        head = yaml.safe_load((folder / "SKILL.md").read_text(encoding="utf-8").split("---\n")[1])
        resource = listed[f"skill://{folder.name}/SKILL.md"]
        assert resource.description == " ".join(head["description"].split())
        assert resource.mime_type == "text/markdown"


async def test_others_are_unknown(client: Caller) -> None:
    for uri in ("skill://nothing/SKILL.md", f"skill://{FOLDERS[0].name}", "file:///etc/passwd"):
        with pytest.raises(MCPError) as caught:
            await asked(client, "skills/get", uri=uri)
        assert caught.value.error.code == -32602
    for uri in (f"skill://{FOLDERS[0].name}/../../pyproject.toml", f"skill://{FOLDERS[0].name}/nothing.md"):
        with pytest.raises(MCPError):
            await client.read_resource(uri)


@pytest.mark.parametrize(
    "head",
    ["description: One line.", 'description: "Quoted, one line."', "description: >-\n  Two\n  lines.\nlicense: MIT"],
)
def test_descriptions(tmp_path: Path, head: str) -> None:
    file = tmp_path / "SKILL.md"
    file.write_text(f"---\nname: x\n{head}\n---\n\nText\n", encoding="utf-8")
    assert _description(file) == yaml.safe_load(head)["description"]


def test_hidden_and_compiled_files_stay_out(tmp_path: Path) -> None:
    for name in ("SKILL.md", "scripts/a.py", "scripts/__pycache__/a.pyc", ".git/config"):
        (tmp_path / "x" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "x" / name).write_text("---\nname: x\ndescription: y\n---\n", encoding="utf-8")
    assert list(skill_files(tmp_path / "x")) == ["SKILL.md", "scripts/a.py"]
    assert MCPServer("x", extensions=[Skills(tmp_path)])
