"""The commands and the options that all of them share."""

from __future__ import annotations

from typing import Annotated

import typer

from modrobust.cli import (
    assemble,
    bench,
    campaign,
    design,
    import_timor,
    modules,
    schema,
    simulate,
)
from modrobust.cli.options import PlainCommand

app = typer.Typer(
    name="modrobust",
    help="Robust tracking controllers with guaranteed bounds for robots assembled from modules.",
    epilog=(
        "\b\nExamples:\n"
        "  modrobust modules\n"
        "  modrobust assemble lwa4p\n"
        "  modrobust simulate lwa4p-paper --scenario 1\n"
        "  modrobust design ur5 --delay 1 --noise 'position=1e-4, velocity=1e-2'\n\n"
        "Exit codes: 0 fine; 1 ran, but the answer is bad (a bound violated, a loop diverged, "
        "a limit missed); 2 bad input or usage; 130 interrupted."
    ),
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for command in (assemble, design, simulate, campaign, bench, modules, schema, import_timor):
    app.command(cls=PlainCommand, epilog=command.EXAMPLES)(command.command)


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"modrobust {version('modrobust')}")
        raise typer.Exit


@app.callback()
def shared(
    version: Annotated[
        bool,
        typer.Option(
            "--version", help="Show the version and exit.", callback=_print_version, is_eager=True
        ),
    ] = False,
) -> None:
    """Robust tracking controllers with guaranteed bounds for robots assembled from modules."""
