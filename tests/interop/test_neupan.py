"""NeuPAN's public examples, driven by the policy as by NeuPAN's own loop.

``NEUPAN_SRC=/path/of/NeuPAN nox -s neupan`` installs the package from a folder of yours and runs them: it is on no
registry, its licence is GPL-3.0, and nothing of it is here.
"""

from __future__ import annotations

import contextlib
import io
import os
from pathlib import Path

import numpy as np
import pytest

import irsim
from irsim.policies import open_policy

SOURCE = os.environ.get("NEUPAN_SRC")
pytestmark = [
    pytest.mark.filterwarnings("ignore"),  # NeuPAN and its solvers warn
    pytest.mark.neupan,
    pytest.mark.slow(150),
    pytest.mark.skipif(not SOURCE, reason="NEUPAN_SRC names no folder of NeuPAN: nox -s neupan runs it"),
]
MAX_STEPS = 1000


def own_loop(folder: Path) -> np.ndarray:
    """(N, 3) poses after each step, driven as NeuPAN's documentation says: state, scan, points, action."""
    from neupan import neupan

    env = irsim.make(folder / "env.yaml", seed=1, headless=True)
    poses = []
    with contextlib.redirect_stdout(io.StringIO()):
        planner = neupan.init_from_yaml(str(folder / "planner.yaml"))
        for _ in range(MAX_STEPS):
            state = env.get_robot_state()
            action, info = planner(state, planner.scan_to_point(state, env.get_lidar_scan()), None)
            if info["arrive"]:
                break
            env.step(action)
            poses.append(env.get_robot_state()[:3, 0])
        else:
            pytest.fail("it did not arrive")
    env.end(ending_time=0)
    return np.array(poses)


def by_policy(folder: Path) -> np.ndarray:
    """(N, 3) poses after each step, driven by the policy until it says that the path has ended."""
    policy = open_policy({"name": "neupan", "config": str(folder / "planner.yaml")})
    env = irsim.make(folder / "env.yaml", seed=1, headless=True, policy=policy)
    poses = []
    for _ in range(MAX_STEPS):
        env.step()
        if "arrived" in policy.remarks().get(0, ""):
            break
        poses.append(env.get_robot_state()[:3, 0])
    env.end(ending_time=0)
    return np.array(poses)


@pytest.mark.parametrize(("example", "steps"), [("corridor/diff", 209), ("dyna_obs/diff", 291)])
def test_an_example_is_driven_as_by_its_own_loop(example: str, steps: int, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = Path(str(SOURCE), "example", example)
    monkeypatch.chdir(str(SOURCE))  # its own loop finds the network from there
    own, ours = own_loop(folder), by_policy(folder)
    print(f"{example}: {len(own)} steps by its own loop, {len(ours)} by the policy")
    assert len(ours) == len(own) == steps
    np.testing.assert_allclose(ours, own, atol=0.05)
