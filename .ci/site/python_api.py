"""Reference of the Python interface, from the docstrings of the sources; nothing is imported for it."""

from __future__ import annotations

import logging
import re
from collections.abc import Iterator
from functools import cache
from typing import Any

import griffe
from pages import ROOT, Page, anchor, cell, contents, link, plain

from irsim.lookup.answer import plain_table

__all__ = ["MODULES", "python_pages"]

MODULES = {
    "irsim": "Functions and classes that programs call first.",
    "irsim.learning": "Scenarios as environments of learning libraries.",
    "irsim.policies": "Policies, which decide for robots from outside their scenario.",
    "irsim.policies.networks": "Networks in files, as policies.",
    "irsim.plugins": "All that a package with a component of its own imports.",
    "irsim.runs": "Recorded runs.",
    "irsim.testing": "Tests for components of plug-ins.",
}
"""Public modules, whose ``__all__`` is documented."""
_START = "reference/python/index"


@cache
def _package() -> Any:
    logging.getLogger("griffe").setLevel(logging.ERROR)
    loader = griffe.GriffeLoader(search_paths=[str(ROOT)], docstring_parser=griffe.Parser.google)
    package = loader.load("irsim")
    loader.resolve_aliases(implicit=False, external=False)
    return package


def _module(name: str) -> Any:
    result = _package()
    for part in name.split(".")[1:]:
        result = result.members[part]
    return result


def _names(module: str) -> list[str]:
    return [str(name) for name in _module(module).exports if not str(name).startswith("__")]


def _object(module: str, name: str) -> Any:
    result = _module(module).members[name]
    if result.is_module:  # A package has the name of a function that the module imports: `irsim.episodes`.
        result = _package()[_module(module).imports[name].removeprefix("irsim.")]
    return result.final_target if result.is_alias else result


def python_pages() -> Iterator[Page]:
    """A page for each public module."""
    rows = [(link(name, _START, _path(name)), about) for name, about in MODULES.items()]
    text = "# Python\n\n" + plain_table(("module", "what it is for"), rows)
    listed = contents([_path(name) for name in MODULES], hidden=True)
    yield Page(_START, f"{text}\n{listed}", text, "Python", "Public modules, functions and classes.")
    for module, about in MODULES.items():
        doc = _module(module).docstring
        parts = [f"# {module}", _words(doc.value) if doc else about]
        for name in _names(module):
            home = next((one for one in MODULES if one != module and name in _names(one)), None)
            if home and list(MODULES).index(home) < list(MODULES).index(module):
                same = link(f"{home}.{name}", _path(module), f"{_path(home)}#{home}.{name}")
                parts.append(f"## {name}\n\n{anchor(f'{module}.{name}')}\n\nThe same as {same}.")
                continue
            parts.append(_section(module, name))
        text = "\n\n".join(parts)
        yield Page(_path(module), text, text, module, about)


def _path(module: str) -> str:
    return f"reference/python/{module}"


def _section(module: str, name: str) -> str:
    one = _object(module, name)
    parts = [f"## {name}", anchor(f"{module}.{name}")]
    if one.is_function:
        parts += [_signature(f"{module}.{name}", one), *_doc(one)]
    elif one.is_class:
        start = one.all_members.get("__init__")
        parts += [_signature(f"{module}.{name}", start) if start and start.is_function else "", *_doc(one)]
        parts += [_member(f"{module}.{name}", key, member) for key, member in sorted(_members(one).items())]
    else:
        parts += [_value(one), *_doc(one)]
    return "\n\n".join(part for part in parts if part)


def _members(one: Any) -> dict[str, Any]:
    """Public methods and attributes of a class that have docstrings, also of its base classes here."""
    result = {}
    for key, member in one.all_members.items():
        target = _written(member.final_target if member.is_alias else member)
        if not key.startswith("_") and target.docstring is not None and (target.is_function or target.is_attribute):
            result[key] = member.final_target if member.is_alias else member
    return result


def _written(one: Any) -> Any:
    """The function of which an attribute of a class is made, as in ``time = computed(queries.time)``."""
    if one.docstring is not None or not one.is_attribute:
        return one
    value = getattr(one.value, "arguments", [one.value])
    path = getattr(value[0], "canonical_path", "") if value else ""
    try:
        return _package()[path.removeprefix("irsim.")] if str(path).startswith("irsim.") else one
    except KeyError:
        return one


def _member(owner: str, name: str, member: Any) -> str:
    one, is_value = _written(member), not member.is_function and hasattr(member.value, "arguments")
    parts = [f"### {owner.rpartition('.')[2]}.{name}", anchor(f"{owner}.{name}")]
    start = f"{owner.rpartition('.')[2].lower()}.{name}"
    if one.is_function and is_value:
        parts.append(f"```text\n{start}: {one.returns}\n```")
    else:
        parts.append(_signature(start, one) if one.is_function else _value(one))
    return "\n\n".join(part for part in [*parts, *_doc(one)] if part)


def _signature(name: str, one: Any) -> str:
    """The call as a program writes it, broken where it is long."""
    parts = []
    for parameter in one.parameters:
        if parameter.name in ("self", "cls", "env") and not parts:
            continue
        kind = parameter.kind.value if parameter.kind else ""
        stars = {"variadic positional": "*", "variadic keyword": "**"}.get(kind, "")
        if kind == "keyword-only" and not any(part.startswith("*") for part in parts):
            parts.append("*")
        annotation = f": {parameter.annotation}" if parameter.annotation is not None else ""
        default = f" = {parameter.default}" if parameter.default is not None and not stars else ""
        parts.append(f"{stars}{parameter.name}{annotation}{default}")
    returns = f" -> {one.returns}" if one.returns is not None else ""
    line = f"{name}({', '.join(parts)}){returns}"
    if len(line) > 96 and parts:
        line = f"{name}(\n" + "".join(f"    {part},\n" for part in parts) + f"){returns}"
    return f"```text\n{line}\n```"


def _value(one: Any) -> str:
    if one.annotation is None and one.value is None:
        return ""
    kind = f": {one.annotation}" if one.annotation is not None else ""
    value = f" = {one.value}" if one.value is not None and len(str(one.value)) < 200 else ""
    return f"```text\n{one.name}{kind}{value}\n```"


def _doc(one: Any) -> Iterator[str]:
    if one.docstring is None:
        return
    for part in one.docstring.parse(griffe.Parser.google, warnings=False):
        kind = part.kind.value
        if kind == "text":
            yield _words(part.value)
        elif kind in ("parameters", "other parameters", "attributes", "returns", "yields", "raises"):
            rows = []
            for item in part.value:
                name = getattr(item, "name", "") or str(getattr(item, "annotation", "") or "")
                rows.append(
                    f"- `{name}`: {cell(_code(item.description))}" if name else f"- {cell(_code(item.description))}"
                )
            yield f"**{kind.capitalize()}**\n\n" + "\n".join(rows)
        elif kind == "admonition":
            yield f"**{part.title}:** {cell(_code(part.value.description))}"
        elif kind == "examples":
            yield from (
                f"```python\n{text}\n```" if what.value == "examples" else _words(text) for what, text in part.value
            )


def _code(text: str) -> str:
    """Code of reStructuredText as code of Markdown; roles are names."""
    text = re.sub(r":[a-z]+:`~?([^`]+)`", r"`\1`", text)
    return re.sub(r"(?<!`)``(?!`)", "`", text)


def _words(text: str) -> str:
    """Paragraphs of a docstring; fences and lists stay."""
    parts, fence = [], False
    for line in _code(text).splitlines():
        fence ^= line.lstrip().startswith("`" * 3)
        parts.append(line if fence or line.startswith("`" * 3) else plain(line))
    return "\n".join(parts)
