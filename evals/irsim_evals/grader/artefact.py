"""The folder that an agent left, read with care: sizes, links and names are checked before anything is opened."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from irsim.common.records import ContentError, FileError, read_bytes, read_json
from irsim_evals.grader.outcome import Cost, Step

__all__ = [
    "BINARY", "CALLS_FILE", "Answer", "ArtefactError", "cost_of", "find_scenario", "from_folder", "rivals",
    "scenarios_in",
]  # fmt: skip

BINARY = (".png", ".jpg", ".jpeg", ".bmp", ".pgm", ".npy", ".npz")
"""Endings of files that hold a picture or an array."""
_MAX_FILE_BYTES = 2_000_000
"""Size of a text file that is read."""
_MAX_FILES = 200
"""Number of files that are looked at."""
_MAX_BLOB_BYTES = 16_000_000
"""Size of a picture or an array that is read."""
_TEXT = (
    ".yaml", ".yml", ".md", ".json", ".jsonl", ".txt", ".toml", ".csv", ".py", ".ipynb", ".sh", ".js", ".pl", ".rb",
    ".bat", ".ps1", ".patch",
)  # fmt: skip
_SCENARIO = (".yaml", ".yml", ".json")
_PLAIN = ("Makefile", "makefile", "justfile")
"""Names of further files that are read."""
_REPLY = re.compile(r"reply(?:-(\d{1,3}))?\.md")
_FENCE = re.compile(r"(?:```|~~~)(?:ya?ml)?[^\n`]*\n(.*?)(?:```|~~~)", re.DOTALL)
_SECTIONS = re.compile(r"^[ \t]*[{\"']?(?:world|robot|obstacle)[\"']?[ \t]*:", re.MULTILINE)
_WORLD = re.compile(r"^[ \t]*[{\"']?world[\"']?[ \t]*:", re.MULTILINE)
_IGNORED = re.compile(r"prompt(?:-\d+)?\.md|log\.jsonl|calls\.jsonl")
CALLS_FILE = "calls.jsonl"
"""Name under which the file is found in the folder of a case."""
_MAX_LOG_BYTES = 16_000_000
"""Size of a file that is read."""
_MAX_STEPS = 200
"""Number of calls that results keep."""


@dataclass(frozen=True)
class Answer:
    """An answer to a case.

    Attributes:
        name: Its name.
        files: Path in the folder → text.
        reply: Last message.
        replies: Message after each turn.
        blobs: Path in the folder → content of a picture or an array.
        trusted_folder: Folder in which programs of the answer may be run; None if they must not be.
    """

    name: str
    files: Mapping[str, str] = field(default_factory=dict)
    reply: str = ""
    replies: tuple[str, ...] = ()
    blobs: Mapping[str, bytes] = field(default_factory=dict)
    trusted_folder: Path | None = None


class ArtefactError(ValueError):
    """The folder holds something that is not graded: a file that is too large, a link that leads out of it."""


def from_folder(folder: Path, turns: int = 1) -> Answer:
    """Read what an agent left.

    Args:
        folder: Its files, and its last message in ``reply.md``, those before in ``reply-1.md``, ``reply-2.md`` …
        turns: Number of turns of the case. The last message may also be numbered.

    Raises:
        ArtefactError: A file is too large, a link leads out of the folder, or there are too many files.
    """
    root = folder.resolve()
    texts: dict[str, str] = {}
    blobs: dict[str, bytes] = {}
    replies: dict[int, str] = {}
    seen = 0
    for path in sorted(folder.rglob("*")):
        relative = path.relative_to(folder)
        if any(part.startswith(".") or part == "__pycache__" for part in relative.parts):
            continue
        if path.is_symlink() or not path.resolve().is_relative_to(root):
            raise ArtefactError(f"{relative} is a link, and links are not followed")
        ending = path.suffix.lower()
        known = ending in (*_TEXT, *BINARY) or relative.name in _PLAIN
        if not path.is_file() or not known or _IGNORED.fullmatch(relative.name):
            continue
        seen += 1
        if seen > _MAX_FILES:
            raise ArtefactError(f"there are more than {_MAX_FILES} files")
        most = _MAX_BLOB_BYTES if ending in BINARY else _MAX_FILE_BYTES
        if path.stat().st_size > most:
            raise ArtefactError(f"{relative} has {path.stat().st_size:,} bytes; at most {most:,} are read")
        if ending in BINARY:
            blobs[relative.as_posix()] = path.read_bytes()
            continue
        # Of a scenario that is not UTF-8, the simulator must not be spared what makes it refuse the file.
        text = path.read_bytes().decode("utf-8", errors="surrogateescape" if ending in _SCENARIO else "replace")
        number = _turn_of(relative.as_posix(), turns)
        if number is None:
            texts[relative.as_posix()] = text
        else:
            replies[number] = text
    said = tuple(replies.get(number, "") for number in range(1, turns + 1))
    return Answer(folder.name, texts, said[-1], said, blobs)


def _turn_of(name: str, turns: int) -> int | None:
    """The turn to which a file holds the reply; None for any other file."""
    match = _REPLY.fullmatch(name)
    if match is None or (match[1] and not 1 <= int(match[1]) <= turns):
        return None
    return int(match[1]) if match[1] else turns


def scenarios_in(texts: Mapping[str, str]) -> list[str]:
    """Names of the files that look like scenarios; JSON is YAML, too."""
    return [
        name for name, text in texts.items() if name.endswith((".yaml", ".yml", ".json")) and _SECTIONS.search(text)
    ]


def find_scenario(answer: Answer, given: Mapping[str, str]) -> tuple[str, str] | None:
    """Name and text of the scenario that an agent made; None if it made none.

    The file that was given counts if it was changed, or if there is no other. A fenced block of the reply counts where
    there is no file at all.
    """
    names = scenarios_in(answer.files)
    made = [name for name in names if given.get(name) != answer.files[name]]
    for preferred in ("scenario.yaml", *given):
        if preferred in made:
            return preferred, answer.files[preferred]
    if made:
        named = [name for name in made if name in answer.reply or Path(name).name in answer.reply]
        best = sorted(named or made, key=lambda name: (name.count("/"), name))[0]
        return best, answer.files[best]
    blocks = _blocks(answer.reply)
    if blocks and not names:
        return "reply.md", blocks[-1]
    left = [name for name in names if name in given]
    return (left[0], answer.files[left[0]]) if left else None


def rivals(answer: Answer, given: Mapping[str, str], chosen: str) -> list[str]:
    """Names of other scenarios that might be meant as well as the one that was found; empty if it is clear.

    It is clear for ``scenario.yaml``, for a file that was given, and for the only one that the reply names.

    Args:
        answer: The answer.
        given: Files that it started with.
        chosen: Name in the result of :func:`find_scenario`.
    """
    if chosen == "reply.md":
        others = [block for block in _blocks(answer.reply)[:-1] if block.strip() != _blocks(answer.reply)[-1].strip()]
        return ["another block of the reply"] * len(others)
    if chosen == "scenario.yaml" or chosen in given:
        return []
    made = [name for name in scenarios_in(answer.files) if name not in given]
    named = [name for name in made if name in answer.reply or Path(name).name in answer.reply]
    same = answer.files[chosen].strip()
    return [name for name in (named or made) if answer.files[name].strip() != same]


def _blocks(reply: str) -> list[str]:
    """The blocks of a reply that look like scenarios; where some have a world, parts of scenarios do not count."""
    blocks = [str(block) for block in _FENCE.findall(reply) if _SECTIONS.search(block)]
    return [block for block in blocks if _WORLD.search(block)] or blocks


class _Call(BaseModel):
    """A line of the file, as far as it matters here."""

    model_config = ConfigDict(extra="ignore", strict=True)

    tool: str
    error: bool
    tokens: Annotated[int, Field(ge=0, le=10**9)]
    codes: list[str] = []


def cost_of(path: Path) -> Cost:
    """Number of calls, of failed ones, and tokens; all unknown if there is no file that can be read.

    Args:
        path: The file. A link is not followed.
    """
    try:
        data = read_bytes(path, _MAX_LOG_BYTES, follow=False)
    except FileError as error:
        missing = error.code == "file-not-found"
        return Cost() if missing else Cost(notes=[f"{path.name}: {error.message}; its calls are not counted"])
    lines = [line for line in data.split(b"\n") if line.strip()]
    calls = [call for line in lines if (call := _call_of(line)) is not None]
    left_out = len(lines) - len(calls)
    notes = [f"{path.name}: lines that do not record a call and are left out: {left_out} of {len(lines)}"]
    return Cost(
        calls=len(calls),
        errors=sum(call.error for call in calls),
        tokens=sum(call.tokens for call in calls),
        notes=notes if left_out else [],
        steps=[Step(tool=call.tool, error=call.error, codes=call.codes) for call in calls[-_MAX_STEPS:]],
    )


def _call_of(line: bytes) -> _Call | None:
    try:
        return _Call.model_validate(read_json(line))
    except (ContentError, ValidationError):
        return None
