"""The gallery: a page for each template, with the replay of its reference run."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from pages import Page, anchor, cell, contents, link, plain

import irsim
from irsim.bundled import templates
from irsim.bundled.templates import Template
from irsim.lookup import Key, lookup
from irsim.lookup.answer import facts, plain_table
from irsim.results.run import RunResult
from irsim.scenario.yaml.modeline import without_modeline
from irsim_mcp.reference import explanation

__all__ = ["SEED", "gallery_pages", "player"]

SEED = 7
"""Seed of the reference runs."""


def gallery_pages(players: Path) -> Iterator[Page]:
    """Run each template, write its player, and yield its page; the first page shows all of them.

    Args:
        players: Folder for the players, one file a template.
    """
    players.mkdir(parents=True, exist_ok=True)
    every = templates.load_all()
    pages = [_page(one, _reference_run(one.name, players)) for one in every]
    cards = [
        f'<a class="irsim-card" href="{one.name}.html"><img src="../_images/template-{one.name}.png" '
        f'alt="Start of {one.name}" width="400" height="300" loading="lazy">'
        f"<strong>{one.title}</strong><span>{one.name}</span></a>"
        for one in every
    ]
    intro = (
        f"Each of these {len(every)} scenarios ships with irsim. `irsim new NAME` writes it to a file, with parameters "
        "of your choice; its page plays the run."
    )
    rows = [(link(one.name, "gallery/index", f"gallery/{one.name}"), cell(one.purpose)) for one in every]
    table = plain_table(("template", "what it shows"), rows)
    text = (
        f'# Gallery\n\n{intro}\n\n<div class="irsim-cards">\n' + "\n".join(cards) + f"\n</div>\n\n## By name\n\n{table}"
    )
    listed = contents([page.path for page in pages], hidden=True)
    yield Page(
        "gallery/index", f"{text}\n{listed}", explanation("templates", None), "Gallery", "All templates, playing."
    )
    yield from pages


def player(name: str) -> str:
    """File name of the player of a template."""
    return f"{name}.html"


def _reference_run(name: str, players: Path) -> RunResult:
    with tempfile.TemporaryDirectory() as folder:
        before = Path.cwd()
        os.chdir(folder)  # the record names the file as it was given
        try:
            Path(f"{name}.yaml").write_text(templates.fill(templates.load(name), {}), encoding="utf-8")
            result = irsim.run(f"{name}.yaml", seed=SEED, record=name)
            irsim.replay(name, players / player(name))
        finally:
            os.chdir(before)
    return result


def _page(one: Template, result: RunResult) -> Page:
    page, name = f"gallery/{one.name}", one.name
    keys = [key for group in lookup(name).groups.values() for key in group]
    setting = f" --set {keys[0].name}={keys[0].default}" if keys else ""
    shown = (
        f'<iframe class="irsim-player" src="../players/{player(name)}" title="Replay of {name}" loading="lazy">'
        "</iframe>"
    )
    commands = (
        f"irsim new {name}{setting}",
        f"irsim run {name}.yaml --seed {SEED}",
        f"irsim render {name}.yaml -o {name}.png",
    )
    parts = [
        f"# {one.title}",
        plain(one.purpose),
        shown,
        f"The reference run has seed {result.seed}. {_ending(result)} {cell(one.prospect())}",
        "## Start from it\n\n```bash\n" + "\n".join(commands) + "\n```",
    ]
    if keys:
        parts.append("## Parameters\n\n" + plain_table(("name", "takes", "meaning"), (_row(name, key) for key in keys)))
    parts.append(f"## The start\n\n![The start of {name}](/pictures/template-{name}.png)")
    parts.append(f"## The scenario\n\n```yaml\n{without_modeline(one.text).strip()}\n```")
    parts.append(f"Tags: {', '.join(one.tags)}.")
    return Page(page, "\n\n".join(parts), explanation(name, None), one.title, one.purpose)


def _row(name: str, key: Key) -> tuple[str, str, str]:
    return anchor(f"{name}.{key.name}") + f"`{key.name}`", cell(facts(key)), cell(key.text)


def _ending(result: RunResult) -> str:
    outcome = str(result.outcome).replace("_", " ")
    return f"Its outcome is **{outcome}**, after {result.steps} steps, at {result.sim_time:g} s: {cell(result.summary)}"
