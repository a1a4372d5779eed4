"""Refusals are kept in order, warnings are not lost, other errors are not hidden."""

import threading
import warnings

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eigenwalker._collect import Refusal, collect, report_refusals
from eigenwalker._validation import WalkError


def _root(number):
    """Return the square root; warn of zero, refuse what is negative, break on None."""
    if number is None:
        raise KeyError("None")
    if number == 0:
        warnings.warn("the root of nothing", RuntimeWarning, stacklevel=1)
    if number < 0:
        raise WalkError(f"expected a positive number, got {number}")
    return number**0.5


@given(st.lists(st.integers(-5, 5).filter(bool)))
def test_each_item_gives_a_result_or_a_refusal(numbers):
    names = [str(number) for number in numbers]
    results, refusals = collect(_root, numbers, names)
    assert results == [number**0.5 if number > 0 else None for number in numbers]
    assert [refusal.name for refusal in refusals] == [str(number) for number in numbers if number < 0]


@pytest.mark.parametrize("n_jobs", [None, 1, 2])
def test_results_and_warnings_do_not_depend_on_processes(n_jobs):
    numbers = [4, 0, -1, 9, 0, -2]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        results, refusals = collect(_root, numbers, list("abcdef"), n_jobs=n_jobs)
    assert results == [2, 0, None, 3, 0, None]
    assert refusals == [
        Refusal("c", "expected a positive number, got -1"),
        Refusal("f", "expected a positive number, got -2"),
    ]
    assert [str(warning.message) for warning in caught] == ["the root of nothing"] * 2
    assert {warning.category for warning in caught} == {RuntimeWarning}


def test_the_callers_filters_hold():
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        collect(_root, [0, 0, 0], list("abc"))
    assert len(caught) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(RuntimeWarning, match="the root of nothing"):
            collect(_root, [4, 0], list("ab"))


def test_in_a_thread_warnings_are_shown_at_once():
    found = []

    def collect_in_thread():
        thread = threading.Thread(target=lambda: found.append(collect(_root, [0, 4], list("ab"))))
        thread.start()
        thread.join()

    with pytest.warns(RuntimeWarning, match="the root of nothing"):
        collect_in_thread()
    assert found == [([0, 2], [])]


@pytest.mark.parametrize("n_jobs", [1, 2])
def test_other_errors_are_not_hidden(n_jobs):
    with pytest.raises(KeyError, match="None"):
        collect(_root, [4, None, 9], list("abc"), n_jobs=n_jobs)


@pytest.mark.parametrize("error", [ValueError("bad value"), FileNotFoundError(2, "No such file", "a.bvh"), OSError()])
def test_bad_values_and_files_are_refusals(error):
    def fail(item):
        raise error

    assert collect(fail, [1], ["a"])[1] == [Refusal("a", str(error) or "OSError")]


def test_a_short_job_shows_no_bar(capsys):
    collect(_root, [1, 4], list("ab"), progress=True, description="rooting")
    assert capsys.readouterr().err == ""


def test_nothing_to_report():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        report_refusals([], 3, on_error="raise")
        report_refusals([], 3, on_error="skip")
    with pytest.raises(ValueError, match="on_error must be one of 'raise', 'skip', got 'warn'"):
        report_refusals([], 3, on_error="warn")


def test_report_has_one_line_a_refusal():
    refusals = [Refusal("a.bvh", "a.bvh, line 3: expected\n this"), Refusal("b.bvh", "expected that")]
    lines = "2 of 7 walks were refused.*:\n  a\\.bvh, line 3: expected this\n  b\\.bvh: expected that$"
    with pytest.raises(WalkError, match=lines):
        report_refusals(refusals, 7, on_error="raise", what="walks")
    with pytest.warns(UserWarning, match=lines):
        report_refusals(refusals, 7, on_error="skip", what="walks")
