"""A notebook in a kernel of Jupyter without a display: what its cells show, and where files go."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.records

SCENE = """
world: {width: 10, height: 10, step_time: 0.1, time_limit: 6}
robot: {name: courier, state: [1, 5, 0], goal: [9, 5], kinematics: {name: diff}, behavior: {name: dash},
        shape: {name: circle, radius: 0.3}, sensors: [{name: lidar2d, number: 60, range_max: 4}]}
obstacle: {state: [5, 7.5], shape: {name: circle, radius: 0.8}}
"""
CELLS = {
    "start": 'import irsim\nenv = irsim.make("scene.yaml", seed=1)\nenv',
    "loop": "for _ in range(12):\n    env.step()\n    env.render()",
    "again": "import matplotlib.pyplot as plt\nenv.step()\nenv.render()",
    "pyplot": 'other = irsim.make("scene.yaml", display=False)\nother.render()\nother.step()',
    "replay": "env.replay()",
    "batch": 'irsim.batch("scene.yaml", 3)',
    "run": 'result = irsim.run("scene.yaml")\nresult',
    "replay of a run": "result.replay()",
    "benchmark": 'irsim.benchmark(["scene.yaml"], ["dash", "orca"], seeds=2)',
    "policy": 'irsim.open_policy("orca")',
    "vector": 'from irsim.learning import VectorEnv\nVectorEnv("goal_lidar", 4)',
    "table": "result.to_pandas().tail(2)",
    "film": (
        'film = irsim.make("scene.yaml", save_ani=True)\nfor _ in range(3):\n    film.step()\n    film.render()\n'
        "film.end(ending_time=0)"
    ),
    "mistake": 'irsim.make("scene.yml")',
}


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, list[Any]], Path]:
    """The outputs of each cell, and the folder of the notebook, in which it stays as `notebook.ipynb`."""
    import nbformat
    from nbclient import NotebookClient

    folder = tmp_path_factory.mktemp("notebook")
    (folder / "scene.yaml").write_text(SCENE, encoding="utf-8")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(text) for text in CELLS.values()])
    client = NotebookClient(notebook, timeout=120, allow_errors=True, resources={"metadata": {"path": str(folder)}})
    client.execute()
    nbformat.write(notebook, folder / "notebook.ipynb")
    outputs = [[one for one in cell.outputs if one.output_type != "stream"] for cell in notebook.cells]
    return dict(zip(CELLS, outputs, strict=True)), folder


def test_notebooks_and_editors_complete_names_and_arguments() -> None:
    import jedi

    begin = "import irsim\nenv = irsim.make('scene.yaml')\n"
    for text, name in (("irsim.ma", "make"), ("env.get_lidar_s", "get_lidar_scan")):
        assert [one.name for one in jedi.Script(begin + text).complete(3, len(text))] == [name]
    [call] = jedi.Script(f"{begin}irsim.make(").get_signatures(3, 11)
    assert {"world_name", "display", "seed"} <= {one.name for one in call.params}


def only(outputs: list[Any]) -> Any:
    """The data of the only output of a cell."""
    [output] = outputs
    assert output.output_type != "error", output.get("evalue")
    return output.data


@pytest.mark.parametrize("cell", ["start", "batch", "vector"])
def test_environments_show_their_world(shown: tuple[dict[str, list[Any]], Path], cell: str) -> None:
    assert 'src="data:image/png;base64,' in only(shown[0][cell])["text/html"]


@pytest.mark.parametrize(
    ("cell", "words"), [("run", "courier"), ("benchmark", "95 % interval"), ("policy", "Policy orca"), ("table", "vx")]
)
def test_results_and_policies_show_their_facts(shown: tuple[dict[str, list[Any]], Path], cell: str, words: str) -> None:
    assert words in only(shown[0][cell])["text/html"]


@pytest.mark.parametrize("cell", ["loop", "again"])
def test_a_loop_updates_one_picture(shown: tuple[dict[str, list[Any]], Path], cell: str) -> None:
    data = only(shown[0][cell])
    assert data["image/png"]
    assert data != only(shown[0]["again" if cell == "loop" else "loop"])


def test_an_environment_without_display_shows_nothing(shown: tuple[dict[str, list[Any]], Path]) -> None:
    assert not shown[0]["pyplot"]


@pytest.mark.parametrize("cell", ["replay", "replay of a run"])
def test_a_replay_is_inside_the_cell(shown: tuple[dict[str, list[Any]], Path], cell: str) -> None:
    text = only(shown[0][cell])["text/html"]
    assert text.startswith("<iframe ")
    assert "srcdoc=" in text
    assert "courier" not in text  # the run is packed


def test_an_animation_is_written_beside_the_notebook(shown: tuple[dict[str, list[Any]], Path]) -> None:
    assert [path.suffix for path in (shown[1] / "animation").iterdir()] == [".gif"]


def test_a_mistake_is_an_error_of_irsim(shown: tuple[dict[str, list[Any]], Path]) -> None:
    [error] = shown[0]["mistake"]
    assert error.ename == "ScenarioNotFoundError"
    assert "did you mean" in error.evalue.lower()
