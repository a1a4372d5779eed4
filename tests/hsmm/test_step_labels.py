"""Labels of steps: what they are for any number of steps, and where they are found in walks."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eigenwalker import WalkError
from eigenwalker.hsmm.step_labels import CONTEXTS, check_labels, label_steps, make_labels
from eigenwalker.motion import Event
from tests.hsmm.walking import shaken_walk
from tests.scissors import walker


def test_ten_contexts():
    assert len(set(CONTEXTS)) == 10


@given(st.integers(1, 40), st.sampled_from(["left", "right"]))
def test_labels_alternate_and_begin_and_end(n_steps, first):
    labels = make_labels(n_steps, first=first)
    assert len(labels) == n_steps
    assert labels[0] == (first, "first")
    assert all(one[0] != two[0] for one, two in itertools.pairwise(labels))
    assert check_labels(labels, walk="w") == labels
    positions = [position for _, position in labels]
    assert positions.count("first") == 1
    assert (positions[-1] == "last") == (n_steps > 1)
    assert positions.count("inside") == max(0, n_steps - 4)


@pytest.mark.parametrize(
    ("n_steps", "positions"),
    [
        (1, ["first"]),
        (2, ["first", "last"]),
        (3, ["first", "second", "last"]),
        (4, ["first", "second", "last but one", "last"]),
        (5, ["first", "second", "inside", "last but one", "last"]),
    ],
)
def test_short_walks(n_steps, positions):
    assert [position for _, position in make_labels(n_steps)] == positions


def test_steps_lie_between_the_strikes_of_the_walker():
    """A left heel strikes where the phase of the walker is a whole number, a right one half a stride later."""
    frequency, frame_rate = 0.9, 60.0
    steps = label_steps(walker(400, frequency=frequency, start=0.3))
    half = frame_rate / frequency / 2
    strikes = (np.arange(0.5, 6.5, 0.5) - 0.3) * frame_rate / frequency
    sides = ["right" if (at % 2) == 0 else "left" for at in range(len(strikes))]
    assert [side for side, _ in steps.labels[:4]] == sides[1:5]
    np.testing.assert_allclose(np.diff(steps.boundaries), half, atol=1.5)
    np.testing.assert_allclose(steps.boundaries[:4], strikes[:4], atol=3)


def test_a_long_start_is_a_step_and_a_short_one_is_not():
    walk = replace(walker(400), events=())
    strikes = [Event(time, "heel_strike", side) for time, side in zip((0.5, 1.1, 1.7, 2.3), "lrlr", strict=True)]
    named = [event._replace(side={"l": "left", "r": "right"}[event.side]) for event in strikes]
    steps = label_steps(replace(walk.to_markers(), events=tuple(named)))
    assert steps.boundaries[0] == 0
    assert steps.labels[0] == ("left", "first")
    assert steps.boundaries[-1] == 400
    assert steps.labels[-1] == ("left", "last")
    late = [event._replace(time=event.time - 0.2) for event in named]
    steps = label_steps(replace(walk.to_markers(), events=tuple(late)))
    assert steps.boundaries[0] == 18
    assert steps.labels[0] == ("right", "first")


def test_a_missed_strike_is_named():
    walk = walker(400).to_markers()
    events = tuple(Event(time, "heel_strike", side) for time, side in ((0.5, "left"), (1.6, "left"), (2.2, "right")))
    with pytest.raises(
        WalkError, match=r"walk 'walker': expected heel strikes of both feet in turn.*left at 0.50 and 1.60 s"
    ):
        label_steps(replace(walk, events=events))


def test_no_step():
    with pytest.raises(WalkError, match="expected a step"):
        label_steps(shaken_walk(n_frames=30))


@pytest.mark.parametrize(
    ("labels", "match"),
    [
        ([], "expected a label for each step"),
        ([("up", "first")], "expected a label for each step.*got \\[\\('up', 'first'\\)\\]"),
        ([("right", "first"), ("right", "last")], "steps 0 and 1 are both right"),
    ],
)
def test_impossible_labels(labels, match):
    with pytest.raises(WalkError, match=match):
        check_labels(labels, walk="anna")


def test_make_labels_refuses():
    with pytest.raises(ValueError, match="n_steps must be at least 1, got 0"):
        make_labels(0)
    with pytest.raises(ValueError, match="first"):
        make_labels(3, first="middle")
