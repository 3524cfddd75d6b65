"""``rules``: patterns for words and numbers in four languages, and a layout for each arrangement that they know.

Nothing is looked at after it is written: no validation, no run.
"""

from __future__ import annotations

import math
import re

import yaml

from irsim_evals.baselines.edits import edit, is_correction, is_unclear
from irsim_evals.baselines.language import NOT_FLAT, UNKNOWN_REFERENCE, has
from irsim_evals.baselines.request import Request, Task, request_of
from irsim_evals.baselines.scenario import build, describe
from irsim_evals.grader.artefact import Answer, scenarios_in

__all__ = ["answer", "dump", "objection"]

_DENSEST = 0.9069
"""Greatest share of a plane that equal discs can cover."""


def answer(task: Task) -> Answer:
    """The scenario or the reply that the rules lead to."""
    files = dict(task.files or {})
    given = next(iter(scenarios_in(files)), None)
    if given is not None:
        return _edited(task, files, given)
    request = request_of(task.prompt)
    refusal = objection(request)
    if refusal is not None:
        return Answer("rules", files, refusal, tuple(refusal for _ in task.requests))
    scenario = build(request)
    files["scenario.yaml"] = dump(scenario)
    reply = describe(scenario)
    if has(request.text, r"!!\w"):
        reply += " Left out: the YAML tag, because it asks the program that loads the file to run a command."
    return Answer("rules", files, reply, tuple(reply for _ in task.requests))


def _edited(task: Task, files: dict[str, str], name: str) -> Answer:
    """The given file, changed as each message asks; a correction starts again from the file before the last message."""
    before, understood = files[name], ""
    replies = []
    for message in task.requests:
        if is_correction(message):
            message = f"{understood} {message}"
        else:
            before = files[name]
        understood = message
        if is_unclear(message):
            replies.append("Nothing changed yet. Do you mean the world, the robot or the obstacles?")
            continue
        files[name], done = edit(before, message)
        replies.append(f"Changed: {'; '.join(done)}." if done else "I found nothing that I could change.")
    return Answer("rules", files, replies[-1], tuple(replies))


def dump(scenario: object) -> str:
    """A scenario as YAML."""
    return yaml.safe_dump(scenario, sort_keys=False, default_flow_style=None, width=110, allow_unicode=True)


def objection(request: Request) -> str | None:
    """Why nothing is built; None if something can be."""
    if has(request.text, NOT_FLAT):
        return (
            "This is not possible: the simulator is flat (2D). It has no height or altitude, so nothing flies over "
            "anything and there are no stairs; an obstacle blocks whatever comes to it. Nothing was built."
        )
    unknown = re.search(UNKNOWN_REFERENCE, request.text)
    if unknown is not None:
        return (
            f'I do not know which one you mean by "{unknown[0]}". Which size, how many obstacles and which goal should '
            "it have? Nothing was built yet."
        )
    if request.size is not None:
        area = request.size[0] * request.size[1]
        round_ones = [group for group in request.robots if "radius" in group.facts]
        needed = sum((group.number or 1) * math.pi * group.facts["radius"] ** 2 for group in round_ones)
        if needed > _DENSEST * area:
            return (
                f"This is not possible: the footprints need {needed:.0f} m² and the world has {area:g} m², of which "
                "equal discs can cover at most 91 %. Fewer or smaller robots, or a larger world, would do. "
                "Nothing was built."
            )
    return None
