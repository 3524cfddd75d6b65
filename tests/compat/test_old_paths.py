"""The module paths of IR-SIM 2.12, from one table: imports, identity, `dir`, pickles, `python -m`, stubs, freezing."""

from __future__ import annotations

import importlib
import importlib.util
import pickle
import pkgutil
import runpy
import subprocess
import sys
import types
from pathlib import Path
from typing import Any

import pytest

import irsim
from irsim.compat.finder import OldPathFinder
from irsim.compat.freezing import hook_folders
from irsim.compat.names import reference_names
from irsim.compat.paths import NAMES, SAME, old_paths, stub_files
from tests.warm import LIBRARIES, warm

PACKAGES = sorted({path for path in old_paths() if any(other.startswith(f"{path}.") for other in old_paths())})


def run(code: str) -> str:
    """The output of a program that starts without irsim."""
    command = warm([sys.executable, "-c", code], LIBRARIES)
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=60).stdout.strip()


@pytest.mark.parametrize("path", sorted(SAME))
def test_another_name_is_the_same_module(path: str) -> None:
    assert importlib.import_module(path) is importlib.import_module(SAME[path])
    assert importlib.import_module(SAME[path]).__spec__.name == SAME[path]


@pytest.mark.parametrize("path", sorted(NAMES))
def test_a_module_of_names_gives_and_lists_each_of_them(path: str) -> None:
    module = importlib.import_module(path)
    for name, home in NAMES[path].items():
        where, _, name_there = home.partition(":")
        assert getattr(module, name) is getattr(importlib.import_module(where), name_there or name)
    assert set(NAMES[path]) <= set(dir(module))
    assert set(module.__all__) == set(NAMES[path])
    with pytest.raises(AttributeError, match="nonsense"):
        _ = module.nonsense


def test_no_old_path_has_a_file() -> None:
    folder = Path(irsim.__file__).parent
    below = {path.removeprefix("irsim.").replace(".", "/") for path in old_paths()}
    assert [name for name in sorted(below) if (folder / name).is_dir() or (folder / f"{name}.py").is_file()] == []


def test_every_module_of_the_reference_is_found_or_known_to_be_absent() -> None:
    from irsim.compat.absent import ABSENT

    modules = {place.partition(":")[0] for place in reference_names()}
    missing = [name for name in sorted(modules - ABSENT.keys()) if importlib.util.find_spec(name) is None]
    assert missing == []


def test_packages_list_what_they_offer() -> None:
    packages = [
        "irsim.api", "irsim.benchmarks", "irsim.env", "irsim.gui", "irsim.metrics", "irsim.msg", "irsim.results",
        "irsim.rendering", "irsim.runs", *PACKAGES, "irsim",
    ]  # fmt: skip
    code = (
        "import importlib\n"
        f"modules = map(importlib.import_module, {packages})\n"
        "print([m.__name__ for m in modules if not set(m.__all__) <= set(dir(m))])"
    )
    assert run(code) == "[]"


def test_packages_and_modules_are_attributes_without_being_imported() -> None:
    code = (
        "import irsim\nprint(irsim.lib.handler.kinematics_handler.KinematicsFactory.__name__, "
        "irsim.world.map.obstacle_map.ObstacleMap.__name__, irsim.util.util.WrapToPi(0.0), "
        "irsim.env.env_plot.EnvPlot.__name__, irsim.config.env_param.platform_name != '')"
    )
    assert run(code) == "KinematicsFactory ObstacleMap 0.0 EnvPlot True"


def test_a_function_and_a_module_of_one_name() -> None:
    code = (
        "import irsim.lib.algorithm.social_force_model\nfrom irsim.lib.algorithm import social_force_model as f\n"
        "print(callable(f), irsim.lib.algorithm.social_force_model is f)"
    )
    assert run(code) == "True True"


def test_there_is_one_finder_and_it_answers_for_listed_paths_only() -> None:
    importlib.reload(irsim)
    finders = [finder for finder in sys.meta_path if type(finder).__name__ == "OldPathFinder"]
    assert len(finders) == 1
    assert OldPathFinder().find_spec("irsim.world.nothing") is None
    assert OldPathFinder().find_spec("other.world") is None
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module("irsim.world.nothing")


def test_pickles_name_either_path() -> None:
    from irsim.world.sensors.lidar2d import Lidar2D

    assert pickle.loads(pickle.dumps(Lidar2D)) is Lidar2D
    old = b"cirsim.world.sensors.lidar2d\nLidar2D\n."
    assert pickle.loads(old) is Lidar2D


def test_reload_keeps_the_module() -> None:
    module = importlib.import_module("irsim.lib.algorithm.rvo")
    assert importlib.reload(module) is importlib.import_module("irsim.compat.functions.rvo")


@pytest.mark.parametrize("path", ["irsim.lib.path_planners.a_star", "irsim.lib.algorithm.rvo", "irsim.world.world"])
def test_old_paths_run_as_programs(path: str) -> None:
    code = "import runpy, warnings\nwarnings.simplefilter('error')\n"
    assert run(f"{code}runpy.run_module({path!r}, run_name='__main__', alter_sys=True)") == ""


def test_stubs_have_each_path_and_name_existing_homes() -> None:
    files = stub_files()
    assert (files["py.typed"], len(files)) == ("partial\n", 1 + len(old_paths()))
    for text in files.values():
        for line in text.splitlines():
            if line.startswith("from "):
                _, module, _, *names = line.split()
                target = importlib.import_module(module)
                assert names[0] == "*" or hasattr(target, names[0]), line


def test_freezing_programs_are_told_what_nothing_imports_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    """The hook, with a stand-in for the two functions of PyInstaller that it calls."""

    def collect_submodules(package: str, filter: Any = bool) -> list[str]:
        modules = pkgutil.walk_packages(importlib.import_module(package).__path__, f"{package}.", lambda name: None)
        return [name for _, name, _ in modules if filter(name)]

    hooks = types.ModuleType("PyInstaller.utils.hooks")
    hooks.collect_submodules, hooks.collect_data_files = collect_submodules, lambda *_, **__: []  # type: ignore[attr-defined]
    for name in ("PyInstaller", "PyInstaller.utils"):
        monkeypatch.setitem(sys.modules, name, types.ModuleType(name))
    monkeypatch.setitem(sys.modules, hooks.__name__, hooks)
    (folder,) = hook_folders()
    told = set(runpy.run_path(str(Path(folder, "hook-irsim.py")))["hiddenimports"])
    homes = {home.partition(":")[0] for names in NAMES.values() for home in names.values()}
    ours = {home for home in (homes | set(SAME.values())) if home.startswith("irsim.")}
    assert sorted(ours - told) == []
    assert {"irsim.runs.chunks", "isal.igzip_lib"} <= told


UNRECORDED = """
irsim.version:__version__ irsim.world.robots:RobotDiff irsim.world.obstacles:ObjectStatic
irsim.env.env_plot:geometry_to_path irsim.world.object_factory:ObjectFactory irsim.util.util:normalize_actions
irsim.lib.behavior.group_behavior:GroupBehavior irsim.lib.behavior.group_behavior_methods:OrcaGroupBehavior
irsim.lib.behavior.group_behavior_methods:SfmGroupBehavior irsim.lib.behavior.group_behavior_methods:beh_omni_orca
irsim.lib.algorithm.rvo:reciprocal_vel_obs irsim.lib.handler.kinematics_handler:OmniKinematics
irsim.lib.handler.kinematics_handler:register_kinematics irsim.lib.handler.geometry_handler:geometry_handler
irsim.lib.handler.geometry_handler:CircleGeometry
"""
"""Names that scripts import and that neither the recorded names of 2.12 nor the script `imports` contain."""


@pytest.mark.parametrize("place", UNRECORDED.split())
def test_scripts_import_names_that_are_not_recorded_too(place: str) -> None:
    module, _, name = place.partition(":")
    assert hasattr(importlib.import_module(module), name) or importlib.util.find_spec(f"{module}.{name}")


def test_the_maps_of_behaviors_list_the_built_in_ones() -> None:
    printed = run(
        "import irsim.lib.behavior.behavior_registry as r\n"
        "print(len(r.behaviors_map), ('diff', 'rvo') in r.behaviors_map)\n"
        "print(sorted(r.group_behaviors_class_map)[:2], len(r.group_behaviors_class_map))\n"
        "print(len(r.behaviors_class_map), len(r.group_behaviors_map))"
    )
    assert printed.splitlines() == ["8 True", "[('diff', 'orca'), ('diff', 'sfm')] 4", "0 0"]
    assert run("from irsim.lib.behavior.behavior_registry import behaviors_map as b; print(len(b))") == "8"
