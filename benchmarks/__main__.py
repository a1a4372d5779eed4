"""All benchmarks in one table: ``python -m benchmarks [BENCHMARK ...] [--guard] [...]``.

Each runs in its short form, in a process of its own; one that fails is a row with its error, the others go on, and the
exit status is 1. With ``--guard`` it is 1 as well if a ratio is below 0.8 of what its benchmark asks for, in each of
three runs, an error is above its bound, or a check is missed. Seconds never count, nor do peers that are not installed.
"""

import argparse
import sys

from benchmarks._comparison import print_comparison
from benchmarks._guard import find_faults, find_slow, find_unasked, keep_fast_rows
from benchmarks._machine import find_machine, find_versions
from benchmarks._results import Results, Suite, read_results, write_results
from benchmarks._suites import LONG, SHORT, run_suites
from benchmarks._summary import print_summary

_REPEATS = 2  # of benchmarks with low ratios


def main(arguments: list[str] | None = None) -> int:
    """Run the benchmarks, print the table, and return the exit status."""
    options = _parse(arguments)
    old = read_results(options.compare) if options.compare else None
    results = read_results(options.read) if options.read else _run(options)
    if options.out:
        write_results(results, options.out)
    print_summary(results)
    if old is not None:
        print_comparison(old, results)
    faults = find_faults(results)
    if options.guard:
        _print_guard(faults, find_unasked(results))
    return int(bool(results.failures()) or (options.guard and bool(faults)))


def _parse(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description="All benchmarks in one table.")
    parser.add_argument("benchmarks", nargs="*", metavar="BENCHMARK", help=f"some of {', '.join(LONG)}; default: all")
    parser.add_argument("--full", action="store_true", help="in their long form, which takes far longer")
    parser.add_argument("--out", metavar="FILE", help="write the results as JSON")
    parser.add_argument("--compare", metavar="FILE", help="print the results beside those of an earlier --out")
    parser.add_argument("--read", metavar="FILE", help="take the results of an earlier --out, and measure nothing")
    parser.add_argument("--guard", action="store_true", help="fail for low ratios, large errors and missed checks")
    parser.add_argument("--details", action="store_true", help="print the tables of each benchmark as well")
    options = parser.parse_args(arguments)
    unknown = [name for name in options.benchmarks if name not in LONG]
    if unknown:
        parser.error(f"expected some of {', '.join(LONG)}, got {', '.join(unknown)}")
    return options


def _run(options: argparse.Namespace) -> Results:
    def report(name: str, suite: Suite, printed: str) -> None:
        if options.details or suite.failure:
            print(f"\n== {name}\n{printed}", flush=True)
        print(f"{name}: {suite.seconds:.0f} s{', FAILED' if suite.failure else ''}", file=sys.stderr, flush=True)

    names = options.benchmarks or (LONG if options.full else SHORT)
    short = not options.full
    results = Results(find_machine(), find_versions(), short, run_suites(names, short=short, report=report))
    for _ in range(_REPEATS if options.guard else 0):
        slow = find_slow(results)  # what is slow once is the machine's doing more often than the program's
        if not slow:
            break
        print(f"measuring again what was slow: {', '.join(slow)}", file=sys.stderr, flush=True)
        again = run_suites(slow, short=short, report=report)
        results.suites.update({name: keep_fast_rows(again[name], results.suites[name]) for name in slow})
    return results


def _print_guard(faults: list[str], unasked: list[str]) -> None:
    for title, lines in (("Guard: not told", unasked), ("Guard: faults", faults)):
        print(f"\n{title}{': none' if not lines else ''}")
        for line in lines:
            print(f"  {line}")


if __name__ == "__main__":
    sys.exit(main())
