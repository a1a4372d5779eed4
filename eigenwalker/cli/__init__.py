"""The command `eigenwalker`."""

import argparse
import sys
import warnings
from collections.abc import Callable, Sequence

from threadpoolctl import threadpool_limits

from eigenwalker.cli import demo, fit, gait, linearize, restyle, study, style, view, walk

__all__ = ["main"]

_STOPPED = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    arguments : sequence of str, default None
        What stands behind `eigenwalker` on the command line; None takes it from there.

    Returns
    -------
    int
        Exit status: 0, 1 after an error, which is printed, or 130 after Ctrl-C, as shells have it.
    """
    parser = _make_parser()
    options = parser.parse_args(arguments)
    # The matrices are small: threads of the linear algebra would only wait for each other.
    with warnings.catch_warnings(), threadpool_limits(limits=1):
        warnings.showwarning = _warning_printer()
        try:
            options.run(options)
        except (ValueError, TypeError, OSError, ImportError) as error:
            print(f"eigenwalker {options.command}: error: {error}", file=sys.stderr)
            return 1
        except KeyboardInterrupt:
            print(f"eigenwalker {options.command}: stopped", file=sys.stderr)
            return _STOPPED
    return 0


def _make_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="eigenwalker",
        description="Statistics of human walking: learn what walkers differ in, and make walks along it.",
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for module in (demo, gait, fit, walk, restyle, style, view, linearize, study):
        name = module.__name__.rpartition(".")[2]
        command = commands.add_parser(name, help=module.HELP, description=module.DESCRIPTION)
        module.add_arguments(command)
        command.set_defaults(run=module.run)
    return parser


def _warning_printer() -> Callable[..., None]:
    """Return what prints each warning once."""
    said = set()

    def show(message: Warning | str, category: type[Warning], *_: object, **__: object) -> None:
        if str(message) not in said and not issubclass(category, (DeprecationWarning, PendingDeprecationWarning)):
            print(f"eigenwalker: note: {message}", file=sys.stderr)
        said.add(str(message))

    return show
