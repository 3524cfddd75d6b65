"""Blocks in the README and server.json for agents' hosts: each is valid, starts the server, and follows the rules."""

from __future__ import annotations

import asyncio
import json
import re
import shlex
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

import pytest
from mcp import Client, StdioServerParameters

from irsim import __version__
from tests.warm import warm

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
SECTION = README.partition("## For agents\n")[2].partition("\n## ")[0]
SERVER = json.loads((ROOT / "server.json").read_text(encoding="utf-8"))
TOOLS = {"lookup", "validate_scenario", "render_snapshot", "run_episode", "inspect_run", "benchmark", "get_job"}
SCRIPTS = "/path/to/irsim/.venv/bin"


def blocks(language: str) -> list[str]:
    return re.findall(rf"^ *```{language}\n(.*?)^ *```", SECTION, re.DOTALL | re.MULTILINE)


def configurations() -> list[dict[str, Any]]:
    """The entry for irsim in each block: two forms of JSON and TOML."""
    loaded = [*map(json.loads, blocks("json")), *map(tomllib.loads, blocks("toml"))]
    return [block.get("mcpServers", block.get("servers", block.get("mcp_servers")))["irsim"] for block in loaded]


def test_each_host_has_a_block() -> None:
    for host in ("Claude Code", "Claude Desktop", "Cursor", "Codex", "VS Code"):
        assert host in SECTION
    keys = [next(iter(json.loads(block))) for block in blocks("json")]
    assert keys == ["mcpServers", "servers"]
    assert [list(tomllib.loads(block)) for block in blocks("toml")] == [["mcp_servers"]]


async def served(command: str, arguments: list[str], mode: str) -> tuple[str, set[str]]:
    server = StdioServerParameters(command=command, args=arguments)
    async with Client(server, mode=mode) as client:
        tools = await client.list_tools()
        return client.server_info.name, {tool.name for tool in tools.tools}


@pytest.mark.parametrize("mode", ["auto", pytest.param("legacy", marks=pytest.mark.slow)])
@pytest.mark.parametrize("index", [0, *(pytest.param(index, marks=pytest.mark.slow) for index in (1, 2))])
def test_the_command_of_each_block_starts_a_server_that_answers(tmp_path: Path, index: int, mode: str) -> None:
    entry = configurations()[index]
    assert set(entry) <= {"type", "command", "args"}
    assert entry.get("type", "stdio") == "stdio"
    folder, _, program = entry["command"].rpartition("/")
    assert folder == SCRIPTS
    arguments = [word.replace("/path/to/scenarios", str(tmp_path)) for word in entry["args"]]
    assert str(tmp_path) in arguments
    installed = str(Path(sysconfig.get_path("scripts"), program))  # a clone's environment, this one
    name, tools = asyncio.run(served(installed, arguments, mode))
    assert name == "irsim"
    assert tools == TOOLS


def test_the_tools_are_named_and_the_published_form_is_called_future() -> None:
    assert set(re.findall(r"`(\w+)`", SECTION)) >= TOOLS
    later = SECTION.partition("Once the package is published")[2].partition("\n\n")[0]
    assert "`uvx`" in later
    assert '["irsim-mcp", "--workspace", …]' in later
    assert SECTION.count("uvx") == 1


def test_the_skills_are_installed_where_hosts_look(tmp_path: Path) -> None:
    lines = [line for block in blocks("bash") for line in block.splitlines()]
    assert len(lines) == 4
    for line in lines:
        command, _, place = line.partition("  #")
        subprocess.run(warm([sys.executable, "-m", *shlex.split(command)]), cwd=tmp_path, check=True, timeout=60)
        assert (tmp_path / place.split(",")[0].strip() / "irsim-scenario" / "SKILL.md").is_file()


def test_every_skill_is_named() -> None:
    for page in (ROOT / "skills").glob("*/SKILL.md"):
        assert f"({page.relative_to(ROOT).as_posix()})" in SECTION


def test_the_registry_can_see_that_the_package_is_ours() -> None:
    assert f"<!-- mcp-name: {SERVER['name']} -->" in README


def test_server_json_follows_the_registrys_rules() -> None:
    assert SERVER["$schema"] == "https://static.modelcontextprotocol.io/schemas/2025-12-11/server.schema.json"
    assert re.fullmatch(r"[a-zA-Z0-9.-]+/[a-zA-Z0-9._-]+", SERVER["name"])
    assert 3 <= len(SERVER["name"]) <= 200
    assert 1 <= len(SERVER["description"]) <= 100
    assert 1 <= len(SERVER["title"]) <= 100
    assert set(SERVER) <= {
        *("$schema", "name", "title", "description", "version", "repository", "websiteUrl", "icons", "packages"),
        *("remotes", "_meta"),
    }
    assert re.fullmatch(r"\d+\.\d+\.\d+", SERVER["version"])  # exact: no range, not "latest"
    assert SERVER["version"] == __version__


def test_server_json_names_the_package_and_how_it_is_started() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    [package] = SERVER["packages"]
    assert set(package) <= {
        *("registryType", "registryBaseUrl", "identifier", "version", "runtimeHint", "transport", "packageArguments"),
        *("runtimeArguments", "environmentVariables", "fileSha256"),
    }
    assert (package["registryType"], package["registryBaseUrl"]) == ("pypi", "https://pypi.org")
    assert package["identifier"] == project["name"]
    assert package["version"] == SERVER["version"] == project["version"]
    assert package["identifier"] in project["scripts"]  # what uvx runs
    assert package["runtimeHint"] == "uvx"
    assert package["transport"] == {"type": "stdio"}
    for argument in package["packageArguments"]:
        assert argument["type"] == "named"
        assert argument["format"] in {"string", "number", "boolean", "filepath"}


def test_arguments_of_server_json_are_the_servers_own() -> None:
    command = warm([sys.executable, "-m", "irsim_mcp", "--help"])
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    for argument in SERVER["packages"][0]["packageArguments"]:
        assert argument["name"] in done.stdout
