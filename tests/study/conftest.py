"""Studies of made-up trials, each run once for all tests that only look at them."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from costeer.methods.conditions import CONDITION_NAMES
from costeer.pages.exhibit import Exhibit
from costeer.pages.style import styled
from costeer.study import report
from costeer.study.configuration import StudySettings
from costeer.study.figures.catalogue import draw_figures
from costeer.study.material import StudyMaterial, read_material
from costeer.study.report import write_report
from costeer.study.run import run_study
from tests.study.fakes import made_up

# 1800 m hold one overtaking event, hence two lane changes a trial.
REPORTED = StudySettings(
    participants=3, conditions=CONDITION_NAMES, intention="scripted", length=1800.0
)


@pytest.fixture(scope="session")
def study_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All conditions, three drivers, tables and records but no report; read only."""
    folder = tmp_path_factory.mktemp("reported") / "study"
    run_study(folder, REPORTED, jobs=1, report=None, simulate=made_up)
    return folder


@pytest.fixture(scope="session")
def material(study_folder: Path) -> StudyMaterial:
    """What the figures and the report are made from."""
    return read_material(study_folder)


@pytest.fixture(scope="session")
def exhibits(material: StudyMaterial) -> list[Exhibit]:
    """Every figure of the study; drawing them is most of the work of a report."""
    with styled():
        return list(draw_figures(material))


@pytest.fixture(scope="session")
def reported(
    study_folder: Path,
    exhibits: list[Exhibit],
    tmp_path_factory: pytest.TempPathFactory,
) -> Path:
    """A copy of the study with its report, of figures that are drawn already."""
    folder = tmp_path_factory.mktemp("with-report") / "study"
    shutil.copytree(study_folder, folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report, "draw_figures", lambda material: exhibits)
        write_report(folder)
    return folder
