"""Names of options: one meaning each in all commands, groups of the help, and older names that still work."""

from __future__ import annotations

import shlex
from functools import partial
from typing import Any

from irsim.cli.completion import offers
from irsim.common.text import clean

__all__ = ["OLD_NAMES", "PANELS", "REFUSED", "finished"]

OLD_NAMES: dict[str, dict[str, str]] = {
    "inspect": {"--from": "--first", "--to": "--last", "--robot": "--objects"},
    "schema": {"--for": "--mark"},
    "diff": {"--run": "--simulate"},
    "train": {"--steps": "--decisions"},
    "map import": {"--robot": "--add-robot", "--radius": "--inflate"},
    "audit": {"--policy": "--policy-file"},
    "bridge preview": {"--view": "--eye"},
    "bridge import-bag": {"--from": "--start", "--to": "--end"},
    "bridge import-pedestrians": {
        "--from": "--start",
        "--to": "--end",
        "--robot": "--add-robot",
        "--suite": "--write-suite",
    },
}
"""Command -> older name of an option, which another command uses for something else -> its name."""
REFUSED: dict[str, dict[str, str]] = {
    "render": {"--steps": "--step N draws the state after N steps (--steps limits the steps of a run)"},
    "replay": {"--html": "a replay is always HTML: -o FILE names the page"},
    "validate": {"--policy": "--for-policy NAME warns where the scene is not one that a policy is for"},
    "bridge import-bag": {"--radius": "--robot-radius is the radius of the robot"},
}
"""Command -> a name of an option that it does not have, or that means something else in others -> what to write."""
PANELS: dict[str, str] = {
    "Simulation": "--seed --seeds --step --steps --until --perturb --policy --policies --bridge --protocol --scenario "
    "--full --strict --import --max-objects",
    "Files": "--out --force --save-gif --record --record-to --export --submission --ros-map",
    "Watching": "--watch --show --speed --port --no-browser",
    "Output": "--json --csv --verbose --require-success",
    "Processes and time": "--workers --threads --cluster --resume --max-time",
}
"""Group of options in the help of a long command -> its options; all others are in ``Options``."""
_LONG = 8
"""Number of options above which they are grouped."""


def finished(command: Any, path: str) -> Any:
    """Give a command, or the commands of a group, completions, groups of options and older names of options.

    Args:
        command: The command of Click.
        path: Its words, such as ``map import``.
    """
    for name, one in getattr(command, "commands", {}).items():
        finished(one, f"{path} {name}")
    if hasattr(command, "commands"):
        return command
    options = [one for one in command.params if one.param_type_name == "option" and not one.hidden]
    panel_of = {option: panel for panel, words in PANELS.items() for option in words.split()}
    for one in options if len(options) > _LONG else ():
        one.rich_help_panel = next((panel_of[name] for name in one.opts if name in panel_of), None)
    for one in command.params:
        if (offer := offers(path, one.name)) is not None:
            one._custom_shell_complete = offer
    command.parse_args = partial(_parse, command.parse_args, path, any("-o" in one.opts for one in options))
    return command


def _parse(parse: Any, path: str, writes: bool, context: Any, words: list[str]) -> Any:
    """Parse words in which older names stand for the present ones.

    Args:
        parse: How Click parses them.
        path: Words of the command.
        writes: Whether it has ``-o``, which an argument too many is probably meant for.
        context: The context of Click.
        words: The words.
    """
    parts = [word.partition("=") for word in words]
    for name, _, _ in parts:
        if not context.resilient_parsing and (instead := REFUSED.get(path, {}).get(name)):
            context.fail(f"irsim {path} has no {name}: {instead}.")
    names = OLD_NAMES.get(path, {})
    context.allow_extra_args |= writes
    parsed = parse(context, [names.get(name, name) + sign + value for name, sign, value in parts])
    if writes and context.args and not context.resilient_parsing:
        extra = shlex.quote(clean(context.args[0], 100))
        context.fail(f"{extra} is one argument too many; a file to write is named with -o: -o {extra}")
    return parsed
