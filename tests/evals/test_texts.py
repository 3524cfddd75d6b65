"""A change of a text that models read is compared before it is done: the kept comparison is as new as the texts."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.evals import texts

LOG = [
    {"case": "pub-01", "answer": []},
    {"tool": "lookup", "arguments": {"topic": "vel_max"}, "expect": ["vel_max"]},
    {"tool": "run_episode", "arguments": {"scenario_path": "no.yaml"}, "expect": ["success"]},
]


def test_the_texts_were_compared_after_their_last_change() -> None:
    kept = json.loads(texts.KEPT.read_text(encoding="utf-8"))
    changed = texts.changed_texts(texts.texts_now(), kept)
    assert changed == [], "run python -m tests.evals.texts, and commit evals/texts.json"


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder like evals, with one log."""
    (tmp_path / "transcripts").mkdir()
    (tmp_path / "transcripts" / "short.jsonl").write_text("".join(f"{json.dumps(line)}\n" for line in LOG))
    monkeypatch.setattr(texts, "EVALS", tmp_path)
    monkeypatch.setattr(texts, "KEPT", tmp_path / "texts.json")
    monkeypatch.delenv("ANTHROPIC_API_KEY", raising=False)
    return tmp_path


def test_a_changed_text_needs_the_comparison(
    place: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert texts.compare_texts(["--check"]) == 1
    assert texts.compare_texts([]) == 0
    assert texts.compare_texts(["--check"]) == 0
    monkeypatch.setattr(texts, "skills_hash", lambda: "another")
    capsys.readouterr()
    assert texts.compare_texts(["--check"]) == 1
    said = capsys.readouterr().out
    assert said.startswith("changed: skills (")
    assert "tools" not in said


def test_answers_that_lack_what_mattered_are_named_and_nothing_is_kept(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert texts.compare_texts(["--all"]) == 1
    said = capsys.readouterr().out
    assert "short: 1 of 2 calls as recorded" in said
    assert "call 2, run_episode: it failed: file-not-found" in said
    assert not (place / "texts.json").exists()
