"""The harness where inspect_ai is not installed: arms, recordings, folders, distractors."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from mcp import Client
from mcp.types import TextContent

from irsim.diagnostics.errors import ArgumentError
from irsim_evals.cases.store import case_of, golds_of
from irsim_evals.grader.outcome import Cost
from irsim_evals.harness.arms import MODEL_ARMS, Side, briefing, skill_folders, skills_hash
from irsim_evals.harness.distractors import build_office
from irsim_evals.harness.folder import Folder, FolderError, run_command
from irsim_evals.harness.prices import known_price
from irsim_evals.harness.recording import (
    Attempt,
    Header,
    Names,
    Recording,
    grade_recording,
    read_recording,
    scrubbed,
    task_hash,
    write_recording,
)
from irsim_evals.harness.run import run_arm
from tests.evals.conftest import irsim_evals, refusal


@pytest.fixture
def recording() -> Recording:
    """Two attempts at a case: a right one, and one that an error ended."""
    instance = case_of("pub-01", 4)
    gold = golds_of(instance)[0]
    known = {"case": "pub-01", "instance": "4", "arm": "skill", "task": task_hash(instance)}
    right = Attempt(**known, files=dict(gold.files), replies=["Done."], cost=Cost(tokens=7))
    broken = Attempt(**known, trial=2, ended="the model's service failed: status 529", failed=True)
    return Recording(header=Header(arm="skill", model="anthropic/x", date="2026-01-01"), attempts=[right, broken])


def test_without_the_extra_the_error_names_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "inspect_ai", None)
    with pytest.raises(ArgumentError, match=r"inspect_ai is not installed.*pip install 'irsim-mcp\[evals\]'"):
        run_arm("skill", [case_of("pub-01")], model="anthropic/x", log_dir=tmp_path)


@pytest.mark.parametrize(
    ("arm", "cases", "epochs", "message"),
    [
        ("rules", ["pub-01"], 1, "no model answers in the arm 'rules'"),
        ("skill", [], 1, "there is no case to answer"),
        ("skill", ["pub-01"], 0, "at least one attempt"),
    ],
)
def test_wrong_arguments_are_refused(arm: str, cases: list[str], epochs: int, message: str, tmp_path: Path) -> None:
    with pytest.raises(ArgumentError, match=message):
        run_arm(arm, [case_of(name) for name in cases], model="anthropic/x", log_dir=tmp_path, epochs=epochs)


def test_a_recording_is_graded_without_the_extra(
    recording: Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "inspect_ai", None)
    path = tmp_path / "recording.jsonl"
    write_recording(recording, path)
    assert read_recording(path) == recording
    right, broken = run_arm(
        "skill", [case_of("pub-01", 4)], model=None, log_dir=tmp_path, replay=path, replay_mode="grade"
    )
    assert (right.verdict.strict, right.number, right.reply, right.model) == (True, 1, "Done.", "anthropic/x")
    assert right.verdict.cost.tokens == 7
    assert (broken.verdict.strict, broken.number) == (False, 2)
    assert broken.ended == broken.verdict.outcomes[0].observed == "the model's service failed: status 529"


def test_a_recording_of_another_prompt_is_refused(recording: Recording) -> None:
    recording.attempts[0].task = "0123"
    with pytest.raises(ArgumentError, match="the prompt or the files of pub-01@4 have changed"):
        grade_recording(recording, [case_of("pub-01", 4)])


@pytest.mark.parametrize("text", ["", "no json\n", '{"kind": "header"}\n', "[]\n"])
def test_other_files_are_no_recordings(text: str, tmp_path: Path) -> None:
    path = tmp_path / "other.jsonl"
    path.write_text(text)
    with pytest.raises(ArgumentError, match="is not a recording"):
        read_recording(path)
    with pytest.raises(ArgumentError, match="cannot be read"):
        read_recording(tmp_path / "missing.jsonl")


def test_keys_and_paths_are_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOME_API_KEY", "hunter2hunter2")
    said = {"a": [f"in {tmp_path}/work/x.yaml", "sk-ant-abcdefghij and hunter2hunter2"], "b": 3}
    assert scrubbed(said, [tmp_path / "work"]) == {"a": ["in <folder>/x.yaml", "<secret> and <secret>"], "b": 3}
    assert str(Path.home()) not in scrubbed(f"{Path.home()}/.config and {sys.prefix}/lib")


def test_ids_of_runs_are_numbered_and_filled_in_again() -> None:
    recorded, now = Names(), Names()
    assert recorded.numbered("Run: hall-0a1b2c, then hall-ffffff and hall-0a1b2c") == "Run: $run1, then $run2 and $run1"
    assert recorded.known({"run_id": "hall-ffffff", "other": "hall-123456"}) == {
        "run_id": "$run2",
        "other": "hall-123456",
    }
    now.numbered("Run: hall-aaaaaa, then hall-bbbbbb")
    assert now.filled({"run_id": ["$run2", "$run3"]}) == {"run_id": ["hall-bbbbbb", "$run3"]}


def test_prices_are_those_of_dated_models_too() -> None:
    assert known_price("anthropic/claude-sonnet-4-5-20250929") == known_price("anthropic/claude-sonnet-4-5") == (3, 15)
    assert known_price("anthropic/claude-unheard-of") is None
    assert known_price("other/claude-sonnet-4-5") is None


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("../x.yaml", "outside the folder"),
        ("/etc/passwd", "outside the folder"),
        ("C:\\x.yaml", "outside the folder"),
        ("link/x.yaml", "outside the folder"),
        (".hidden", "begin with a dot"),
        ("a\0b", "not the name of a file"),
        ("x" * 400, "not the name of a file"),
        ("sub", "is a folder"),
        ("skills/s/SKILL.md", "can be read only"),
        ("given.yaml/x", "cannot be written"),
    ],
)
def test_a_folder_refuses_what_leads_out_of_it(path: str, message: str, tmp_path: Path) -> None:
    root, skill = tmp_path / "work", tmp_path / "skill"
    (root / "sub").mkdir(parents=True)
    skill.mkdir()
    (root / "given.yaml").write_text("a: 1\n")
    (root / "link").symlink_to(tmp_path)
    with pytest.raises(FolderError, match=message):
        Folder(root, {"skills/s": skill}).write(path, "b: 2")
    assert sorted(item.name for item in tmp_path.iterdir()) == ["skill", "work"]


def test_a_folder_reads_in_parts_and_lists_what_is_there(tmp_path: Path) -> None:
    root, skill = tmp_path / "work", tmp_path / "skill"
    root.mkdir()
    (skill / "references").mkdir(parents=True)
    (skill / "references" / "keys.md").write_text("# Keys\n")
    (root / "plan.png").write_bytes(b"\x89PNG")
    (root / "data.bin").write_bytes(b"\xff\xfe\x00")
    folder = Folder(root, {"skills/s": skill})
    assert folder.write("deep/a.yaml", "é" * 50_000) == "wrote deep/a.yaml (100,000 bytes)"
    first = folder.read("deep/a.yaml")
    assert isinstance(first, str)
    assert first.endswith("[cut; the file has 50,000 characters, go on with start=40000]")
    assert folder.read("deep/a.yaml", 40_000) == "é" * 10_000
    assert folder.read("plan.png") == ("image/png", b"\x89PNG")
    assert folder.read("skills/s/references/keys.md") == "# Keys\n"
    assert folder.names() == ["data.bin", "deep/a.yaml", "plan.png"]
    assert folder.names("skills/s") == ["skills/s/references/keys.md"]
    for name, message in (("data.bin", "neither a text"), ("no.yaml", "there is no file"), ("deep", "is a folder")):
        with pytest.raises(FolderError, match=message):
            folder.read(name)
    with pytest.raises(FolderError, match="write at most"):
        folder.write("big.yaml", "x" * 2_000_000)


def test_each_arm_is_told_what_it_has(tmp_path: Path) -> None:
    told = {arm: briefing(Side(arm), tmp_path) for arm in MODEL_ARMS}
    assert ["SKILL.md" in text for text in told.values()] == [False, True, True, True, True]
    assert ["edit the YAML -> validate_scenario" in text for text in told.values()] == [False] * 3 + [True, True]
    assert ["You have no shell" in text for text in told.values()] == [True, True, False, True, True]
    assert told["skill+mcp"] == told["skill+mcp+distractors"]
    assert skill_folders(Side("no-skill")) == {}
    for arm in MODEL_ARMS[1:]:
        assert all((place / "SKILL.md").is_file() for place in skill_folders(Side(arm)).values())


@pytest.fixture
def other_texts(tmp_path: Path) -> tuple[Path, Path]:
    """A folder with another skill, and other instructions of the server."""
    skill, said = tmp_path / "new" / "short" / "SKILL.md", tmp_path / "said.md"
    skill.parent.mkdir(parents=True)
    skill.write_text("---\nname: short\ndescription: All that matters.\n---\n# Short\n")
    said.write_text("Validate once.\n")
    return skill.parent.parent, said


def test_other_texts_take_the_place_of_the_installed_ones(other_texts: tuple[Path, Path], tmp_path: Path) -> None:
    side = Side("skill+mcp", *other_texts)
    text = briefing(side, tmp_path)
    assert side.label == "skill+mcp@new@said"
    assert "- short (skills/short/SKILL.md): All that matters." in text
    assert text.endswith("The MCP server irsim says:\nValidate once.\n")
    assert "irsim-scenario" not in text
    assert list(skill_folders(side)) == ["skills/short"]
    assert skills_hash(other_texts[0]) != skills_hash()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--arm", "skill", "--against", "skill"], "both sides are skill"),
        (["--arm", "no-skill", "--against", "no-skill", "--skills", "new"], "holds no skill that the arm no-skill"),
        (["--arm", "skill", "--skills", "new/short"], "holds no skill that the arm skill would read"),
        (["--arm", "skill", "--instructions", "said.md"], "reads no instructions"),
        (["--arm", "baselines", "--against", "skill"], "one arm with one other"),
        (["--arm", "skill", "--against", "skil"], "did you mean skill"),
    ],
)
def test_sides_that_cannot_be_compared_are_refused(
    words: list[str], message: str, other_texts: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(other_texts[1].parent)
    assert message in refusal("run", *words, "pub-01", "--model", "anthropic/x")


def test_two_baselines_are_compared_at_once(tmp_path: Path) -> None:
    done = irsim_evals("run", "--arm", "null", "--against", "retrieval", "pub-01", "pub-02", "--output", tmp_path)
    assert done.exit_code == 0, done.output
    assert "retrieval passes 0 of 2 cases and null 0" in done.output


def test_the_command_line_of_an_agent_is_irsim_in_its_folder(tmp_path: Path, scenario: str) -> None:
    folder = tmp_path / "work"
    folder.mkdir()
    (folder / "a.yaml").write_text(scenario)
    assert "valid: 1 robot" in run_command(folder, "irsim validate a.yaml")
    for line, message in [
        ("irsim validate b.yaml", r"b\.yaml[^$]*\[exit code 2\]$"),
        ("rm a.yaml", "the commands are irsim templates"),
        ("irsim run a.yaml; ls", r"unexpected extra argument"),
        ("irsim run ../a.yaml", "only files of your folder"),
        ("irsim render a.yaml -o/tmp/x.png", "only files of your folder"),
        ("irsim run a.yaml --policy x.py:drive", "no programs"),
        ("irsim run a.yaml --import=antigravity", "no programs"),
        ('irsim run "a.yaml', "is not a command line"),
    ]:
        with pytest.raises(FolderError, match=message):
            run_command(folder, line)
    assert [path.name for path in folder.iterdir()] == ["a.yaml"]


@pytest.mark.anyio
async def test_the_office_has_a_dozen_tools_that_work() -> None:
    calls = [
        ("convert_units", {"value": 3, "source": "ft", "target": "m"}, "0.9144 m"),
        ("issue_create", {"title": "Paint"}, "created #104"),
        ("note_search", {"words": "corridor"}, "2.4 m"),
        ("convert_time_zone", {"hour": 23, "source": "UTC", "target": "CET"}, "00:00 CET"),
    ]
    async with Client(build_office()) as client:
        tools = (await client.list_tools()).tools
        assert len(tools) >= 12
        assert all(tool.description for tool in tools)
        for name, arguments, expected in calls:
            result = await client.call_tool(name, arguments)
            assert isinstance(result.content[0], TextContent)
            assert expected in result.content[0].text
