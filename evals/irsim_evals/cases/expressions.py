"""Values of a case's parameters, and the expressions over them that stand in its texts as ``$(expression)``."""

from __future__ import annotations

import random
import re
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from irsim.bundled.templates.fill import evaluate
from irsim.diagnostics.diagnostic import Diagnostic, Path
from irsim_evals.cases.model import Parameter

__all__ = ["in_words", "substitute", "values_of"]

_EXPRESSION = re.compile(r"\$\(((?:[^()]|\((?:[^()]|\([^()]*\))*\))+)\)")
_WORDS = {
    "en": "zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen",
    "de": "null ein zwei drei vier fünf sechs sieben acht neun zehn elf zwölf dreizehn vierzehn fünfzehn sechzehn",
    "es": "cero un dos tres cuatro cinco seis siete ocho nueve diez once doce trece catorce quince dieciséis",
    "zh": "零 一 两 三 四 五 六 七 八 九 十 十一 十二 十三 十四 十五 十六",
}


def values_of(raw: Mapping[str, Any], rng: random.Random | None, problems: list[Diagnostic]) -> dict[str, Any]:
    """The values of the parameters of a case, and of the names under ``let``.

    Args:
        raw: Content of the file.
        rng: Draws the values; None for the case as published.
        problems: Gets what is wrong with an expression.
    """
    values: dict[str, Any] = {}
    for name, data in _mapping(raw.get("parameters")).items():
        try:
            parameter = Parameter.model_validate(data)
        except ValidationError:  # the model of the case says what is wrong with it
            values[name] = _mapping(data).get("default", 1)
        else:
            values[name] = parameter.default if rng is None else _draw(parameter, rng)
    for name, expression in _mapping(raw.get("let")).items():
        try:
            values[name] = evaluate(str(expression), values)
        except _FAILURES as error:
            problems.append(_problem(("let", str(name)), str(expression), values, error))
            values[name] = 1
    return values


def substitute(
    value: Any,
    values: Mapping[str, Any],
    language: str = "en",
    problems: list[Diagnostic] | None = None,
    path: Path = (),
) -> Any:
    """Replace every ``$(expression)`` in a value.

    A text that is nothing but an expression becomes its value; within a text it becomes its shortest form, or a word
    with ``$(n: words)``. Problems of expressions are added to ``problems``; without such a list, the first is raised.
    """
    if isinstance(value, dict):
        return {
            substitute(k, values, language, problems, path): substitute(v, values, language, problems, (*path, str(k)))
            for k, v in value.items()
        }
    if isinstance(value, list):
        return [substitute(item, values, language, problems, (*path, i)) for i, item in enumerate(value)]
    if not isinstance(value, str):
        return value
    try:
        whole = _EXPRESSION.fullmatch(value)
        if whole is not None and not whole[1].endswith(": words"):
            return _tidy(evaluate(whole[1], values))
        return _EXPRESSION.sub(lambda match: _text(match[1], values, language), value)
    except _FAILURES as error:
        if problems is None:
            raise
        problems.append(_problem(path, value, values, error))
        return value


_FAILURES = (ValueError, SyntaxError, TypeError, ArithmeticError, LookupError)
"""Exceptions that the evaluation of an expression may raise."""


def _problem(path: Path, expression: str, values: Mapping[str, Any], error: Exception) -> Diagnostic:
    why = str(error).splitlines()[0].removeprefix("a template ") if str(error) else type(error).__name__
    return Diagnostic(
        "invalid-value", "error", path, f"it cannot be computed: {why}", given=expression,
        allowed=f"the names {', '.join(map(str, values))}" if values else "names under `parameters`",
    )  # fmt: skip


def _mapping(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def _text(expression: str, values: Mapping[str, Any], language: str) -> str:
    if expression.endswith(": words"):
        return in_words(int(evaluate(expression.removesuffix(": words"), values)), language)
    value = _tidy(evaluate(expression, values))
    text = f"{value:g}" if isinstance(value, float) else str(value)
    return text.replace(".", ",") if isinstance(value, float) and language in ("de", "es") else text


def _tidy(value: Any) -> Any:
    """A number without rounding errors; 3.0 as 3."""
    if isinstance(value, float):
        short = round(value, 6)
        return int(short) if short == int(short) and abs(short) < 1e9 else short
    if isinstance(value, list):
        return [_tidy(item) for item in value]
    return value


def _draw(parameter: Parameter, rng: random.Random) -> Any:
    if parameter.choose is not None:
        return rng.choice(parameter.choose)
    low, high = parameter.between or (0.0, 0.0)
    steps = round((high - low) / parameter.step)
    value = low + rng.randint(0, steps) * parameter.step
    return _tidy(float(value))


def in_words(number: int, language: str = "en") -> str:
    """A number from 0 to 16 in words, a greater one in digits."""
    words = _WORDS.get(language, _WORDS["en"]).split()
    return words[number] if 0 <= number < len(words) else str(number)
