"""The references of the skill are generated, complete, and right about what is not simulated."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from irsim.lookup.pages import find_gaps
from irsim.lookup.reference import main, out_of_date
from irsim.options.registry import REGISTRIES
from irsim.scenario.model.json_schema import json_schema

REFERENCES = Path(__file__).resolve().parents[2] / "skills" / "irsim-scenario" / "references"
PAGE_OF = {
    "behavior": "behaviors",
    "distribution": "distributions",
    "kinematics": "kinematics",
    "map": "world",
    "planner": "behaviors",
    "sensor": "sensors",
    "shape": "shapes",
}


RUNNER_BRIDGES = REFERENCES.parents[1] / "irsim-runner" / "references" / "bridges.md"
"""The page about bridges, which are not part of what happens in a scenario; the skill that runs it has the page."""


def page(name: str) -> str:
    return (REFERENCES / f"{name}.md").read_text(encoding="utf-8")


def test_up_to_date() -> None:
    # A process of its own: other tests register features of their own here.
    done = subprocess.run(
        [sys.executable, "-m", "irsim.lookup.reference", "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_a_changed_a_missing_and_a_foreign_page_are_found(tmp_path: Path) -> None:
    for path in REFERENCES.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    (tmp_path / "world.md").write_text("# World\n", encoding="utf-8")
    (tmp_path / "plot.md").unlink()
    (tmp_path / "notes.md").write_text("mine\n", encoding="utf-8")
    assert {"world.md", "plot.md", "notes.md"} <= {path.name for path in out_of_date(tmp_path)}


def test_help_is_there(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    assert ended.value.code == 0
    assert "--check" in capsys.readouterr().out


def test_every_built_in_component_has_its_section() -> None:
    for kind, registry in REGISTRIES.items():
        text = RUNNER_BRIDGES.read_text(encoding="utf-8") if kind == "bridge" else page(PAGE_OF[kind])
        for feature in registry.features():
            if feature.origin == "built-in":
                mark = "" if feature.simulated else " \\(not simulated by this version\\)"
                assert re.search(rf"^##+ {feature.name}{mark}$", text, re.MULTILINE), (kind, feature.name)


def test_what_the_validator_refuses_is_listed_and_nothing_else() -> None:
    gaps = find_gaps(json_schema())
    components = {"behavior": "behavior", "sensor": "sensors", "shape": "shape", "kinematics": "kinematics"}
    refused = {(gap.key, gap.value) for gap in gaps if gap.section == "robot"}
    for kind, key in components.items():
        for feature in REGISTRIES[kind].features():
            if feature.origin == "built-in":
                assert ((key, feature.name) in refused) == (not feature.simulated), feature.name
    rows = re.findall(r"^\| `(\w+)`.*? \| `(.*?)` \| (.*) \|$", page("not-simulated"), re.MULTILINE)
    assert bool(rows) == bool(gaps)
    assert set(rows) <= {(gap.section, gap.example, gap.message) for gap in gaps}
