"""Every error of irsim tells a program its code and its problems."""

from __future__ import annotations

import importlib
import inspect
import pickle
import re
from pathlib import Path
from typing import Any

import pytest

import irsim
from irsim.diagnostics.errors import IrsimError
from irsim.policies.networks.errors import flaw

SCENE = "world: {}\nrobot:\n  - {kinematics: {name: diff}, name: rover, state: [1, 1, 0], goal: [8, 8, 0]}\n"


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ({"text": "wrld: {}", "strict": True}, "unknown-key"),
        ({"files": "nope.yaml"}, "file-not-found"),
        ({"text": "world: {}", "steps": -1}, "bad-argument"),
        ({"text": SCENE, "policy": "orcca"}, "unknown-policy"),
    ],
)
def test_every_error_has_a_code_and_diagnostics(given: dict[str, Any], code: str) -> None:
    with pytest.raises(irsim.IrsimError) as caught:
        irsim.run(given.pop("files", None), **given)
    first = caught.value.diagnostics[0]
    assert caught.value.code == first.code == code
    assert first.severity == "error"
    assert first.message == caught.value.message != ""
    assert first.as_dict()["fix"] == caught.value.fix


def test_an_unknown_name_comes_with_the_nearest_and_all_that_there_are(tmp_path: Path) -> None:
    with pytest.raises(irsim.IrsimError) as policy:
        irsim.run(text=SCENE, policy="orcca")
    assert policy.value.diagnostics[0].fix == "did you mean orca?"
    assert {"orca", "dash"} <= set(policy.value.diagnostics[0].allowed or ())
    (tmp_path / "office.yaml").write_text(SCENE)
    with pytest.raises(irsim.ScenarioNotFoundError) as file:
        irsim.make(tmp_path / "ofice.yaml")
    (near,) = file.value.diagnostics[0].allowed or ()
    assert Path(near).resolve() == tmp_path / "office.yaml"


PARTS: dict[str, Any] = {
    "code": "bad-argument",
    "message": "it is wrong",
    "fix": "write another",
    "diagnostics": [flaw("robot", "it is wrong")],
    "problems": [flaw("w0", "it is wrong")],
    "source": "a.npz",
    "topic": "lidr",
    "near": ["lidar"],
    "searched": ["/"],
    "advice": ["write one"],
}
"""The parts that errors are made of, by the names that their constructors have for it."""


def classes(root: type[IrsimError]) -> set[type[IrsimError]]:
    return {root}.union(*(classes(one) for one in root.__subclasses__()))


def exception_classes() -> list[type[IrsimError]]:
    package = Path(irsim.__file__).parent
    for file in sorted(package.rglob("*.py")):
        if re.search(r"^class \w+Error\(", file.read_text(), re.M):
            importlib.import_module(".".join(["irsim", *file.relative_to(package).with_suffix("").parts]))
    own = [kind for kind in classes(IrsimError) if kind.__module__.startswith("irsim.")]
    return sorted(own, key=lambda kind: (kind.__module__, kind.__name__))


def made(kind: type[IrsimError]) -> IrsimError:
    if kind.__init__ is IrsimError.__init__:
        return kind("it is wrong")
    _, *needed = inspect.signature(kind.__init__).parameters.values()
    return kind(**{one.name: PARTS[one.name] for one in needed if one.default is one.empty})


def test_all_classes_of_errors_have_diagnostics() -> None:
    kinds = exception_classes()
    assert len(kinds) >= 30
    for kind in kinds:
        error = made(kind)
        for one in (error, pickle.loads(pickle.dumps(error))):
            first = one.diagnostics[0]
            assert (first.severity, bool(first.message)) == ("error", True), kind
            assert first.code in (error.code, "invalid-value"), kind
            assert first.as_dict()["message"] == first.message


def world(folder: Path) -> Any:
    (folder / "scene.yaml").write_text(SCENE)
    return irsim.make(folder / "scene.yaml", display=False)


@pytest.mark.parametrize(
    ("action", "kinds", "message"),
    [
        ([1], (ValueError,), "'rover' (diff) takes 2 numbers per action, got 1"),
        ({"rovr": [0, 0]}, (ValueError,), "no object with id or name 'rovr'"),
        ([float("nan"), 0], (ValueError,), "the action for 'rover' is not finite"),
        ("fast", (ValueError, TypeError), "action must be a list, tuple, ndarray or mapping"),
    ],
)
def test_a_wrong_action_is_an_error_of_irsim_and_of_python(
    tmp_path: Path, action: Any, kinds: tuple[type[Exception], ...], message: str
) -> None:
    env = world(tmp_path)
    with pytest.raises(irsim.IrsimError) as caught:
        env.step(action)
    assert all(isinstance(caught.value, kind) for kind in kinds)
    (only,) = caught.value.diagnostics
    assert (caught.value.code, only.path) == ("bad-argument", ("action",))
    assert only.message.startswith(message)
    env.end(ending_time=0)


def test_a_misspelt_object_of_an_action_is_named(tmp_path: Path) -> None:
    env = world(tmp_path)
    with pytest.raises(irsim.IrsimError, match="did you mean rover") as caught:
        env.step({"rovr": [0, 0]})
    assert list(caught.value.diagnostics[0].allowed or ()) == ["rover"]
    env.end(ending_time=0)
