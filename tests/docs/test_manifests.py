"""The manifests for agents' hosts name the same package, version, server and skills."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from irsim import __version__

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[2]


def load(name: str) -> dict[str, Any]:
    manifest: dict[str, Any] = json.loads((ROOT / name).read_text(encoding="utf-8"))
    return manifest


SERVER = load("server.json")
CLAUDE, MARKET = load(".claude-plugin/plugin.json"), load(".claude-plugin/marketplace.json")
COPILOT = load(".github/plugin/marketplace.json")
CODEX, GEMINI = load(".codex-plugin/plugin.json"), load("gemini-extension.json")
BUNDLE = load("mcp_server/bundle/manifest.json")
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
    assert (
        BUNDLE["user_config"]["workspace"]["description"] == SERVER["packages"][0]["packageArguments"][0]["description"]
    )


def test_the_bundle_asks_for_this_version_and_starts_it(tmp_path: Path) -> None:
    folder = ROOT / "mcp_server" / "bundle"
    project = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["dependencies"] == [f"{PROJECT['name']}=={PROJECT['version']}"]
    assert project["version"] == PROJECT["version"]
    assert project["requires-python"] == PROJECT["requires-python"] == BUNDLE["compatibility"]["runtimes"]["python"]
    done = subprocess.run(
        [sys.executable, str(folder / BUNDLE["server"]["entry_point"]), "--version"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    assert done.stdout == f"irsim-mcp {__version__}\n", done.stderr


def test_skills_are_where_the_plugins_say() -> None:
    assert CLAUDE["skills"] == CODEX["skills"] == "./skills/"
    assert sorted(path.name for path in (ROOT / "skills").iterdir()) == sorted(
        path.parent.name for path in (ROOT / "skills").glob("*/SKILL.md")
    )


def test_keys_are_those_the_hosts_know() -> None:
    assert set(GEMINI) <= {
        "name",
        "version",
        "description",
        "mcpServers",
        "contextFileName",
        "excludeTools",
        "settings",
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


def test_claude_installs_the_plugin_by_the_readmes_commands(tmp_path: Path) -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    commands = re.findall(r"`claude (plugin [^`]+)`", readme)
    assert len(commands) == 2
    for command in commands:
        words = command.replace("/path/to/irsim", str(ROOT)).split()
        validated(shutil.which("claude"), *words, home=tmp_path)
