"""The table of all benchmarks, its JSON, comparison and guard, with findings that nobody measured."""

import json
from dataclasses import dataclass

import numpy as np
import pytest

from benchmarks import __main__ as command
from benchmarks._comparison import print_comparison
from benchmarks._findings import Check, Row, from_plain, to_plain
from benchmarks._guard import find_faults, find_slow, find_unasked, give_verdict, keep_fast_rows
from benchmarks._results import Results, Suite, read_results, write_results
from benchmarks._suites import run_suites
from benchmarks._summary import print_summary
from benchmarks._tables import format_ratio, format_seconds, print_targets

_GOOD = Row("load a file", 0.0303, "pymotion", 0.24, 7.9, wanted=6, error=0.0, bound=0.0)
_NEAR = Row("fit a walk", 51e-6, "scikit-fda", 1e-3, 16.0, wanted=20, error=3e-15, bound=1e-9, unit="m")
_SLOW = _NEAR._replace(ratio=15.9)
_WRONG = _NEAR._replace(error=1e-8)
_ABSENT = Row("load a file", 0.03, "bvh", None, None, wanted=12, bound=0.0, note="did not run: No module named 'bvh'")
_FREE = Row("10,000 permutations", 0.08, "a loop", 7700.0, 96000.0)
_PASSED, _MISSED = Check("octave errors 0", "0", True), Check("octave errors 0", "3", False)
_SECONDS = Check("an iteration at most 0.5 s", "0.9 s", False, guarded=False)
_UNKNOWN = Check("recordings in kinect", "not there", None)


def _results(*findings, failure="", short=True, commit="abc"):
    machine = {"processor": "some processor", "cores": "2", "memory": "4 GiB", "commit": commit}
    return Results(machine, {"numpy": "2.0"}, short, {"suite": Suite(12.3, list(findings), failure)})


@pytest.mark.parametrize("row", [_SLOW, _WRONG, _NEAR._replace(error=float("nan")), _NEAR._replace(ratio=float("nan"))])
def test_low_ratios_and_large_errors_are_faults(row):
    assert len(find_faults(_results(_GOOD, row))) == 1


def test_only_what_is_merely_slow_is_measured_again():
    assert find_slow(_results(_GOOD, _NEAR)) == []
    assert find_slow(_results(_GOOD, _SLOW)) == list(_results(_SLOW).suites)
    assert find_slow(_results(_SLOW, _MISSED)) == []


def test_of_low_ratios_the_higher_is_kept_and_nothing_else():
    before = Suite(1.0, [_GOOD._replace(ratio=9.0), _NEAR, _MISSED])
    kept = keep_fast_rows(Suite(2.0, [_GOOD, _SLOW, _PASSED, _ABSENT]), before)
    assert kept == Suite(2.0, [_GOOD, _NEAR, _PASSED, _ABSENT])
    slower = _SLOW._replace(ratio=1.0)
    assert keep_fast_rows(Suite(2.0, [_SLOW]), Suite(1.0, [slower])).findings == [_SLOW]
    assert keep_fast_rows(Suite(2.0, [_WRONG]), before).findings == [_WRONG]
    failed = Suite(2.0, [], "ValueError: no")
    assert keep_fast_rows(failed, before) == failed


def test_what_is_slow_is_measured_twice_more_at_most(monkeypatch, capsys):
    found = iter([[_SLOW, _GOOD], [_NEAR, _GOOD._replace(ratio=1.0)], [_SLOW, _GOOD]])
    monkeypatch.setattr(command, "run_suites", lambda *_, **__: {"read": Suite(1.0, next(found))})
    assert command.main(["read", "--guard"]) == 0  # in the second run both reach their share in one run or the other
    assert list(found) == [[_SLOW, _GOOD]]
    monkeypatch.setattr(command, "run_suites", lambda *_, **__: {"read": Suite(1.0, [_SLOW])})
    assert command.main(["read", "--guard"]) == 1
    assert capsys.readouterr().err.count("measuring again") == 3


def test_a_missed_check_is_a_fault():
    assert find_faults(_results(_PASSED, _MISSED)) == ["suite: octave errors 0: 3"]


def test_a_benchmark_that_failed_is_a_fault():
    assert find_faults(_results(failure="ValueError: no")) == ["suite failed: ValueError: no"]


def test_seconds_and_absent_peers_are_no_faults_but_told():
    results = _results(_GOOD, _NEAR, _FREE, _ABSENT, _SECONDS, _UNKNOWN)
    assert find_faults(results) == []
    told = find_unasked(results)
    assert len(told) == 3
    assert "No module named 'bvh'" in told[0]
    assert "seconds" in told[1]


@pytest.mark.parametrize(
    ("finding", "verdict"),
    [
        (_GOOD, "met"),
        (_NEAR, "near"),
        (_SLOW, "MISSED"),
        (_WRONG, "MISSED: error"),
        (_ABSENT, "not run"),
        (_FREE, ""),
        (_PASSED, "met"),
        (_MISSED, "MISSED"),
        (_SECONDS, "MISSED: seconds"),
        (_UNKNOWN, "not told"),
    ],
)
def test_verdicts(finding, verdict):
    assert give_verdict(finding) == verdict


def test_findings_come_back_from_plain_data():
    findings = [_GOOD, _NEAR, _ABSENT, _FREE, _PASSED, _SECONDS, _UNKNOWN]
    assert from_plain(json.loads(json.dumps(to_plain(findings)))) == findings


def test_numbers_of_numpy_become_plain():
    plain = to_plain([_GOOD._replace(ratio=np.float32(2)), _PASSED._replace(passed=np.bool_(True))])
    assert json.loads(json.dumps(plain))[1]["passed"] is True


def test_results_come_back_from_their_file(tmp_path):
    results = _results(_GOOD, _ABSENT, _SECONDS, failure="ValueError: µ", short=False)
    write_results(results, tmp_path / "results.json")
    assert read_results(tmp_path / "results.json") == results


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"suites": {"read": {}}}', '{"suites": {}, "extra": 1}'])
def test_other_files_are_refused(text, tmp_path):
    path = tmp_path / "other.json"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"other\.json: expected what"):
        read_results(path)


def test_the_table_holds_rows_checks_notes_and_failures(capsys):
    results = _results(_GOOD, _ABSENT, _FREE, _MISSED, failure="ImportError: " + "long " * 50)
    print_summary(results)
    lines = capsys.readouterr().out.splitlines()
    assert "some processor" in lines[0]
    row = next(line for line in lines if "pymotion" in line)
    assert row.split()[-10:] == ["30.3", "ms", "pymotion", "240", "ms", "7.9", "6", "0.0e+00", "0", "met"]
    absent = next(line for line in lines if "bvh [1]" in line)
    assert absent.endswith("not run")
    assert "[1] did not run: No module named 'bvh'" in lines
    assert any(line.endswith("FAILED") and len(line) < 200 for line in lines)
    assert any(line.split()[-1:] == ["MISSED"] for line in lines)
    assert lines[-1] == "Seconds: suite 12"


def test_two_runs_side_by_side(capsys):
    old = _results(_GOOD._replace(ratio=4.0), _NEAR, _PASSED, commit="old")
    print_comparison(old, _results(_GOOD._replace(ratio=8.0), _FREE, _MISSED, commit="new"))
    printed = capsys.readouterr().out
    lines = {line.split("  ")[1].strip(): line.split() for line in printed.splitlines() if line.startswith("suite")}
    assert lines["load a file"][-5:] == ["4", "8", "2", "0.0e+00", "0.0e+00"]
    assert lines["fit a walk"][-2:] == ["16", "3.0e-15"]  # in the old run alone
    assert lines["octave errors 0"][-4:] == ["0", "(met)", "3", "(MISSED)"]
    assert "commit old" in printed
    assert "commit new" in printed


def test_benchmarks_of_one_run_alone_are_only_named(capsys):
    old, new = _results(_GOOD), _results(_GOOD)
    new.suites["another"] = Suite(1.0, [_NEAR, _PASSED])
    print_comparison(old, new)
    printed = capsys.readouterr().out
    assert "In one run alone: another" in printed
    assert "scikit-fda" not in printed
    assert "octave" not in printed
    assert list(new.suites) == ["suite", "another"]


def test_targets_of_a_single_benchmark(capsys):
    print_targets([_GOOD, _SLOW, _ABSENT, _FREE, _UNKNOWN])
    lines = capsys.readouterr().out.split("\n")[2:-1]
    assert [line.split()[0] for line in lines] == ["met", "met", "MISSED", "met", "not", "not", "not"]
    assert lines[2].endswith("fit a walk: at least 20 times as fast as scikit-fda: 15.9")


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.0, "0 µs"), (5.15e-5, "51.5 µs"), (0.2, "200 ms"), (1.0, "1 s"), (7731.0, "7,731 s")]
)
def test_times_have_their_units(seconds, text):
    assert format_seconds(seconds) == text


@pytest.mark.parametrize(("ratio", "text"), [(0.4512, "0.451"), (999.4, "999"), (999.6, "1,000"), (95900.0, "95,900")])
def test_ratios_have_no_exponents(ratio, text):
    assert format_ratio(ratio) == text


def test_a_benchmark_that_fails_is_told_and_the_others_go_on():
    seen = []
    suites = run_suites(["nowhere", "neither"], short=True, report=lambda name, *_: seen.append(name))
    assert seen == ["nowhere", "neither"]
    assert "No module named benchmarks.nowhere" in suites["nowhere"].failure
    assert suites["nowhere"].findings == []


@dataclass
class _Saved:
    path: str

    def run(self, *options):
        return command.main(["--read", self.path, *options])


@pytest.fixture
def saved(tmp_path):
    def save(*findings, failure=""):
        write_results(_results(*findings, failure=failure), tmp_path / "results.json")
        return _Saved(str(tmp_path / "results.json"))

    return save


def test_the_exit_status_is_that_of_the_guard_where_it_is_asked(saved):
    assert saved(_GOOD, _NEAR, _SECONDS, _ABSENT, _UNKNOWN).run("--guard") == 0
    assert saved(_GOOD, _SLOW).run() == 0
    assert saved(_GOOD, _SLOW).run("--guard") == 1
    assert saved(_MISSED).run("--guard") == 1


def test_the_exit_status_of_a_failure_is_1_without_a_guard(saved):
    assert saved(_GOOD, failure="ValueError: no").run() == 1


def test_a_saved_run_beside_itself(saved, capsys):
    one = saved(_GOOD, _MISSED)
    assert one.run("--compare", one.path) == 0
    printed = capsys.readouterr().out
    assert "side by side" in printed
    assert "otherwise" not in printed


def test_unknown_benchmarks_are_refused(capsys):
    with pytest.raises(SystemExit):
        command.main(["reed"])
    assert "got reed" in capsys.readouterr().err
