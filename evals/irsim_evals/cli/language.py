"""``irsim-evals predicates``, ``selections`` and ``properties``: what a case can say, read from its declarations."""

from __future__ import annotations

import math
import re
import types
from collections.abc import Iterator
from inspect import cleandoc
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

import typer
import yaml
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from irsim.cli.output import console
from irsim.common.field_docs import field_docs
from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import ArgumentError
from irsim.scenario.yaml.formatting import flow
from irsim_evals.cases.expressions import substitute
from irsim_evals.cases.store import case_files, case_of, raw_case
from irsim_evals.grader.matching import TOLERANCES, Counted, Match, Quantity, Seeds
from irsim_evals.grader.predicates._base import registered, stands_at_start
from irsim_evals.grader.properties import PROPERTIES
from irsim_evals.grader.selection import BUILT_IN, Selector
from irsim_evals.grader.words import Listed, OneOf, Regex

__all__ = ["examples", "predicates", "properties", "selections"]

_SUBJECTS = {
    "scene": "the world at its start", "seeds": "worlds of several seeds",
    "episode": "an episode: it belongs under episodes", "answer": "files and replies",
}  # fmt: skip
_UNITS = {"length": "m", "size": "m", "speed": "m/s", "rate": "rad/s", "time": "s", "angle": "rad", "heading": "rad",
          "axis": "rad", "share": "share", "count": "number", "name": "word", "flag": "true or false",
          "aspect": "ratio", "area": "m²"}  # fmt: skip
_TYPES: list[tuple[Any, str]] = [
    (Quantity, "number"), (Counted, "count"), (Seeds, "seeds"), (Regex, "regular expression"), (Match, "values"),
    (bool, "true or false"), (Any, "value"), (str, "text"), (int, "number"), (float, "number"),
]  # fmt: skip
_MATCH = "values: one value, or a mapping of these keys, all of which must hold"
_NUMBERS = "number: in m, rad and s, or with a unit: 35cm, 90deg, 3.6km/h, 2min, 80%"


def predicates(
    name: Annotated[str | None, typer.Argument(metavar="[NAME]", help="A predicate; default: a list of all.")] = None,
) -> None:
    """Say what assertions there are, and what their keys mean."""
    known = registered()
    if name is None:
        firsts = {name: _plain(one.__doc__).split(". ")[0].rstrip(".") for name, one in known.items()}
        return _show(_beside({name: f"{first}." for name, first in firsts.items()}))
    if name not in known:
        raise ArgumentError(f"no predicate is called {name!r}", suggestion(name, known, "irsim-evals predicates"))
    one, example = known[name], examples().get(name)
    at_start = one.subject == "episode" and stands_at_start(one)
    place = ", or under assert, where it is about the start" * at_start
    lines = [f"{name}: {_plain(one.__doc__)}", f"It is about {_SUBJECTS[one.subject]}{place}.", "", *_keys(one), ""]
    lines += [f"example ({example[0]}): {{id: a-name, {name}: {example[1]}}}", ""] if example else []
    return _show([*lines, _NUMBERS, _MATCH, *_keys(Match)])


def selections() -> None:
    """Say which selections of bodies every case has, and how it defines its own."""
    keys = {name: flow(one.model_dump(exclude_defaults=True)).strip("{}") for name, one in BUILT_IN.items()}
    built_in = _beside({f"  {name}": text or "every body" for name, text in keys.items()})
    own = "A case defines its own under select, such as boxes: {among: solids, shape: rectangle}."
    _show(["Every case has these:", *built_in, "", own, *_keys(Selector)])


def properties() -> None:
    """Say which properties of bodies selections and assertions can name, with their units and tolerances."""
    texts = {}
    for name, one in PROPERTIES.items():
        relative, absolute = TOLERANCES.get(one.kind, (0.0, 0.0))
        wide = [f"{relative:.0%}"] * bool(relative) + [f"{absolute:.2g}"] * bool(absolute)
        about = _UNITS.get(name, _UNITS[one.kind]) + (f", ± {' or '.join(wide)}" if wide else "")
        texts[name] = f"{about:18}  {_plain(one.sentence)}"
    _show(_beside(texts))


def examples() -> dict[str, tuple[str, str]]:
    """Predicate → its shortest use in a published case: the id of the case, and the value as one line of YAML.

    One that needs no selections of its own case is preferred.
    """
    uses_of: dict[str, list[tuple[bool, int, str, str]]] = {}
    for case_id in case_files():
        raw, values = raw_case(case_id), case_of(case_id).values
        for item in [item for plan in (raw, *raw.get("episodes", ())) for item in plan.get("assert", ())]:
            for name in registered().keys() & item.keys():
                text = _line(substitute(item[name], values))
                own = bool(set(re.findall(r"[\w-]+", text)) & set(raw.get("select", ())))
                uses_of.setdefault(name, []).append((own, len(text), case_id, text))
    return {name: min(uses)[2:] for name, uses in uses_of.items()}


def _line(value: Any) -> str:
    """A value as one line of YAML."""
    return yaml.safe_dump(value, default_flow_style=True, width=math.inf, sort_keys=False, allow_unicode=True).strip()


def _beside(texts: dict[str, str]) -> list[str]:
    """A line for each name, with its text in a second column."""
    width = max(map(len, texts))
    return [f"{name:{width}}  {text}" for name, text in texts.items()]


def _show(lines: Any) -> None:
    out = console()
    for line in lines:
        out.print(line, soft_wrap=True)


def _plain(text: str | None) -> str:
    return " ".join(cleandoc(text or "").replace("``", "").split())


def _keys(model: type[BaseModel]) -> Iterator[str]:
    """One line for each key: its type, its default, its sentence; then the words that its keys may have."""
    docs, hints = field_docs(model), get_type_hints(model, include_extras=True)
    rows = [
        (field.alias or key, f"{_words(hints[key])}{_default(field)}", _plain(docs.get(key)))
        for key, field in model.model_fields.items()
    ]
    if rows:
        first, second = (max(len(row[k]) for row in rows) for k in (0, 1))
        yield from (f"  {key:{first}}  {kind:{min(second, 40)}}  {text}" for key, kind, text in rows)
    for one in dict.fromkeys(part for hint in hints.values() for part in _parts(hint) if isinstance(part, OneOf)):
        if not one.own and one.kind != "property":
            yield f"  {one.kind}: {', '.join(one.words)}"


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return ", needed"
    value = field.get_default(call_default_factory=True)
    value = value.model_dump(exclude_unset=True, by_alias=True) if isinstance(value, BaseModel) else value
    value = round(value, 4) if isinstance(value, float) else value
    return "" if value in (None, "", [], {}) else f", default {flow(value)}"


def _parts(hint: Any) -> Iterator[Any]:
    yield from getattr(hint, "__metadata__", ())
    for part in get_args(hint):
        yield from _parts(part)


def _words(hint: Any) -> str:
    """A type in words."""
    for known, word in _TYPES:
        if hint == known:
            return word
    for part in getattr(hint, "__metadata__", ()):
        if isinstance(part, OneOf):
            return part.kind
        if isinstance(part, Listed):
            item = _words(get_args(get_args(hint)[0])[0])
            return f"{item} or list of {item}"
    origin, inner = get_origin(hint), [one for one in get_args(hint) if one is not type(None)]
    if origin is Literal:
        return " or ".join(map(str, inner))
    if origin is list:
        return f"list of {_words(inner[0])}"
    if origin is tuple:
        return f"[{', '.join(map(_words, inner))}]"
    if origin is dict:
        return f"{_words(inner[0])} → {_words(inner[1])}"
    if origin in (types.UnionType, Any) or str(origin) == "typing.Union":
        return " or ".join(map(_words, inner))
    return _words(inner[0]) if inner else "mapping"
