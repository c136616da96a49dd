"""A shard is every N-th task; a job array of SLURM says which."""

from __future__ import annotations

import pytest

from costeer.scale.shard import Shard, parse_shard, part

SLURM = "SLURM_ARRAY_TASK_"


def test_all_shards_together_are_all_tasks_once() -> None:
    parts = [part(range(11), Shard(number, 4)) for number in (1, 2, 3, 4)]
    assert parts[0] == [0, 4, 8]
    assert sorted(each for some in parts for each in some) == list(range(11))


def test_a_shard_is_given_as_a_fraction() -> None:
    assert parse_shard("3/20", {}) == Shard(3, 20)


@pytest.mark.parametrize(
    ("first", "step", "number", "wanted"),
    [(1, 1, 3, 3), (0, 1, 0, 1), (0, 1, 4, 5), (10, 5, 20, 3)],
)
def test_a_job_array_may_count_as_it_likes(
    first: int, step: int, number: int, wanted: int
) -> None:
    told = {"ID": number, "COUNT": 5, "MIN": first, "STEP": step}
    environment = {f"{SLURM}{name}": str(value) for name, value in told.items()}
    assert parse_shard("slurm", environment) == Shard(wanted, 5)


@pytest.mark.parametrize(
    ("text", "environment", "message"),
    [
        ("0/4", {}, "the first number is 1 to 4; give I/N"),
        ("5/4", {}, "the first number is 1 to 4"),
        ("1/0", {}, "there can be 1 to 10000 shards"),
        ("1/99999", {}, "there can be 1 to 10000 shards"),
        ("-1/4", {}, "shard '-1/4' is not known; give I/N"),
        ("first", {}, "shard 'first' is not known; give I/N"),
        ("slurm", {}, "only a job array has: sbatch --array=1-20"),
        (
            "slurm",  # --array=3,7: two jobs, and the second is number 7
            {f"{SLURM}ID": "7", f"{SLURM}COUNT": "2", f"{SLURM}MIN": "3"},
            "SLURM_ARRAY_TASK_ID 7 of 2: the first number is 1 to 2",
        ),
        (
            "slurm",
            {f"{SLURM}ID": "4", f"{SLURM}COUNT": "2", f"{SLURM}STEP": "2"},
            "does not count from 1 by 2",
        ),
    ],
)
def test_what_is_no_shard_is_refused(
    text: str, environment: dict[str, str], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        parse_shard(text, environment)
