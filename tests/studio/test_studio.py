"""The server of the studio: it checks, edits, runs and saves texts of one folder, for its own page."""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import irsim
from irsim.studio.feed import BEGIN, END, FAILED, RESULT, ROWS
from irsim.studio.studio import Studio
from tests.cli.conftest import CRASH
from tests.studio.conftest import Client

pytestmark = pytest.mark.one_python


@pytest.fixture
def studio(tmp_path: Path) -> Iterator[Studio]:
    (tmp_path / "crash.yaml").write_text(CRASH, encoding="utf-8")
    made = Studio(tmp_path, first={"name": "crash.yaml"})
    yield made
    made.close()


@pytest.fixture
def page(studio: Studio) -> Client:
    client = Client(studio._server)
    assert client.enter().status == 204
    return client


def asked(page: Client, path: str, **what: Any) -> Any:
    answer = page.ask("POST", path, what)
    assert answer.status == 200
    return json.loads(answer.text)  # type: ignore[attr-defined]


def frames(page: Client, **what: Any) -> list[tuple[int, bytes]]:
    answer = page.ask("POST", "/run", what)
    assert answer.status == 200
    data, at, taken = answer.read(), 0, []
    answer.close()
    while at < len(data):
        length, kind, _ = struct.unpack_from("<IBI", data, at)
        taken.append((kind, data[at + 9 : at + 9 + length]))
        at += 9 + length
    return taken


def test_the_page_and_its_parts_hold_nothing_of_a_user_and_all_else_needs_the_cookie(studio: Studio) -> None:
    stranger = Client(studio._server)
    answer = stranger.ask("GET", "/")
    assert answer.status == 200
    assert "crash" not in answer.text  # type: ignore[attr-defined]
    rules = dict(rule.split(" ", 1) for rule in answer.getheader("Content-Security-Policy", "").split("; "))
    assert (rules["default-src"], rules["script-src"], rules["connect-src"]) == ("'none'", "'self'", "'self'")
    for part in ("theme.css", "studio.css", "replay.css", "studio.js", "dom.js", "vendor/codemirror.js"):
        assert stranger.status("GET", f"/web/{part}") == 200
    for other in ("../server.py", "%2e%2e/server.py", "server.py", "studio.html", "vendor", "/etc/passwd"):
        assert stranger.status("GET", f"/web/{other}") == 404
    for path in ("/files", "/open", "/save", "/check", "/edit", "/run"):
        assert stranger.status("POST", path, {"text": "robot: {}", "name": "crash.yaml"}) == 403
        assert stranger.status("GET", path) in (403, 405)


def test_a_text_is_checked_as_by_validate_and_drawn(page: Client) -> None:
    good = asked(page, "/check", text=CRASH, name="crash.yaml")
    assert good["findings"] == irsim.validate(text=CRASH).model_dump()["findings"]
    assert base64.b64decode(good["scene"])
    assert [place["path"] for place in good["objects"]] == [["robot", 0], ["obstacle", 0]]
    bad = asked(page, "/check", text=CRASH.replace("robot", "robt"))
    assert bad["findings"][0]["code"] == irsim.validate(text=CRASH.replace("robot", "robt")).findings[0].code
    assert "scene" not in bad
    assert asked(page, "/check", text="a: [")["findings"][0]["line"] == 2


def test_a_run_is_that_of_irsim_run(page: Client) -> None:
    taken = frames(page, text=CRASH, seed=3)
    kinds = [kind for kind, _ in taken if kind not in (ROWS, 4)]
    assert kinds == [BEGIN, END, RESULT]
    result, alone = json.loads(taken[-1][1]), irsim.run(text=CRASH, seed=3)
    assert (result["outcome"], result["steps"], result["robots"]) == (
        alone.outcome,
        alone.steps,
        alone.model_dump(mode="json")["robots"],
    )
    assert json.loads(next(content for kind, content in taken if kind == END))["outcome"] == alone.outcome
    [(kind, why)] = frames(page, text=CRASH.replace("robot", "robt"))
    assert kind == FAILED
    assert b"unknown" in why


def test_several_seeds_are_run_one_after_the_other_and_a_policy_drives(page: Client) -> None:
    text = CRASH.replace("behavior: {name: dash}", "behavior: {name: rvo}")
    taken = frames(page, text=text, seeds=[4, 5], policy="dash")
    results = [json.loads(content) for kind, content in taken if kind == RESULT]
    assert [one["seed"] for one in results] == [4, 5]
    assert [one["behavior"] for one in results] == ["dash", "dash"]
    assert [kind for kind, _ in taken].count(BEGIN) == 2
    [(kind, why)] = frames(page, text=text, policy="dahs")
    assert kind == FAILED
    assert b"dash" in why
    [(kind, why)] = frames(page, text=text, policy="../model.npz")
    assert kind == FAILED
    names = [one["name"] for one in asked(page, "/files")["policies"]]
    assert {"as-written", "orca", "dash", "goal_lidar"} <= set(names)
    assert "process" not in names


def test_a_recorded_run_is_opened_and_a_run_becomes_a_page(page: Client, studio: Studio) -> None:
    run = irsim.run(text=CRASH, seed=3, record=studio.files.root / ".irsim" / "runs" / "kept-1a2b3c")
    opened = asked(page, "/open", run="kept-1a2b3c")
    assert (opened["text"], opened["seed"], opened["mark"]) == (CRASH, run.seed, None)
    assert "no run" in asked(page, "/open", run="nothing-123456")["why"]
    html = asked(page, "/page", text=CRASH, seed=3)["html"]
    assert html.startswith("<!doctype html>")
    assert "default-src 'none'" in html


def test_files_are_read_and_written_only_in_the_folder(page: Client, tmp_path: Path) -> None:
    assert asked(page, "/files")["files"] == ["crash.yaml"]
    opened = asked(page, "/open", name="crash.yaml")
    assert opened["text"] == CRASH
    saved = asked(page, "/save", name="crash.yaml", text=CRASH + "# more\n", mark=opened["mark"])
    assert (tmp_path / "crash.yaml").read_text() == CRASH + "# more\n"
    (tmp_path / "crash.yaml").write_text("robot: {}\n")
    refused = asked(page, "/save", name="crash.yaml", text=CRASH, mark=saved["mark"])
    assert refused == {"why": "another program has changed this file since it was opened", "text": "robot: {}\n"}
    assert "since it was opened" in asked(page, "/save", name="crash.yaml", text=CRASH, mark=None)["why"]
    assert (tmp_path / "crash.yaml").read_text() == "robot: {}\n"
    (tmp_path.parent / "other.yaml").write_text("secret: 1\n")
    (tmp_path / "out.yaml").symlink_to(tmp_path.parent / "other.yaml")
    for name in ("../other.yaml", "/etc/passwd", "out.yaml", ".hidden.yaml", "notes.txt", "a\0.yaml", "~/x.yaml"):
        assert "why" in asked(page, "/open", name=name)
        assert "why" in asked(page, "/save", name=name, text="robot: {}", mark=None)
    assert (tmp_path.parent / "other.yaml").read_text() == "secret: 1\n"


def test_a_text_reads_no_files_outside_of_the_folder(page: Client, tmp_path: Path) -> None:
    (tmp_path.parent / "secret.png").write_bytes(b"x")
    for name in ("../secret.png", str(tmp_path.parent / "secret.png")):
        text = f"world: {{obstacle_map: '{name}'}}\nrobot: {{goal: [1, 1]}}\n"
        answer = asked(page, "/check", text=text, name="crash.yaml", root="/")
        assert "scene" not in answer
        assert answer["findings"][0]["severity"] == "error"


@pytest.mark.parametrize(
    "text", ["a: &a [*a]\n", "&x " * 300, "[" * 3000, "robot: {number: 100000000}\n", "\0", "é" * 200_000]
)
def test_hostile_texts_are_answered(page: Client, text: str) -> None:
    answer = asked(page, "/check", text=text)
    assert "scene" not in answer
    assert asked(page, "/check", text=CRASH)["scene"], "the next one is served"


def test_bodies_without_a_text_are_refused(page: Client) -> None:
    for path in ("/check", "/edit", "/run", "/save"):
        assert page.status("POST", path, {"text": 5}) == 400
    assert page.status("POST", "/check", "{}", Content_Length="3000000") == 413
