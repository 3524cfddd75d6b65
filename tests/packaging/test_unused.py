"""All code is called, by other code, by a test or by another library; vulture finds code without a caller."""

from __future__ import annotations

import pytest
import vulture

from tests.packaging.house import ROOT

CALLED_BY_OTHERS = {
    "Gymnasium": "close_extras",
    "TorchRL": "_reset _set_seed",
    "Stable-Baselines3": "_on_step env_is_wrapped env_method get_attr get_images set_attr step_async step_wait",
    "the import system": "__getattr__ create_module get_code is_package",
    "expat": "doctype namespaced",
    "Matplotlib": "get_transforms get_window_title",
    "the MCP SDK": "methods pre_parse_json run_stdio_async",
    "http.server": "do_GET do_POST handle_error log_message",
    "pickle": "persistent_id persistent_load",
    "shutil and os.walk": "inode is_junction",
    "typer": "on_broken_pipe",
    "learners, by message": "_advance _observe _renew _set_level",
    "drives of users": "coast",
    "scripts of 2.12": "coherence_force critical gaze_force group_repulsive_force init_geometry load_group_behaviors "
    "load_yaml step_world_plot update_members",
    "the oracle, by the name of a predicate": "line_of_sight",
}
"""Who calls functions and methods by a name that stands nowhere else in this repository."""


@pytest.mark.slow(8)
def test_all_code_is_called() -> None:
    """Decorators register code, and fields are read by names that others choose: neither is looked at."""
    names = " ".join(CALLED_BY_OTHERS.values()).split()
    checker = vulture.Vulture(ignore_names=names, ignore_decorators=["@*"])
    checker.scavenge([str(ROOT / path) for path in ("irsim", "mcp_server", "evals/irsim_evals", "noxfile.py", "tests")])
    dead = [one for one in checker.get_unused_code() if one.typ not in ("attribute", "variable")]
    assert [f"{one.filename}:{one.first_lineno}: {one.name}" for one in dead if "tests" not in one.filename.parts] == []
