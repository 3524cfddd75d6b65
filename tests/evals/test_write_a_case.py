"""Authors who are new to the grader: commands say what a case can say, and the page leads to a case that works."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
import yaml

from irsim_evals.cases.model import Assertion
from irsim_evals.cases.store import case_files, case_of
from irsim_evals.cli.language import examples
from irsim_evals.grader.predicates._base import registered
from irsim_evals.grader.properties import PROPERTIES
from irsim_evals.grader.selection import BUILT_IN, Selector
from tests.evals.conftest import EVALS, irsim_evals, refusal

PAGE = (EVALS / "write-a-case.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"<!-- (file|run): (\S+) -->\n```\w+\n(.*?)```", PAGE, re.DOTALL)
SLOW = ("check --grade", "prove")


def commands(text: str) -> list[str]:
    return [line.split("#")[0].strip() for line in text.strip().splitlines()]


def followed(folder: Path, monkeypatch: pytest.MonkeyPatch, slow: bool) -> list[str]:
    """Write the files of the page and run its commands in order; the commands that were run."""
    monkeypatch.chdir(folder)
    done = []
    for kind, word, text in BLOCKS:
        if kind == "file":
            Path(word).parent.mkdir(parents=True, exist_ok=True)
            Path(word).write_text(text, encoding="utf-8")
            continue
        for command in commands(text):
            name, *words = shlex.split(command)
            assert name == "irsim-evals"
            if slow or not " ".join(words).startswith(SLOW):
                result = irsim_evals(*words)
                assert result.exit_code == int(word), result.output
                done.append(result.output)
    return done


def test_the_case_of_the_page_is_right_and_its_wrong_answer_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = followed(tmp_path, monkeypatch, slow=False)
    assert "cases/table.yaml: valid: case table, 8 assertions" in done[-3]
    assert "no-collision: expected" in done[-2]
    assert "0 of 1 case passes" in done[-2]
    assert re.search(r"floor +PASS", done[-1])


@pytest.mark.slow(15)
def test_the_golds_of_the_page_pass_and_its_proof_is_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done = followed(tmp_path, monkeypatch, slow=True)
    assert "8 assertions, 2 golds in" in done[-4]
    assert re.search(r"false accepts: 0 of \d\d\d", done[-2])
    assert "WRONG" not in done[-2]


def test_every_predicate_is_listed_and_explained() -> None:
    listed = {line.split()[0] for line in irsim_evals("predicates").output.splitlines()}
    assert listed == set(registered())
    text = irsim_evals("predicates", "count").output
    assert re.search(r"^ *of +selection, needed", text, re.MULTILINE)
    assert re.search(r"^ *number +values, needed", text, re.MULTILINE)
    assert re.search(r"example \(\S+\): {id: a-name, count: {of: all, number: \d+}}", text)
    assert "did you mean count?" in refusal("predicates", "cuont")


def test_the_example_of_a_predicate_can_be_used() -> None:
    used = {
        item.predicate.name
        for case in (case_of(case_id).case for case_id in case_files())
        for item in case.assertions().values()
    }
    assert len(used) > 30
    by_predicate = examples()
    assert set(by_predicate) == used
    for name, (_, text) in by_predicate.items():
        assertion = Assertion.model_validate(yaml.safe_load(f"{{id: a-name, {name}: {text}}}"))
        assert assertion.predicate.name == name


def test_properties_and_selections_are_listed() -> None:
    lines = irsim_evals("properties").output.splitlines()
    assert [line.split()[0] for line in lines] == list(PROPERTIES)
    assert "radius          m, ± 2% or 0.01     Radius of a disc." in lines
    text = irsim_evals("selections").output
    for name in (*BUILT_IN, *Selector.model_fields):
        assert re.search(rf"^  {name} ", text, re.MULTILINE)
