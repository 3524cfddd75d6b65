"""The page of results on recorded pedestrians says what its command computes."""

from __future__ import annotations

from pathlib import Path
from string import Formatter

import pytest

from irsim.bridges.pedestrians.comparison import CONSTANT_VELOCITY
from irsim.bridges.pedestrians.imitation import GOALS
from irsim.bridges.pedestrians.published import RECORDINGS, SHA256
from tests.benchmarks.pedestrians import fitted, human, robot, walks
from tests.benchmarks.pedestrians.write import PAGE, TEXT, with_words
from tests.benchmarks.reference.kept import kept_lines, source_of


@pytest.mark.foreign
def test_the_cells_of_hotel_are_derived_again(foreign: Path) -> None:
    compared = human.compare(foreign / "pedestrians", ["hotel"])
    assert "\n".join(human.table(compared, "hotel")) in PAGE.read_text(encoding="utf-8")


def test_the_page_has_a_table_for_each_recording() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert [name for name in human.FILES if f"**{name}**: " not in text] == []


@pytest.mark.foreign
def test_the_suite_is_written_again_and_its_first_episodes_are_the_kept_ones(foreign: Path) -> None:
    plan = robot.plan_of(foreign / "pedestrians", seeds=1)
    assert f"hash {plan.suite_hash}." in PAGE.read_text(encoding="utf-8")
    hotel = [one.name for one in plan.scenarios if one.name.startswith("hotel-")]
    part = robot.plan_of(foreign / "pedestrians", ["orca", "dash"], seeds=1, scenarios=hotel)
    known = {(line["scenario"], line["policy"], line["seed"]): line for line in kept_lines(robot.KEPT)}
    made = robot.lines_of(part, robot.measure(part))
    assert len(made) == 2 * len(hotel) == 20
    for line in made:
        kept = known[line["scenario"], line["policy"], line["seed"]]
        del kept["engine"]  # another engine has the same numbers
        assert {key: line.get(key, "") for key in kept} == kept


def test_the_page_counts_the_kept_episodes() -> None:
    text, lines = PAGE.read_text(encoding="utf-8"), kept_lines(robot.KEPT)
    assert source_of(robot.KEPT) in text
    for policy in robot.POLICIES:
        for where in (*RECORDINGS, "all"):
            own = [
                line for line in lines if line["policy"] == policy and where in ("all", line["scenario"][: len(where)])
            ]
            start = f"| {where} | `{robot.shown(policy)}` | {len(own)} | "
            [row] = [line for line in text.splitlines() if line.startswith(start)]
            shares = [float(cell.split(" %")[0]) for cell in row.removeprefix(start).split(" | ")[:3]]
            counts = [sum(line["outcome"] == kind for line in own) for kind in ("success", "collision", "timeout")]
            assert shares == pytest.approx([100 * count / len(own) for count in counts], abs=0.51)


def test_errors_and_contacts_on_the_page_are_those_of_the_kept_cases() -> None:
    text, kept = PAGE.read_text(encoding="utf-8"), walks.kept_cells()
    assert source_of(walks.KEPT, walks.CASES) in text
    stems = {Path(file).stem: name for name, file in human.FILES.items()}
    rows = 0
    for (recording, behavior, goal), cells in kept.items():
        name, _, fitted_to = behavior.partition(", ")
        if behavior in (*human.BEHAVIORS, CONSTANT_VELOCITY):
            part = text.partition(f"**{stems[recording]}**: ")[2].partition("**")[0]
            start = f"| {human.named(behavior)} | {goal or '–'} | {' | '.join(cells)} |"
        elif goal == GOALS[0]:
            part = text.partition(f"**`{name}`**")[2].partition("**`")[0]
            start = f"{fitted.heads(fitted_to, stems[recording].lower())} | {' | '.join(cells)} |"
        else:
            continue
        assert start in part
        rows += 1
    assert rows == 3 * (1 + 2 * len(human.BEHAVIORS)) + 2 * 4 * 3


def test_the_page_has_the_words_of_its_template() -> None:
    """Numbers take minutes, and need files that are not part of the repository; everything else is checked here."""
    shown, place = PAGE.read_text(encoding="utf-8"), 0
    for words, *_ in Formatter().parse(TEXT.read_text(encoding="utf-8")):
        place = shown.index(words, place) + len(words)
    assert place == len(shown)


def test_other_words_leave_the_tables_as_they_are() -> None:
    old, new = "Of {n} cases:\n{table}\nEnd {{x}}.", "In {n} cases\n{table}\nThe end."
    assert with_words("Of 7 cases:\n| a |\n| b |\nEnd {x}.", old, new) == "In 7 cases\n| a |\n| b |\nThe end."
    with pytest.raises(SystemExit, match="measure it again"):
        with_words("Of 7 cases: none", old, new)


def test_the_page_names_the_files_of_the_published_results() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for name, file in human.FILES.items():
        assert f"| {name} | `{file}` | {human.PUBLISHED[name]} | `{SHA256[name.lower()]}` |" in text


@pytest.mark.foreign
def test_the_table_of_files_is_made_again_and_notices_another_file(foreign: Path, tmp_path: Path) -> None:
    data = foreign / "pedestrians"
    assert human.files_table(data) in PAGE.read_text(encoding="utf-8")
    for file in human.FILES.values():
        (tmp_path / file).write_bytes((data / file).read_bytes())
    (tmp_path / human.FILES["hotel"]).write_text("0 1 0 0\n")
    assert ", not the published file |" in human.files_table(tmp_path).splitlines()[3]
    assert human.files_table(tmp_path).count("not the published file") == 1
