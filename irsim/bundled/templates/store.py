"""Finds and reads the bundled templates."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path, PurePosixPath

from irsim.bundled.templates.metadata import Template, TemplateError
from irsim.common import data_files as resources
from irsim.diagnostics.diagnostic import suggestion

__all__ = ["find", "load", "load_all", "meant", "names", "picture_file", "scenario_file"]


def names() -> list[str]:
    """Names of all templates, sorted."""
    return sorted(path.parent.name for path in resources.templates_directory().glob("*/template.yaml"))


def meant(path: str) -> str | None:
    """Name of the template that the path of a missing file means: ``doorway``, ``doorway.yaml``, ``templates/doorway``.

    Args:
        path: The path as the user wrote it.
    """
    parts = PurePosixPath(path.replace("\\", "/")).parts
    if len(parts) > 1 and parts[-1] == "scenario.yaml":
        parts = parts[:-1]
    name = parts[-1].removesuffix(".yaml").removesuffix(".yml").lower() if parts else ""
    return name if name in names() else None


def load(name: str) -> Template:
    """One template.

    Raises:
        TemplateError: No template has that name.
    """
    known = names()
    if name not in known:
        raise TemplateError(
            "unknown-template",
            f"there is no template {name!r}; choose one of {', '.join(known)}.",
            suggestion(name, known, None),
        )
    file = scenario_file(name)
    described = resources.read_yaml(file.with_name("template.yaml").read_text(encoding="utf-8"))
    text = file.read_text(encoding="utf-8")
    return Template.model_validate({"name": name, "text": text, **described})


def load_all() -> list[Template]:
    """All templates, by name."""
    return [load(name) for name in names()]


def find(words: Iterable[str], *, every: bool = False) -> list[Template]:
    """The templates whose name, title, purpose and tags contain the most of some words.

    Args:
        words: Words to look for; without words all templates are found.
        every: Find only templates that contain every word.
    """
    wanted = [word.lower() for phrase in words for word in phrase.split()]
    templates = load_all()
    if not wanted:
        return templates
    scores = {template.name: sum(word in _search_text(template) for word in wanted) for template in templates}
    best = len(wanted) if every else max(scores.values(), default=0)
    return [template for template in templates if best and scores[template.name] == best]


def scenario_file(name: str) -> Path:
    """Path of a template's scenario."""
    return resources.templates_directory() / name / "scenario.yaml"


def picture_file(name: str) -> Path:
    """Path of the picture of a template's start."""
    return resources.templates_directory() / name / "picture.png"


def _search_text(template: Template) -> str:
    return " ".join((template.name, template.title, template.purpose, *template.tags)).lower()
