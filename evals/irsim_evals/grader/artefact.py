"""What an agent left in a folder, read with care: sizes, links and names are checked before anything is opened."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from irsim_evals.cases.store import Answer

__all__ = ["ArtefactError", "find_scenario", "from_folder", "scenarios_in"]

_MAX_FILE_BYTES = 2_000_000
"""Size of a text file that is read."""
_MAX_FILES = 200
"""Number of files that are looked at."""
_TEXT = (".yaml", ".yml", ".py", ".md", ".json", ".jsonl", ".txt", ".toml", ".csv", ".sh")
_REPLY = re.compile(r"reply(?:-(\d+))?\.md")
_FENCE = re.compile(r"```(?:ya?ml)?[^\n]*\n(.*?)```", re.DOTALL)
_SECTIONS = re.compile(r"^\s*[{\"']?(?:world|robot|obstacle)[\"']?\s*:", re.MULTILINE)
_IGNORED = ("prompt.md", "log.jsonl", "calls.jsonl")


class ArtefactError(ValueError):
    """The folder holds something that is not graded: a file that is too large, a link that leads out of it."""


def from_folder(folder: Path, name: str = "") -> Answer:
    """Read what an agent left.

    Args:
        folder: Its files, and ``reply.md`` (``reply-1.md``, ``reply-2.md`` … after each turn).
        name: Name of the answer; default: that of the folder.

    Raises:
        ArtefactError: A file is too large, a link leads out of the folder, or there are too many files.
    """
    root = folder.resolve()
    texts: dict[str, str] = {}
    replies: dict[int, str] = {}
    reply = ""
    seen = 0
    for path in sorted(folder.rglob("*")):
        relative = path.relative_to(folder)
        if any(part.startswith(".") or part == "__pycache__" for part in relative.parts):
            continue
        if path.is_symlink() or not path.resolve().is_relative_to(root):
            raise ArtefactError(f"{relative} is a link, and links are not followed")
        if not path.is_file() or path.suffix.lower() not in _TEXT or relative.name in _IGNORED:
            continue
        seen += 1
        if seen > _MAX_FILES:
            raise ArtefactError(f"there are more than {_MAX_FILES} files")
        if path.stat().st_size > _MAX_FILE_BYTES:
            raise ArtefactError(f"{relative} has {path.stat().st_size:,} bytes; at most {_MAX_FILE_BYTES:,} are read")
        text = path.read_bytes().decode("utf-8", errors="replace")
        found = _REPLY.fullmatch(relative.as_posix())
        if found is None:
            texts[relative.as_posix()] = text
        elif found[1]:
            replies[int(found[1])] = text
        else:
            reply = text
    before = tuple(replies[number] for number in sorted(replies))
    return Answer(name or folder.name, texts, reply, (*before, reply) if reply else before)


def scenarios_in(texts: Mapping[str, str]) -> list[str]:
    """Names of the files that look like scenarios."""
    return [name for name, text in texts.items() if name.endswith((".yaml", ".yml")) and _SECTIONS.search(text)]


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
    blocks = [block for block in _FENCE.findall(answer.reply) if _SECTIONS.search(block)]
    if blocks and not names:
        return "reply.md", str(blocks[-1])
    left = [name for name in names if name in given]
    return (left[0], answer.files[left[0]]) if left else None
