"""`costeer doctor`: what this computer has and how to fix what is missing."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def doctor(
    out: Annotated[
        Path, typer.Option(help="Folder in which results would be written.")
    ] = Path("out"),
    json: Annotated[
        bool, typer.Option("--json", help="Print the findings as JSON.")
    ] = False,
    report: Annotated[
        bool,
        typer.Option(
            "--report",
            help="Print what a bug report needs, without names of user, folders or "
            "computer.",
        ),
    ] = False,
) -> None:
    """Show what this computer has and how to fix what is missing.

    The exit code is 0 if a study can run here, else 1.

    Example:
        costeer doctor
        costeer doctor --report
    """
    if json and report:
        raise ValueError("--json and --report were both given; give one of them")
    from costeer.doctor import examine

    findings = examine(out)
    if report:
        from costeer.cli.doctor_report import bug_report

        typer.echo(bug_report(findings, out))
    elif json:
        import json as encoder

        typer.echo(encoder.dumps([f._asdict() for f in findings], indent=2))
    else:
        for finding in findings:
            typer.echo(f"{finding.status:8}  {finding.name}: {finding.detail}")
            if finding.remedy:
                typer.echo(f"{'':10}to mend: {finding.remedy}")
    if any(finding.status == "missing" for finding in findings):
        raise typer.Exit(1)
