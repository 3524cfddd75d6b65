"""How commands draw: the style and the theme that are asked for, that the scenario has, or that are usual."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

from irsim.common.text import clean
from irsim.diagnostics.diagnostic import nearest
from irsim.diagnostics.errors import InputError
from irsim.scenario.resolve.resolved import ResolvedScenario

if TYPE_CHECKING:
    from irsim.env import Env

__all__ = ["DEFAULT_STYLE", "STYLES", "THEME_NAMES", "Style", "ThemeName", "dress", "look_options", "with_look"]

Style = Literal["modern", "classic"]
ThemeName = Literal["light", "dark"]
STYLES: tuple[Style, ...] = ("modern", "classic")
THEME_NAMES: tuple[ThemeName, ...] = ("light", "dark")
DEFAULT_STYLE: Style = "modern"
"""Style of what commands draw of a scenario that does not say its style."""


def with_look(
    scenario: ResolvedScenario,
    style: str | None = None,
    theme: str | None = None,
    *,
    printed: bool = False,
    as_strip: bool = False,
) -> ResolvedScenario:
    """The scenario with the style and the theme in which it is drawn.

    Args:
        scenario: The scenario.
        style: ``modern`` or ``classic``; None: the scenario's.
        theme: ``light`` or ``dark``; None: the scenario's.
        printed: Whether the layout for print is asked for.
        as_strip: Whether a strip is asked for.

    Raises:
        InputError: There is no such style or theme, or classic pictures or strips do not have it.
    """
    for given, known, what in ((style, STYLES, "style"), (theme, THEME_NAMES, "theme")):
        if given is not None and given not in known:
            near = nearest(given, known)
            fix = (f"write {near!r}; " if near else "") + f"choose {' or '.join(known)}"
            raise InputError(f"{clean(given, 40)!r} is not a {what} of pictures", fix)
    plot = scenario.world.plot
    chosen = {"style": style or plot.style or DEFAULT_STYLE, "theme": theme or plot.theme}
    if chosen["style"] == "classic" and (theme is not None or printed):
        what = "a layout for print" if printed else "themes"
        raise InputError(f"the style classic does not have {what}", "choose the style modern, or leave this out")
    if printed and as_strip:
        raise InputError("a strip does not have a layout for print", "leave out one of them")
    plot = plot.model_copy(update=chosen)
    return replace(scenario, world=scenario.world.model_copy(update={"plot": plot}))


def dress(env: Env, style: str | None = None, theme: str | None = None) -> None:
    """Let an environment that nothing has been drawn of yet be drawn in a style and a theme; see :func:`with_look`."""
    env.simulation.scenario = with_look(env.simulation.scenario, style, theme)


def look_options(style: str | None, theme: str | None, printed: bool = False) -> list[str]:
    """The options of ``irsim render`` that ask for these."""
    given = [*(["--style", style] if style else []), *(["--theme", theme] if theme else [])]
    return [*given, *(["--print"] if printed else [])]
