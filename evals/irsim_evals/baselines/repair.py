"""``repair``: the given file, or else the retrieved template, mended and tried through the MCP server.

The server is a process of its own, called over standard input and output as an agent's host calls it. A given file
with an error gets the fixes that the server's findings name; one without stays as it is. A template whose robots do not
arrive with the numbers of the request keeps its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import yaml

from irsim.bundled.templates.fill import parse_path
from irsim.diagnostics.diagnostic import Edit
from irsim.scenario.model.lookup import at
from irsim.scenario.yaml.rewrite import rewrite
from irsim_evals.baselines.retrieval import written
from irsim_evals.cases.store import Instance
from irsim_evals.grader.artefact import Answer, scenarios_in

if TYPE_CHECKING:
    from irsim_evals.baselines.server import Server

__all__ = ["answers"]

_ROUNDS = 6
"""Rounds of validating and fixing."""


def answers(instances: Iterable[Instance]) -> Iterator[Answer]:
    """The answers to some requests, with one server for all."""
    from irsim_evals.baselines.server import started

    with started() as server:
        for instance in instances:
            yield _answer(server, instance)


def _answer(server: Server, instance: Instance) -> Answer:
    files = dict(instance.case.files)
    name = next(iter(scenarios_in(files)), None)
    if name is not None:
        files[name], fixed = _mended(server, files[name])
        reply = f"Changed in {name}: {'; '.join(fixed)}." if fixed else f"{name} has no error: nothing changed."
    else:
        text, reply = written(instance)
        run = server.run(text)
        if run is None or any(robot["outcome"] != "success" for robot in run["robots"]):
            text, reply = written(instance, filled=False)
        files["scenario.yaml"] = text
    return Answer("repair", files, reply, tuple(reply for _ in instance.requests))


def _mended(server: Server, text: str) -> tuple[str, list[str]]:
    """A text after the fixes that its findings name, if one of them is an error, and what was wrong."""
    fixed: list[str] = []
    for number in range(_ROUNDS):
        report = server.validate(text)
        findings = report["findings"] if report is not None else []
        if number == 0 and not any(finding["severity"] == "error" for finding in findings):
            break
        before = text
        for finding in findings:
            edit = _edit_of(finding, yaml.safe_load(text))
            text = (rewrite(text, edit) if edit is not None else None) or text
            fixed += [finding["message"]] if edit is not None and text != before else []
        if text == before:
            break
    return text, fixed


def _edit_of(finding: dict[str, Any], data: Any) -> Edit | None:
    """The repair of a finding: its own edit, or the removal of an unknown key."""
    edit, path = finding["edit"], parse_path(finding["path"])
    if edit is not None:
        return Edit(edit["action"], parse_path(edit["path"]), edit["value"])
    return Edit("remove", path) if finding["code"] == "unknown-key" and at(data, path) is not None else None
