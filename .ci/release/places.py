"""The places that hold the version of irsim or the owner of its repository: they are read, compared and written here.

``nox -s version -- 0.2.0`` writes the version, ``nox -s version -- --owner NAME`` the owner, which is the name of a
user or an organisation on GitHub. The MCP registry derives the name of the server from it.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
VERSION = r"\d+\.\d+\.\d+(?:rc\d+)?"
"""A release, or a candidate of one."""
OWNER = r"[A-Za-z0-9](?:-?[A-Za-z0-9]){0,38}"
"""How GitHub writes the name of an owner."""

IN_JSON, DEPENDENCY = r'"version": "{}"', r'"irsim-mcp=={}"'
VERSION_PLACES = {
    "pyproject.toml": (r'^version = "{}"',),
    "CITATION.cff": (r"^version: {}$",),
    "README.md": (r"@software\{irsim,.* version = \{{}\}",),
    "server.json": (IN_JSON,),
    "gemini-extension.json": (IN_JSON,),
    ".claude-plugin/*.json": (IN_JSON,),
    ".codex-plugin/plugin.json": (IN_JSON,),
    ".github/plugin/marketplace.json": (IN_JSON,),
    "mcp_server/bundle/manifest.json": (IN_JSON,),
    "mcp_server/bundle/pyproject.toml": (r'^version = "{}"', DEPENDENCY),
    "skills/*/SKILL.md": (r'^  version: "{}"$',),
    "skills/*/scripts/*.py": (rf"^# dependencies = \[{DEPENDENCY}\]",),
}
"""Files -> patterns of the lines with the version, for which ``{}`` stands. A script may have no such line."""
OWNER_PLACES = {
    "server.json": (r'"name": "io\.github\.{}/irsim-mcp"',),
    "README.md": (r"<!-- mcp-name: io\.github\.{}/irsim-mcp -->", r"https://{}\.github\.io/"),
    "irsim/common/data_files.py": (r"https://{}\.github\.io/",),
    "schema/scenario.schema.json": (r'"\$id": "https://{}\.github\.io/',),
    ".github/CODEOWNERS": (r"^\* @{}$",),
}
"""Files -> patterns of the lines with the owner."""
RECORDS = {
    "CHANGELOG.md": "says what changed in each version",
    "skills/irsim-benchmark/results/": "tables of runs, which stay true for the version that made them",
    "skills/irsim-runner/recipes/": "trainings, with the version that they were made with",
    "evals/transcripts/": "recordings of agents",
    "skills/irsim-dev/examples/new-sensor/pyproject.toml": "the version of another package",
    "tests/": "made-up files; what must be the version of today is read there from the package",
    ".ci/": "shows how a version is written",
    "irsim/common/installed.py": "shows how a version is written",
}
"""Files that may hold another version than this one: path, or its beginning -> why."""

Place = tuple[Path, int, int, str]
"""File, begin and end of the value in its text, and the value."""


def places(patterns: dict[str, tuple[str, ...]], form: str, root: Path = ROOT) -> Iterator[Place]:
    """Every place that the patterns describe.

    Raises:
        SystemExit: A file is missing, or lacks a line that it should have.
    """
    for name, lines in patterns.items():
        files = sorted(root.glob(name))
        count = 0
        for file in files:
            text = file.read_text(encoding="utf-8")
            for line in lines:
                for match in re.finditer(line.replace("{}", f"({form})", 1), text, re.MULTILINE):
                    count += 1
                    yield file, *match.span(1), match[1]
        if count < (len(lines) if "*" in name else len(lines) * len(files) or 1):
            raise SystemExit(f"{name}: no line like {' or '.join(lines)}")


def the_value(patterns: dict[str, tuple[str, ...]], form: str, root: Path = ROOT) -> str:
    """The value that all places hold.

    Raises:
        SystemExit: They differ; the message lists them.
    """
    rows = [(file.relative_to(root).as_posix(), value) for file, _, _, value in places(patterns, form, root)]
    values = {value for _, value in rows}
    if len(values) > 1:
        raise SystemExit("places differ:\n" + "\n".join(f"  {value}  {name}" for name, value in rows))
    return rows[0][1]


def version(root: Path = ROOT) -> str:
    """The version, which all places agree about."""
    return the_value(VERSION_PLACES, VERSION, root)


def owner(root: Path = ROOT) -> str:
    """The owner, whom all places agree about."""
    return the_value(OWNER_PLACES, OWNER, root)


def write(patterns: dict[str, tuple[str, ...]], form: str, new: str, root: Path = ROOT) -> int:
    """Put a value into all places; returns their number."""
    if not re.fullmatch(form, new):
        raise SystemExit(f"{new!r} is not of the form that is needed, such as 0.2.0, 0.2.0rc1 or an owner's name")
    # From the last place of a file to its first: what stands before a place does not move.
    rows = sorted(places(patterns, form, root), key=lambda row: row[:2], reverse=True)
    for file, begin, end, _ in rows:
        text = file.read_bytes().decode()
        file.write_bytes(f"{text[:begin]}{new}{text[end:]}".encode())
    return len(rows)


def unlisted(root: Path = ROOT) -> list[str]:
    """Lines of tracked files that name irsim or a version, hold today's version and are neither place nor record."""
    now = version(root)
    command = ["git", "grep", "-nIE", rf"(^|[^0-9.]){re.escape(now)}([^0-9.]|\.?$|\.[^0-9])"]
    grep = subprocess.run(command, cwd=root, capture_output=True, text=True, encoding="utf-8", check=False)
    listed = set()
    for file, begin, _, _ in places(VERSION_PLACES, VERSION, root):
        line = file.read_text(encoding="utf-8").count("\n", 0, begin) + 1
        listed.add(f"{file.relative_to(root).as_posix()}:{line}")
    return [
        row
        for row in grep.stdout.splitlines()
        if re.search("irsim|version", row.split(":", 2)[2], re.IGNORECASE)
        and not row.startswith(tuple(RECORDS))
        and ":".join(row.split(":", 2)[:2]) not in listed
    ]


def check_changelog(now: str, root: Path = ROOT) -> str:
    """The section of a version in the changelog, without its heading.

    Raises:
        SystemExit: The section is missing or empty.
    """
    text = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    final = now.partition("rc")[0]
    heading = rf"^## \[?{re.escape(final)}\]?(?!\S)[^\n]*\n"
    section = re.search(rf"{heading}(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
    if section is None or not section[1].strip():
        raise SystemExit(f"CHANGELOG.md has no section '## [{final}] - DATE' with entries")
    return section[1].strip() + "\n"


def check_tag(tag: str, root: Path = ROOT) -> str:
    """The version that a tag names, if all places and the changelog have it."""
    now = version(root)
    if tag != f"v{now}":
        raise SystemExit(f"the tag {tag} is not v{now}, which pyproject.toml and the other places hold")
    check_changelog(now, root)
    return now


def main() -> None:
    """Write values, or say what the places hold."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("version", nargs="?", help="written into every place, such as 0.2.0 or 0.2.0rc1")
    parser.add_argument("--owner", help="written into every place, and so into the name in the MCP registry")
    parser.add_argument("--tag", help="fail unless this tag names the version that all places and the changelog have")
    parser.add_argument(
        "--owned-by", help="fail unless this is the owner in all places: who pushes the tag owns the name"
    )
    parser.add_argument("--notes", action="store_true", help="print the section of the changelog, and nothing else")
    given = parser.parse_args()
    if given.version:
        count = write(VERSION_PLACES, VERSION, given.version)
        print(f"version {given.version} in {count} places", file=sys.stderr)
    if given.owner:
        count = write(OWNER_PLACES, OWNER, given.owner)
        print(f"owner {given.owner} in {count} places", file=sys.stderr)
    if given.tag:
        check_tag(given.tag)
    if given.owned_by and given.owned_by.lower() != owner().lower():
        raise SystemExit(
            f"the repository belongs to {given.owned_by}, the places name {owner()}: write it with --owner"
        )
    if given.notes:
        print(check_changelog(version()), end="")
    else:
        print(f"version={version()}\nowner={owner()}")


if __name__ == "__main__":
    main()
