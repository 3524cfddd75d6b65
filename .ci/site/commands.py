"""Reference of the command line: a page for each command, from typer."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import typer
from pages import Page, anchor, cell, contents, link

from irsim.cli.app import COMMANDS, FILES_RULE, app
from irsim.lookup.answer import plain_table

__all__ = ["command_pages", "commands"]


def commands() -> dict[str, Any]:
    """Full name -> command; a group is there beside its commands."""
    top: Any = typer.main.get_command(app)
    known = {}
    for name in COMMANDS:
        command = top.get_command(None, name)
        known[f"irsim {name}"] = command
        for inner, one in getattr(command, "commands", {}).items():
            known[f"irsim {name} {inner}"] = one
    return known


def command_pages() -> Iterator[Page]:
    """A page for each command, and one that lists them."""
    every, start = commands(), "reference/commands/index"
    pages = [_page(name, command, every) for name, command in every.items()]
    rows = [(link(name, start, _path(name)), cell(_first(command))) for name, command in every.items()]
    about = (
        "Every command answers `--help`. The exit code is 0 if it finished, 1 if it could not finish and 2 if its "
        f"input is invalid.\n\n{FILES_RULE}"
    )
    table = plain_table(("command", "what it does"), rows)
    listed = contents([page.path for page in pages if len(page.title.split()) == 2], hidden=True)
    text = f"# Commands\n\n{about}\n\n{table}"
    yield Page(start, f"{text}\n{listed}", _readable(text), "Commands", "All commands of `irsim`.")
    yield from pages


def _path(name: str) -> str:
    return f"reference/commands/{'-'.join(name.split()[1:])}"


def _page(name: str, command: Any, every: dict[str, Any]) -> Page:
    path = _path(name)
    arguments = [one for one in command.params if one.param_type_name == "argument"]
    options = [one for one in command.params if one.param_type_name == "option"]
    inner = [other for other in every if other.startswith(f"{name} ")]
    context = command.make_context(name, [], resilient_parsing=True)
    words = "" if inner else " " + " ".join([_argument(one) for one in arguments] + ["[OPTIONS]"] * bool(options))
    usage = f"```text\n{name}{' COMMAND' if inner else words}\n```"
    parts = [f"# {name}", _sentences(command.help or ""), usage]
    if inner:
        parts.append(
            plain_table(("command", "what it does"), [(link(o, path, _path(o)), cell(_first(every[o]))) for o in inner])
        )
        parts.append(contents([_path(other) for other in inner], hidden=True))
    for title, params in (("Arguments", arguments), ("Options", options)):
        shown = [one for one in params if not getattr(one, "hidden", False) and one.name != "help"]
        if shown and not inner:
            rows = [_row(one, context) for one in shown]
            parts.append(f"## {title}\n\n{plain_table(('name', 'meaning', 'default'), rows)}")
    text = "\n\n".join(parts)
    return Page(path, text, _readable(text), name, _first(command))


def _row(one: Any, context: Any) -> tuple[str, str, str]:
    is_argument = one.param_type_name == "argument"
    names = [_argument(one)] if is_argument else [*one.opts, *one.secondary_opts]
    name = ", ".join(f"`{name}`" for name in names)
    if not is_argument and not one.is_flag:
        name += f" `{one.metavar or _type(one.display_type(context))}`"
    marks = "".join(anchor(each.strip("[].").lower() if is_argument else each) for each in names)
    text, limits = " ".join(str(one.help or "").split()), one._get_number_range_help_str()
    if limits and str(2**64 - 1) not in limits:
        text += f" Range: {limits.strip('[]')}."
    default = one.default if one.show_default else None
    shown = f"`{_value(default)}`" if default not in (None, (), [], False, "") and not callable(default) else ""
    return marks + name, cell(_unmarked(text)), shown or ("required" if one.required else "")


def _type(text: str) -> str:
    return text.strip("<>").removesuffix(" range").removesuffix(" RANGE")


def _value(default: Any) -> str:
    if isinstance(default, list | tuple):
        return ", ".join(map(str, default))
    return str(getattr(default, "value", default))


def _argument(one: Any) -> str:
    name = (one.metavar or one.name or "").upper().strip("[]")
    name += "..." if one.nargs == -1 and not name.endswith("...") else ""
    return name if one.required else f"[{name}]"


def _first(command: Any) -> str:
    return " ".join(_unmarked(command.help or "").partition("\n\n")[0].split())


def _sentences(text: str) -> str:
    """The help as paragraphs; what it indents is shown as it stands."""
    parts = []
    for paragraph in _unmarked(text).replace("\b\n", "").split("\n\n"):
        lines = paragraph.splitlines()
        if lines and all(line.startswith("  ") for line in lines if line):
            parts.append("```text\n" + "\n".join(line[2:] for line in lines) + "\n```")
        else:
            parts.append(cell(paragraph))
    return "\n\n".join(parts)


def _unmarked(text: str) -> str:
    """Help without the marks for colors of the terminal."""
    return re.sub(r"\[/?(?:bold|dim|italic|cyan|green|yellow|red)\]", "", text)


def _readable(text: str) -> str:
    return re.sub(r"\n*```\{toctree\}.*?```", "", re.sub(r'<span id="[^"]*"></span>', "", text), flags=re.DOTALL)
