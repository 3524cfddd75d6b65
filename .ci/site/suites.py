"""Pages of the suites: what each fixes, its protocol and the results that are kept."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from answers import section
from mirror import LISTED
from pages import Page, cell, contents, link

from irsim.benchmarks.suite import SUITES
from irsim.lookup import lookup
from irsim.lookup.answer import plain_table
from irsim_mcp.reference import explanation

__all__ = ["suite_pages"]

_SKILL = "skills/irsim-benchmark"
_START = "suites/index"


def suite_pages(where: Mapping[str, str]) -> Iterator[Page]:
    """One page a suite, and one that lists them with their results and the keys of a suite file."""
    names = SUITES.names()
    answer = lookup("suites")
    about = {key.name: key.text for key in answer.groups["suites"]}
    rows = [(link(name, _START, f"suites/{name}"), cell(about[name])) for name in names]
    results = sorted(page for page in LISTED if page.startswith(f"{_SKILL}/results/"))
    results = [page.removesuffix(".md") for page in results]
    readable = f"{_SKILL}/results/referee"
    own = [page for page in results if page != readable]
    keys = answer.model_copy(update={"groups": {k: v for k, v in answer.groups.items() if k != "suites"}, "text": ""})
    kept = link("what was measured", _START, f"{_SKILL}/results/results")
    ranks = link("ranks with ideal and with realistic sensing", _START, f"{_SKILL}/results/realistic_ranks")
    referees = link("page for referees", _START, readable)
    parts = [
        "# Suites",
        "A suite is a benchmark that can be cited: fixed scenarios, seeds, horizon, protocol and policies.",
        plain_table(("suite", "what it asks"), rows),
        f"Results: {kept}, {ranks}, and a {referees} with each objection and the command that answers it.",
        section(keys, _START, "suites", where, title="A suite file of your own"),
        contents([f"suites/{name}" for name in names], caption="Suites", hidden=True),
        contents([readable, *own, f"{_SKILL}/guides/audit"], caption="Results", hidden=True),
    ]
    text = "\n\n".join(parts)
    yield Page(_START, text, explanation("suites", None), "Suites", "Benchmarks that can be cited, and their results.")
    for name in names:
        yield _page(name, where)


def _page(name: str, where: Mapping[str, str]) -> Page:
    page, answer = f"suites/{name}", lookup(name)
    protocol, results = f"{_SKILL}/references/protocol_{name}", f"{_SKILL}/results/{name}"
    parts = [section(answer, page, name, where, level=1, title=name)]
    links = [link("The whole protocol", page, protocol)] if f"{protocol}.md" in LISTED else []
    links += [link("Kept results", page, results)] if f"{results}.md" in LISTED else []
    if links:
        parts.append("## More\n\n" + "\n".join(f"- {one}" for one in links))
    if f"{protocol}.md" in LISTED:
        parts.append(contents([protocol], hidden=True))
    return Page(page, "\n\n".join(parts), explanation(name, None), name, answer.title)
