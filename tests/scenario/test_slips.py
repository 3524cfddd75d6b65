"""Slips of YAML that leave a valid file: what they are taken for is said."""

from __future__ import annotations

import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app

ROBOT = "kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, behavior: {name: dash}"


@pytest.mark.parametrize("color", ["#ff0000", "#f00", "#ff0000cc"])
def test_a_color_that_is_a_comment_is_a_warning(color: str) -> None:
    text = f"robot:\n  kinematics: {{name: diff}}\n  goal: [5, 5]\n  color: {color}\n  plot:\n    obj_color: {color}\n"
    matches = [one for one in irsim.validate(text=text).findings if one.code == "hash-comment"]
    assert [one.line for one in matches] == [4, 6]
    assert all(f"'{color}'" in str(one.fix) for one in matches)


@pytest.mark.parametrize("text", ["robot: #ff\n", "robot: # 1 robot\n", "world: {name: '#ff0000'}\n"])
def test_other_comments_are_none(text: str) -> None:
    assert all(one.code != "hash-comment" for one in irsim.validate(text=text).findings)


@pytest.mark.parametrize("use", ["{<<: *robot, goal: [5, 5]}", "*robot"])
def test_a_key_that_holds_an_anchor_is_not_advised_away(use: str) -> None:
    text = f"common: &robot {{{ROBOT}}}\nrobot:\n  - {use}\n"
    [matches] = [one for one in irsim.validate(text=text).findings if one.code == "unknown-key"]
    assert "custom" in str(matches.fix)
    assert irsim.validate(text=f"custom: {{common: &robot {{{ROBOT}}}}}\nrobot:\n  - {use}\n").valid


def test_a_key_without_use_is_advised_away() -> None:
    [matches] = [one for one in irsim.validate(text=f"common: {{{ROBOT}}}\n").findings if one.code == "unknown-key"]
    assert matches.fix == "remove it"


@pytest.mark.parametrize("missing", ["tensorboard", "gymnasium"])
def test_training_names_the_extra_of_what_is_missing(missing: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim.common.extras.find_spec", lambda name: None if name == missing else object())
    done = CliRunner().invoke(app, ["train", "goal_lidar"])
    assert f"{missing} is not installed" in done.stderr
    assert "irsim-mcp[learn]" in done.stderr
