"""A part of a study for one job of a batch system: shard I of N."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeVar

Task = TypeVar("Task")

MOST_SHARDS = 10_000
SLURM = "slurm"

_WAYS = "give I/N, as 3/20 for the third of twenty, or slurm in a job array of SLURM"


class Shard(NamedTuple):
    """One part of many.

    Attributes:
        number: From 1.
        total: How many there are.
    """

    number: int
    total: int


WHOLE = Shard(1, 1)


def part(tasks: Sequence[Task], shard: Shard) -> list[Task]:
    """The tasks of a shard: every N-th, so that all shards take about as long."""
    return list(tasks[shard.number - 1 :: shard.total])


def parse_shard(text: str, environment: Mapping[str, str]) -> Shard:
    """Return the shard that `--shard` names.

    Args:
        text: `I/N`, or `slurm` for the job of an array that the environment tells.
        environment: Of the process.

    Raises:
        ValueError: If it names none.
    """
    if text == SLURM:
        return _of_slurm(environment)
    match = re.fullmatch(r"(\d{1,9})/(\d{1,9})", text)
    if match is None:
        raise ValueError(f"shard {text!r} is not known; {_WAYS}")
    return _checked(Shard(int(match[1]), int(match[2])), f"shard {text}")


def _checked(shard: Shard, told: str) -> Shard:
    if not 1 <= shard.total <= MOST_SHARDS:
        raise ValueError(f"{told}: there can be 1 to {MOST_SHARDS} shards; {_WAYS}")
    if not 1 <= shard.number <= shard.total:
        raise ValueError(f"{told}: the first number is 1 to {shard.total}; {_WAYS}")
    return shard


def _of_slurm(environment: Mapping[str, str]) -> Shard:
    """The shard of a job array, whatever number it counts from."""
    names = ("ID", "COUNT", "MIN", "STEP")
    found = {n: environment.get(f"SLURM_ARRAY_TASK_{n}", "") for n in names}
    if not found["ID"].isdigit() or not found["COUNT"].isdigit():
        raise ValueError(
            "shard slurm needs SLURM_ARRAY_TASK_ID and SLURM_ARRAY_TASK_COUNT, which "
            "only a job array has: sbatch --array=1-20; or give I/N"
        )
    first, step = int(found["MIN"] or 1), int(found["STEP"] or 1)
    number, left = divmod(int(found["ID"]) - first, step)
    told = f"SLURM_ARRAY_TASK_ID {found['ID']} of {found['COUNT']}"
    if left:
        raise ValueError(f"{told} does not count from {first} by {step}; {_WAYS}")
    return _checked(Shard(number + 1, int(found["COUNT"])), told)
