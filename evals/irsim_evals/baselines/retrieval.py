"""``retrieval``: the template whose description shares most words with the request, its parameters filled in.

A number of the request becomes the value of the parameter whose name and description share most words with what
stands around the number, if unit and range allow it. Nothing else of the request has an effect.
"""

from __future__ import annotations

from collections import Counter

from irsim.bundled.templates import Parameter, Template, TemplateError, fill, load_all
from irsim.lookup.full_text import bm25, words_of
from irsim_evals.baselines.language import Kind, Quantity, plain, quantities
from irsim_evals.baselines.request import Task
from irsim_evals.grader.artefact import Answer

__all__ = ["answer", "best_template", "slots"]

_SILENT = frozenset(
    {
        "a", "an", "and", "are", "as", "at", "be", "by", "each", "every", "for", "from", "has", "have", "in", "into",
        "is", "it", "its", "not", "of", "on", "one", "or", "so", "than", "that", "the", "their", "them", "then", "they",
        "this", "to", "up", "use", "want", "which", "who", "with", "without", "you", "i", "me", "my", "make",
    }
)  # fmt: skip
"""Words of a request that say nothing of a template."""
_WINDOW = 24
"""Number of characters before and after a number in which its words are looked for."""
_UNITS: dict[str, tuple[Kind, ...]] = {
    "m": ("length",), "m/s": ("speed",), "s": ("time",), "rad": ("angle",), "rad/s": ("turn",), "kg": ("mass",),
    "Hz": ("rate",), "1": ("count", "share"),
}  # fmt: skip


def answer(task: Task) -> Answer:
    """The template that fits best, filled with numbers of the request."""
    request = "\n".join(task.requests)
    template = best_template(request)
    values = slots(template, request)
    try:
        text = fill(template, values)
    except TemplateError:
        text = template.text
    used = ", ".join(f"{name} = {value}" for name, value in values.items()) or "its own values"
    reply = f"Assumed: the template {template.name} ({template.purpose}) with {used}."
    files = {**(task.files or {}), "scenario.yaml": text}
    return Answer("retrieval", files, reply, tuple(reply for _ in task.requests))


def best_template(request: str) -> Template:
    """The template that fits a request best."""
    templates = load_all()
    counts = [Counter(words_of(_description(template), _SILENT)) for template in templates]
    wanted = dict.fromkeys(words_of(plain(request), _SILENT))
    ranked = bm25([[count[word] for count in counts] for word in wanted], [count.total() for count in counts])
    return templates[max(range(len(templates)), key=lambda i: (ranked[i], -i))]


def slots(template: Template, request: str) -> dict[str, float | int]:
    """Values of a template's parameters from the numbers of a request, the surest first."""
    text = plain(request)
    pairs = [
        (_fit(name, parameter, text, quantity), name, quantity)
        for name, parameter in template.parameters.items()
        for quantity in quantities(text)
    ]
    chosen: dict[str, float | int] = {}
    spent: set[int] = set()
    for fit, name, quantity in sorted(pairs, key=lambda pair: (-pair[0], pair[2].start)):
        if fit > 0 and name not in chosen and quantity.start not in spent:
            integer = template.parameters[name].type == "integer"
            chosen[name] = int(quantity.value) if integer else quantity.value
            spent.add(quantity.start)
    return chosen


def _fit(name: str, parameter: Parameter, text: str, quantity: Quantity) -> int:
    """How many words a parameter shares with what stands around a number; 0 if it cannot take the number."""
    kinds = _UNITS.get(parameter.unit or "1", ())
    if parameter.type not in ("number", "integer") or quantity.kind not in kinds:
        return 0
    try:
        parameter.check(name, quantity.value)
    except TemplateError:
        return 0
    around = text[max(0, quantity.start - _WINDOW) : quantity.start] + " " + text[quantity.end : quantity.end + _WINDOW]
    described = f"{name} {parameter.description}".replace("_", " ")
    return len(set(words_of(around, _SILENT)) & set(words_of(described, _SILENT)))


def _description(template: Template) -> str:
    """All words that describe a template and its parameters."""
    options = [f"{name} {parameter.description}" for name, parameter in template.parameters.items()]
    return " ".join([template.name, template.title, template.purpose, *template.tags, *options])
