"""`costeer doctor`: what this computer has and how to mend what is missing."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def doctor(
    out: Annotated[
        Path, typer.Option(help="Folder in which results would be written.")
    ] = Path("out"),
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Show what this computer has and how to mend what is missing.

    The exit code is 0 if a study can run here, else 1.

    Example:
        costeer doctor --json
    """
    from costeer.doctor import examine

    findings = examine(out)
    if json:
        import json as encoder

        typer.echo(encoder.dumps([f._asdict() for f in findings], indent=2))
    else:
        for finding in findings:
            typer.echo(f"{finding.status:8}  {finding.name}: {finding.detail}")
            if finding.remedy:
                typer.echo(f"{'':10}to mend: {finding.remedy}")
    if any(finding.status == "missing" for finding in findings):
        raise typer.Exit(1)
