"""``repair``: what the rules write, validated, repaired and run through the MCP server until it works.

The server is a process of its own, called over standard input and output as an agent's host calls it. Fixes that its
findings suggest are applied; then the scenario is run, and behavior, collision mode or places of obstacles are changed
if robots do not arrive. Everything that the request names stays.
"""

from __future__ import annotations

import copy
import math
import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import yaml

from irsim.bundled.templates.fill import parse_path
from irsim.diagnostics.diagnostic import Edit
from irsim.scenario.model.lookup import at
from irsim.scenario.yaml.rewrite import rewrite
from irsim_evals.baselines import rules
from irsim_evals.baselines.edits import entries
from irsim_evals.baselines.language import has, plain
from irsim_evals.baselines.request import Request, Task, request_of
from irsim_evals.baselines.scenario import describe
from irsim_evals.grader.artefact import Answer, scenarios_in

if TYPE_CHECKING:
    from irsim_evals.baselines.server import Server

__all__ = ["answers"]

_ROUNDS = 6
"""Rounds of validating and fixing."""
_SEEDS = (0, 1, 2)
"""Seeds that a scenario with random parts is run with."""
_STEPS_WITHOUT_ROBOTS = 1200
"""Steps for which a scene without robots is run: nothing in it ends."""
_CONVERTED = re.compile(r"(-?\d+(?:\.\d+)?) (?:degrees|cm) are (-?\d+(?:\.\d+)?)")
_LONG_M = 4.0
"""Lengths of a robot above this are taken for centimetres where a finding says so."""
_FREE = re.compile(r"\((-?\d+(?:\.\d+)?), (-?\d+(?:\.\d+)?)\) is free")
_FIX_REQUEST = (
    r"\b(?:fix|repair|correct|broken|faults?|errors?|mistakes?|bugs?|repariere|korrigiere|fehler|arregla|corrige|errores)\b"
    r"|修复|修正|错误"
)
_SHIFTS_M = (0.8, 1.6, 2.4)
"""Distances by which an obstacle is moved out of the way of robots."""


def answers(tasks: Iterable[Task]) -> Iterator[Answer]:
    """The answers to some requests, with one server for all."""
    from irsim_evals.baselines.server import started

    with started() as server:
        for task in tasks:
            yield _answer(server, task)


def _answer(server: Server, task: Task) -> Answer:
    first = rules.answer(task)
    given = next(iter(scenarios_in(task.files or {})), None)
    name = given or "scenario.yaml"
    if name not in first.files:
        return Answer("repair", first.files, first.reply, first.replies)
    text = first.files[name]
    if given is not None:
        wanted = any(has(plain(request), _FIX_REQUEST) for request in task.requests)
        text = _fixed(server, text, None if wanted else (task.files or {})[name], hints=wanted)
        return Answer("repair", {**first.files, name: text}, first.reply, first.replies)
    text = _working(server, _fixed(server, text, None), request_of(task.prompt))
    reply = first.reply.replace(describe(yaml.safe_load(first.files[name])), describe(yaml.safe_load(text)))
    return Answer("repair", {**first.files, name: text}, reply, tuple(reply for _ in task.requests))


def _fixed(server: Server, text: str, base: str | None, hints: bool = False) -> str:
    """The text after the fixes that the findings suggest; with a base only errors that it does not have.

    Args:
        server: The server.
        text: The scenario.
        base: The scenario before an edit.
        hints: Whether what hints suggest is done, too.
    """
    for _ in range(_ROUNDS):
        report = server.validate(text, base)
        findings = report["findings"] if report is not None else []
        if base is not None:
            findings = [one for one in findings if one["severity"] == "error" and not one["in_base"]]
        before, done = text, set[str]()
        for finding in (one for one in findings if hints or one["severity"] != "hint"):
            edit = _edit_of(finding, yaml.safe_load(text))
            if edit is not None and finding["path"] not in done:
                done.add(finding["path"])
                text = rewrite(text, edit) or text
        if text == before:
            break
    return text


def _edit_of(finding: dict[str, Any], data: Any) -> Edit | None:
    """The repair of a finding: its own edit, a place or a value that it names, or the removal of an unknown key."""
    path = parse_path(finding["path"])
    suggested = finding["edit"]
    if suggested is not None:
        return Edit(suggested["action"], parse_path(suggested["path"]), suggested["value"])
    free = _FREE.search(finding["fix"] or "")
    old = at(data, path)
    if free is not None and isinstance(old, list) and len(old) >= 2 and not isinstance(old[0], list):
        return Edit("replace", path, [float(free[1]), float(free[2]), *old[2:]])
    if finding["code"] == "unknown-key":
        return Edit("remove", path)
    if finding["code"] == "looks-like-centimetres" and isinstance(old, dict):
        lengths = {key: value for key, value in old.items() if isinstance(value, (int, float))}
        return Edit("replace", path, old | {key: value / 100 for key, value in lengths.items() if value > _LONG_M})
    converted = _CONVERTED.search(finding["fix"] or "")
    if converted is not None and isinstance(old, (int, float, list)):
        wrong, right = float(converted[1]), float(converted[2])
        values = [right if value == wrong else value for value in (old if isinstance(old, list) else [old])]
        return Edit("replace", path, values if isinstance(old, list) else values[0])
    named = re.match(rf"{re.escape(str(path[-1]))}: ([^;]+?)(?: or |;|$)", finding["fix"] or "") if path else None
    return Edit("replace", path, yaml.safe_load(named[1])) if named is not None and old is not None else None


def _working(server: Server, text: str, request: Request) -> str:
    """The scenario after the first change with which every robot arrives; without one the best that was found."""
    data = yaml.safe_load(text)
    if not _driven(data):
        return text
    best, score = data, _score(server, data)
    if score is None or score[0] == 1:
        return text
    for candidate in _changes(data, request):
        candidate_score = _score(server, candidate)
        if candidate_score is not None and candidate_score > score:
            best, score = candidate, candidate_score
        if score[0] == 1:
            break
    return text if best is data else rules.dump(best)


def _driven(data: Any) -> list[dict[str, Any]]:
    """The entries of what moves by itself."""
    return [entry for section in ("robot", "obstacle") for _, entry in entries(data, section) if "behavior" in entry]


def _score(server: Server, data: Any) -> tuple[float, float] | None:
    """Share of robots that arrive, and how much goes on without robots; None if it does not run.

    Without robots the share is 1 if there is no collision, and ties are broken by arrivals minus collisions:
    people who stop after a collision do not arrive any more.
    """
    shares, surplus = [], 0
    text = rules.dump(data)
    for seed in _SEEDS:
        run = server.run(text, seed, None if "robot" in data else _STEPS_WITHOUT_ROBOTS)
        if run is None:
            return None
        hits = sum(event["kind"] == "collision" for event in run["events"])
        robots = [robot["outcome"] == "success" for robot in run["robots"]]
        if not robots:
            surplus += sum(event["kind"] == "arrival" for event in run["events"]) - hits
        shares.append(sum(robots) / len(robots) if robots else float(hits == 0))
        if not run["random"]:
            break
    return min(shares), surplus


def _changes(data: Any, request: Request) -> Iterator[Any]:
    """Changes that may help, the likeliest first; what the request names is not touched."""
    if "obstacle" in data and any("behavior" in entry for _, entry in entries(data, "obstacle")):
        changed = copy.deepcopy(data)
        changed["world"]["collision_mode"] = "unobstructed_obstacles"
        yield changed
    options: list[dict[str, Any]] = []
    if request.behavior is None and not request.undriven:
        both = {"name": "follow", "local": {"name": "orca"}}
        crowded = sum(entry.get("number", 1) for entry in _driven(data)) > 1
        options = [{"name": "orca"}, both] if crowded else [{"name": "follow"}]
    for option in options:
        changed = copy.deepcopy(data)
        for _, entry in entries(changed, "robot"):
            if "behavior" in entry:
                entry["behavior"] = dict(option)
        yield changed
    if not request.parts and request.behavior != "dash":
        yield from _shifted(data, request)


def _shifted(data: Any, request: Request) -> Iterator[Any]:
    """The obstacles whose places the request leaves open, moved away from the middle of the world."""
    if any(place.role == "obstacle" for place in request.places):
        return
    world = data["world"]
    x0, y0 = world.get("offset", (0, 0))
    middle = (x0 + world["width"] / 2, y0 + world["height"] / 2)
    for shift in _SHIFTS_M:
        changed = copy.deepcopy(data)
        for _, entry in entries(changed, "obstacle"):
            if "behavior" in entry or "state" not in entry:
                continue
            states = entry["state"] if isinstance(entry["state"][0], list) else [entry["state"]]
            for state in states:
                away = math.atan2(state[1] - middle[1], state[0] - middle[0])
                state[0] = round(state[0] + shift * math.cos(away), 4)
                state[1] = round(state[1] + shift * math.sin(away), 4)
        yield changed
