"""The folder that an agent left, read with care: sizes, links and names are checked before anything is opened."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from pydantic import ConfigDict, Field, ValidationError

from irsim.common.hashing import file_digest
from irsim.common.records import ContentError, FileError, read_bytes, read_json
from irsim_evals.grader.outcome import Cost, Step

__all__ = [
    "BINARY", "CALLS_FILE", "Answer", "ArtefactError", "Call", "calls_of", "cost_of", "find_scenario",
    "from_folder", "rivals", "scenarios_in",
]  # fmt: skip

BINARY = (".png", ".jpg", ".jpeg", ".bmp", ".pgm", ".npy", ".npz")
"""Endings of files that hold a picture or an array."""
_MAX_FILE_BYTES = 2_000_000
"""Size of a text file that is read."""
_MAX_FILES = 200
"""Number of files that are opened; further ones are named."""
_MAX_THINGS = 5000
"""Number of files, folders and links that are named."""
_MAX_BLOB_BYTES = 16_000_000
"""Largest size of a file that is read although it is not text [bytes]."""
_MAX_BLOBS_BYTES = 64_000_000
"""Largest size of all such files together [bytes]."""
_MAX_DIGEST_BYTES = 64_000_000
"""Size of a file whose digest is told."""
_SCENARIO = (".yaml", ".yml", ".json")
_CLOSED = (".git", "__pycache__")
"""Folders of programs: what lies in them is named and not opened."""
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


class Call(Step):
    """A call of a tool: a line of the log, as far as it matters here."""

    model_config = ConfigDict(extra="ignore", strict=True)

    error: bool
    """Whether it was refused, or ended with an error."""
    tokens: Annotated[int, Field(ge=0, le=10**9)]
    """Tokens of its arguments and its answer."""


@dataclass(frozen=True)
class Answer:
    """An answer to a case.

    Attributes:
        name: Its name.
        files: Path in the folder → text.
        reply: Last message.
        replies: Message after each turn.
        blobs: Path in the folder → content of a picture, an array, or another file that is not text.
        others: Path in the folder → what was not opened there, in words; the path of a folder ends with ``/``.
        trusted_folder: Folder in which programs of the answer may be run; None if they must not be.
        calls: Tools that the agent called, in their order; None if there is no log of them.
    """

    name: str
    files: Mapping[str, str] = field(default_factory=dict)
    reply: str = ""
    replies: tuple[str, ...] = ()
    blobs: Mapping[str, bytes] = field(default_factory=dict)
    others: Mapping[str, str] = field(default_factory=dict)
    trusted_folder: Path | None = None
    calls: tuple[Call, ...] | None = None


class ArtefactError(ValueError):
    """The folder cannot be graded: it holds too much."""


def from_folder(folder: Path, turns: int = 1) -> Answer:
    """Read what an agent left.

    Args:
        folder: Its files, and its last message in ``reply.md``, those before in ``reply-1.md``, ``reply-2.md`` …
        turns: Number of turns of the case. The last message may also be numbered.

    Raises:
        ArtefactError: There are too many files.
    """
    texts: dict[str, str] = {}
    blobs: dict[str, bytes] = {}
    others: dict[str, str] = {}
    replies: dict[int, str] = {}
    paths = list(itertools.islice(folder.rglob("*"), _MAX_THINGS + 1))
    if len(paths) > _MAX_THINGS:
        raise ArtefactError(f"there are more than {_MAX_THINGS:,} files and folders")
    for path in sorted(paths, key=lambda path: (_is_hidden(path.relative_to(folder)), len(path.parts), path)):
        relative = path.relative_to(folder)
        name = relative.as_posix()
        why = _unopened(path)
        if path.is_dir() and not why:
            others |= {} if any(path.iterdir()) else {f"{name}/": "an empty folder"}
        elif _IGNORED.fullmatch(name) or _is_of_a_record(folder, relative):
            continue
        elif why or any(part in _CLOSED for part in relative.parts) or len(texts) + len(blobs) >= _MAX_FILES:
            others[name] = why or _described(path)
        elif (number := _turn_of(name, turns)) is not None:
            replies[number] = path.read_bytes().decode("utf-8", errors="replace")
        elif (text := _text(path)) is not None:
            texts[name] = text
        elif sum(map(len, blobs.values())) + path.stat().st_size <= _MAX_BLOBS_BYTES:
            blobs[name] = path.read_bytes()
        else:
            others[name] = _described(path)
    said = tuple(replies.get(number, "") for number in range(1, turns + 1))
    return Answer(folder.name, texts, said[-1], said, blobs, others)


def _is_of_a_record(folder: Path, path: Path) -> bool:
    """Whether a file belongs to a run or job that the tools have recorded."""
    kept = path.parts[:2] in ((".irsim", "runs"), (".irsim", "jobs"))
    return kept and folder.joinpath(*path.parts[:3], "run.json").is_file()


def _is_hidden(path: Path) -> bool:
    return any(part.startswith(".") for part in path.parts)


def _unopened(path: Path) -> str:
    """Why a file is not opened, in words; empty if it is."""
    if path.is_symlink():
        return "a link"
    if path.is_dir():
        return ""
    if not path.is_file():
        return "no ordinary file"
    is_text = path.suffix.lower() not in BINARY and b"\0" not in _start(path)
    return _described(path) if path.stat().st_size > (_MAX_FILE_BYTES if is_text else _MAX_BLOB_BYTES) else ""


def _start(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(4096)


def _described(path: Path) -> str:
    """Size and digest of a file."""
    size = path.stat().st_size
    digest = f", sha256 {file_digest(path)[:16]}" if size <= _MAX_DIGEST_BYTES else ""
    return f"{size:,} bytes{digest}"


def _text(path: Path) -> str | None:
    """The text of a file; None if the file is not text."""
    content = path.read_bytes()
    scenario = path.suffix.lower() in _SCENARIO
    if path.suffix.lower() in BINARY or (b"\0" in content and not scenario):
        return None
    try:
        # Of a scenario that is not UTF-8, the simulator must not be spared what makes it refuse the file.
        return content.decode("utf-8", errors="surrogateescape" if scenario else "strict")
    except UnicodeDecodeError:
        return None


def _turn_of(name: str, turns: int) -> int | None:
    """The turn to which a file holds the reply; None for any other file."""
    match = _REPLY.fullmatch(name)
    if match is None or (match[1] and not 1 <= int(match[1]) <= turns):
        return None
    return int(match[1]) if match[1] else turns


def scenarios_in(texts: Mapping[str, str]) -> list[str]:
    """Names of the files that look like scenarios and are not hidden; JSON is YAML, too."""
    return [
        name
        for name, text in texts.items()
        if name.endswith(_SCENARIO) and not _is_hidden(Path(name)) and _SECTIONS.search(text)
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


def cost_of(path: Path) -> Cost:
    """Number of calls, of failed ones, and tokens; all unknown if there is no file that can be read.

    Args:
        path: The file. A link is not followed.
    """
    calls, notes = calls_of(path)
    if calls is None:
        return Cost(notes=notes)
    return Cost(
        calls=len(calls),
        errors=sum(call.error for call in calls),
        tokens=sum(call.tokens for call in calls),
        notes=notes,
        steps=[Step(tool=call.tool, error=call.error, codes=call.codes) for call in calls[-_MAX_STEPS:]],
    )


def calls_of(path: Path) -> tuple[tuple[Call, ...] | None, list[str]]:
    """The calls in the log of an agent, or None if no log can be read, and notes about what is left out.

    Args:
        path: The file. A link is not followed.
    """
    try:
        data = read_bytes(path, _MAX_LOG_BYTES, follow=False)
    except FileError as error:
        missing = error.code == "file-not-found"
        return None, [] if missing else [f"{path.name}: {error.message}; its calls are not counted"]
    lines = [line for line in data.split(b"\n") if line.strip()]
    calls = tuple(call for line in lines if (call := _call_of(line)) is not None)
    left_out = len(lines) - len(calls)
    note = f"{path.name}: lines that do not record a call and are left out: {left_out} of {len(lines)}"
    return calls, [note] if left_out else []


def _call_of(line: bytes) -> Call | None:
    try:
        return Call.model_validate(read_json(line))
    except (ContentError, ValidationError):
        return None
