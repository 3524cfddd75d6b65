"""The assertions about an answer, and the checks that decide whether each of them holds.

Every assertion of `evals/skills/*/evals.json` and of the transcripts has one of the forms in `FORMS`: people and models
read the sentence, a program finds its check here. Files are in the folder that the agent worked in; "the given one" is
the file of that name as the agent got it.

    python -m evals.skills.assertions SKILL ID FOLDER [--reply FILE]

prints as JSON which assertions of an eval hold for a folder. Exits with 0 if all hold, 1 if not, 2 if the eval or the
folder does not exist. It runs the programs that assertions name: use it only on answers that you would run yourself.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

import irsim

HERE = Path(__file__).parent
Check = Callable[[Path, str, dict[str, str]], bool]


def read(path: Path) -> Any:
    """Load a file of YAML or JSON."""
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def values(data: Any, path: str) -> list[Any]:
    """Return the values at a path such as `robot[*].vel_max[0]`; a single entry counts as a list of one."""
    found = [data]
    for name, index in re.findall(r"([^.\[\]]+)|\[(\d+|\*)\]", path):
        if name:
            found = [item[name] for item in found if isinstance(item, dict) and name in item]
            continue
        lists = [item if isinstance(item, list) else [item] for item in found]
        found = [item for entry in lists for item in (entry if index == "*" else entry[int(index) :][:1])]
    return found


def alike(found: Any, wanted: Any) -> bool:
    """Whether two values are equal, numbers within two percent."""
    if isinstance(wanted, list):
        return isinstance(found, list) and len(found) == len(wanted) and all(map(alike, found, wanted))
    if isinstance(wanted, bool) or not isinstance(wanted, int | float):
        return bool(found == wanted)
    return isinstance(found, int | float) and math.isclose(found, wanted, rel_tol=0.02, abs_tol=1e-3)


def holds(folder: Path, _: str, said: dict[str, str]) -> bool:
    found = values(read(folder / said["file"]), said["path"])
    return bool(found) and all(alike(item, yaml.safe_load(said["value"])) for item in found)


def lies_between(folder: Path, _: str, said: dict[str, str]) -> bool:
    found = values(read(folder / said["file"]), said["path"])
    return bool(found) and all(float(said["low"]) <= item <= float(said["high"]) for item in found)


def lacks(folder: Path, _: str, said: dict[str, str]) -> bool:
    return not values(read(folder / said["file"]), said["path"])


def is_valid(folder: Path, _: str, said: dict[str, str]) -> bool:
    return irsim.validate(folder / said["file"]).valid


def makes(folder: Path, _: str, said: dict[str, str]) -> bool:
    return irsim.validate(folder / said["file"]).counts.get(said["kind"] + "s", 0) == int(said["count"])


def ends_in(folder: Path, _: str, said: dict[str, str]) -> bool:
    seed = int(said["seed"]) if said["seed"] else None
    return irsim.run(folder / said["file"], seed=seed, behavior=said["behavior"]).outcome == said["outcome"]


def differs_only_in(folder: Path, _: str, said: dict[str, str]) -> bool:
    allowed = re.findall(r"`([^`]+)`", said["paths"])
    changed = [change.path for change in irsim.diff(said["given"], folder / said["file"]).keys]
    within = [[path == ok or path.startswith((f"{ok}.", f"{ok}[")) for ok in allowed] for path in changed]
    return all(map(any, within)) and all(any(row[i] for row in within) for i in range(len(allowed)))


def keeps_comments(folder: Path, _: str, said: dict[str, str]) -> bool:
    return not irsim.diff(said["given"], folder / said["file"]).comments_lost


def is_the_given(folder: Path, _: str, said: dict[str, str]) -> bool:
    return (folder / said["file"]).read_bytes() == Path(said["given"]).read_bytes()


def exists(folder: Path, _: str, said: dict[str, str]) -> bool:
    return (folder / said["file"]).is_file()


def is_missing(folder: Path, _: str, said: dict[str, str]) -> bool:
    return not any(folder.rglob(said["file"]))


def contains(folder: Path, _: str, said: dict[str, str]) -> bool:
    return bool(re.search(said["pattern"], (folder / said["file"]).read_text(encoding="utf-8")))


def prints(folder: Path, _: str, said: dict[str, str]) -> bool:
    words = shlex.split(said["command"])
    command = [sys.executable, *words[1:]] if words[0] == "python" else [sys.executable, "-m", *words]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=120)
    return done.returncode == 0 and bool(re.search(said["pattern"] or "", done.stdout))


def replies(_: Path, reply: str, said: dict[str, str]) -> bool:
    return bool(reply) and bool(re.search(said["pattern"], reply, re.IGNORECASE)) == (said["says"] == "says")


FILE, PATH, PATTERN = r"`(?P<file>[^`]+)`", r"`(?P<path>[^`]+)`", r"/(?P<pattern>.+)/"
FORMS: dict[str, Check] = {
    rf"{FILE} is valid": is_valid,
    rf"{FILE} holds {PATH} = (?P<value>.+)": holds,
    rf"{FILE} holds {PATH} between (?P<low>\S+) and (?P<high>\S+)": lies_between,
    rf"{FILE} has no {PATH}": lacks,
    rf"{FILE} makes (?P<count>\d+) (?P<kind>robot|obstacle|sensor)s?": makes,
    rf"{FILE} ends in (?P<outcome>success|collision|timeout)(?: with behavior `(?P<behavior>[^`]+)`)?"
    r"(?: and seed (?P<seed>\d+))?": ends_in,
    rf"{FILE} differs from the given one only in (?P<paths>`.+`)": differs_only_in,
    rf"{FILE} keeps the comments of the given one": keeps_comments,
    rf"{FILE} is the given one": is_the_given,
    rf"{FILE} exists": exists,
    rf"there is no {FILE}": is_missing,
    rf"{FILE} contains {PATTERN}": contains,
    rf"`(?P<command>[^`]+)` (?:succeeds|prints {PATTERN})": prints,
    rf"the reply (?P<says>does not say|says) {PATTERN}": replies,
}


def form_of(assertion: str) -> tuple[Check, dict[str, str]] | None:
    """Return the check of an assertion and the words in it, or None if the assertion has none of the forms."""
    for form, check in FORMS.items():
        found = re.fullmatch(form, assertion)
        if found:
            return check, found.groupdict()
    return None


def passes(assertion: str, folder: Path, reply: str = "", given: Path = HERE) -> tuple[bool, str]:
    """Whether an assertion holds, and if it could not be checked, why.

    Args:
        assertion: A sentence of one of the forms.
        folder: The folder that the agent worked in.
        reply: Its last message.
        given: Folder of the files as the agent got them.

    Raises:
        ValueError: The sentence has none of the forms.
    """
    known = form_of(assertion)
    if known is None:
        raise ValueError(f"no form fits: {assertion}")
    check, said = known
    if "file" in said:
        said["given"] = str(given / said["file"])
    try:
        return check(folder, reply, said), ""
    except (OSError, ValueError, TypeError, KeyError, yaml.YAMLError, subprocess.TimeoutExpired, irsim.IrsimError) as e:
        return False, f"{type(e).__name__}: {e}"


def evals_of(skill: str) -> list[dict[str, Any]]:
    """Return the evals of a skill."""
    found: list[dict[str, Any]] = read(HERE / skill / "evals.json")["evals"]
    return found


def main() -> int:
    """Check one answer."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("skill", choices=sorted(path.parent.name for path in HERE.glob("*/evals.json")))
    parser.add_argument("id", help="id of the eval")
    parser.add_argument("folder", type=Path, help="folder that the agent worked in")
    parser.add_argument("--reply", type=Path, help="file with its last message")
    given = parser.parse_args()
    chosen = [item for item in evals_of(given.skill) if item["id"] == given.id]
    if not chosen or not given.folder.is_dir():
        print(f"assertions.py: eval {given.id!r} or folder {given.folder} does not exist", file=sys.stderr)
        return 2
    reply = given.reply.read_text(encoding="utf-8") if given.reply else ""
    rows = []
    for assertion in chosen[0]["assertions"]:
        passed, why = passes(assertion, given.folder, reply, HERE / given.skill / "files")
        rows.append({"assertion": assertion, "passed": passed, **({"why": why} if why else {})})
    print(json.dumps({"passed": sum(row["passed"] for row in rows), "of": len(rows), "assertions": rows}, indent=1))
    return 0 if all(row["passed"] for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
