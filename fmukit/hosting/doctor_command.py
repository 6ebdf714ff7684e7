"""`fmus doctor`: what this machine lacks, and how to get it."""

from __future__ import annotations

import typer

from fmukit.hosting.requirements import requirements


def doctor() -> None:
    """Say what of platform, compiler, libpython and cache folder is missing, and how to get it."""
    missing = []
    for requirement in requirements():
        print(f"{'ok' if requirement.there else 'missing':9}{requirement.thing:14}{requirement.seen}")
        if not requirement.there:
            missing.append(f"{requirement.thing}: {requirement.remedy}")
    for sentence in missing:
        print(sentence)
    raise typer.Exit(1 if missing else 0)
