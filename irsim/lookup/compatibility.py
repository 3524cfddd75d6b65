"""Makes the published page about IR-SIM 2.12, ``irsim/compat/README.md``: one row per key and per public name."""

from __future__ import annotations

from collections.abc import Iterator

from irsim.compat.changed_scenes import CHANGED_SCENES
from irsim.compat.differences import ABSENT, DIFFERENCES, EXTENSIONS, FEATURES, KEY_DIFFERENCES, NAME_DIFFERENCES
from irsim.compat.names import reference_names
from irsim.lookup.schema_walk import Node, mappings
from irsim.lookup.tables import plain_table
from irsim.options.registry import REGISTRIES

__all__ = ["page"]

_INTRO = (
    "Scenario files and Python programs for IR-SIM 2.12 run without changes. *same* means the same meaning, defaults, "
    "units and array shapes. An id refers to an intended difference in the first table. *added* marks optional keys "
    "of irsim, which do not change the meaning of existing files."
)

_SCENES = (
    "These scenes of irsim itself moved in another way before the difference. All other templates and all scenes "
    "recorded from 2.12 move as before; its recorded decisions, too, with `turning: fixed`, `keep_gap: false`, and "
    "without static lines (D6) and `acce` (D28)."
)


def page(schema: Node) -> str:
    """Return the page as Markdown.

    Args:
        schema: JSON Schema of the language.
    """
    ids = [(f"`{name}`", one.theirs, one.ours, one.why) for name, one in DIFFERENCES.items()]
    scenes = [(f"`{place}`", one.difference, one.why) for place, one in CHANGED_SCENES.items()]
    parts = [
        "# Compatibility with IR-SIM 2.12",
        "<!-- Written by `python -m irsim.lookup.reference`: do not edit. -->",
        _INTRO,
        "## Intended differences\n\n" + plain_table(("id", "IR-SIM 2.12", "irsim", "why"), ids),
        f"## Scenes that move otherwise\n\n{_SCENES}\n\n" + plain_table(("scene", "id", "why"), scenes),
        "## Keys of scenarios\n\n" + plain_table(("key", "compared with 2.12"), _keys(schema)),
    ]
    parts += [
        f"## `{place.replace(':', '.')}`\n\n" + plain_table(("name", "compared with 2.12"), rows)
        for place, rows in _names()
    ]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def _keys(schema: Node) -> list[tuple[str, str]]:
    language = max(mappings(schema, schema), key=lambda option: len(option["properties"]))["properties"]
    rows: list[tuple[str, str]] = []
    for section, name in (("world", "world"), ("robot", "entry")):
        [keys] = [option["properties"] for option in mappings(schema, language[section])]
        rows += [_key_row(f"{name}.{key}") for key in keys]
    for kind, registry in REGISTRIES.items():
        for feature in registry.features():
            place = f"{kind}.{feature.name}"
            keys = [f"{place}.{key}" for key in feature.options.model_fields if key != "name"]
            if feature.name not in FEATURES[kind]:
                rows += [(f"`{one}`", f"added: {EXTENSIONS.get(place, 'of irsim')}") for one in (place, *keys)]
            else:
                rows += [_key_row(place), *(_key_row(key, kind) for key in keys)]
    return rows


def _key_row(place: str, kind: str = "") -> tuple[str, str]:
    short = f"{kind}.{place.rpartition('.')[2]}" if kind else place
    owner = place.rpartition(".")[0]
    added = EXTENSIONS.get(place) or (EXTENSIONS.get(owner) if kind else None)
    if added is not None:
        return f"`{place}`", f"added: {added}"
    return f"`{place}`", KEY_DIFFERENCES.get(place) or KEY_DIFFERENCES.get(short) or "same"


def _names() -> Iterator[tuple[str, list[tuple[str, str]]]]:
    for place, names in reference_names().items():
        owner = place.partition(":")[2] or place
        rows = []
        for name in names:
            difference = NAME_DIFFERENCES.get(f"{owner}.{name}", "same")
            absent = ABSENT.get(f"{place}.{name}") or ABSENT.get(place)
            rows.append((f"`{name}`", f"missing: {absent}" if absent else difference))
        if rows:
            yield place, rows
