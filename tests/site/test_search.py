"""The search of the site finds what people ask for."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

from tests.site.questions import QUESTIONS

pytestmark = [pytest.mark.site, pytest.mark.one_python]


def test_the_first_three_pages_answer_each_question(html: Path) -> None:
    script = Path(__file__).with_name("search.mjs")
    asked = json.dumps(list(QUESTIONS))
    done = subprocess.run(["node", str(script), str(html)], input=asked, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    firsts = [list(dict.fromkeys(pages))[:3] for pages in json.loads(done.stdout)]
    wrong = {
        question: first
        for (question, right), first in zip(QUESTIONS.items(), firsts, strict=True)
        if not set(right) & set(first)
    }
    assert len(QUESTIONS) == 20
    assert wrong == {}
