"""Documents grown from the schema of scenarios or from known files, then spoilt: the same ones for the same seed."""

from __future__ import annotations

import functools
import json
import math
import random
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import yaml

from irsim.common import data_files as resources

__all__ = ["document"]

ROOT = Path(__file__).resolve().parents[2]
DEEPEST = 7

RAW = (
    "1e999", "-.inf", ".nan", "0x7fffffffffffffff", "0o17", "1:30", "1_000", "2024-01-01", "~", "yes", "On",
    "!!python/object/apply:os.system [id]", "!!binary AAAA", "!!set {a, b}", "!!float x", "!local 3", "*nowhere",
    "9" * 400, "-" + "9" * 30, "1e-320", "1.7976931348623157e308", "5e-324", "- - - -", "? a", "&a [*a]", "[[[[1]]]]",
    "1e", "0.1.2", "+", "1e15", "-0.0", "1e6", "18446744073709551616", "-9223372036854775809", "2147483648", "'",
)  # fmt: skip
"""Texts that are written as they are, even if that is not valid YAML."""
HOSTILE = (
    "", " ", "\x1b[2J", "\x00", "\u202e", "\ud7ff", "\ufeff", "\U0001f916", "a" * 3000, "../../../etc/passwd",
    "/dev/zero", "/proc/self/mem", "CON", "~root", "__class__", "{0.__class__}", "%s%n", "${HOME}", "<b>", "\n\n", "\t",
    "null", "true", "pi/2", "90deg", "5 m", "1,5", "0,5", "10cm", "2*pi", "nan", "inf", "-", "*", "&", "robot_0",
    "(text)", "[bold]", "dash", "orca", "avocado", "footprint_orca", "rvo", "sfm", "follow", "diff", "acker", "omni",
    "lidar2d", "circle", "polygon", "random", "none",
)  # fmt: skip
NUMBERS = (
    0, -1, 1, 2, 7, 0.0, -0.5, 1e-9, 1e-300, 1e3, 1e6, 1e9, 1e18, 1e300, math.inf, -math.inf, math.nan, 2**31, 2**63,
)  # fmt: skip
WIDE = (-1e4, 1e4)


@functools.cache
def schema() -> Any:
    """The schema of scenario files."""
    return json.loads(resources.schema_file().read_text(encoding="utf-8"))


@functools.cache
def keys() -> tuple[str, ...]:
    """All keys of the language."""
    names = {key for part in schema()["$defs"].values() for key in part.get("properties", ())}
    return (*sorted(names), "<<", "irsim", "")


@functools.cache
def known_texts() -> tuple[str, ...]:
    """Existing scenarios: templates, bad ones, scenarios of the parity tests."""
    patterns = ("templates/*/scenario.yaml", "tests/scenario/bad/*.yaml", "tests/parity/scenarios/*.yaml")
    return tuple(file.read_text(encoding="utf-8") for pattern in patterns for file in sorted(ROOT.glob(pattern)))


def document(seed: int, index: int) -> str:
    """One text.

    Args:
        seed: Of all texts.
        index: Which one.
    """
    rng = random.Random(f"{seed}/{index}")
    kind = rng.random()
    if kind < 0.1:
        return _scribbled(rng, rng.choice(known_texts()))
    tree = grown(rng, {"$ref": "#/$defs/Scenario"}) if kind < 0.5 else _tree(rng.choice(known_texts()))
    for _ in range(rng.choice((0, 0, 1, 1, 1, 2, 3, 6))):
        tree = _spoilt(rng, tree)
    text = _written(rng, tree)
    return _scribbled(rng, text) if rng.random() < 0.03 else text


def _tree(text: str) -> Any:
    """Data of a text; the text itself if it is not YAML."""
    try:
        return yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    except yaml.YAMLError:
        return {"custom": text}


# growing --------------------------------------------------------------------------------------------------------------


def grown(rng: random.Random, part: Any, depth: int = 0) -> Any:
    """A value that a part of the schema describes, or nearly."""
    if "$ref" in part:
        rest = {key: value for key, value in part.items() if key != "$ref"}
        part = {**schema()["$defs"][part["$ref"].rpartition("/")[2]], **rest}
    if "const" in part:
        return part["const"]
    if "enum" in part:
        return rng.choice(part["enum"])
    if part.get("examples") and rng.random() < 0.2:
        return json.loads(json.dumps(rng.choice(part["examples"])))
    if "anyOf" in part:
        options = [option for option in part["anyOf"] if option.get("type") != "null"] or part["anyOf"]
        return grown(rng, rng.choice(options if rng.random() < 0.9 else part["anyOf"]), depth)
    kind = part.get("type")
    if kind == "object":
        return _grown_object(rng, part, depth)
    if kind == "array":
        least = part.get("minItems", 0)
        count = min(part.get("maxItems", 1000), least + rng.choice((0, 0, 1, 2, 3)))
        return [grown(rng, part.get("items", {}), depth + 1) for _ in range(count if depth < DEEPEST else least)]
    if kind in ("number", "integer"):
        return _grown_number(rng, part, whole=kind == "integer")
    if kind == "boolean":
        return rng.random() < 0.5
    if kind == "string":
        return _grown_text(rng, part)
    return rng.choice((None, 1, "x"))


def _grown_object(rng: random.Random, part: Any, depth: int) -> dict[str, Any]:
    properties, required = part.get("properties", {}), part.get("required", ())
    share = 0.0 if depth > DEEPEST else rng.choice((0.1, 0.25, 0.4))
    chosen = [key for key in properties if key in required or key == "name" or rng.random() < share]
    if depth == 0:
        chosen = [key for key in ("world", "robot", "obstacle", "gui") if key != "gui" or rng.random() < 0.1]
    elif "kinematics" in properties:
        chosen = [*dict.fromkeys([*chosen, "kinematics", "behavior", "shape", "state", "goal"])]
        if "waypoints" in chosen:
            chosen.remove("goal")
        if rng.random() < 0.7:
            chosen.remove("name")
    return {key: grown(rng, properties[key], depth + 1) for key in chosen}


def _grown_number(rng: random.Random, part: Any, *, whole: bool) -> float:
    low = part.get("minimum", part.get("exclusiveMinimum"))
    high = part.get("maximum", part.get("exclusiveMaximum"))
    bottom = -8.0 if low is None else low
    top = min(bottom + rng.choice((1, 5, 12, 60)), math.inf if high is None else high)
    if whole:
        return rng.randint(math.ceil(bottom), max(math.ceil(bottom), math.floor(top)))
    value = rng.uniform(bottom, top)
    return rng.choice((value, round(value, 2), round(value), value)) if rng.random() < 0.95 else rng.uniform(*WIDE)


def _grown_text(rng: random.Random, part: Any) -> str:
    pattern = part.get("pattern", "")
    if pattern.startswith("^(#"):
        return rng.choice(("#a1b2c3", "C3", "0.5", "red"))
    if pattern:
        return re.sub(r"\[(\w)\w\]", r"\1", pattern.strip("^$"))
    return rng.choice(("one", "two", "robot_0", "pedestrian", "a.png", rng.choice(HOSTILE)))


# spoiling -------------------------------------------------------------------------------------------------------------


def _places(tree: Any, most: int = 400) -> list[tuple[Any, Any]]:
    """(container, key) of the values of a tree, each container once."""
    places: list[tuple[Any, Any]] = []
    seen: set[int] = set()
    stack = [tree]
    while stack and len(places) < most:
        part = stack.pop()
        if id(part) in seen or not isinstance(part, (dict, list)):
            continue
        seen.add(id(part))
        items: Iterator[tuple[Any, Any]] = iter(part.items()) if isinstance(part, dict) else enumerate(part)
        for key, value in list(items)[:50]:
            places.append((part, key))
            stack.append(value)
    return places


def _spoilt(rng: random.Random, tree: Any) -> Any:
    places = _places(tree)
    if not places:
        return {rng.choice(keys()): tree}
    where, key = rng.choice(places)
    rng.choice(_SPOILERS)(rng, places, where, key)
    return tree


def _put_hostile(rng: random.Random, places: Any, where: Any, key: Any) -> None:
    where[key] = rng.choice(HOSTILE)


def _put_raw(rng: random.Random, places: Any, where: Any, key: Any) -> None:
    where[key] = f"RAW{rng.randrange(len(RAW)):03d}RAW"


def _put_number(rng: random.Random, places: Any, where: Any, key: Any) -> None:
    numbers = [(w, k) for w, k in places if isinstance(w[k], (int, float))]
    where, key = rng.choice(numbers) if numbers else (where, key)
    where[key] = rng.choice(NUMBERS)


def _scale(rng: random.Random, places: Any, where: Any, key: Any) -> None:
    """Wrong units: centimetres, degrees, milliseconds, or a unit behind the number."""
    numbers = [(w, k) for w, k in places if isinstance(w[k], (int, float)) and not isinstance(w[k], bool)]
    if numbers:
        where, key = rng.choice(numbers)
        factor = rng.choice((100, 0.01, 57.3, 1000, -1, 1e6, 1e12, 0.0))
        where[key] = rng.choice((where[key] * factor, f"{where[key]} m", f"{where[key]}deg", str(where[key])))


def _rename(rng: random.Random, places: Any, where: Any, key: Any) -> None:
    if isinstance(where, dict):
        text = str(key)
        at = rng.randrange(len(text) + 1)
        new = rng.choice(
            (text[:at] + text[at + 1 :], text[:at] + "e" + text[at:], text.upper(), rng.choice(keys()), 3, None)
        )
        where[new] = where.pop(key)


def _delete(rng: random.Random, places: Any, where: Any, key: Any) -> None:
    del where[key]


def _add(rng: random.Random, places: Any, where: Any, key: Any) -> None:
    """A key of the language, where it belongs or not, with a value that suits it or not."""
    part = schema()["$defs"][rng.choice(sorted(schema()["$defs"]))]
    name = rng.choice(sorted(part.get("properties", {"x": 0})))
    value = grown(rng, part.get("properties", {}).get(name, {}), 3) if rng.random() < 0.8 else rng.choice(NUMBERS)
    if isinstance(where, dict):
        where[name] = value
    else:
        where.insert(key, value)


def _wrap(rng: random.Random, places: Any, where: Any, key: Any) -> None:
    for _ in range(rng.choice((1, 1, 2, 3, 40, 200))):
        where[key] = [where[key]] if rng.random() < 0.7 else {rng.choice(keys()): where[key]}


def _unwrap(rng: random.Random, places: Any, where: Any, key: Any) -> None:
    value = where[key]
    inner = list(value.values()) if isinstance(value, dict) else value
    where[key] = rng.choice(inner) if isinstance(inner, list) and inner else None


def _repeat(rng: random.Random, places: Any, where: Any, key: Any) -> None:
    if isinstance(where[key], list):
        where[key] = where[key] * rng.choice((0, 2, 3, 30))
    elif isinstance(where, list):
        where[key:key] = [where[key]] * rng.choice((1, 2, 10, 100, 1500))


def _share(rng: random.Random, places: Any, where: Any, key: Any) -> None:
    """The same thing in two places: an alias; or a thing inside itself."""
    other, name = rng.choice(places)
    where[key] = other[name] if rng.random() < 0.9 else where


def _swap(rng: random.Random, places: Any, where: Any, key: Any) -> None:
    other, name = rng.choice(places)
    where[key], other[name] = other[name], where[key]


def _many(rng: random.Random, places: Any, where: Any, key: Any) -> None:
    """Far too many objects, beams or nodes."""
    counts = [(w, k) for w, k in places if isinstance(w, dict) and ("kinematics" in w or "name" in w)]
    if counts:
        rng.choice(counts)[0]["number"] = rng.choice((0, 50, 999, 1001, 5000, 100000, 10**9))


_SPOILERS: tuple[Callable[[random.Random, Any, Any, Any], None], ...] = (
    *(_put_hostile, _put_raw, _put_number, _put_number, _scale, _scale, _rename, _delete, _add, _add),
    *(_wrap, _unwrap, _repeat, _share, _share, _swap, _many),
)


# writing --------------------------------------------------------------------------------------------------------------


def _written(rng: random.Random, tree: Any) -> str:
    flow = rng.choice((None, None, True, False))
    try:
        text: str = yaml.safe_dump(tree, default_flow_style=flow, allow_unicode=rng.random() < 0.5, sort_keys=False)
    except RecursionError:  # deeper than can be written
        text = "robot: " + "[" * 2000 + "]" * rng.choice((1999, 2000)) + "\n"
    text = re.sub(r"RAW(\d{3})RAW", lambda match: RAW[int(match[1])], text)
    return text.replace("'<<':", "<<:")


def _scribbled(rng: random.Random, text: str) -> str:
    """Characters and lines lost, doubled, moved or put in."""
    for _ in range(rng.choice((1, 1, 2, 4, 10))):
        lines = text.splitlines(keepends=True) or [""]
        at, line = rng.randrange(len(text) + 1), rng.randrange(len(lines))
        choice = rng.randrange(7)
        if choice == 0:
            text = text[:at] + rng.choice("{}[]:,-&*!|>'\"#%@`? \t\n\r\x00\x85\ufeff") + text[at:]
        elif choice == 1:
            text = text[:at] + text[at + rng.choice((1, 3, 20)) :]
        elif choice == 2:
            lines[line:line] = [lines[line]] * rng.choice((1, 2, 50))
            text = "".join(lines)
        elif choice == 3:
            lines.insert(rng.randrange(len(lines)), lines.pop(line))
            text = "".join(lines)
        elif choice == 4:
            lines[line] = rng.choice(("  ", "\t", "- ", "---\n", "%YAML 9.9\n", "# ")) + lines[line]
            text = "".join(lines)
        elif choice == 5:
            text = text[:at] + rng.choice(RAW) + text[at:]
        else:
            text = text[:at]
    return text
