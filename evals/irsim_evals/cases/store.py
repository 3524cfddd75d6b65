"""Where cases and their golds lie, and how they are read: the values of the parameters are put into every text."""

from __future__ import annotations

import functools
import random
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from irsim.bundled.templates.fill import evaluate
from irsim.common.data_files import read_yaml
from irsim_evals.cases.drawing import draw
from irsim_evals.cases.model import Case, Parameter
from irsim_evals.grader.artefact import BINARY, Answer
from irsim_evals.grader.material import write_files

__all__ = [
    "Instance", "all_case_ids", "case_ids", "case_of", "folder", "given_pictures", "golds_of", "in_words",
    "instance_of", "raw_case", "substitute", "write_given",
]  # fmt: skip

_EXPRESSION = re.compile(r"\$\(((?:[^()]|\((?:[^()]|\([^()]*\))*\))+)\)")
_WORDS = {
    "en": "zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen",
    "de": "null ein zwei drei vier fünf sechs sieben acht neun zehn elf zwölf dreizehn vierzehn fünfzehn sechzehn",
    "es": "cero un dos tres cuatro cinco seis siete ocho nueve diez once doce trece catorce quince dieciséis",
    "zh": "零 一 两 三 四 五 六 七 八 九 十 十一 十二 十三 十四 十五 十六",
}


@dataclass(frozen=True)
class Instance:
    """A case with values.

    Attributes:
        case: The case, in which every expression is replaced by its value.
        values: Parameters and derived values.
        name: Empty for the case as published, else the seed of the instance.
        prompt: The request to the agent.
    """

    case: Case
    values: Mapping[str, Any]
    name: str
    prompt: str


def instance_of(raw: Mapping[str, Any], seed: int | None = None) -> Instance:
    """An instance of a case file.

    Args:
        raw: Content of the file.
        seed: Seed of a fresh instance; None for the case as published.

    Raises:
        ValueError: An expression or a key of the file is wrong.
    """
    values: dict[str, Any] = {}
    rng = random.Random(f"{raw.get('id')} {seed}")
    for name, data in (raw.get("parameters") or {}).items():
        parameter = Parameter.model_validate(data)
        values[name] = parameter.default if seed is None else _draw(parameter, rng)
    for name, expression in (raw.get("let") or {}).items():
        values[name] = evaluate(str(expression), values)
    language = str(raw.get("language", "en"))
    kept = {"parameters": raw.get("parameters") or {}, "let": raw.get("let") or {}}
    filled = {key: kept.get(key, substitute(value, values, language)) for key, value in raw.items()}
    case = Case.model_validate(filled)
    prompts = [case.prompt, *case.wordings]
    prompt = case.prompt if seed is None else rng.choice(prompts)
    return Instance(case, values, "" if seed is None else str(seed), prompt)


def substitute(value: Any, values: Mapping[str, Any], language: str = "en") -> Any:
    """Replace every ``$(expression)`` in a value.

    A text that is nothing but an expression becomes its value; within a text it becomes its shortest form, or a word
    with ``$(n: words)``.
    """
    if isinstance(value, dict):
        return {substitute(k, values, language): substitute(v, values, language) for k, v in value.items()}
    if isinstance(value, list):
        return [substitute(item, values, language) for item in value]
    if not isinstance(value, str):
        return value
    whole = _EXPRESSION.fullmatch(value)
    if whole is not None and not whole[1].endswith(": words"):
        return _tidy(evaluate(whole[1], values))
    return _EXPRESSION.sub(lambda match: _text(match[1], values, language), value)


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


def folder(kind: str) -> Path:
    """The folder ``cases`` or ``golds``: beside this package in a checkout, else in the installed data."""
    here = Path(__file__).resolve().parents[2] / kind
    return here if here.is_dir() else Path(__file__).resolve().parents[1] / "data" / kind


def case_ids() -> list[str]:
    """Ids of the cases that count: commands are about these unless others are named."""
    return sorted(path.stem for path in folder("cases").glob("*.yaml"))


def all_case_ids() -> list[str]:
    """Ids of all cases, including the tasks of the skills, which lie in folders of their own."""
    return sorted(_case_files())


@functools.cache
def _case_files() -> dict[str, Path]:
    """Id → file of each case."""
    return {path.stem: path for path in sorted(folder("cases").rglob("*.yaml"))}


@functools.cache
def raw_case(case_id: str) -> Any:
    """Content of a case file.

    Raises:
        KeyError: There is no such case.
    """
    return read_yaml(_case_files()[case_id].read_text(encoding="utf-8"))


def case_of(case_id: str, seed: int | None = None) -> Instance:
    """An instance of a case; as published without a seed."""
    return instance_of(raw_case(case_id), seed)


def golds_of(instance: Instance) -> list[Answer]:
    """The golds of a case: answers that are known to be right."""
    root = folder("golds") / instance.case.id
    return [_gold(path, instance) for path in sorted(root.iterdir()) if path.is_dir()] if root.is_dir() else []


def given_pictures(instance: Instance) -> dict[str, bytes]:
    """The pictures that the folder of a case starts with: name → content of the file."""
    return {name: draw(drawing) for name, drawing in instance.case.drawings.items()}


def write_given(folder: Path, instance: Instance) -> None:
    """Write the files and pictures that the folder of a case starts with."""
    write_files(folder, instance.case.files, given_pictures(instance))


def _gold(path: Path, instance: Instance) -> Answer:
    texts, blobs = {}, given_pictures(instance)
    for file in sorted(path.rglob("*")):
        name = file.relative_to(path).as_posix()
        if file.suffix.lower() in BINARY:
            blobs[name] = file.read_bytes()
        elif file.is_file():
            texts[name] = substitute(file.read_text(encoding="utf-8") + "\0", instance.values).rstrip("\0")
    replies = tuple(texts.pop(name) for name in sorted(texts) if name.startswith("reply-"))
    reply = texts.pop("reply.md", "")
    return Answer(path.name, {**instance.case.files, **texts}, reply, (*replies, reply), blobs)
