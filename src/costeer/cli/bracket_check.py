"""The check of a network's bracketed form, after a training."""

from __future__ import annotations

from pathlib import Path


def check_form(file: Path, kilometres: float, jobs: int) -> None:
    """Check a network on fresh drives; write what was found among its facts.

    Args:
        file: Of the network, written anew.
        kilometres: To be driven [km].
        jobs: Threads.
    """
    from costeer.cli.console import note, progress
    from costeer.intention.checked import shortcomings
    from costeer.intention.weights import load_weights, save_weights
    from costeer.training.bracket_check import (
        CHECK_SEED,
        checked_drives,
        num_drives,
        with_check,
    )

    network, places = load_weights(file), range(num_drives(kilometres))
    with progress("drives to check the bracket", len(places)) as advance:
        found = checked_drives(network, places, CHECK_SEED, jobs, advance)
    save_weights(file, with_check(network, found, CHECK_SEED))
    note(
        f"bracket: {found.kilometres:.0f} km, {found.verdicts} verdicts, "
        f"{found.triggers} triggers, {found.wrong} on the wrong side, margin "
        f"{100.0 * found.margin:.0f} %"
    )
    told = shortcomings(found._asdict())
    use = f"exact windows: {'; '.join(told)}" if told else "the bracket"
    note(f"the loop will use {use}")
