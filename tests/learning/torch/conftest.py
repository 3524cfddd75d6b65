"""These tests need torch, which only `nox -s learn` installs."""

from __future__ import annotations

from importlib.util import find_spec

collect_ignore_glob = [] if find_spec("torch") and find_spec("stable_baselines3") else ["test_*.py"]
