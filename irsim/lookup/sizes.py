"""Numbers of a question that are parameters of a template: ``corridor 2 m wide`` asks for ``width=2``."""

from __future__ import annotations

import re

from irsim.bundled.templates import Parameter, Template, TemplateError
from irsim.lookup.full_text import words_of

__all__ = ["settings_asked", "without_sizes"]

_ADJECTIVES = {"wide": "width", "broad": "width", "long": "length", "high": "height", "deep": "depth", "large": "size"}
"""Word behind a number -> the parameter that it is about."""
_UNITS = {"m": "m", "metre": "m", "meter": "m", "m/s": "m/s"}
"""Units of questions -> units of parameters."""
_NUMBER = re.compile(
    r"(?:\b(?P<before>[^\W\d_]+)\s*(?:of|=|:)?\s*)?(?<![\w.])(?P<number>\d+(?:\.\d+)?)"
    r"[\s-]*(?P<unit>m/s|(?:metre|meter)s?\b|m\b)?[\s-]*(?P<after>[^\W\d_]+)?"
)


_SIZE = re.compile(
    r"(?<![\w.])(?:\d+\.\d+|\d+(?=[\s-]*(?:m/s|(?:metre|meter)s?|m)\b))(?:[\s-]*(?:m/s|(?:metre|meter)s?|m)\b)?"
)


def without_sizes(question: str) -> str:
    """A question without lengths, speeds and decimal numbers, which tell nothing of its topic."""
    return _SIZE.sub(" ", question) if re.search(r"[^\W\d_]{2}", _SIZE.sub(" ", question)) else question


def settings_asked(template: Template, question: str) -> tuple[dict[str, str], list[str]]:
    """The parameters whose values a question names.

    Args:
        template: The template.
        question: Free text.

    Returns:
        Name of a parameter -> its value as in the question, and a sentence for each value out of range.
    """
    settings, misfits = dict[str, str](), list[str]()
    for number in _NUMBER.finditer(question.lower()):
        name = _parameter(template, number)
        if name is None:
            continue
        try:
            template.parameters[name].check(name, number["number"])
        except TemplateError as error:
            misfits.append(f"{error.message} Here {error.fix}")
        else:
            settings[name] = number["number"]
    return settings, misfits


def _parameter(template: Template, number: re.Match[str]) -> str | None:
    """The parameter that the words beside a number name."""
    unit = _UNITS.get((number["unit"] or "").removesuffix("s") if number["unit"] != "m/s" else "m/s")
    for word in filter(None, (number["after"], number["before"])):
        singular = words_of(_ADJECTIVES.get(word, word))
        usable = {name: one for name, one in template.parameters.items() if _has_unit(one, unit)}
        named = (name for name in usable if words_of(name) == singular)
        described = (name for name, one in usable.items() if words_of(one.description)[:1] == singular)
        if (parameter := next(named, None) or next(described, None)) is not None:
            return parameter
    return None


def _has_unit(parameter: Parameter, unit: str | None) -> bool:
    return parameter.type in ("number", "integer") and (unit is None or parameter.unit == unit)
