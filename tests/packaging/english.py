"""Constructions of English that a reader meets twice: in docstrings, comments, messages, pages, skills and names.

``python -m tests.packaging.english [folder …]`` lists them; ``test_english.py`` holds their number.
"""

from __future__ import annotations

import ast
import io
import re
import sys
import tokenize
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("irsim", "mcp_server", "evals", "skills", "templates", "tests", ".ci")
PERSONS = "persons for things"
CONSTRUCTIONS = {
    "that of, those of": r"\b(?:[Tt]hat|[Tt]hose) of\b|\b[Tt]hose that\b",
    "is no X": r"(?<![Tt]here )\b(?:is|are|was|were|be) no (?!longer\b|more\b|less\b|larger\b|smaller\b|matter\b)",
    "What as a noun": r"(?:^|[.:;!]\s+)What\b(?![^.]*\?)(?! is new\b)",
    "none as a pronoun": r"\b(?:is|are|or|has|have|needs|of which|and|but) none\b(?! of\b)(?!`)",
    PERSONS: r"\b(?:[Ss]ome|[Nn]o|[Aa]ny|[Ee]very)body\b|\b[Ww]hoever\b",
    "of others": r"\b(?:by|of|from|to|for) others\b",
}
"""Construction -> pattern in a text whose lines are joined."""
NAMES = {"found"}
"""Names of variables that say nothing."""


def findings(*folders: str) -> Iterator[tuple[str, str, str]]:
    """Construction, place and the words around it, in files of these folders or of the whole checkout."""
    for path in _files(folders or FOLDERS):
        text = path.read_text(encoding="utf-8")
        place = path.relative_to(ROOT).as_posix()
        for line, words in _texts(path, text):
            for name, pattern in CONSTRUCTIONS.items():
                if name == PERSONS and path.suffix == ".md":  # pages speak of pedestrians
                    continue
                for match in re.finditer(pattern, words):
                    yield name, f"{place}:{line}", words[max(0, match.start() - 30) : match.end() + 40].strip()
        if path.suffix == ".py" and any(name in text for name in NAMES) and (tree := _tree(text)):
            for node in ast.walk(tree):
                if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and node.id in NAMES:
                    yield f"the name {node.id}", f"{place}:{node.lineno}", node.id


def _files(folders: tuple[str, ...]) -> Iterator[Path]:
    yield from (path for path in sorted(ROOT.glob("*.md")) if folders == FOLDERS and path.name != "CHANGELOG.md")
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in {".py", ".md", ".cpp", ".hpp"} and path.name not in {"english.py", "prompt.md"}:
                yield path


def _texts(path: Path, text: str) -> Iterator[tuple[int, str]]:
    """Line and text of each paragraph for people: strings and comments of programs, and all of a page but its code."""
    if path.suffix == ".py":
        try:
            tokens = list(tokenize.generate_tokens(io.StringIO(text).readline))
        except (tokenize.TokenError, SyntaxError):
            return
        kinds = {tokenize.STRING, tokenize.COMMENT, getattr(tokenize, "FSTRING_MIDDLE", tokenize.COMMENT)}
        pieces = [(token.start[0], token.string.strip("rbf\"'# \n")) for token in tokens if token.type in kinds]
    elif path.suffix == ".md":
        pieces = [(1, re.sub(r"```.*?```", lambda code: "\n" * code[0].count("\n"), text, flags=re.DOTALL))]
    else:
        pieces = [
            (text[: match.start()].count("\n") + 1, match[0].lstrip("/ ")) for match in re.finditer(r"//.*", text)
        ]
    for line, piece in pieces:
        for part in re.finditer(r"(?:[^\n]+\n?)+", piece):
            yield line + piece[: part.start()].count("\n"), " ".join(part[0].split())


def _tree(text: str) -> ast.Module | None:
    try:
        return ast.parse(text)
    except SyntaxError:  # a program of the evals that is a template
        return None


if __name__ == "__main__":
    rows = list(findings(*sys.argv[1:]))
    for name, place, words in rows:
        print(f"{place}: {name}: {words}")
    print(*(f"{count:5} {name}" for name, count in Counter(row[0] for row in rows).most_common()), sep="\n")
    print(f"{len(rows):5} in all")
