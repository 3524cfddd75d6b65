"""Find and read the bundled templates."""

from __future__ import annotations

import yaml

from irsim import resources
from irsim.diagnostics import nearest
from irsim.templates.metadata import Template, TemplateError

__all__ = ["load", "load_all", "names"]


def names() -> list[str]:
    """Names of all templates, sorted."""
    return sorted(path.parent.name for path in resources.templates_directory().glob("*/template.yaml"))


def load(name: str) -> Template:
    """One template.

    Raises:
        TemplateError: There is none of that name.
    """
    known = names()
    if name not in known:
        near = nearest(name, known)
        raise TemplateError(
            "unknown-template",
            f"there is no template {name!r}; there are {', '.join(known)}.",
            f"did you mean {near}?" if near else None,
        )
    folder = resources.templates_directory() / name
    described = yaml.safe_load((folder / "template.yaml").read_text(encoding="utf-8"))
    text = (folder / "scenario.yaml").read_text(encoding="utf-8")
    return Template.model_validate({"name": name, "text": text, **described})


def load_all() -> list[Template]:
    """All templates, by name."""
    return [load(name) for name in names()]
