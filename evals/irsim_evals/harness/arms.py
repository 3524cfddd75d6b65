"""The arms of models: the system message of each, and the skills that an agent may read."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path

from irsim.bundled.skills import find_skills
from irsim.common.hashing import digest

__all__ = ["MODEL_ARMS", "SKILLS", "Side", "briefing", "skill_folders", "skills_hash"]

MODEL_ARMS: tuple[str, ...] = ("no-skill", "skill", "skill+cli", "skill+mcp", "skill+mcp+distractors")
"""Arms in which a model answers: with files only, with the skills, and then with the command line, with the MCP tools,
with tools that do not help."""


@dataclass(frozen=True)
class Side:
    """One side of a comparison: an arm, and the texts that take the place of the installed ones.

    Attributes:
        arm: One of ``MODEL_ARMS``.
        skills: Folder with other skills.
        instructions: File with other instructions of the MCP server.
    """

    arm: str
    skills: Path | None = None
    instructions: Path | None = None

    @property
    def label(self) -> str:
        """Name of the arm in results: ``skill+mcp``, or ``skill+mcp@new`` with texts from ``new``."""
        return "@".join([self.arm, *(path.stem for path in (self.skills, self.instructions) if path is not None)])


SKILLS = "skills"
"""Where an agent finds the skills."""

_TASK = """\
You make and edit scenarios for irsim, a simulator of robots in a flat world. A scenario is one YAML file with the \
keys world, robot and obstacle, in the format of IR-SIM. Lengths are m, times s, angles rad, x points right, y up.

You have a folder, and tools for the files in it. Save your scenario there as scenario.yaml, unless the user names a \
file or asks for a change of one that is there: then save that one. Your folder is not seen until you are done. You \
are done when you answer without calling a tool: that answer is your message to the user, so say in it what you \
assumed and what could not be done. """
_NO_PROGRAMS = "You have no shell and cannot run programs."
_COMMAND = "The tool irsim runs one command of irsim in your folder; there is no other program and no shell."
_SKILLS = """\
There are skills: instructions for kinds of work. Before you start, read with read_file the SKILL.md of each that fits \
the request, and the files it refers to when you need them; their paths are relative to the folder of the skill."""


def briefing(side: Side, folder: Path) -> str:
    """The system message of an arm; the MCP server calls the folder its workspace."""
    arm = side.arm
    texts = [_TASK + (_COMMAND if "+cli" in arm else _NO_PROGRAMS)]
    if arm.startswith("skill"):
        skills = "\n".join(
            f"- {skill.name} ({SKILLS}/{skill.name}/SKILL.md): {skill.description}"
            for skill in find_skills(place=side.skills)
        )
        texts.append(f"{_SKILLS}\n\n{skills}")
    if "+mcp" in arm:
        said = side.instructions.read_text(encoding="utf-8") if side.instructions else _server_instructions(folder)
        texts.append(f"The MCP server irsim says:\n{said}")
    return "\n\n".join(texts)


def skill_folders(side: Side) -> dict[str, Path]:
    """Folders that an agent of an arm may read: path → place."""
    if not side.arm.startswith("skill"):
        return {}
    return {f"{SKILLS}/{skill.name}": skill.folder for skill in find_skills(place=side.skills)}


@functools.cache
def skills_hash(place: Path | None = None) -> str:
    """Digest of all files of all skills, of this package or in a folder."""
    parts: list[bytes | str] = []
    for skill in find_skills(place=place):
        for name, content in sorted(skill.files().items()):
            parts += [f"{skill.name}/{name}\n{len(content)}\n", content]
    return digest(*parts)[:16]


def _server_instructions(folder: Path) -> str:
    """The server's own instructions, which hosts put before their models."""
    from irsim_mcp.server import build_server

    return build_server(folder).instructions or ""
