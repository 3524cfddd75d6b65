"""``lookup`` and the resources: the language and the templates, as text."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest
from mcp import Client, MCPError
from mcp.types import ResourceTemplateReference, TextResourceContents

from irsim import api
from irsim.bundled import templates
from irsim.options.registry import REGISTRIES
from tests.mcp.conftest import ERAS, connected, error_of, text_of

pytestmark = [pytest.mark.one_python, pytest.mark.anyio]

SECTIONS = ["scenario", "world", "robot", "obstacle", "gui", *sorted(REGISTRIES)]
MOST_CHARACTERS = 32_000  # 8k tokens


async def looked_up(empty: Path, topic: str, **arguments: object) -> str:
    async with connected(empty) as client:
        return text_of(await client.call_tool("lookup", {"topic": topic, **arguments}))


async def test_index_fits_a_screen_and_leads_on(empty: Path) -> None:
    index = await looked_up(empty, "")
    lines = index.splitlines()
    assert len(lines) <= 24 + len(templates.names())  # one line for each template
    for name in (
        "world",
        "robot",
        "obstacle",
        "dash",
        "lidar2d",
        "diff",
        "rectangle",
        "codes",
        "metrics",
        *templates.names(),
    ):
        assert name in index
    assert "irsim describe" not in index


@pytest.mark.parametrize(
    ("topic", "said"),
    [
        ("robot.sensors.lidar2d.range_max", ["default 10", "[m]"]),
        ("lidar2d", ["range_max", "angle_range", "For example"]),
        ("robot", ["kinematics", "behavior", "goal_threshold"]),
        ("vel_max", ["Upper limits"]),
        ("behavior", ["dash", "orca"]),
        ("unknown-key", ["not part of the language"]),
        ("out-of-time", ["stopped"]),
        ("codes", ["unknown-key", "path-outside-workspace", "busy"]),
        ("parking", ["car-park"]),
        ("aggregated_time", ["a number [s]", "the greatest time_to_goal", "Less is better"]),
        ("metrics", ["spl", "metric success", "path_irregularity", "more is better"]),
        ("hallway", ["corridor-passing"]),
        ("path must exist", ["goal-unreachable", "pictures", "narrowest gap of the widest path"]),
        ("car avoids with orca", ["use follow with local: {name: orca}, for cars too"]),
        ("dash, car avoids with orca", ["use follow with local: {name: orca}, for cars too"]),
    ],
)
async def test_topics(empty: Path, topic: str, said: list[str]) -> None:
    text = await looked_up(empty, topic)
    assert len(text) < MOST_CHARACTERS
    for word in said:
        assert word in text


async def test_no_path_of_this_machine_is_told(empty: Path) -> None:
    for topic in ("hallway", "dash, hallway"):
        assert "corridor-passing" in (text := await looked_up(empty, topic))
        assert "picture.png" not in text


@pytest.mark.parametrize("name", templates.names())
async def test_templates_come_as_yaml_that_is_valid(empty: Path, name: str) -> None:
    text = await looked_up(empty, name)
    assert text.startswith(f"template {name}")
    assert "yaml-language-server" not in text
    assert api.validate(text=text.split("```yaml\n")[1].split("```")[0]).valid


async def test_no_outcome_is_promised_for_other_parameters(empty: Path) -> None:
    text = await looked_up(empty, "u-trap", parameters={"behavior": "dash"})
    assert "With the default parameters it ends in success; with behavior=dash it may end otherwise: run it." in text


async def test_parameters_are_filled_in(empty: Path) -> None:
    text = await looked_up(empty, "circle-swap", parameters={"robots": 5, "kinematics": "omni"})
    assert "number: 5" in text
    assert "kinematics: {name: omni}" in text
    assert "scenario.yaml with robots=5, kinematics=omni:" in text
    as_text = await looked_up(empty, "circle-swap", parameters='{"robots": 5}')  # some hosts send objects as text
    assert "number: 5" in as_text


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        (
            {"topic": "corridor-pasing"},
            "unknown-topic: 'corridor-pasing' is not a topic (topic). Fix: did you mean ",
        ),
        ({"topic": "xyzzy"}, "Fix: lookup without a topic lists all topics."),
        ({"topic": "xyzzy", "parameters": {"a": 1}}, "unknown-template: there is no template 'xyzzy'"),
        ({"topic": "crossing", "parameters": {"beam": 1}}, "(parameters). Fix: did you mean beams?"),
        ({"topic": "crossing", "parameters": {"beams": 1.5}}, "bad-parameter: beams cannot be 1.5"),
        ({"topic": "x" * 300}, "bad-argument: "),
    ],
)
async def test_errors(empty: Path, arguments: dict[str, object], error: str) -> None:
    async with connected(empty) as client:
        assert error in error_of(await client.call_tool("lookup", arguments))


async def text_at(client: Client, uri: str) -> str:
    content = (await client.read_resource(uri)).contents[0]
    assert isinstance(content, TextResourceContents)
    return content.text


@pytest.mark.parametrize("era", ERAS)
async def test_resources_can_be_listed_and_read(empty: Path, era: str) -> None:
    async with connected(empty, era) as client:
        uris = [str(resource.uri) for resource in (await client.list_resources()).resources]
        patterns = [template.uri_template for template in (await client.list_resource_templates()).resource_templates]
        text = await text_at(client, "irsim://templates/crossing")
        deeper = json.loads(await text_at(client, "irsim://schema/robot.sensors.lidar2d"))
    assert patterns[:2] == ["irsim://schema/{section}", "irsim://templates/{name}"]
    assert len(uris) == len(set(uris))
    assert sum(uri.startswith(("irsim://schema/", "irsim://templates/")) for uri in uris) == len(SECTIONS) + len(
        templates.names()
    )
    assert api.validate(text=text).valid
    assert "range_max" in deeper["properties"]


@pytest.mark.slow
async def test_every_listed_resource_can_be_read_and_is_what_it_says(empty: Path) -> None:
    async with connected(empty) as client:
        listed = [str(resource.uri) for resource in (await client.list_resources()).resources]
        uris = [uri for uri in listed if uri.startswith("irsim://")]
        texts = {uri: await text_at(client, uri) for uri in uris}
    for text in texts.values():
        assert 100 < len(text) < 1_000_000
    schemas = {name: json.loads(texts[f"irsim://schema/{name}"]) for name in SECTIONS}
    for schema in schemas.values():
        jsonschema.Draft202012Validator.check_schema(schema)
    entry = jsonschema.Draft202012Validator(schemas["robot"])
    assert entry.is_valid({"kinematics": {"name": "diff"}, "state": [1, 1, 0]})
    assert not entry.is_valid({"kinematics": {"name": "dif"}})
    for name in templates.names():
        assert f"irsim://templates/{name}" in texts


@pytest.mark.parametrize(
    "uri",
    [
        "irsim://templates/nope",
        "irsim://templates/..%2F..%2Fpyproject.toml",
        "irsim://templates/../../x",
        "irsim://templates//etc/passwd",
        "irsim://schema/nope",
        "irsim://runs/1",
    ],
)
async def test_other_resources_do_not_exist(empty: Path, uri: str) -> None:
    async with connected(empty) as client:
        with pytest.raises(MCPError) as error:
            await client.read_resource(uri)
    assert error.value.code == -32602


async def test_names_are_completed(empty: Path) -> None:
    async with connected(empty) as client:
        ref = ResourceTemplateReference(type="ref/resource", uri="irsim://templates/{name}")
        completed = await client.complete(ref, {"name": "name", "value": "c"})
    assert {"car-park", "circle-swap", "corridor-passing", "crossing"} <= set(completed.completion.values)


async def test_several_topics_are_answered_in_one_call(empty: Path) -> None:
    text = await looked_up(empty, "robot.fov, sfm, doorway, no-such-thing-zq")
    assert "== robot.fov" in text
    assert "== behavior sfm" in text
    assert "scenario.yaml with the default parameters" in text  # of the template
    assert "no-such-thing-zq" in text


async def test_too_many_topics_are_refused(empty: Path) -> None:
    async with connected(empty) as client:
        result = await client.call_tool("lookup", {"topic": ", ".join(f"robot.k{n}" for n in range(13))})
    assert "bad-argument" in error_of(result)


@pytest.mark.parametrize("topic", ["suites", "metrics", "policies"])
async def test_lists_are_short(empty: Path, topic: str) -> None:
    text = await looked_up(empty, topic)
    assert len(text) <= 3600
    if topic != "policies":
        last = text.rsplit("such as ", 1)[1]
        assert len(await looked_up(empty, last)) > 50
    assert ("random_polygons_v1" if topic == "suites" else "success" if topic == "metrics" else "sarl") in text
