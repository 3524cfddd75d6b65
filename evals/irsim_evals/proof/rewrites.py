"""Other ways to write the same world: each must be accepted wherever the original is."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterator
from typing import Any

import yaml

from irsim_evals.cases.model import Case
from irsim_evals.grader.scene import GradedScene
from irsim_evals.proof.operators import NUMBER, REWRITES, Data, dump, entries, plain, rewrite, sensors_of
from irsim_evals.proof.rewrites_of_layout import mirrored  # the module registers its rewrites when it is imported

__all__ = ["rewrites_of", "rewrites_of_edit"]

_MIRRORS = {"mirror_x": "mirrored_left_right", "mirror_y": "mirrored_up_down"}
"""Fact of the world that a case leaves free → rewrite along x, and along y."""
_KEY = re.compile(r"(?<![\w\"'])([a-z_]+): ")


def rewrites_of(case: Case, name: str, text: str, scene: GradedScene) -> Iterator[tuple[str, str]]:
    """Name and text of each rewrite that applies to a scenario.

    Args:
        case: The case that it answers.
        name: Name of its file.
        text: The scenario as written.
        scene: Its world with the first seed.
    """
    if name in case.files:  # an edit is about the text, too
        yield from rewrites_of_edit(case.files[name], text) if text != case.files[name] else ()
        return
    free = {fact for pin in case.free if pin.of == "world" for fact in pin.facts}
    data = yaml.safe_load(text)
    for operator, make in REWRITES.items():
        rewritten = make(text, plain(data), scene)
        same = text if make is block_style else dump(data)
        if rewritten not in (None, text, same):
            yield operator, str(rewritten)
    for axis, (fact, operator) in enumerate(_MIRRORS.items()):
        made = mirrored(plain(data), axis) if fact in free else None
        if made not in (None, data):
            yield operator, dump(made)


def rewrites_of_edit(given: str, text: str) -> Iterator[tuple[str, str]]:
    """Name and text of each rewrite of an edited file.

    Args:
        given: The file before the edit.
        text: The file after it.
    """
    lines = text.splitlines()
    matcher = difflib.SequenceMatcher(None, given.splitlines(), lines, autojunk=False)
    changed = [k for tag, _, _, a, b in matcher.get_opcodes() if tag != "equal" for k in range(a, b)]

    def with_lines(change: Callable[[str], str]) -> str:
        return "\n".join(change(line) if k in changed else line for k, line in enumerate(lines)) + "\n"

    made = {
        "without a newline at the end": text.rstrip("\n"),
        "with carriage returns": text.replace("\n", "\r\n"),
        "numbers as floats": with_lines(lambda line: _numbers(line, lambda n: f"{float(n)}")),
        "numbers with an exponent": with_lines(lambda line: _numbers(line, lambda n: f"{float(n):.9e}")),
        "numbers with more digits": with_lines(lambda line: _numbers(line, lambda n: f"{float(n):.6f}")),
        "keys in quotes": with_lines(lambda line: _keys(line, r'"\1": ')),
        "more spaces after keys": with_lines(lambda line: _keys(line, r"\1:   ")),
        "spaces at the end of a line": with_lines(lambda line: f"{line}   "),
        "spaces within brackets": with_lines(lambda line: _within(line, "[]")),
        "spaces within braces": with_lines(lambda line: _within(line, "{}")),
        "a comment on the changed lines": with_lines(lambda line: line if "#" in line else f"{line}  # changed"),
    }  # fmt: skip
    yield from ((name, new) for name, new in made.items() if new != text)


def _numbers(line: str, change: Callable[[str], str]) -> str:
    """Change the numbers of a line that are not counts: those with the key ``number`` stay."""

    def one(match: re.Match[str]) -> str:
        before = line[: match.start()].rstrip()
        return match[0] if before.endswith(("number:", "group:", "seed:")) else change(match[1])

    return _code(line, lambda code: NUMBER.sub(one, code))


def _keys(line: str, by: str) -> str:
    return _code(line, lambda code: _KEY.sub(by, code))


def _within(line: str, brackets: str) -> str:
    first, last = brackets[0], brackets[1]
    return _code(line, lambda code: code.replace(first, f"{first} ").replace(last, f" {last}"))


def _code(line: str, change: Callable[[str], str]) -> str:
    """Change a line up to its comment."""
    code, mark, comment = line.partition("#")
    return change(code) + mark + comment


@rewrite
def flow_style(text: str, data: Data, scene: GradedScene) -> str | None:
    """Everything on as few lines as possible."""
    return dump(data, default_flow_style=True, width=10_000)


@rewrite
def block_style(text: str, data: Data, scene: GradedScene) -> str | None:
    """Every key on its own line."""
    return dump(data, default_flow_style=False)


@rewrite
def keys_reversed(text: str, data: Data, scene: GradedScene) -> str | None:
    """Keys in the opposite order, at every level."""

    def turned(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: turned(value[key]) for key in reversed(value)}
        return [turned(item) for item in value] if isinstance(value, list) else value

    return dump(turned(data))


@rewrite
def comments(text: str, data: Data, scene: GradedScene) -> str | None:
    """With comments."""
    return "# a scenario\n" + "".join(
        f"{line}  # so it is\n" if line.endswith("}") else f"{line}\n" for line in text.splitlines()
    )


@rewrite
def list_or_mapping(text: str, data: Data, scene: GradedScene) -> str | None:
    """A single entry without the list around it, or with one."""
    for section in ("robot", "obstacle"):
        given = data.get(section)
        if isinstance(given, list) and len(given) == 1:
            data[section] = given[0]
        elif isinstance(given, dict):
            data[section] = [given]
    return dump(data)


@rewrite
def explicit_defaults(text: str, data: Data, scene: GradedScene) -> str | None:
    """Keys with their default values written out."""
    world = data.setdefault("world", {})
    for key in ("step_time", "sample_time", "control_mode", "collision_mode"):
        world.setdefault(key, getattr(scene.world, key))
    for *_, entry in entries(data):
        entry.setdefault("static", False)
        entry.setdefault("unobstructed", False)
        entry.setdefault("goal_threshold", 0.1)
    return dump(data)


@rewrite
def anchors(text: str, data: Data, scene: GradedScene) -> str | None:
    """Equal mappings written once, with anchors and aliases."""
    known: dict[str, Any] = {}

    def shared(value: Any) -> Any:
        if isinstance(value, dict):
            made = {key: shared(item) for key, item in value.items()}
            return known.setdefault(repr(made), made)
        return [shared(item) for item in value] if isinstance(value, list) else value

    made = dump(shared(data))
    return made if "&id" in made else None


@rewrite
def numbers_otherwise(text: str, data: Data, scene: GradedScene) -> str | None:
    """Whole numbers with a decimal point, others in powers of ten."""

    class Odd(yaml.SafeDumper):
        pass

    def number(dumper: yaml.SafeDumper, value: float) -> Any:
        return dumper.represent_scalar("tag:yaml.org,2002:float", f"{value:.12e}")

    Odd.add_representer(float, number)
    return str(yaml.dump(data, Dumper=Odd, sort_keys=False, allow_unicode=True))


@rewrite
def entries_renamed(text: str, data: Data, scene: GradedScene) -> str | None:
    """Descriptive names where there were none."""
    for number, (section, _, entry) in enumerate(entries(data)):
        if "name" not in entry and entry.get("number", 1) == 1:
            entry["name"] = f"{section}-number-{number}"
    return dump(data)


@rewrite
def sections_swapped(text: str, data: Data, scene: GradedScene) -> str | None:
    """Obstacles and robots before the world."""
    first = [section for section in ("obstacle", "robot") if section in data]
    return dump({key: data[key] for key in (*first, *data)})


@rewrite
def sensor_by_type(text: str, data: Data, scene: GradedScene) -> str | None:
    """``type`` instead of ``name`` for sensors."""
    for *_, entry in entries(data):
        for sensor in sensors_of(entry):
            if "name" in sensor:
                sensor["type"] = sensor.pop("name")
    return dump(data)


@rewrite
def wrapped(text: str, data: Data, scene: GradedScene) -> str | None:
    """Behind a marker of the document, with blank lines."""
    return "---\n\n" + text.replace("\n", "\n\n") + "\n"
