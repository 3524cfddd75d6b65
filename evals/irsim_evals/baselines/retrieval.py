"""``retrieval``: the template whose description shares most words with the request, its parameters filled in.

A number of the request becomes the value of the parameter whose name and description share most words with what
stands around the number, if unit and range allow it. Nothing else of the request has an effect.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator

from irsim.bundled.templates import Parameter, Template, TemplateError, fill, load_all
from irsim.lookup.full_text import bm25, words_of
from irsim_evals.cases.store import Instance
from irsim_evals.grader.artefact import Answer

__all__ = ["answer", "best_template", "slots", "written"]

_SILENT = {
    "a", "an", "and", "are", "as", "at", "be", "by", "each", "every", "for", "from", "has", "have", "in", "into", "is",
    "it", "its", "not", "of", "on", "one", "or", "so", "than", "that", "the", "their", "them", "then", "they", "this",
    "to", "up", "use", "want", "which", "who", "with", "without", "you", "i", "me", "my", "make",
}  # fmt: skip
"""Words of a request that say nothing of a template."""
_WINDOW = 24
"""Number of characters before and after a number in which its words are looked for."""
_UNITS: dict[str | None, tuple[str, float]] = {
    None: ("1", 1), "m": ("m", 1), "cm": ("m", 0.01), "mm": ("m", 0.001), "m/s": ("m/s", 1), "km/h": ("m/s", 1 / 3.6),
    "s": ("s", 1), "Hz": ("Hz", 1), "kg": ("kg", 1), "°": ("rad", math.pi / 180), "degrees": ("rad", math.pi / 180),
    "rad": ("rad", 1), "rad/s": ("rad/s", 1), "%": ("1", 0.01),
}  # fmt: skip
"""Unit of a request → unit of a parameter, and the factor between them."""
_UNIT = "|".join(sorted((re.escape(unit) for unit in _UNITS if unit), key=len, reverse=True))
_NUMBER = re.compile(rf"(?<![\w.,])(\d+(?:\.\d+)?)(?:[\s-]?({_UNIT})(?![\w/]))?(?![\w.,]\d)")


def answer(instance: Instance) -> Answer:
    """The template that fits best, filled with numbers of the request."""
    text, reply = written(instance)
    files = {**instance.case.files, "scenario.yaml": text}
    return Answer("retrieval", files, reply, tuple(reply for _ in instance.requests))


def written(instance: Instance, filled: bool = True) -> tuple[str, str]:
    """The template that fits best, ``filled`` with numbers of the request, and the reply that goes with it."""
    request = "\n".join(instance.requests)
    template = best_template(request)
    values = slots(template, request) if filled else {}
    try:
        text = fill(template, values)
    except TemplateError:
        text, values = template.text, {}
    used = ", ".join(f"{name} = {value}" for name, value in values.items()) or "its own values"
    return text, f"Assumed: the template {template.name} ({template.purpose}) with {used}."


def best_template(request: str) -> Template:
    """The template that fits a request best."""
    templates = load_all()
    counts = [Counter(words_of(_description(template), _SILENT)) for template in templates]
    wanted = dict.fromkeys(words_of(request, _SILENT))
    ranked = bm25([[count[word] for count in counts] for word in wanted], [count.total() for count in counts])
    return templates[max(range(len(templates)), key=lambda i: (ranked[i], -i))]


def slots(template: Template, request: str) -> dict[str, float | int]:
    """Values of a template's parameters from the numbers of a request, the surest first."""
    pairs = [
        (_fit(name, parameter, value, unit, around), name, value, start)
        for value, unit, around, start in _numbers(request)
        for name, parameter in template.parameters.items()
    ]
    chosen: dict[str, float | int] = {}
    spent: set[int] = set()
    for fit, name, value, start in sorted(pairs, key=lambda pair: (-pair[0], pair[3])):
        if fit > 0 and name not in chosen and start not in spent:
            chosen[name] = int(value) if template.parameters[name].type == "integer" else value
            spent.add(start)
    return chosen


def _numbers(request: str) -> Iterator[tuple[float, str, str, int]]:
    """The numbers of a request that are written as digits: value, unit, the words around it, and where it stands."""
    for match in _NUMBER.finditer(request):
        unit, factor = _UNITS[match[2]]
        around = f"{request[max(0, match.start() - _WINDOW) : match.start()]} {request[match.end() :][:_WINDOW]}"
        yield round(float(match[1]) * factor, 9), unit, around, match.start()


def _fit(name: str, parameter: Parameter, value: float, unit: str, around: str) -> int:
    """How many words a parameter shares with what stands around a number; 0 if it cannot take the number."""
    if parameter.type not in ("number", "integer") or (parameter.unit or "1") != unit:
        return 0
    try:
        parameter.check(name, value)
    except TemplateError:
        return 0
    described = f"{name} {parameter.description}".replace("_", " ")
    return len(set(words_of(around, _SILENT)) & set(words_of(described, _SILENT)))


def _description(template: Template) -> str:
    """All words that describe a template and its parameters."""
    options = [f"{name} {parameter.description}" for name, parameter in template.parameters.items()]
    return " ".join([template.name, template.title, template.purpose, *template.tags, *options])
