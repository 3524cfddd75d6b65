"""The policies that ship with irsim: what they reach in the scenes of their tasks, and their cards."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest

import irsim
from irsim.learning.tasks.files import TASKS, open_task
from irsim.learning.tasks.scene import scenario_text
from irsim.lookup.topics import lookup
from irsim.policies.trained import trained_policies, trained_policy
from irsim.scenario.perturbation import perturbation_text

RECIPES = Path(irsim.__file__).parents[1] / "skills" / "irsim-runner" / "recipes"
LEAST = {
    "goal_lidar": 0.9,
    "crowd": 0.9,
    "corridor_social": 0.9,
    "multi_robot": 0.9,
    "multi_robot_freeze": 0.75,
    "sarl": 0.9,
    "rl_rvo": 0.7,
    "sarl_multi_robot": 0.75,
}
"""Success that each must reach in 20 scenes that it was not trained on; in all it has reached more."""

TRAINED_ON = {"sarl": "sarl_circle"}
"""Name of a policy -> task that it was trained on, where the names differ."""


@pytest.mark.slow(15)
@pytest.mark.parametrize("name", trained_policies())
def test_it_reaches_its_success_in_scenes_of_its_task(name: str, tmp_path: Path) -> None:
    task, folder = open_task(TRAINED_ON.get(name, name))
    (tmp_path / "scene.yaml").write_text(scenario_text(task, folder))
    spreads = "; ".join(perturbation_text(one) for one in task.perturb) or None
    found = irsim.benchmark(tmp_path / "scene.yaml", policies=[name], seeds=20, perturb=spreads, workers=1)
    [row] = found.rows
    assert row.success.rate >= LEAST[name]


@pytest.mark.parametrize("name", trained_policies())
def test_its_card_and_its_curve_are_those_of_the_file(name: str) -> None:
    file = trained_policy(name)
    assert file.stat().st_size < 1_000_000
    card = (RECIPES / f"{name}.md").read_text(encoding="utf-8")
    assert hashlib.sha256(file.read_bytes()).hexdigest() in card
    assert f"![learning curve]({name}.png)" in card
    assert (RECIPES / f"{name}.png").is_file()
    assert f"[{name}]({name}.md)" in (RECIPES / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", trained_policies())
def test_a_lookup_tells_what_a_policy_is_for(name: str) -> None:
    answer = lookup(f"policy {name}")
    facts = {key.name: key.text for key in answer.groups["facts"]}
    assert (answer.kind, answer.topic) == ("policy", name)
    assert facts["trained on"].split()[0] in {*TASKS.names()}
    assert facts["license"] == "MIT"
    assert name in (answer.example or "")
    if name != "crowd":  # a template has that name
        assert lookup(name.upper().replace("_", "-")) == answer


def test_a_name_that_a_suite_gives_leads_to_the_policy() -> None:
    answer = lookup("PPO")
    assert answer.topic == "multi_robot"
    assert "The suite random_polygons_v1 calls it ppo." in answer.text
