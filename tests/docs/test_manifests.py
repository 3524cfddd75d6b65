"""Manifests and blocks for agents' hosts: the same package, version, server and skills, and each starts the server."""

from __future__ import annotations

import asyncio
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

import pytest
import yaml
from mcp import Client, StdioServerParameters

from irsim import __version__
from tests.warm import warm

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

pytestmark = pytest.mark.one_python

ROOT = Path(__file__).resolve().parents[2]


def load(name: str) -> dict[str, Any]:
    manifest: dict[str, Any] = json.loads((ROOT / name).read_text(encoding="utf-8"))
    return manifest


SERVER = load("server.json")
CLAUDE, MARKET = load(".claude-plugin/plugin.json"), load(".claude-plugin/marketplace.json")
COPILOT = load(".github/plugin/marketplace.json")
CODEX, GEMINI = load(".codex-plugin/plugin.json"), load("gemini-extension.json")
BUNDLE = load("mcp_server/bundle/manifest.json")
README = (ROOT / "README.md").read_text(encoding="utf-8")
AGENTS = (ROOT / ".ci/site/hand/agents.md").read_text(encoding="utf-8")
TOOLS = {"lookup", "validate_scenario", "render_snapshot", "run_episode", "inspect_run", "benchmark", "get_job"}
SCRIPTS = "/path/to/irsim/.venv/bin"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
MANIFESTS = {
    "claude": CLAUDE,
    "marketplace": MARKET["plugins"][0],
    "copilot": COPILOT["plugins"][0],
    "codex": CODEX,
    "gemini": GEMINI,
    "bundle": BUNDLE,
}
each = pytest.mark.parametrize("manifest", MANIFESTS.values(), ids=MANIFESTS)


def start_of(command: str, args: list[str]) -> tuple[list[str], list[str]]:
    """How the server is started, and what it is told."""
    cut = args.index("--workspace")
    return [command, *args[:cut]], args[cut:]


def test_the_citation_is_of_this_version() -> None:
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert (cited["version"], cited["license"], cited["title"]) == (__version__, PROJECT["license"], "irsim")
    assert cited["authors"] == PROJECT["authors"]
    assert cited["keywords"] == PROJECT["keywords"]
    block = README.partition("```bibtex\n")[2].partition("```")[0]
    assert f"version = {{{__version__}}}" in block


@each
def test_version_and_description_are_those_of_the_server(manifest: dict[str, Any]) -> None:
    assert manifest["version"] == SERVER["version"] == PROJECT["version"] == __version__
    assert manifest["description"] == SERVER["description"]


@pytest.mark.parametrize("manifest", [CLAUDE, CODEX, BUNDLE], ids=["claude", "codex", "bundle"])
def test_license_author_and_keywords_are_those_of_the_package(manifest: dict[str, Any]) -> None:
    assert manifest["license"] == PROJECT["license"]
    assert manifest["author"] == PROJECT["authors"][0] == MARKET["owner"]
    assert manifest["keywords"] == PROJECT["keywords"]


def test_plugins_have_one_name_which_is_that_of_the_tools_prefix() -> None:
    assert {CLAUDE["name"], MARKET["plugins"][0]["name"], CODEX["name"], GEMINI["name"]} == {"irsim"}
    assert BUNDLE["name"] == SERVER["packages"][0]["identifier"]
    assert MARKET["plugins"][0]["source"] == "./"


def test_copilot_finds_the_plugin_that_claude_finds() -> None:
    assert COPILOT == MARKET
    assert set(COPILOT) <= {"name", "owner", "plugins", "metadata"}
    assert {"name", "owner", "plugins"} <= set(COPILOT)
    [plugin] = COPILOT["plugins"]
    assert {"name", "source"} <= set(plugin) <= {"name", "source", "version", "description"}
    assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", plugin["name"])
    assert (ROOT / plugin["source"] / ".claude-plugin" / "plugin.json").is_file()  # one of the places it looks at


def test_each_starts_the_server_of_this_version() -> None:
    program = SERVER["packages"][0]["identifier"]
    assert program in PROJECT["scripts"]
    claude, gemini = CLAUDE["mcpServers"]["irsim"], GEMINI["mcpServers"]["irsim"]
    codex = load(CODEX["mcpServers"])["mcpServers"]["irsim"]
    bundle = BUNDLE["server"]["mcp_config"]
    assert start_of(**claude) == (["uvx", "--from", "${CLAUDE_PLUGIN_ROOT}", program], ["--workspace", "."])
    assert start_of(**gemini) == (["uvx", "--from", "${extensionPath}", program], ["--workspace", "${workspacePath}"])
    assert start_of(**codex) == (["uvx", program], ["--workspace", "."])
    assert start_of(**bundle) == (
        ["uv", "run", "--directory", "${__dirname}", BUNDLE["server"]["entry_point"]],
        ["--workspace", "${user_config.workspace}"],
    )
    assert BUNDLE["user_config"]["workspace"]["type"] == "directory"
    assert BUNDLE["user_config"]["workspace"]["required"] is True
    described = SERVER["packages"][0]["packageArguments"][0]["description"]
    assert BUNDLE["user_config"]["workspace"]["description"] == described


def test_the_bundle_asks_for_this_version_and_starts_it(tmp_path: Path) -> None:
    folder = ROOT / "mcp_server" / "bundle"
    project = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["dependencies"] == [f"{PROJECT['name']}=={PROJECT['version']}"]
    assert project["version"] == PROJECT["version"]
    assert project["requires-python"] == PROJECT["requires-python"] == BUNDLE["compatibility"]["runtimes"]["python"]
    command = [sys.executable, str(folder / BUNDLE["server"]["entry_point"]), "--version"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.stdout == f"irsim-mcp {__version__}\n", done.stderr


def test_skills_are_where_the_plugins_say() -> None:
    assert CLAUDE["skills"] == CODEX["skills"] == "./skills/"
    assert sorted(path.name for path in (ROOT / "skills").iterdir()) == sorted(
        path.parent.name for path in (ROOT / "skills").glob("*/SKILL.md")
    )


def test_keys_are_those_the_hosts_know() -> None:
    assert set(GEMINI) <= {
        *("name", "version", "description", "mcpServers", "contextFileName", "excludeTools", "settings")
    }
    assert re.fullmatch(r"[a-z0-9-]+", GEMINI["name"])
    assert set(CODEX) <= {
        *("name", "version", "description", "author", "homepage", "repository", "license", "keywords", "skills"),
        *("mcpServers", "apps", "hooks", "interface"),
    }
    assert CODEX["mcpServers"].startswith("./")
    assert 1 <= len(CODEX["interface"]["defaultPrompt"]) <= 3
    assert all(len(prompt) <= 128 for prompt in CODEX["interface"]["defaultPrompt"])


def validated(program: str | None, *arguments: str, home: Path) -> None:
    if program is None:
        pytest.skip("the host's validator is not installed")
    environment = {**os.environ, "HOME": str(home)}
    done = subprocess.run(
        [program, *arguments], capture_output=True, text=True, cwd=ROOT, env=environment, check=False, timeout=120
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_mcpb_accepts_the_bundle(tmp_path: Path) -> None:
    validated(shutil.which("mcpb"), "validate", "mcp_server/bundle/manifest.json", home=tmp_path)


@pytest.mark.parametrize("path", [".", ".claude-plugin/plugin.json"])
def test_claude_accepts_the_plugin(path: str, tmp_path: Path) -> None:
    validated(shutil.which("claude"), "plugin", "validate", "--strict", path, home=tmp_path)


def test_claude_installs_the_plugin_by_the_commands_of_the_page(tmp_path: Path) -> None:
    commands = re.findall(r"`claude (plugin [^`]+)`", AGENTS)
    assert len(commands) == 2
    for command in commands:
        words = command.replace("/path/to/irsim", str(ROOT)).split()
        validated(shutil.which("claude"), *words, home=tmp_path)


def blocks(language: str) -> list[str]:
    return re.findall(rf"^ *```{language}\n(.*?)^ *```", AGENTS, re.DOTALL | re.MULTILINE)


def configurations() -> list[dict[str, Any]]:
    """The entry for irsim in each block: two forms of JSON and TOML."""
    loaded = [*map(json.loads, blocks("json")), *map(tomllib.loads, blocks("toml"))]
    return [block.get("mcpServers", block.get("servers", block.get("mcp_servers")))["irsim"] for block in loaded]


def test_each_host_has_a_block_and_each_skill_a_link() -> None:
    for host in ("Claude Code", "Claude Desktop", "Cursor", "Codex", "VS Code"):
        assert host in AGENTS
    for page in (ROOT / "skills").glob("*/SKILL.md"):
        assert f"(../{page.relative_to(ROOT).as_posix()})" in AGENTS
    assert f"<!-- mcp-name: {SERVER['name']} -->" in README  # shows the registry that the package is ours
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
    assert set(re.findall(r"`(\w+)`", AGENTS)) >= TOOLS
    later = AGENTS.partition("Once the package is published")[2].partition("\n\n")[0]
    assert "`uvx`" in later
    assert '["irsim-mcp", "--workspace", …]' in later
    assert AGENTS.count("uvx") == 1


def test_the_skills_are_installed_where_hosts_look(tmp_path: Path) -> None:
    lines = [line for block in blocks("bash") for line in block.splitlines() if "skills install" in line]
    assert len(lines) == 4
    for line in lines:
        command, _, place = line.partition("  #")
        subprocess.run(warm([sys.executable, "-m", *shlex.split(command)]), cwd=tmp_path, check=True, timeout=60)
        assert (tmp_path / place.split(",")[0].strip() / "irsim-scenario" / "SKILL.md").is_file()


def test_server_json_follows_the_registrys_rules() -> None:
    assert SERVER["$schema"] == "https://static.modelcontextprotocol.io/schemas/2025-12-11/server.schema.json"
    assert re.fullmatch(r"[a-zA-Z0-9.-]+/[a-zA-Z0-9._-]+", SERVER["name"])
    assert 3 <= len(SERVER["name"]) <= 200
    assert all(1 <= len(SERVER[key]) <= 100 for key in ("description", "title"))
    assert set(SERVER) <= {
        *("$schema", "name", "title", "description", "version", "repository", "websiteUrl", "icons", "packages"),
        *("remotes", "_meta"),
    }
    assert re.fullmatch(r"\d+\.\d+\.\d+(rc\d+)?", SERVER["version"])  # exact: no range, not "latest"
    assert SERVER["version"] == __version__


def test_server_json_names_the_package_and_how_it_is_started() -> None:
    [package] = SERVER["packages"]
    assert set(package) <= {
        *("registryType", "registryBaseUrl", "identifier", "version", "runtimeHint", "transport", "packageArguments"),
        *("runtimeArguments", "environmentVariables", "fileSha256"),
    }
    assert (package["registryType"], package["registryBaseUrl"]) == ("pypi", "https://pypi.org")
    assert package["identifier"] == PROJECT["name"]
    assert package["version"] == SERVER["version"] == PROJECT["version"]
    assert package["identifier"] in PROJECT["scripts"]  # what uvx runs
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
