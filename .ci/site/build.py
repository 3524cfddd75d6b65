"""Builds the site: ``python .ci/site/build.py OUT`` writes Markdown to ``OUT/source`` and pages to ``OUT/html``.

The Markdown is made of what the program knows of itself (registries, models, docstrings, ``--help``, ``tools/list``),
of the skills, and of five pages written by hand in ``hand/``. Sphinx lays it out and reads nothing else.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

from commands import command_pages
from films import with_films
from gallery import gallery_pages
from head import lighter
from language import language_pages, whereabouts
from mirror import FOLDERS, GUIDES, LISTED, files_of, mirrored, rewritten
from models import model_pages, with_models
from pages import ROOT, Page, contents, headed, link, once, summary_of
from python_api import python_pages
from redirects import STUB, write_stubs
from suites import suite_pages
from tools import tool_pages
from twins import write_twins

from irsim.bundled import templates
from irsim.common.installed import version
from irsim.options.registry import reading_order

__all__ = ["build", "lay_out", "write_source"]

HERE = Path(__file__).resolve().parent
BY_HAND = ("index", "start/robotics", "start/learning", "start/agents", "start/from-ir-sim")
"""Pages of ``hand/``; the last one ends with the table of differences."""
_START = BY_HAND[1:]
MEANINGS = 3
"""How many places the search shows first for the name of a key."""


def write_source(folder: Path) -> list[Page]:
    """Write the Markdown of all pages, and the files that they show or link.

    Returns:
        The pages, in the order in which the navigation shows them.
    """
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    pages, files = list[Page](), set[str]()
    for page in _by_hand():
        pages.append(page)
    for page, needed in mirrored():
        pages.append(page)
        files |= needed
    where = whereabouts()
    pages += _indexes()
    for part in (
        gallery_pages(folder / "players"),
        language_pages(where),
        command_pages(),
        tool_pages(),
        python_pages(),
        suite_pages(where),
        model_pages(where, folder / "pictures" / "realism"),
    ):
        pages += part
    pages = with_models(pages)
    for page in pages:
        target = folder / f"{page.path}.md"
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(once(page.text).rstrip() + "\n", encoding="utf-8")
    for name in sorted(files):
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / name, target)
    (folder / "schema").mkdir(exist_ok=True)
    for path in sorted((ROOT / "schema").glob("*.json")):
        shutil.copyfile(path, folder / "schema" / path.name)
    (folder / "pictures").mkdir(exist_ok=True)
    shutil.copyfile(ROOT / ".github" / "crossing.gif", folder / "pictures" / "crossing.gif")
    for name in templates.names():
        shutil.copyfile(templates.picture_file(name), folder / "pictures" / f"template-{name}.png")
    return pages


def _by_hand() -> Iterator[Page]:
    for path in BY_HAND:
        text = (HERE / "hand" / f"{Path(path).name}.md").read_text(encoding="utf-8")
        title = re.search(r"^# (.*)", text, re.MULTILINE)
        assert title is not None
        shown = text
        if path == "start/from-ir-sim":
            table = re.search(
                r"^## Intended differences\n\n(.*?)\n\n## ",
                (ROOT / "irsim/compat/README.md").read_text(encoding="utf-8"),
                re.DOTALL | re.MULTILINE,
            )
            assert table is not None
            shown += f"\n## Intended differences\n\n{table[1]}\n"
        twin = shown
        if path == "index":
            tops = ("start/index", "guides/index", "gallery/index", "reference/index", "realism/index")
            tops += ("suites/index", "bridges/index", "evals/index", "project/index")
            shown += "\n" + contents(tops, hidden=True)
        yield Page(path, shown, twin, title[1], summary_of(text))


def _index(path: str, title: str, about: str, members: list[tuple[str, str, str]], captions: bool = False) -> Page:
    """A page that lists others: path, title and sentence of each."""
    lines = [f"- {link(name, path, page)}" + (f": {text}" if text else "") for page, name, text in members]
    text = f"# {title}\n\n{about}\n\n" + "\n".join(lines)
    return Page(path, f"{text}\n\n{contents([page for page, *_ in members], hidden=True)}", text, title, about)


def _about(path: str) -> tuple[str, str, str]:
    """A page of the checkout with its title and first sentence."""
    text = (ROOT / f"{path}.md").read_text(encoding="utf-8")
    title = LISTED[f"{path}.md"] or re.search(r"^# (.*)", text, re.MULTILINE)[1]  # type: ignore[index]
    return path, title, summary_of(rewritten(text, f"{path}.md")[0])


def _indexes() -> Iterator[Page]:
    hands = {page.path: page for page in _by_hand()}
    start = [(path, hands[path].title, hands[path].summary) for path in _START]
    yield _index("start/index", "Start", "Ten minutes each.", [*start, _about("README")])
    skills = [(f"{skill}/SKILL", title, _about(f"{skill}/SKILL")[2]) for skill, title in GUIDES.items()]
    yield _index("guides/index", "Guides", "Pages for people and coding agents who work with irsim.", skills)
    bridges = files_of("skills/irsim-runner", "bridges")
    bridges.sort(key=lambda page: not page.endswith("/overview"))
    about = "The same scenario drives a robot or another simulator, and worlds of other programs become scenarios."
    yield _index("bridges/index", "Bridges", about, [_about(page) for page in bridges])
    cases = ["evals/README", "evals/write-a-case"]
    yield _index("evals/index", "Evaluate agents", "Tasks that measure agents.", [_about(page) for page in cases])
    project = [
        "CHANGELOG",
        "CONTRIBUTING",
        "RELEASING",
        "AGENTS",
        "irsim/core/README",
        "irsim/compat/README",
        "tests/speed/README",
    ]
    yield _index("project/index", "Project", "How irsim is made.", [_about(page) for page in project])
    kinds = ("behavior", "kinematics", "sensor", "shape", "distribution", "map", "planner", "bridge")
    parts = [
        ("reference/world", "World", "keys of `world`, with zones and pictures"),
        ("reference/robot", "Robots and obstacles", "keys of `robot` and `obstacle`"),
        ("reference/sections", "Other sections", "keyboard and mouse, your own data, the version"),
        *((f"reference/{kind}/index", f"{kind.capitalize()}", "") for kind in kinds),
        ("reference/things", "How to write it", "things, words and wishes, each with the keys that express it"),
        ("reference/policies", "Policies", "what drives robots from outside their scenario"),
        ("reference/tasks", "Tasks for learning", "observations, actions, rewards"),
        ("reference/metrics", "Metrics", "the numbers that measure an episode"),
        ("reference/events", "Events", "what happens in a run"),
        ("reference/codes", "Codes", "errors and findings, each with its fix"),
        ("reference/commands/index", "Commands", "the command line"),
        ("reference/tools", "MCP tools", "what an agent's host lists"),
        ("reference/python/index", "Python", "modules, functions and classes"),
    ]
    yield _index("reference/index", "Reference", "Generated from the program itself.", parts)


def names_of(pages: list[Page]) -> dict[str, list[tuple[str, str, str]]]:
    """Names that people look for, as keys, components and codes -> page, its title and anchor of each meaning."""
    names = dict[str, list[tuple[str, str, str]]]()
    titles = {page.path: page.title for page in pages}
    order = {path: number for number, path in enumerate(titles)}
    places = dict.fromkeys(where for where in whereabouts().values() if "#" in where)
    for page in pages:
        if page.path.startswith("reference/"):
            places |= dict.fromkeys(
                f"{page.path}#{name}" for name in re.findall(r'<span id="([^"]*)"></span>', page.text)
            )
    split = [(path, name) for path, _, name in (place.partition("#") for place in places)]
    for path, name in sorted(split, key=lambda place: (*reading_order(place[1]), order[place[0]])):
        for said in dict.fromkeys((name.lower(), name.rpartition(".")[2].lower())):
            names.setdefault(said, []).append((path, titles[path], name))
    return {said: meanings[:MEANINGS] for said, meanings in sorted(names.items())}


def lay_out(source: Path, html: Path, names: Mapping[str, object], *, jobs: str = "2") -> None:
    """Make pages of the Markdown, whose search knows the names; a warning is an error."""
    shutil.rmtree(html, ignore_errors=True)
    scorer = source.parent / "search.js"
    ranking = (HERE / "theme/search.js").read_text(encoding="utf-8")
    scorer.write_text(f"const NAMES = {json.dumps(names, separators=(',', ':'))};\n{ranking}", encoding="utf-8")
    command = [sys.executable, "-m", "sphinx", "-b", "html", "-c", str(HERE / "theme"), "-q", "-W", "--keep-going"]
    environment = {**os.environ, "SOURCE_DATE_EPOCH": "0", "PYTHONHASHSEED": "0", "IRSIM_SITE_RELEASE": version()}
    environment["IRSIM_SITE_SCORER"] = str(scorer)
    done = subprocess.run(
        [*command, "-j", jobs, "-d", str(source.parent / "doctrees"), str(source), str(html)],
        env=environment,
        check=False,
    )
    if done.returncode:
        raise SystemExit(f"Sphinx found mistakes (exit code {done.returncode})")


def _finish(html: Path, pages: list[Page]) -> None:
    """Let pages load little, name the switches of the navigation, and find the list of versions from their places."""
    about = {page.path: page.summary for page in pages}
    listed = os.environ.get("IRSIM_SITE_SWITCHER", "_static/switcher.json")
    for path in sorted(html.rglob("*.html")):
        if path.relative_to(html).parts[0] in ("_static", "players"):
            continue
        name = path.relative_to(html).with_suffix("").as_posix()
        text = lighter(path.read_text(encoding="utf-8"), searches=name == "search", about=about.get(name, ""))
        text = with_films(headed(text), path).replace(
            "<summary><span", '<summary aria-label="Pages below this one"><span'
        )
        if "://" not in listed:
            text = text.replace(f"'{listed}'", f"'{os.path.relpath(html / listed, path.parent)}'")
        path.write_text(text, encoding="utf-8")


def build(out: Path, *, previous: Path | None = None) -> None:
    """Build the whole site.

    Args:
        out: Folder that gets ``source`` and ``html``.
        previous: The site as it was before, whose addresses go on to lead somewhere.
    """
    source, html = out / "source", out / "html"
    pages = write_source(source)
    shutil.rmtree(out / "doctrees", ignore_errors=True)
    lay_out(source, html, names_of(pages))
    for path in sorted(source.rglob("*")):
        if path.is_file() and path.suffix != ".md":
            target = html / path.relative_to(source)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, target)
    _finish(html, pages)
    write_twins(pages, html)
    for folder, page in FOLDERS.items():
        (html / folder).mkdir(parents=True, exist_ok=True)
        to = f"{os.path.relpath(html / page, html / folder)}.html"
        (html / folder / "index.html").write_text(STUB.format(to=to), encoding="utf-8")
    (html / ".nojekyll").write_text("", encoding="utf-8")
    (html / ".buildinfo").unlink(missing_ok=True)
    (html / "objects.inv").unlink(missing_ok=True)
    if previous is not None:
        write_stubs(previous, html)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="folder that gets source/ and html/")
    parser.add_argument("--previous", type=Path, help="an older site, whose addresses shall lead on")
    given = parser.parse_args()
    sys.path.append(str(ROOT))  # plots of models use estimators of the tests
    build(given.out.resolve(), previous=given.previous)
    print(f"the site is in {given.out / 'html'}")
