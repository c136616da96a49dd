"""The same bytes on workers of Ray, where somebody has installed it."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.study.run import Scale, run_study
from tests.study.fakes import SMALL, contents, made_up, plain_report, run_small

pytest.importorskip("ray")


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.filterwarnings("ignore")  # of Ray's own
def test_workers_of_ray_give_the_same_bytes(tmp_path: Path) -> None:
    run_small(tmp_path / "threads")
    run_study(
        tmp_path / "ray",
        SMALL,
        report=plain_report,
        simulate=made_up,
        scale=Scale(cluster="ray:2"),
    )
    assert contents(tmp_path / "ray") == contents(tmp_path / "threads")
