"""The search of the site finds what people ask for."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

from tests.site.questions import QUESTIONS

pytestmark = [pytest.mark.site, pytest.mark.one_python]


def answers(html: Path, questions: list[str]) -> list[list[str]]:
    """Pages, with anchors, that the search finds for each question, best first."""
    script = Path(__file__).with_name("search.mjs")
    command = ["node", str(script), str(html)]
    done = subprocess.run(command, input=json.dumps(questions), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_the_first_three_pages_answer_each_question(html: Path) -> None:
    answered = answers(html, list(QUESTIONS))
    firsts = [list(dict.fromkeys(place.partition("#")[0] for place in places))[:3] for places in answered]
    wrong = {
        question: first
        for (question, right), first in zip(QUESTIONS.items(), firsts, strict=True)
        if not set(right) & set(first)
    }
    assert len(QUESTIONS) == 20
    assert wrong == {}


def test_a_name_leads_first_to_where_it_is_explained(html: Path) -> None:
    right = {
        "vel_max": "reference/robot#robot.vel_max",
        "`range_max`": "reference/sensor/lidar2d#sensor.lidar2d.range_max",
        "what does unknown-key mean?": "reference/codes#unknown-key",
        "spl": "reference/metrics#spl",
        "neighborDist": "reference/behavior/orca#behavior.orca.neighbordist",
        "vel max": "reference/robot#robot.vel_max",
        "range max": "reference/sensor/lidar2d#sensor.lidar2d.range_max",
        "collision mode": "reference/world#world.collision_mode",
        "which policy": "reference/things#which-policy",
        "unknown cells": "reference/things#unknown-cells",
    }
    answered = dict(zip(right, answers(html, list(right)), strict=True))
    assert {question: places[0].lower() for question, places in answered.items()} == right
    text = {
        name: (html / f"{name}.html").read_text(encoding="utf-8") for name in ("reference/robot", "reference/codes")
    }
    assert 'id="robot.vel_max"' in text["reference/robot"]
    assert 'id="unknown-key"' in text["reference/codes"]


@pytest.mark.parametrize(("slip", "word"), [("lidr", "lidar"), ("benchmrk", "benchmark"), ("trajectroy", "trajectory")])
def test_a_misspelt_word_finds_what_the_word_finds(html: Path, slip: str, word: str) -> None:
    named, right = answers(html, [slip, word])
    assert set(named[:5]) <= set(right)
    assert len(named) >= 5
