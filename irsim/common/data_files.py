"""Finds the data files: templates, schema and skills, in a checkout or inside an installed package."""

from __future__ import annotations

from pathlib import Path
from typing import Any

__all__ = ["checkout", "published_schema", "read_yaml", "schema_file", "skills_directory", "templates_directory"]

_PACKAGE = Path(__file__).resolve().parents[1]


def checkout() -> Path | None:
    """Root of the repository the package runs from, or None for an installed package.

    A checkout takes precedence, so that an editable install never serves stale copies.
    """
    root = _PACKAGE.parent
    marks = (root / "pyproject.toml", root / "templates", root / "irsim" / "common" / "data_files.py")
    return root if all(mark.exists() for mark in marks) else None


def templates_directory() -> Path:
    """Directory with one folder per template."""
    return (checkout() or _PACKAGE / "_bundled") / "templates"


def schema_file(of: str = "scenario") -> Path:
    """The JSON Schema of scenario files, or of files of another kind."""
    return (checkout() or _PACKAGE / "_bundled") / "schema" / f"{of}.schema.json"


def published_schema(of: str = "scenario") -> str:
    """The address at which the site has that schema, which files name in their first line and keep when they move."""
    return f"https://irsim.github.io/irsim/latest/schema/{of}.schema.json"


def skills_directory() -> Path:
    """Directory with one folder per agent skill (in an installed package, where agents look for them)."""
    root = checkout()
    return root / "skills" if root else _PACKAGE / ".agents" / "skills"


def read_yaml(text: str) -> Any:
    """The data of a trusted YAML text; libyaml, if PyYAML has it, is ten times as fast."""
    import yaml  # imported late: a server needs it only once it is asked for something

    return yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
