"""Pages of the models of realism: the text in ``realism/x.md``, its keys from the program, its plot from a run.

Two comments in a text stand for what is made here: ``<!-- keys: TOPIC KEY … -->`` for a table of keys of a topic of
``irsim describe`` (all that only it has if none is named), and ``<!-- plot -->`` for the plot with its caption.
"""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from answers import keys_table
from pages import Page, contents, link, plain, summary_of
from plots import draw
from realism.validation import Validation

from irsim.lookup import lookup
from irsim.lookup.answer import plain_table

__all__ = ["GROUPS", "example_of", "model_pages", "text_of", "validation_of", "with_models"]

GROUPS = {
    "Motion": ("actuation", "tricycle", "skid_steer", "single_track", "diff_dynamic", "slip"),
    "Lidar": ("lidar_noise", "beam_outcomes", "dark_surfaces", "sweep"),
    "Pose estimates": ("odometry", "imu", "gnss", "localization"),
    "Other sensors": ("detector", "uwb", "sonar", "ir_range"),
}
"""Models in the order of the navigation."""
_TEXTS = Path(__file__).resolve().parent / "realism"
_KEYS = re.compile(r"^<!-- keys: (.*?) -->$", re.MULTILINE)
_PLOT = "<!-- plot -->"
_OVERVIEW = "skills/irsim-benchmark/results/realism"
"""The page with the table of all models, peers and costs."""
_ABOUT = (
    "Each model of realism has a page: what it is, its equation, its keys, its source, and a run of the simulator "
    "beside the equation. Everything here is off unless a key asks for it, seeded, and equal in batches."
)


def text_of(name: str) -> str:
    """The text of a model's page as it is written by hand."""
    return (_TEXTS / f"{name}.md").read_text(encoding="utf-8")


def example_of(name: str) -> str:
    """The scenario in YAML on a model's page."""
    examples = re.findall(r"^```yaml\n(.*?)^```", text_of(name), re.DOTALL | re.MULTILINE)
    assert len(examples) == 1, f"{name}.md has {len(examples)} examples in YAML"
    scenario: str = examples[0]
    return scenario


def validation_of(name: str) -> Validation:
    """The comparison of a model with its law, simulated now."""
    result: Validation = importlib.import_module(f"realism.{name}").validation(example_of(name))
    return result


def _title(name: str) -> str:
    heading = re.match(r"# (.*)", text_of(name))
    assert heading is not None, f"{name}.md begins with a title"
    return heading[1]


def _topics(name: str) -> list[str]:
    """Topics whose keys a page shows."""
    return [words.split()[0] for words in _KEYS.findall(text_of(name))]


def model_pages(where: Mapping[str, str], pictures: Path) -> Iterator[Page]:
    """One page a model, and one that lists them with what was measured.

    Args:
        where: Topic -> page and anchor, for links.
        pictures: Folder for the plots.
    """
    every = {name: validation_of(name) for names in GROUPS.values() for name in names}
    start = "realism/index"
    parts, twins = ["# Realism", _ABOUT], ["# Realism", _ABOUT]
    overview = link("All equations in one table", start, _OVERVIEW)
    parts.append(f"{overview}, with other simulators and costs.")
    heads = ("model", "what is measured", "simulated", "by the equation")
    for group, names in GROUPS.items():
        rows = []
        for name in names:
            one = every[name]
            shown = (one.quantity, one.shown(one.measured), f"{one.shown(one.expected)} {one.margin}")
            rows.append((link(_title(name), start, f"realism/{name}"), *map(plain, shown)))
        table = plain_table(heads, rows).strip()
        twins.append(f"## {group}\n\n{table}")
        parts += [
            f'## {group}\n\n<div class="irsim-numbers">\n\n{table}\n\n</div>',
            contents([f"realism/{name}" for name in names], caption=group, hidden=True),
        ]
    yield Page(start, "\n\n".join(parts), "\n\n".join(twins), "Realism", _ABOUT.partition(": ")[0] + ".")
    for name, one in every.items():
        draw(one, pictures, name)
        yield _page(name, one, where)


def _page(name: str, one: Validation, where: Mapping[str, str]) -> Page:
    page, title = f"realism/{name}", _title(name)

    def keys(comment: re.Match[str]) -> str:
        topic, *chosen = comment[1].split()
        groups = lookup(topic).groups
        listed = [key for group in groups.values() for key in group if key.name in chosen] or groups["keys"]
        assert not chosen or len(listed) == len(chosen), f"{name}.md: {topic} has not all of {chosen}"
        target = where[lookup(topic).topic]
        return f"Keys of {link(topic, page, target)}.\n\n{keys_table(listed, page, f'{name}.{topic}', {})}"

    filled = _KEYS.sub(keys, text_of(name))
    words = f"Plot of {one.y} over {one.x}: simulated points on the lines of the equation"
    pictures = "".join(
        f'<img class="only-{theme} irsim-plot" src="../pictures/realism/{name}-{theme}.svg" alt="{words}" '
        f'width="538" height="{422 if one.paths else 346}" loading="lazy">'
        for theme in ("light", "dark")
    )
    caption = plain(one.caption)
    text = filled.replace(_PLOT, f'<figure class="irsim-plot">{pictures}</figure>\n\n{caption}')
    twin = re.sub(r'<span id="[^"]*"></span>', "", filled)
    twin = twin.replace(_PLOT, f"![{words}](../pictures/realism/{name}-light.svg)\n\n{caption}")
    return Page(page, text, twin, title, summary_of(text_of(name)))


def with_models(pages: list[Page]) -> list[Page]:
    """The same pages; the overview and the pages of components also link the models that they are about."""
    topics = {name: _topics(name) for names in GROUPS.values() for name in names}
    models_of: dict[str, list[str]] = {}
    for name, asked in topics.items():
        for path in dict.fromkeys(_component(topic) for topic in asked):
            if path:
                models_of.setdefault(path, []).append(name)
    return [_linked(page, models_of.get(page.path, [])) for page in pages]


def _component(topic: str) -> str:
    """The page of the component that a topic belongs to; empty for keys of no component."""
    words = lookup(topic).topic.split(".")
    kinds = {"kinematics": "kinematics", "sensors": "sensor"}
    return f"reference/{kinds[words[1]]}/{words[2]}" if len(words) > 2 and words[1] in kinds else ""


def _linked(page: Page, names: list[str]) -> Page:
    if page.path == _OVERVIEW:
        return replace(page, text=_with_links(page.text))
    if not names:
        return page
    links = ", ".join(link(_title(name), page.path, f"realism/{name}") for name in names)
    return replace(page, text=f"{page.text}\n\nEquation, source and validation: {links}.\n")


def _with_links(text: str) -> str:
    """The table of all models, whose first cells lead to their pages."""
    known = {name: name for names in GROUPS.values() for name in names}
    known |= {_title(name).lower(): name for name in known}

    def cell(row: re.Match[str]) -> str:
        parts = [part.strip("`") for part in row[1].split(", ")]
        if not all(part.lower() in known for part in parts):
            return row[0]
        shown = [link(part, _OVERVIEW, f"realism/{known[part.lower()]}") for part in parts]
        return f"| {', '.join(shown)} |"

    return re.sub(r"^\| ([^|]*?) \|", cell, text, flags=re.MULTILINE)
