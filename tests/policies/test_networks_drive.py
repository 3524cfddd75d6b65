"""A network from a file drives worlds, the same in each use."""

from __future__ import annotations

from pathlib import Path

import pytest

import irsim
from irsim.policies.networks import save_network
from tests.policies.networks.examples import go_to_goal

SCENE = """
world: {width: 10, height: 10, time_limit: 25}
robot:
  - number: 2
    kinematics: {name: diff}
    distribution: {name: random, range_low: [1, 1, -3], range_high: [9, 9, 3]}
    behavior: {name: dash}
"""


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("scene.yaml").write_text(SCENE)
    save_network("net.npz", go_to_goal())


def test_a_batch_equals_single_environments() -> None:
    batch = irsim.batch("scene.yaml", 3, seeds=[4, 5, 6], policy="net.npz")
    batch.advance(60)
    for world, seed in enumerate((4, 5, 6)):
        env = irsim.make("scene.yaml", headless=True, seed=seed, log_level="ERROR", policy="net.npz")
        for _ in range(60):
            env.step()
        assert batch.pose[world].tobytes() == env.simulation.pose.tobytes()


def test_it_reaches_its_goals_in_a_benchmark_whatever_the_number_of_processes() -> None:
    one = irsim.benchmark("scene.yaml", ["net.npz", "random"], 4, workers=1)
    assert one.rows[0].success.count + one.rows[0].collision.count == 4
    assert one == irsim.benchmark("scene.yaml", ["net.npz", "random"], 4, workers=2)


def test_it_is_described() -> None:
    from irsim.policies.description import describe_policy

    found = describe_policy("net.npz")
    assert (found.kind, found.drives, found.output) == ("file", ["diff"], "control")
    assert found.digest == irsim.open_policy("net.npz").digest
