"""``irsim diff``: list the differences between two scenarios."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.text import Text

from irsim import api
from irsim.cli.guard import FAILED
from irsim.cli.options import Json, Seed
from irsim.cli.output import console, print_json
from irsim.common.text import clean, names_if_different, rounded_pair, shorten_pair
from irsim.diagnostics.diagnostic import Path, format_path
from irsim.scenario.locate import locate
from irsim.scenario.yaml.comments import places_of_comments
from irsim.scenario.yaml.document import load_path
from irsim.scenario.yaml.rewrite import yaml_flow
from irsim.validation.diff.keys import place

if TYPE_CHECKING:
    from irsim.results.validation import ScenarioDiff

__all__ = ["diff"]

_SIGNS = {"added": ("+", "green"), "removed": ("-", "red"), "changed": ("~", "yellow"), "moved": ("~", "yellow")}
MAX_VALUE_LENGTH = 100
"""Longer values are cut off [characters]."""


def diff(
    before: Annotated[str, typer.Argument(metavar="BEFORE", help="Scenario file.", show_default=False)],
    after: Annotated[str, typer.Argument(metavar="AFTER", help="Scenario file after an edit.", show_default=False)],
    seed: Seed = None,
    only: Annotated[
        list[str] | None,
        typer.Option(
            "--only",
            metavar="PATH",
            help="Key that may differ, with all keys below it, such as robot[0].vel_max. Exit with code 1 if another "
            "key or a comment differs, or if a comment is lost. Repeatable.",
        ),
    ] = None,
    run: Annotated[
        bool, typer.Option("--simulate", help="Also simulate the first steps of both with one seed, and compare them.")
    ] = False,
    json_output: Json = False,
) -> None:
    """List the differences between two scenarios: keys of the files, and properties of the resulting worlds.

    Order of keys, layout and equivalent notations do not count. Entries are matched even if others are added or
    removed.
    """
    difference = api.diff(before, after, seed=seed, run=run)
    extra = [
        place(change.change, change.path)
        for change in difference.keys
        if only and not any(_within(change.path, path) for path in only)
    ]
    extra += _comments_outside(difference, after, only) if only and difference.comments_changed else []
    if json_output:
        print_json(difference)
    else:
        _show(difference, extra)
    if extra or (only and difference.comments_lost):
        raise typer.Exit(FAILED)


def _comments_outside(difference: ScenarioDiff, after: str, only: list[str]) -> list[str]:
    """Return the changed comments that belong to keys other than the allowed ones."""
    places: dict[str, list[Path]] = defaultdict(list)
    for comment, about in places_of_comments(load_path(locate(after))):
        places[comment] += about
    return [
        edited.after
        for edited in difference.comments_changed
        if not any(_within(format_path(path), allowed) for path in places.get(edited.after, ()) for allowed in only)
    ]


def _within(path: str, allowed: str) -> bool:
    return path == allowed or path.startswith((f"{allowed}.", f"{allowed}["))


def _show(difference: ScenarioDiff, extra: list[str]) -> None:
    out = console()

    def line(kind: str, where: str, before: Any, after: Any) -> None:
        sign, color = _SIGNS[kind]
        was, now = yaml_flow(before), yaml_flow(after)
        if kind == "changed":
            was, now = shorten_pair(was, now, MAX_VALUE_LENGTH)
        was, now = clean(was, MAX_VALUE_LENGTH), clean(now, MAX_VALUE_LENGTH)
        moved = f"{was} -> {now}"
        change = {"added": now, "removed": was, "changed": moved, "moved": moved}[kind]
        out.print(Text.assemble((f"{sign} {clean(where, 120)}", color), f"  {change}"), soft_wrap=True)

    if difference.keys:
        out.print("in the file", style="bold")
    for change in difference.keys:
        line(change.change, place(change.change, change.path), change.before, change.after)
    facts = [fact for fact in difference.world or [] if not fact.direct]
    if facts:
        out.print("in the world", style="bold")
    for fact in facts:
        line(
            fact.change,
            " ".join(filter(None, (fact.object or "world", fact.key))),
            *rounded_pair(*names_if_different(fact.before, fact.after)),
        )
    if difference.motion is not None:
        out.print("in motion", style="bold")
        for moved in difference.motion or ["no difference"]:
            out.print(Text(clean(moved, 300)), soft_wrap=True)
    for comment in difference.comments_lost:
        out.print(Text.assemble(("comment lost", "red"), f"  {clean(comment, MAX_VALUE_LENGTH)}"), soft_wrap=True)
    for edited in difference.comments_changed:
        line("changed", "comment", edited.before, edited.after)
    out.print(clean(difference.summary, 600), soft_wrap=True)
    if extra:
        out.print(Text(f"not allowed by --only: {clean(', '.join(extra), 400)}", style="bold red"), soft_wrap=True)
