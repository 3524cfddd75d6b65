"""``irsim describe``: whatever one may ask for is found, and near misses are helped."""

from __future__ import annotations

from typing import get_args

import pytest

from irsim.bundled import templates
from irsim.common.event_kinds import EVENTS, EventKind
from irsim.diagnostics.codes import CODES, TOOL_CODES
from irsim.lookup import as_brief_text, as_text, lookup
from irsim.lookup.full_text import Document, best
from irsim.metrics import EPISODE_METRICS, METRICS
from irsim.options.registry import REGISTRIES
from tests.cli.conftest import Run, parsed

pytestmark = pytest.mark.one_python


def test_without_a_topic_it_lists_what_there_is(irsim: Run) -> None:
    shown = irsim("describe").stdout
    for word in ("world", "robot", "obstacle", "behavior", "sensor", "kinematics", *templates.names()):
        assert word in shown
    assert len(shown.splitlines()) <= 60


def test_a_path_gives_type_unit_default_and_meaning(irsim: Run) -> None:
    shown = irsim("describe", "robot.sensors.lidar2d.range_max").stdout
    assert "robot.sensors.lidar2d.range_max" in shown
    assert "a number [m]" in shown
    assert "default 10" in shown
    about = lookup("robot.sensors.lidar2d.range_max").about
    assert about is not None
    assert about.text


def test_what_a_word_probably_means_comes_before_other_topics(irsim: Run) -> None:
    shown = irsim("describe", "lidar", code=0).stdout
    assert shown.startswith("sensor lidar2d")
    assert 0 < shown.index("range_max") < shown.index("robot.sensors.fmcw_lidar2d")


@pytest.mark.parametrize(
    "topic",
    ["robot[0].vel_max", "obstacle.shape.circle.radius", "world.plot.viewpoint", "gui.keyboard", "world", "robot"],
)
def test_paths_of_all_kinds(irsim: Run, topic: str) -> None:
    irsim("describe", topic, code=0)
    assert lookup(topic).kind == "key"


@pytest.mark.parametrize("topic", ["behavior dash", "behavior.dash", "robot.behavior.dash", "dash", "behaviors dash"])
def test_a_component_by_any_of_its_names(irsim: Run, topic: str) -> None:
    shown = irsim("describe", *topic.split()).stdout
    assert shown.startswith("behavior dash")
    assert "angle_tolerance" in shown
    assert "[rad]" in shown
    assert "behavior: {name: dash" in shown


@pytest.mark.parametrize("kind", sorted(REGISTRIES))
def test_every_component_is_described(kind: str) -> None:
    for name in REGISTRIES[kind].names():
        answer = lookup(f"{kind} {name}")
        assert answer.kind == "component", name
        assert answer.text, name
        for keys in answer.groups.values():
            assert all(key.text for key in keys), [key.name for key in keys if not key.text]


@pytest.mark.parametrize("topic", ["sensor", "sensors", "robot.sensors", "shapes", "behavior", "kinematics", "map"])
def test_a_kind_lists_its_components(topic: str) -> None:
    (listed,) = lookup(topic).groups.values()
    assert len(listed) >= 2


def test_codes_are_explained(irsim: Run) -> None:
    shown = irsim("describe", "unknown-key").stdout
    assert CODES["unknown-key"].explanation.split(".")[0] in " ".join(shown.split())
    assert {*CODES, *TOOL_CODES} == {key.name for keys in lookup("codes").groups.values() for key in keys}


def test_templates_show_their_parameters(irsim: Run) -> None:
    shown = irsim("describe", "corridor-passing").stdout
    assert "width" in shown
    assert "from 1.2 to 4 m" in shown
    assert "irsim new corridor-passing --set width=1.6" in shown


def test_a_suite_is_told_briefly_unless_all_of_it_is_asked_for(irsim: Run) -> None:
    brief, whole = irsim("describe", "social_v2").stdout, irsim("describe", "social_v2", "-v").stdout
    assert len(brief.splitlines()) <= 10
    assert "seeds: 100000 to 100049 (200 with --full); time: at most 100 s; protocols: freeze, yield" in brief
    assert "policies: as-written, orca, sfm, dash" in brief
    assert "irsim benchmark social_v2 --seeds 5" in brief
    assert "irsim describe social_v2 -v" in brief
    for detail in ("timeHorizonObst", "Francis et al.", "100000 to 100049"):
        assert detail in whole
    assert "timeHorizonObst" not in brief


def test_metrics_are_explained(irsim: Run) -> None:
    shown = irsim("describe", "aggregated_time").stdout
    assert shown.startswith("metric aggregated_time")
    assert "the greatest time_to_goal" in " ".join(shown.split())
    assert "Less is better" in shown
    assert "[s]" in shown
    assert "spl: [0-1] + success" in as_text(lookup("metrics"))
    assert "is better" not in as_text(lookup("metrics")).replace("more is better, -", "")
    listed = [key.name for keys in lookup("metrics").groups.values() for key in keys]
    assert len(listed) == len(METRICS) + len(EPISODE_METRICS)
    for name in listed:
        answer = lookup(name)
        assert (answer.kind, answer.topic, answer.see[0]) == ("metric", name, "metrics")
    for metric in (*METRICS, *EPISODE_METRICS):
        for asked in (f"metric {metric.key}", f"metrics.{metric.key}"):
            assert lookup(asked).title == f"metric {metric.key}"
    assert lookup("success").see == ["metric success"]  # the word has a guide of its own
    assert lookup("success").kind == "guide"


def test_a_key_alone_is_found_wherever_it_is() -> None:
    assert lookup("vel_max").topic in ("robot.vel_max", "obstacle.vel_max")
    several = lookup("radius")
    assert several.kind == "search"
    assert "robot.shape.circle.radius" in {key.name for keys in several.groups.values() for key in keys}


def test_a_key_of_many_places_has_one_line_for_each_meaning() -> None:
    lines = lookup("wheelbase").groups["topics"]
    places = ("robot.shape.rectangle", "robot.kinematics.diff", "robot.kinematics.single_track")
    assert [line.name for line in lines] == [f"{place}.wheelbase" for place in places]
    assert "The same key of circle, polygon, linestring, compound, compound.parts.circle" in lines[0].text
    assert "omni_angular" in lines[1].text
    assert lookup("wheelbase").example == "wheelbase: 2.6"
    assert len(as_text(lookup("wheelbase"))) < 700


def test_the_list_of_templates_is_short_and_has_their_names_among_other_topics() -> None:
    answer = lookup("templates")
    assert len(as_text(answer)) < 3800
    assert as_brief_text(answer).splitlines()[1] == f"- templates: {', '.join(templates.names())}"
    for line in answer.groups["templates"]:
        assert 20 < len(line.text) < 80
        assert templates.load(line.name).purpose.startswith(line.text)


def test_other_words_are_searched_for(irsim: Run) -> None:
    assert "corridor-passing" in irsim("describe", "hallway").stdout


@pytest.mark.parametrize(
    ("topic", "near"),
    [
        ("robot.sensors.lidar2d.range_maks", "robot.sensors.lidar2d.range_max"),
        ("behavior dahs", "behavior.dash"),
        ("wrld.widht", "world.width"),
    ],
)
def test_a_miss_of_several_words_shows_what_is_near(irsim: Run, topic: str, near: str) -> None:
    assert irsim("describe", *topic.split(), code=0).stdout.startswith(f"No such topic; nearest: '{near}'. ")


@pytest.mark.parametrize(("word", "near"), [("unknwon-kye", "unknown-key"), ("path_iregularity", "path_irregularity")])
def test_a_misspelt_word_is_read_as_the_name_that_is_clearly_nearest(irsim: Run, word: str, near: str) -> None:
    assert irsim("describe", word, code=0).stdout.startswith(f"No such topic; nearest: '{near}'. ")
    assert parsed(irsim("describe", word, "--json"))["read_as"] == near


def test_json(irsim: Run) -> None:
    assert parsed(irsim("describe", "dash", "--json")) == lookup("dash").model_dump(mode="json")


@pytest.mark.parametrize(
    ("words", "title"),
    [
        ("reset", "program: the Python loop"),
        ("env.reset", "program: the Python loop"),
        ("seeds", "seeds: what is random"),
        ("pillar", "things: how everyday"),
        ("obstacle avoidance", "avoidance: what each behavior avoids"),
        ("radians", "units: metres"),
        ("altitude", "limits: what cannot be simulated"),
        ("drone", "drone: only one that keeps its height"),
        ("3D", "limits: what cannot be simulated"),
        ("stagger", "limits: what cannot be simulated"),
        ("trap", "dead-ends: traps"),
        ("U-shape", "dead-ends: traps"),
        ("local minimum", "dead-ends: traps"),
        ("forbidden area", "keep-out: an area"),
        ("frontier exploration", "exploration: driving"),
        ("explored", "exploration: driving"),
        ("conversation", "standing-group: people"),
        ("acker orca", "avoidance: what each behavior avoids"),
    ],
)
def test_guides_about_what_is_no_key(irsim: Run, words: str, title: str) -> None:
    assert irsim("describe", words).output.startswith(title)


def test_words_are_found_whole_and_one_by_one(irsim: Run) -> None:
    assert "step_mode" in irsim("describe", "external").output
    assert "Nothing about 'quux'" in irsim("describe", "quux beams").output
    assert "interaction" not in irsim("describe", "actio").output


@pytest.mark.parametrize(
    ("words", "among"),
    [
        ("acker avoidance footprint circle", "robot.shape"),
        ("turn_rate", "robot.vel_max"),
        ("top speed", "robot.vel_max"),
        ("how high can a drone fly", "drone"),
        ("person appears after some time", "limits"),
        ("narrow gap", "narrow-passage"),
        ("lidar noise", "robot.sensors.lidar2d.noise"),
        ("car between walls", "avoidance"),
        ("door", "doorway"),
        ("makespan greatest time", "aggregated_time"),
        ("heading change", "cumulative_heading_change"),
    ],
)
def test_free_text_finds_the_few_topics_that_fit_best(words: str, among: str) -> None:
    answer = lookup(words)
    (hits,) = answer.groups.values()
    assert answer.kind == "search"
    assert 1 <= len(hits) <= 5
    assert among in [hit.name for hit in hits]
    assert all(len(hit.text) < 200 for hit in hits)
    for hit in hits:
        assert lookup(hit.name).topic == hit.name


def test_a_page_with_all_words_comes_before_one_with_a_rare_word() -> None:
    rare = Document("rare", "wheelbase wheelbase", "")
    whole = Document("whole", "", "wheelbase of a car red red red")
    others = [Document(f"page {k}", "", "car of another kind") for k in range(3)]
    names, unknown = best([rare, *others, whole], "wheelbase car")
    assert names[:2] == ["whole", "rare"]
    assert not unknown


def test_words_of_a_code_in_any_order_find_it() -> None:
    assert lookup("unreachable-goal").topic == "goal-unreachable"
    assert lookup("key unknown").topic == "unknown-key"


def test_only_what_fits_nothing_is_an_error(irsim: Run) -> None:
    result = irsim("describe", "xyzzy")
    assert (result.exit_code, "unknown-topic" in result.stderr) == (2, True)


def test_colors_are_not_listed_one_by_one() -> None:
    (keys,) = [keys for name, keys in lookup("fmcw_lidar2d").groups.items() if name == "keys"]
    colors = [key for key in keys if key.name.endswith("_color") and key.name != "velocity_color"]
    assert len(colors) >= 4
    assert {(key.type, key.allowed) for key in colors} == {("a color", None)}
    assert "#3366cc" in lookup("robot.color").text


def test_the_local_behavior_has_its_keys_by_behavior() -> None:
    answer = lookup("robot.behavior.follow.local")
    keys = {name: [key.name for key in keys] for name, keys in answer.groups.items()}
    assert "timeHorizon" in keys["keys of orca"]
    assert "timeHorizon" not in keys["keys of rvo"]
    assert "wander" in keys["keys of all"]
    assert answer.example is not None
    assert answer.example.startswith("local: {name: orca")


def test_numbers_without_a_unit_are_told_without() -> None:
    for template in templates.load_all():
        for parameter in template.parameters.values():
            assert not parameter.allowed().endswith(" 1") or parameter.max == 1


def test_several_topics_are_answered_briefly_in_one_call(irsim: Run) -> None:
    shown = irsim("describe", "robot.fov,", "sfm,", "behavior", "dash").stdout
    assert shown.index("robot.fov") < shown.index("behavior sfm") < shown.index("behavior dash")
    assert len(shown) < len(irsim("describe", "sfm").stdout)
    assert "keys it has in common with the others: wander" in shown


def test_an_unknown_topic_among_others_does_not_stop_the_others(irsim: Run) -> None:
    result = irsim("describe", "robot.fov, quux", "--json")
    assert [answer["topic"] for answer in parsed(result)["answers"]] == ["robot.fov"]
    assert "quux" in result.stderr
    assert irsim("describe", "quux, xyzzy").exit_code == 2


@pytest.mark.parametrize(
    ("word", "topic"),
    [
        ("vision cone", "robot.fov"),
        ("guard", "guard-patrol"),
        ("sees", "robot.fov"),
        ("surveillance", "robot.fov"),
        ("courtyard", "robot.shape.linestring"),
        ("passage", "corridor-passing"),
        ("bend", "l-passage"),
        ("evacuation", "room-evacuation"),
        ("braking", "robot.acce"),
    ],
)
def test_everyday_words_lead_to_the_part_of_the_language(word: str, topic: str) -> None:
    assert topic in [key.name for key in lookup(word).groups["topics"][:3]]


def test_title_is_the_key_of_pictures() -> None:
    assert lookup("title").topic == "world.plot.title"


@pytest.mark.parametrize("kind", ["contact_between_steps", "passed_through", "overshoot"])
def test_kinds_of_events_have_pages(kind: EventKind) -> None:
    answer = lookup(kind)
    assert (answer.topic, answer.kind) == (kind, "event")
    assert answer.text == EVENTS[kind]
    assert {line.name for line in lookup("events").groups["events"]} == set(get_args(EventKind))
