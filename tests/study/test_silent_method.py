"""A method without trigger and haptic gain: nothing is said that nobody judged."""

from __future__ import annotations

import html
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from costeer.loop.scenario import TrialSetup
from costeer.pages import frame
from costeer.records.columns import COLUMNS, TrialRecord
from costeer.records.row import record_columns
from costeer.study.analysis import analyse
from costeer.study.detection import Detection, detect
from costeer.study.report import write_report
from costeer.study.run import run_study
from tests.study.fakes import SMALL, made_up

NO_TRIGGER = "the method pi-keeping does not trigger lane changes"
NO_VERDICT = "the method pi-keeping has no haptic gain and gives no verdict"

pytestmark = pytest.mark.slow  # a study and its report


def silent(setup: TrialSetup) -> TrialRecord:
    """A made-up trial of a method that gives a torque and no more."""
    record = made_up(setup)
    if setup.condition == "manual":
        return record
    time = record.columns["time"]
    undefined = np.full(time.size, np.nan)
    nowhere = np.ma.MaskedArray(np.zeros(time.size, np.int8), mask=True)
    own = {
        "haptic_gain": undefined,
        "torque_agreement": undefined,
        "consistent": np.ma.MaskedArray(np.ones(time.size, bool), mask=False),
        "intention": np.zeros(time.size, bool),
        "mode": np.full(time.size, "lane_keeping", "<U13"),
        "target_lane": nowhere,
    }
    about = {"method": "pi-keeping", "replan_gain": None}
    return record._replace(
        metadata={**record.metadata, **about}, columns={**record.columns, **own}
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("silent") / "study"
    run_study(made, SMALL, jobs=1, report=None, simulate=silent)
    with pytest.MonkeyPatch.context() as patch:  # words count here, not drawings
        patch.setattr(frame, "svg_text", lambda *_: '<svg viewBox="0 0 1 1"></svg>')
        write_report(made)
    return made


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    return html.unescape((folder / "report.html").read_text("utf-8"))


def test_the_measures_say_why_there_is_none() -> None:
    setup = TrialSetup(condition="strong-rapid", length=1800.0)
    (found,) = analyse(silent(setup))
    assert found.measures["num_missed"].reason == NO_TRIGGER
    assert found.measures["num_inconsistencies"].reason == NO_VERDICT


def test_a_method_that_aims_at_a_lane_has_missed_what_it_did_not_announce() -> None:
    columns = dict(silent(TrialSetup(condition="strong-rapid", length=1800.0)).columns)
    columns["target_lane"] = np.ma.MaskedArray(columns["lane"], mask=False)
    found = detect(columns)
    assert isinstance(found, Detection)
    assert len(found.crossings) == 2


def test_nothing_is_missed_under_assistance(folder: Path) -> None:
    trials = pd.read_csv(folder / "trials.csv").set_index("condition")
    assert trials.loc["manual", "num_missed"].eq(0).all()
    for name in ("strong-rapid", "weak-gentle"):
        assert trials.loc[name, "num_missed"].isna().all()
    assert set(pd.read_csv(folder / "triggers.csv")["condition"]) == {"manual"}


def test_the_sentences_say_what_was_not_judged(page: str) -> None:
    assert f"In manual driving alone, as {NO_TRIGGER}: 4 of 4 completed" in page
    assert f"There is no verdict on inconsistency: {NO_VERDICT}." in page
    assert "No assisted trial" not in page


def test_tables_and_figures_say_so_too(page: str) -> None:
    assert page.count(f"Under assistance nothing is counted: {NO_TRIGGER}.") == 2
    assert f"Manual driving alone: {NO_TRIGGER}." in page
    assert f"There is no verdict in this study: {NO_VERDICT}." in page
    assert f"No gain is adjusted: {NO_VERDICT}." in page
    assert 'id="table-inconsistencies"' not in page
    shown = re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)
    assert shown.count("Undefined throughout, not drawn: haptic_gain.") == 2
    assert "No verdict was inconsistent" not in page


def test_a_sample_without_a_haptic_gain_has_no_verdict() -> None:
    names = [column.name for column in COLUMNS]
    rows = np.ones((2, len(COLUMNS)))
    rows[1, names.index("haptic_gain")] = np.nan
    verdict = record_columns(rows, True)["consistent"]
    assert np.ma.getmaskarray(verdict).tolist() == [False, True]
