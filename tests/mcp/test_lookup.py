"""``lookup`` and the resources: the language and the templates, as text."""

from __future__ import annotations

import json

import jsonschema
import pytest
from mcp import Client, MCPError
from mcp.types import ResourceTemplateReference, TextResourceContents

from irsim import api
from irsim.bundled import templates
from irsim.lookup import topics_of
from irsim.options.registry import REGISTRIES
from irsim_mcp.reference import explanation
from tests.mcp.conftest import ERAS, Caller

pytestmark = [pytest.mark.one_python, pytest.mark.anyio]

SECTIONS = ["scenario", "world", "robot", "obstacle", "gui", *sorted(REGISTRIES)]


async def test_index_fits_a_screen_and_leads_on(client: Caller) -> None:
    index = await client.text("lookup", topic="")
    assert len(index.splitlines()) <= 24 + len(templates.names())  # one line for each template
    topics = {"world", "robot", "obstacle", "dash", "lidar2d", "diff", "rectangle", "codes", "metrics"}
    assert [name for name in (*topics, *templates.names()) if name not in index] == []
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
        ("metrics", ["spl", "metric success", "path_irregularity", "more is better"]),
        ("hallway", ["corridor-passing"]),
        ("dash, hallway", ["corridor-passing"]),
        ("dash, car avoids with orca", ["use follow with local: {name: orca}, for cars too"]),
        ("robot.fov, sfm, doorway, quux", ["== robot.fov", "== behavior sfm", "== template doorway", "quux"]),
        ("suites", ["random_polygons_v1"]),
        ("policies", ["sarl"]),
    ],
)
def test_topics(topic: str, said: list[str]) -> None:
    text = explanation(topic, None)
    assert [word for word in said if word not in text] == []
    assert len(text) <= (3_600 if topic in ("suites", "metrics", "policies") else 32_000)  # 8k tokens
    assert "picture.png" not in text  # no path of this machine
    if topic in ("suites", "metrics"):
        assert len(explanation(text.rsplit("such as ", 1)[1], None)) > 50


@pytest.mark.parametrize(
    ("topic", "topics"),
    [
        ("corridor-passing guard-patrol", ["corridor-passing", "guard-patrol"]),
        ("maze queue", ["maze", "queue"]),
        ("range_max noise, crowd lidar2d", ["range_max", "noise", "crowd", "lidar2d"]),
        ("behavior footprint_orca", ["behavior footprint_orca"]),  # one topic as it stands
        ("lidar2d noise", ["lidar2d noise"]),
        ("circle crossing", ["circle crossing"]),
        ("guard-patrol with people", ["guard-patrol with people"]),
    ],
)
def test_names_without_commas_are_several_topics(topic: str, topics: list[str]) -> None:
    assert topics_of(topic) == topics


@pytest.mark.parametrize(
    ("topic", "read_as", "said"),
    [
        ("forklfit", "forklift", "2.4 x 1.2 m"),
        ("pedestiran", "pedestrian", "post, pillar"),
        ("corridor-pasing", "corridor-passing", "```yaml"),
        ("elevater, dash", "elevator", "== behavior dash"),
        ("behavior dahs", "behavior.dash", "straight"),
        ("lidr", "lidar", "range_max"),
    ],
)
def test_a_misspelt_word_is_answered_at_once(topic: str, read_as: str, said: str) -> None:
    text = explanation(topic, None)
    assert f"No such topic; nearest: {read_as!r}. " in text.splitlines()[0]
    assert said in text


def test_several_topics_are_answered_briefly_and_each_thing_once() -> None:
    text = explanation(
        "compass, weather, rain, magnetometer, ice, doorway, corridor-passing, feet, mph, drone, uav", None
    )
    assert text.count("The world is flat and seen from above") == 1
    assert text.count("1 in = 0.0254 m") == 1
    assert text.count("keeps its height is kinematics omni") == 1
    for said in (
        "rain: see limits above",
        "magnetometer: see compass above",
        "uav: see drone above",
        "1 mph = 0.44704 m/s",
    ):
        assert f"== {said}" in text
    assert "```yaml" not in text  # whole templates come alone
    assert "lookup with topic: doorway, alone, returns its YAML" in text
    assert len(text) < 4_200


@pytest.mark.parametrize("name", templates.names())
def test_templates_come_as_yaml_that_is_valid(name: str) -> None:
    text = explanation(name, None)
    assert text.startswith(f"template {name}")
    assert "yaml-language-server" not in text
    assert api.validate(text=text.split("```yaml\n")[1].split("```")[0]).valid


def test_no_outcome_is_promised_for_other_parameters() -> None:
    text = explanation("u-trap", {"behavior": "dash"})
    assert "With the default parameters it ends in success; with behavior=dash it may end otherwise: run it." in text


async def test_parameters_are_filled_in(client: Caller) -> None:
    text = await client.text("lookup", topic="circle-swap", parameters={"robots": 5, "kinematics": "omni"})
    for said in ("number: 5", "kinematics: {name: omni}", "scenario.yaml with robots=5, kinematics=omni:"):
        assert said in text
    as_text = '{"robots": 5}'  # some hosts send objects as text
    assert "number: 5" in await client.text("lookup", topic="circle-swap", parameters=as_text)


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        ({"topic": "xyzzy"}, "unknown-topic: 'xyzzy' is not a topic (topic)."),
        ({"topic": "xyzzy"}, "Fix: lookup without a topic lists all topics."),
        ({"topic": "xyzzy", "parameters": {"a": 1}}, "unknown-template: there is no template 'xyzzy'"),
        ({"topic": "crossing", "parameters": {"beam": 1}}, "(parameters). Fix: did you mean beams?"),
        ({"topic": "crossing", "parameters": {"beams": 1.5}}, "bad-parameter: beams cannot be 1.5"),
        ({"topic": "x" * 300}, "bad-argument: "),
        ({"topic": ", ".join(f"robot.k{n}" for n in range(13))}, "bad-argument: "),
    ],
)
async def test_errors(client: Caller, arguments: dict[str, object], error: str) -> None:
    assert error in await client.error("lookup", **arguments)


async def text_at(client: Client, uri: str) -> str:
    content = (await client.read_resource(uri)).contents[0]
    assert isinstance(content, TextResourceContents)
    return content.text


@pytest.mark.parametrize("era", ERAS)
async def test_resources_can_be_listed_and_read(client: Caller) -> None:
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
async def test_every_listed_resource_can_be_read_and_is_what_it_says(client: Caller) -> None:
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
async def test_other_resources_do_not_exist(client: Caller, uri: str) -> None:
    with pytest.raises(MCPError) as error:
        await client.read_resource(uri)
    assert error.value.code == -32602


async def test_names_are_completed(client: Caller) -> None:
    ref = ResourceTemplateReference(type="ref/resource", uri="irsim://templates/{name}")
    completed = await client.complete(ref, {"name": "name", "value": "c"})
    assert {"car-park", "circle-swap", "corridor-passing", "crossing"} <= set(completed.completion.values)
