"""Opening policies: names, options, plug-ins, functions, files, and what a sandbox refuses."""

from __future__ import annotations

import hashlib
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from irsim.diagnostics.errors import CodedError, InputError, PolicyError
from irsim.policies import FunctionPolicy, Needs, Observations, Policy, open_policy, register_policy
from irsim.policies.behavior import BehaviorPolicy, with_policy
from irsim.policies.catalog import UnknownPolicyError
from irsim.policies.driver import attach_policy
from irsim.policies.registry import POLICIES, PolicyRegistry
from irsim.scenario.behavior_override import read_with_behavior
from irsim.scenario.yaml.document import Document
from tests.policies.scenes import ROBOT, scenario, simulation


class Still(Policy):
    """Stands still."""

    def __init__(self, speed: float = 0.0) -> None:
        self.name, self.speed = "", float(speed)

    def act(self, observations: Observations) -> Any:
        return np.full((len(observations), 2), self.speed)


class Network(Still):
    """Stands for a network from a file."""

    def __init__(self, path: Path, **options: Any) -> None:
        super().__init__(**options)
        self.name = path.stem


@pytest.fixture(autouse=True)
def stand_in(monkeypatch: pytest.MonkeyPatch) -> None:
    module = ModuleType("irsim.policies.networks")
    module.open_network = Network  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "irsim.policies.networks", module)
    monkeypatch.setattr(POLICIES, "_makers", {"still": Still})


def test_policies_and_functions_are_taken_as_they_are() -> None:
    policy = Still()
    assert open_policy(policy) is policy
    assert policy.text is None

    def creep(observations: Observations) -> Any:
        return np.full((len(observations), 2), 0.1)

    creep.needs = Needs(neighbors=2)  # type: ignore[attr-defined]
    made = open_policy(creep)
    assert (made.name, made.text, made.needs, made.output) == ("creep", None, Needs(neighbors=2), "control")
    assert FunctionPolicy(creep, output="velocity").output == "velocity"


@pytest.mark.parametrize(
    ("source", "text", "name"),
    [
        ("orca", "orca", "orca"),
        ({"name": "orca", "timeHorizon": 5}, "{name: orca, timeHorizon: 5}", "orca"),
        ("as-written", "as-written", "as-written"),
        ("random", "random", "random"),
        ("{name: random, decision_dt: 0.5}", "{name: random, decision_dt: 0.5}", "random"),
        ("still", "still", "still"),
        ("{name: still, speed: 0.5}", "{name: still, speed: 0.5}", "{name: still, speed: 0.5}"),
    ],
)
def test_names_open_policies(source: Any, text: str, name: str) -> None:
    made = open_policy(source)
    assert (made.text, made.source, made.name, made.digest) == (text, text, name, None)


def test_files_have_a_digest_and_are_found_from_their_folder(tmp_path: Path) -> None:
    (tmp_path / "my net.npz").write_bytes(b"weights")
    made = open_policy("my net.npz", folder=tmp_path)
    assert (made.text, made.name, made.stochastic) == ("my net.npz", "my net", False)
    assert made.digest == hashlib.sha256(b"weights").hexdigest()
    again = open_policy({"name": str(tmp_path / "my net.npz"), "decision_dt": 0.5})
    assert again.decision_dt == 0.5
    assert open_policy(made.source).digest == open_policy(again.source).digest == made.digest


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("orka", "unknown-policy: there is no policy 'orka'. Fix: did you mean orca"),
        ("ppo", "there is no policy 'ppo'. Fix: did you mean multi_robot"),
        ("sarl.pt", "there is no policy 'sarl.pt'. Fix: irsim convert makes a policy file"),
        ("{name: sarl, decision_dt: 1e9}", "must be a time .s. above 0, got '1e9'"),
        ("stil", "there is no policy 'stil'. Fix: did you mean still"),
        ("xyzzy", r"Fix: choose one of as-written, .*dash, .*random.* or a file"),
        ("nett.npz", "there is no file 'nett.npz'. Fix: did you mean net.npz"),
        ("orca dash", "'orca dash' is not a policy"),
        (7, "a policy cannot be 7"),
        ("{name: net.npz, sped: 1}", "'sped' is not an option of a file"),
        ("{name: net.npz, decision_dt: -1}", "decision_dt must be a time"),
        ("{name: still, sped: 1}", "policy-failed: policy 'still' has no option 'sped'.*speed"),
        ("{name: random, decison_dt: 1}", "policy 'random' has no option 'decison_dt'.*decision_dt"),
    ],
)
def test_what_is_not_a_policy_is_refused(source: Any, message: str, tmp_path: Path) -> None:
    (tmp_path / "net.npz").write_bytes(b"")
    with pytest.raises((UnknownPolicyError, InputError, PolicyError), match=message):
        open_policy(source, folder=tmp_path)


def test_a_sandbox_opens_built_in_policies_and_files_inside(tmp_path: Path) -> None:
    (tmp_path / "net.npz").write_bytes(b"w")
    (tmp_path.parent / "outside.npz").write_bytes(b"w")
    for source in ("orca", "random", "as-written", "net.npz"):
        assert open_policy(source, root=tmp_path).text == source
    for source in ("still", "../outside.npz", str(tmp_path / "net.npz"), lambda seen: None):
        with pytest.raises(CodedError):
            open_policy(source, root=tmp_path)


def test_registered_names_must_be_free() -> None:
    table = PolicyRegistry()
    table.register("own", Still)
    table.register("own", Still)
    for name in ("orca", "random", "a b", "net.npz", ""):
        with pytest.raises(ValueError, match=r"built in|cannot name"):
            table.register(name, Still)
    with pytest.raises(ValueError, match="registered already"):
        table.register("own", Network)
    assert register_policy("mine")(Still) is Still
    assert "mine" in POLICIES.names()


def test_random_controls_are_within_the_limits_and_the_same_in_a_batch() -> None:
    robots = [{"kinematics": {"name": "diff"}, "vel_min": [0, -0.5], "vel_max": [0.4, 0.5]}, {"state": [1, 5, 0]}]
    together, alone = simulation(*robots, seeds=(3, 4)), simulation(*robots, seeds=(4,))
    for made in (together, alone):
        attach_policy(made, open_policy("random"))
    for _ in range(5):
        together.step()
        alone.step()
        assert (together.control[::2, 0] >= 0).all()
        assert (np.abs(together.control[:, :2]) <= [[0.4, 0.5], [1, 1]] * 2).all()
    assert together.pose[2:].tobytes() == alone.pose.tobytes()
    assert not np.array_equal(together.pose[:2], together.pose[2:])


def test_behaviors_replace_those_of_a_scenario_as_in_its_file() -> None:
    options = {"name": "rvo", "factor": 2.0}
    robots = [
        {"behavior": {"name": "dash", "wander": True, "range_low": [1, 1, 0]}},
        {"state": [1, 5, 0], "behavior": {"name": "rvo", "factor": 5.0, "target_roles": "robot"}},
    ]
    resolved = scenario(*robots)
    changed = with_policy(resolved, open_policy(options))
    data = {"world": {"width": 10, "height": 10}, "robot": [{**ROBOT, **one} for one in robots]}
    expected = read_with_behavior(Document(data, name="test"), options, strict=True)[0]
    assert changed.objects == expected.objects
    assert resolved.objects[0].behavior != changed.objects[0].behavior
    assert with_policy(resolved, BehaviorPolicy("as-written")) is resolved
    assert with_policy(resolved, Still()) is resolved


def test_behaviors_that_do_not_fit_are_refused() -> None:
    with pytest.raises(InputError, match="factr"):
        with_policy(scenario({}), open_policy("{name: rvo, factr: 2}"))
