"""Reports say what their numbers take for granted."""

from __future__ import annotations

from pathlib import Path

from irsim.benchmarks.comparison import benchmark
from irsim.benchmarks.report.markdown import markdown

ROBOT = "{kinematics: {name: diff}, state: [1, 1, 0], goal: [3, 2, 0], behavior: {name: dash}%s}"


def assumed(folder: Path, **scenes: tuple[str, str]) -> str:
    """Assumptions in the report of some scenes; (keys of the world, keys of the robot) by name."""
    texts = {
        name: f"world: {{width: 5, height: 5{world}}}\nrobot:\n  - {ROBOT % robot}\n"
        for name, (world, robot) in scenes.items()
    }
    files = {name: folder / f"{name}.yaml" for name in texts}
    for name, text in texts.items():
        files[name].write_text(text, encoding="utf-8")
    report = markdown(benchmark(files, seeds=1, workers=1))
    line, *others = [line for line in report.splitlines() if line.startswith("Taken for granted: ")]
    assert not others
    return line.removeprefix("Taken for granted: ").rstrip()


def test_as_in_2_12(tmp_path: Path) -> None:
    assert assumed(tmp_path, plain=(", step_time: 0.2", "")) == (
        "contacts count at the ends of steps of 0.2 s only; robots change their speed at once (no acce); "
        "behaviors know the poses and velocities of all objects exactly."
    )


def test_limits_and_contacts_within_steps(tmp_path: Path) -> None:
    told = assumed(tmp_path, real=(", contacts: swept", ", acce: [1, 2]"))
    assert told.startswith("contacts within steps count, too; accelerations are limited; ")


def test_scenes_that_differ_are_named(tmp_path: Path) -> None:
    told = assumed(tmp_path, a=("", ""), b=(", contacts: swept", ""), c=("", ""))
    assert told.startswith(
        "in a, c contacts count at the ends of steps of 0.1 s only, in b contacts within steps count, too; robots "
    )
