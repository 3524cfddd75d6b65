"""The work of an agent, through a real client and a real process: template, edit, validate, look, run."""

from __future__ import annotations

import base64
import io
from pathlib import Path

import jsonschema
import pytest
from PIL import Image

from tests.mcp.conftest import ERAS, Caller, as_process, data_of, image_of, text_of

pytestmark = pytest.mark.anyio


@pytest.mark.parametrize("era", ERAS)
async def test_from_a_template_to_a_run(workspace: Path, era: str) -> None:
    async with Caller(as_process(workspace), mode=era) as client:
        tools = {tool.name: tool for tool in (await client.list_tools()).tools}

        index = await client.text("lookup")
        assert len(index.splitlines()) <= 75
        assert "corridor-passing" in index

        answer = await client.text("lookup", topic="corridor-passing", parameters={"width": 1.4})
        scenario = answer.split("```yaml\n")[1].split("```")[0]
        (workspace / "mine.yaml").write_text(scenario.replace("eastbound", "nurse"), encoding="utf-8")

        wrong = scenario.replace("behavior:", "behaviour:")
        report = await client.data("validate_scenario", scenario_yaml=wrong)
        assert report["valid"] is False
        assert [issue["fix"] for issue in report["issues"]] == ["rename it to 'behavior'"] * 2

        source = {"scenario_path": "mine.yaml"}
        result = await client.call_tool("validate_scenario", source)
        assert data_of(result)["valid"] is True
        jsonschema.validate(result.structured_content, tools["validate_scenario"].output_schema or {})

        picture = await client.call("render_snapshot", **source, seed=7)
        assert "'nurse' at (1.00, 2.40)" in text_of(picture)
        with Image.open(io.BytesIO(base64.b64decode(image_of(picture).data))) as image:
            assert (image.format, image.mode, max(image.size)) == ("PNG", "P", 600)

        result = await client.call("run_episode", **source, seed=7)
        data = data_of(result)
        assert (data["outcome"], data["seed"], data["robot_count"]) == ("success", 7, 2)
        assert data["reproduce"] == "irsim run mine.yaml --seed 7 --strict"
        assert {robot["name"] for robot in data["robots"]} == {"nurse", "westbound"}
        jsonschema.validate(result.structured_content, tools["run_episode"].output_schema or {})

        end = await client.text("render_snapshot", **source, seed=7, step=-1, return_image=False)
        assert "'nurse' arrived" in end
    assert sorted(path.name for path in workspace.iterdir()) == [".irsim", "mine.yaml"]
