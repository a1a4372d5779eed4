"""``eigenwalker linearize``: any number of recordings become one table of coefficients."""

import argparse
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from eigenwalker.batch import linearize_files
from eigenwalker.cli._numbers import count
from eigenwalker.cli._preparation import Preparation, find_walks, make_preparation
from eigenwalker.cli._recordings import add_recording_arguments, reading_options
from eigenwalker.io.formats import read_walk
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.motion.preparer import WalkPreparer

HELP = "the Fourier coefficients of any number of recordings, in Parquet files"
DESCRIPTION = (
    "Read recordings one by one, bring them to the treadmill frame, and write their Fourier coefficients, one row a "
    "walk, into a folder of Parquet files; what was refused has its reason there. However many they are, few are in "
    "memory. The same command again goes on where a stopped one was, and takes in files that were added."
)

_SHOWN = 5  # names in an error


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("files", nargs="*", type=Path, metavar="FILE", help="recordings")
    parser.add_argument(
        "--files-from", metavar="LIST", help="more recordings than a command line holds: a text file, one a line, or -"
    )
    parser.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for the table")
    parser.add_argument("--jobs", type=count, metavar="N", help="number of processes (1)")
    parser.add_argument(
        "--retry-refused", action="store_true", help="read files again that an earlier run refused, such as mended ones"
    )
    model = parser.add_argument_group("the table")
    model.add_argument(
        "--representation",
        choices=("markers", "joints"),
        default="markers",
        help="paths of 15 markers, or joint angles, for files with a skeleton such as BVH: of the joints that turn in "
        "the first recording (markers)",
    )
    model.add_argument("--harmonics", type=count, default=2, metavar="N", help="number of harmonics (2)")
    model.add_argument(
        "--extra", action="append", choices=("speed", "size"), default=[], help="a further feature; may be repeated"
    )
    add_recording_arguments(parser)


def run(options: argparse.Namespace) -> None:
    """Linearize, and say what is in the folder."""
    if (options.files_from is None) != bool(options.files):
        raise ValueError("expected recordings, either as FILE ... or in --files-from LIST")
    _check_there(options.files)
    reading = reading_options(options)
    preparation = make_preparation(options, reading=reading)
    try:
        done = linearize_files(
            options.files if options.files else _listed(options.files_from),
            FourierLinearizer(options.harmonics, extras=tuple(options.extra)),
            options.out,
            preparer=WalkPreparer(**preparation.options),
            read=partial(_read, reading=reading, preparation=preparation),
            n_jobs=options.jobs,
            retry_refused=options.retry_refused,
            progress=True,
        )
    except KeyboardInterrupt:
        print(f"{options.out} keeps what was done; the same command goes on from there", file=sys.stderr)
        raise
    print(f"files: {done.n_files}, walks: {done.n_walks}, refused: {done.n_refused}")
    if done.n_refused:
        print("why they were refused is in the column reason; --retry-refused reads them again")
    print(f"wrote {done.folder}; read it with eigenwalker.batch.read_coefficients or pandas.read_parquet")


def _check_there(files: Sequence[Path]) -> None:
    """Raise a FileNotFoundError for names that no file has, such as patterns that the shell has left as they are."""
    absent = [str(path) for path in files if not path.exists()]
    if absent:
        more = f" and {len(absent) - _SHOWN} more" if len(absent) > _SHOWN else ""
        raise FileNotFoundError(f"expected recordings, found no file {', '.join(absent[:_SHOWN])}{more}")


def _listed(name: str) -> Iterator[Path]:
    """Yield the paths in a text file, one a line."""
    if name == "-":
        yield from _paths(sys.stdin)
        return
    with Path(name).open(encoding="utf-8-sig") as lines:
        yield from _paths(lines)


def _paths(lines: Iterable[str]) -> Iterator[Path]:
    return (Path(line.rstrip("\r\n")) for line in lines if line.strip())


def _read(path: Path, *, reading: Mapping[str, object], preparation: Preparation) -> list[Any]:
    return find_walks(read_walk(path, **reading), preparation)
