"""A study on workers of Dask: the same bytes, and nothing lost when one is killed."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest

import costeer
from costeer.scale.cluster import workers
from costeer.scale.jobs import run_jobs
from costeer.scale.shard import Shard
from costeer.study.configuration import StudySettings
from costeer.study.merge import merge_study
from costeer.study.run import Scale, run_study
from costeer.study.trials import TrialDone
from tests.study.fakes import SMALL, contents, made_up, plain_report
from tests.waiting import PATIENCE, wait_for

pytest.importorskip("distributed")
pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]

REAL = StudySettings(participants=2, conditions=("manual", "weak-gentle"), length=400.0)
"""Simulated, with the network."""

MANY = SMALL._replace(participants=20)
TWO = "local:2"
LONG = 6 * PATIENCE
"""After which workers that have to start first are done, on any machine [s]."""
ROOT = Path(__file__).parents[2]


def tables(folder: Path) -> dict[str, bytes]:
    """The tables of a study."""
    held = contents(folder)
    return {name: held[name] for name in held if name.endswith(".csv")}


def test_workers_shards_and_threads_give_the_same_bytes(tmp_path: Path) -> None:
    threads, workers, alone, shards = (tmp_path / name for name in "abcd")
    run_study(threads, REAL, jobs=1, report=None)
    run_study(workers, REAL, report=None, scale=Scale(cluster=TWO))
    assert contents(workers) == contents(threads)
    scale = Scale(cluster=TWO, records=False)
    run_study(alone, REAL, report=None, scale=scale)
    assert tables(alone) == tables(threads)
    for number in (1, 2, 3):
        run_study(shards, REAL, jobs=2, scale=Scale(shard=Shard(number, 3)))
    merge_study([shards], report=None)
    assert contents(shards) == contents(threads)


def worker_pids(engine: Any) -> list[int]:
    """Processes of the workers of this computer that are up."""
    nannies = engine.client.cluster.workers.values()
    return [
        each.process.pid
        for each in nannies
        if each.status.name == "running" and each.process.is_alive()
    ]


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL there")
@pytest.mark.parametrize("records", [True, False])
def test_killed_workers_lose_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, records: bool
) -> None:
    draw, seen, killed = random.Random(1), 0, 0
    run_study(tmp_path / "whole", MANY, report=plain_report, simulate=made_up)
    with workers(None, TWO) as engine:

        @contextmanager
        def given(*_: object) -> Iterator[Any]:
            yield engine

        def kill_some(_: TrialDone) -> None:
            nonlocal seen, killed
            seen += 1
            if seen in (5, 20, 35):
                os.kill(draw.choice(worker_pids(engine)), signal.SIGKILL)
                killed += 1

        monkeypatch.setattr("costeer.study.run.workers", given)
        run_study(
            tmp_path / "killed",
            MANY,
            report=plain_report,
            progress=kill_some,
            simulate=made_up,
            scale=Scale(cluster=TWO, records=records),
        )
    assert (killed, seen) == (3, 60)
    if records:
        assert contents(tmp_path / "killed") == contents(tmp_path / "whole")
    assert tables(tmp_path / "killed") == tables(tmp_path / "whole")


GATE = "gate"
"""The file without which a study that `started` does not come to its end."""

CANCELLED = """
import sys
from functools import partial
from costeer.cli import main
from costeer.study import run
from tests.study.fakes import held_up, plain_report

if __name__ == "__main__":
    run.full_report = plain_report
    run.run_study = partial(
        run.run_study, simulate=partial(held_up, gate=sys.argv[2])
    )
    sys.exit(main(["study", "--out", sys.argv[1], "--participants", "60",
        "--conditions", "manual,strong-rapid,weak-gentle", "--intention", "scripted",
        "--length", "1800", *sys.argv[3:]]))
"""


@contextmanager
def started(tmp_path: Path, *words: str) -> Iterator[subprocess.Popen[str]]:
    """A study of made-up trials as a user starts it, in a process group of its own."""
    script = tmp_path / "script.py"
    script.write_text(CANCELLED)
    with subprocess.Popen(
        [
            sys.executable,
            str(script),
            *(str(tmp_path / name) for name in ("out", GATE)),
            *words,
        ],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        try:
            yield process
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)


@pytest.mark.skipif(sys.platform == "win32", reason="no process groups there")
def test_ctrl_c_reaches_workers_too_and_loses_nothing(tmp_path: Path) -> None:
    results = tmp_path / "out" / "results"
    with started(tmp_path, "--cluster", TWO, "--no-records") as process:
        wait_for(
            lambda: process.poll() is not None or any(results.glob("*.json")), LONG
        )
        os.killpg(process.pid, signal.SIGINT)
        (tmp_path / GATE).touch()
        _, said = process.communicate(timeout=LONG)
    assert process.returncode == 130, said
    kept = len(list(results.glob("*.json")))
    assert f"costeer: {kept} of 180 trials are done and kept in" in said
    assert "run the same command again" in said
    assert "Traceback" not in said
    assert 0 < kept < 180


@contextmanager
def scheduler(
    folder: Path, sources: Path | None = None
) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """A scheduler with one worker, as an administrator starts them.

    Args:
        folder: For what they write.
        sources: Where the worker finds costeer.
    """
    file = folder / "scheduler.json"
    paths = [str(sources or ""), str(ROOT), *sys.path]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths))}
    dask, options = [sys.executable, "-m", "dask"], ["--no-dashboard"]
    options += ["--scheduler-file", str(file)]
    first = [*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", *options]
    second = [*dask, "worker", "--nthreads", "1", *options]
    second += ["--local-directory", str(folder / "scratch")]
    quiet = subprocess.DEVNULL
    with ExitStack() as running:

        def start(words: list[str]) -> subprocess.Popen[bytes]:
            process = subprocess.Popen(
                words, env=environment, stdout=quiet, stderr=quiet
            )
            running.callback(process.wait, PATIENCE)
            running.callback(process.terminate)
            return process

        server = start(first)
        wait_for(lambda: file.exists() and file.read_text().endswith("}"), LONG)
        start(second)
        yield json.loads(file.read_text())["address"], server


def test_a_lost_scheduler_is_told_and_loses_nothing(tmp_path: Path) -> None:
    records = tmp_path / "out" / "records"
    with (
        scheduler(tmp_path) as (address, server),
        started(tmp_path, "--cluster", address) as process,
    ):
        wait_for(
            lambda: process.poll() is not None or any(records.glob("*.parquet")), LONG
        )
        server.kill()
        server.wait(LONG)
        (tmp_path / GATE).touch()
        _, said = process.communicate(timeout=LONG)
    assert process.returncode == 2, said
    last = said.splitlines()[-1]
    assert "lost" in last
    assert "of 180 trials are done and kept in" in last
    assert "run the same command again to go on from there" in last
    assert "Traceback" not in said
    assert "ERROR" not in said
    assert any(records.glob("*.parquet"))


def test_nobody_at_the_address_is_told(tmp_path: Path) -> None:
    with pytest.raises(
        ValueError, match=r"no Dask scheduler answers at 127\.0\.0\.1:9"
    ):
        run_study(tmp_path / "out", SMALL, scale=Scale(cluster="127.0.0.1:9"))
    assert not (tmp_path / "out").exists()


def test_a_worker_of_another_costeer_is_refused_before_there_is_a_folder(
    tmp_path: Path,
) -> None:
    package = Path(costeer.__file__).parent
    copy = tmp_path / "copy" / "costeer"
    shutil.copytree(package, copy, ignore=shutil.ignore_patterns("web", "__pycache__"))
    with (copy / "study" / "gaps.py").open("a") as file:
        file.write("# edited\n")
    with (
        scheduler(tmp_path, copy.parent) as (address, _),
        pytest.raises(
            ValueError,
            match=r"the worker tcp://\S+ has another costeer than .*: sources \w+ "
            r"there and \w+ here; install the same .* \(process \d+ on \S+ is here\)",
        ),
    ):
        run_study(tmp_path / "out", SMALL, scale=Scale(cluster=address))
    assert not (tmp_path / "out").exists()


def where(_: int) -> int:
    """The process that does a task."""
    return os.getpid()


def test_a_single_worker_works_elsewhere_too() -> None:
    with workers(None, "local:1") as engine:
        did = run_jobs(where, range(20), engine, lambda _: None)
    assert os.getpid() not in did
    assert len(set(did)) == 1
