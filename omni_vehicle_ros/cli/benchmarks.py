"""The command that measures."""

import json
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from omni_vehicle_ros.bench import BENCHES
from omni_vehicle_ros.cli.options import choose
from omni_vehicle_ros.errors import RunError

if TYPE_CHECKING:
    from omni_vehicle_ros.console import ProgressBar


def bench(
    name: Annotated[
        str | None, typer.Argument(metavar='[NAME]', help=f'One of: {", ".join(BENCHES)}. Default: all.')
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option('--json', metavar='FILE', help='Write the results there, too.')
    ] = None,
) -> None:
    """Measure how fast this package is on this machine, each figure beside a bare limit."""
    from omni_vehicle_ros.bench.frame import machine, run_bench
    from omni_vehicle_ros.console import ProgressBar

    choose('NAME', name or BENCHES[0], BENCHES)
    found: dict[str, Any] = {'machine': machine()}
    for one in BENCHES if name is None else (name,):
        with ProgressBar(f'bench {one}', 100.0, '%') as bar:
            result = run_bench(one, partial(show_share, bar))
        found[one] = result.as_json()
        for line in result.text:
            print(line, flush=True)
    if json_file is not None:
        try:
            json_file.write_text(json.dumps(found, indent=2) + '\n', encoding='utf-8')
        except OSError as error:
            raise RunError(f'{json_file}: {error.strerror}') from None


def show_share(bar: 'ProgressBar', done: float) -> None:
    """Show a share of 0 to 1 on a bar of per cent."""
    bar.advance(round(100.0 * done))
