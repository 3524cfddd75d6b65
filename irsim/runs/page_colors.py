"""Colours of the style `modern` for pages that follow the colour scheme of the reader."""

from __future__ import annotations

from collections.abc import Sequence

from irsim.graphics.scene.theme import DARK, LIGHT, Theme

__all__ = ["scheme_rules"]


def scheme_rules(names: Sequence[str]) -> str:
    """Rules of a style sheet with some colours of the themes as variables, dark where the reader prefers that.

    Args:
        names: Names of colours in the table of the themes, such as ``page`` and ``ink``.
    """
    light, dark = _variables(LIGHT, names), _variables(DARK, names)
    return f":root {{ {light} }}\n@media screen and (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}"


def _variables(theme: Theme, names: Sequence[str]) -> str:
    return " ".join(f"--{name}: {theme.tokens[name]};" for name in names)
