"""Several policies in one world: who drives whom, what is refused, and what each role reaches."""

from __future__ import annotations

from pathlib import Path

import pytest

import irsim
from irsim.benchmarks.stored import measure_plan
from irsim.benchmarks.suite import Suite, SuiteError
from irsim.benchmarks.suite_plan import suite_plan, suite_policy
from irsim.diagnostics.errors import ArgumentError, InputError, PolicyError
from irsim.policies import FunctionPolicy, Observations, open_policy
from irsim.policies.catalog import has_inner_files, is_network
from irsim.policies.mixed import MixedPolicy

ROBOTS = """
world: {width: 10, height: 10, step_time: 0.1, time_limit: 30, collision_mode: stop}
robot:
  - number: 6
    tags: [[probe], [crowd], [crowd], [probe, crowd], [crowd], [loose]]
    kinematics: {name: diff}
    distribution: {name: random, range_low: [1, 1, -3], range_high: [9, 9, 3]}
    shape: {name: circle, radius: 0.2}
    behavior: {name: dash}
    vel_max: [1, 3]
    vel_min: [-1, -3]
    goal_threshold: 0.3
"""


@pytest.mark.parametrize("policy", ["orca", "avocado", "footprint_orca", "rl_rvo", "multi_robot", "random"])
def test_parts_of_one_policy_are_that_policy(policy: str) -> None:
    parts = {"probe": policy, "crowd": policy, "others": policy}
    shared = irsim.benchmark(ROBOTS, [{"name": "mixed", "policies": parts}], seeds=2, workers=1)
    alone = irsim.benchmark(ROBOTS, [policy], seeds=2, workers=1)
    same = [one.metrics for one in shared.episodes] == [one.metrics for one in alone.episodes]
    assert same == (policy != "random")  # each part draws from a stream of its own


def test_worlds_that_are_stepped_together_are_those_run_alone() -> None:
    policy = "{name: mixed, policies: {probe: rl_rvo, crowd: multi_robot, others: orca}}"
    for one in irsim.benchmark(ROBOTS, [policy], seeds=3, workers=1).episodes:
        alone = irsim.run(text=ROBOTS, seed=one.seed, policy=policy)
        assert (one.outcome, one.steps) == (alone.outcome, alone.steps)


def forward(observations: Observations) -> list[list[float]]:
    return [[1.0, 0.0]] * len(observations)


def test_the_first_selection_counts_and_robots_of_none_keep_their_behavior(tmp_path: Path) -> None:
    (tmp_path / "robots.yaml").write_text(ROBOTS, encoding="utf-8")
    env = irsim.make(tmp_path / "robots.yaml", seed=1, headless=True, display=False)
    seen: dict[str, list[int]] = {}

    def watching(name: str) -> FunctionPolicy:
        def decide(observations: Observations) -> list[list[float]]:
            seen[name] = observations.robot.tolist()
            return forward(observations)

        return FunctionPolicy(decide, name=name)

    env.set_policy(MixedPolicy({"robot_4": watching("one"), "probe": watching("two"), "crowd": watching("three")}))
    before = env.robot_list[5].state.copy()
    env.step()
    assert seen == {"one": [4], "two": [0, 3], "three": [1, 2]}
    assert (env.robot_list[5].state != before).any()  # dash
    env.set_policy("{name: mixed, policies: {loose: orca, others: sfm}}")
    drivers = [record.behavior.name for record in env._simulation.scenario.objects]
    assert drivers == ["sfm"] * 5 + ["orca"]
    env.end(ending_time=0)


@pytest.mark.parametrize(
    ("policies", "message", "fix"),
    [
        ("{crow: orca}", "has a part for 'crow', and no robot has this name or tag", "did you mean crowd?"),
        ("{crowd: orca, robot_1: dash}", "has nothing to do for 'robot_1'", "choose from"),
        ("{probe: orca, crowd: dash, loose: dash, others: dash}", "nothing to do for 'others'", "choose from"),
        ("{crowd: orka}", "there is no policy 'orka'", "did you mean orca?"),
        ("{crowd: {name: orca, timeHorizn: 2}}", "timeHorizn", "timeHorizon"),
        ("{}", "policies must be a mapping from robots", "write {name: mixed"),
        ("orca", "policies must be a mapping from robots", "write {name: mixed"),
        ("{crowd: {name: mixed, policies: {probe: orca}}}", "itself one of several", "name its parts here"),
        ("{crowd: 3}", "a policy cannot be 3", "give a name"),
    ],
)
def test_what_is_wrong_is_named_before_anything_runs(policies: str, message: str, fix: str) -> None:
    with pytest.raises((ArgumentError, InputError, PolicyError)) as caught:
        irsim.run(text=ROBOTS, policy=f"{{name: mixed, policies: {policies}}}", steps=2)
    assert message in caught.value.message
    assert fix in (caught.value.fix or "")


def test_an_option_that_is_missing_or_unknown_is_named() -> None:
    with pytest.raises(PolicyError, match="needs the option policies"):
        open_policy("{name: mixed}")
    with pytest.raises(PolicyError, match="has no option 'policy'"):
        open_policy("{name: mixed, policies: {a: orca}, policy: 1}")


CRASH = """
world: {width: 20, height: 10, step_time: 0.1, time_limit: 30, collision_mode: stop}
robot:
  - {kinematics: {name: omni}, tags: [pair], state: [2, 2], goal: [8, 2], vel_max: [1, 1]}
  - {kinematics: {name: omni}, tags: [pair], state: [8, 2], goal: [2, 2], vel_max: [1, 1]}
  - {kinematics: {name: omni}, tags: [free], state: [2, 8], goal: [8, 8], vel_max: [1, 1]}
  - {kinematics: {name: omni}, tags: [free], state: [15, 3], goal: [15, 5], vel_max: [0, 0], vel_min: [0, 0]}
"""


def test_each_role_has_its_own_shares_and_times() -> None:
    policy = "{name: mixed, policies: {pair: dash, free: dash}}"
    result = irsim.benchmark(CRASH, [policy, "dash"], seeds=1, workers=1)
    mine, plain = result.episodes
    assert plain.roles == {}
    pair, free = mine.roles["pair"], mine.roles["free"]
    assert (pair["robots"], pair["success"], pair["collision"], pair["timeout"]) == (2, 0, 1, 0)
    assert (pair["time_to_goal"], pair["restricted_time"], pair["collision_count"]) == (None, 30, 1)
    assert (free["robots"], free["success"], free["collision"], free["timeout"]) == (2, 0.5, 0, 0.5)
    assert free["time_to_goal"] == pytest.approx(6.0, abs=0.2)
    assert free["restricted_time"] == pytest.approx((free["time_to_goal"] + 30) / 2)
    row = result.rows[0]
    assert (row.roles["free"]["success"].mean, row.roles["pair"]["time_to_goal"].n) == (0.5, 0)


def suite_of(policies: dict[str, str]) -> Suite:
    scenario = {"robot": [{"kinematics": {"name": "diff"}, "tags": ["probe"]}, {"kinematics": {"name": "diff"}}]}
    data = {"name": "two", "scenario": scenario, "policies": policies}
    return Suite.model_validate(
        {"suite": "s", "version": 1, "title": "t", "scenarios": [data], "steps": 9,
         "policies": {"mine": {"name": "orca", "timeHorizon": 3}, "other": "rl_rvo"}}
    )  # fmt: skip


def test_a_suite_says_who_shares_a_scene() -> None:
    plan = suite_plan(suite_of({"probe": "compared", "others": "other"}))
    assert plan.company == {"other": "rl_rvo"}
    parts = plan.parts()["two"]
    assert (parts["probe"], parts["others"] is not None and parts["others"].name) == (None, "rl_rvo")
    other = suite_plan(suite_of({"probe": "compared", "others": "dash"}))
    assert len({plan.hash, other.hash}) == len({plan.suite_hash, other.suite_hash}) == 2
    with pytest.raises(ValueError, match="driven by compared"):
        suite_of({"probe": "orca"})


def test_one_episode_of_a_suite_has_the_company_that_the_suite_names() -> None:
    text = suite_policy("mixed_v2/one-rl_rvo", "orca")
    policy = open_policy(text)
    assert {key: part.name for key, part in policy.parts.items()} == {"probe": "orca", "crowd": "rl_rvo"}
    assert suite_policy("mixed_v2/one-rl_rvo", text) == text  # as `reproduce` has it
    assert suite_policy("random_polygons_v2/robots-5/freeze", "dash") == "dash"
    [row] = irsim.benchmark(
        {"one": suite_plan("mixed_v2", scenarios=["one-rl_rvo"]).scenarios[0].document()}, [text], seeds=[200000]
    ).episodes
    run = irsim.run("mixed_v2/one-rl_rvo", seed=200000, policy="orca")
    assert (run.outcome, run.steps) == (row.outcome, row.steps)


def test_a_policy_of_a_scene_that_does_not_exist_is_named() -> None:
    with pytest.raises((SuiteError, InputError), match="there is no policy 'orka'"):
        measure_plan(suite_plan(suite_of({"probe": "compared", "others": "orka"})))


def test_a_suite_whose_robots_do_not_exist_is_refused_with_the_nearest_tag() -> None:
    with pytest.raises(SuiteError, match="no robot has the name or tag 'prob', did you mean probe") as caught:
        suite_plan(suite_of({"prob": "compared", "others": "dash"}))
    assert caught.value.diagnostics[0].path == ("scenarios", 0, "policies", "prob")


def test_files_within_a_policy_are_found() -> None:
    mixed = "{name: mixed, policies: {probe: PART, others: orca}}"
    for part, inner, network in (
        ("dash", False, False),
        ("rl_rvo", False, True),
        ("mine.npz", True, True),
        ("{name: mine.npz, decision_dt: 0.2}", True, True),
        ("rl_rvo_authors", False, True),
        ("{name: rl_rvo_authors, weights: pre_train.pt}", True, True),
    ):
        text = mixed.replace("PART", part)
        assert (part, has_inner_files(text), is_network(text)) == (part, inner, network)
    assert not has_inner_files("mine.npz")


def test_a_run_says_for_whom_its_policy_is() -> None:
    shared = irsim.run(text=ROBOTS, seed=1, policy="{name: mixed, policies: {probe: rl_rvo, others: orca}}", steps=3)
    assert "with policy {name: mixed, policies: {probe: rl_rvo, others: orca}}: " in shared.summary
    assert "with policy rl_rvo for all robots: " in irsim.run(text=ROBOTS, seed=1, policy="rl_rvo", steps=3).summary
