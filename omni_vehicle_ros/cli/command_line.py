"""The command line as a whole: all commands, arguments of ROS, signals and exit codes."""

import signal
import sys
from collections.abc import Callable
from types import FrameType
from typing import Annotated

import typer

from omni_vehicle_ros import __version__
from omni_vehicle_ros.cli import bags, benchmarks, driving, faults, studies
from omni_vehicle_ros.ending import ENDING, EXIT_SIGNAL
from omni_vehicle_ros.errors import OmniVehicleError
from omni_vehicle_ros.run import Interrupted

EXIT_USAGE = 2
GRACE = 10  # s, of an end by a signal
AGAIN = 0.01  # s, until an end that was swallowed is tried again

COMMANDS: dict[str, Callable[..., None]] = {
    'run': driving.run,
    'start': driving.start,
    'scenarios': driving.scenarios,
    'thesis': studies.thesis,
    'map': studies.draw_map,
    'sweep': studies.sweep,
    'campaign': faults.campaign,
    'replay': driving.replay,
    'analyse': bags.analyse_bags,
    'export': bags.export_bag,
    'repair': bags.repair,
    'bench': benchmarks.bench,
}


def print_version(wanted: bool) -> None:
    """Print the version and end."""
    if wanted:
        print(__version__)
        raise typer.Exit


def omni_vehicle(
    version: Annotated[
        bool, typer.Option('--version', callback=print_version, is_eager=True, help='Print the version.')
    ] = False,
) -> None:
    """Steer-by-wire for a vehicle whose four wheels steer and drive independently."""


def make_app() -> typer.Typer:
    """Return the command line."""
    app = typer.Typer(
        add_completion=False, no_args_is_help=True, rich_markup_mode=None, pretty_exceptions_enable=False
    )
    app.callback()(omni_vehicle)
    for name, command in COMMANDS.items():
        app.command(name)(command)
    return app


def interrupt(number: int, frame: FrameType | None) -> None:
    """Turn a signal into an end without a trace; a run has its own handlers while nodes are up."""
    ignore_signals()
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(GRACE)  # kills this process, should anything have swallowed the exception for good

    def again(unraisable: 'sys.UnraisableHookArgs') -> None:
        if not isinstance(unraisable.exc_value, Interrupted):
            sys.__unraisablehook__(unraisable)
            return
        signal.signal(signal.SIGALRM, lambda late, frame: interrupt(number, frame))  # a destructor has swallowed it
        signal.setitimer(signal.ITIMER_REAL, AGAIN)

    sys.unraisablehook = again
    raise Interrupted('interrupted', number)


def own_arguments(arguments: list[str]) -> list[str]:
    """Return what is not between ``--ros-args`` and ``--``: that is for the node, which finds it by itself."""
    if '--ros-args' not in arguments:
        return arguments
    begin = arguments.index('--ros-args')
    rest = arguments[begin:]
    return arguments[:begin] + (own_arguments(rest[rest.index('--') + 1 :]) if '--' in rest else [])


def ignore_signals() -> None:
    """Let nothing disturb the end, that of the interpreter included."""
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)


def main() -> None:
    """Run the command line; what the user got wrong is one line and exit code 2, a signal 128 plus its number."""
    for number in ENDING:
        signal.signal(number, interrupt)
    try:
        try:
            make_app()(own_arguments(sys.argv[1:]))
        finally:
            ignore_signals()
    except Interrupted as error:
        print(error, file=sys.stderr)
        sys.exit(EXIT_SIGNAL + error.number)
    except OmniVehicleError as error:
        print(f'error: {error}', file=sys.stderr)
        sys.exit(EXIT_USAGE)
