"""What the tests of all formats of markers share: random walks, and files with a fault in them."""

import numpy as np
import pytest
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from eigenwalker._validation import WalkError
from eigenwalker.motion import Event, MarkerSet, Walk
from tests.synthetic import body_coefficients

__all__ = ["assert_same_walk", "body", "faults", "names", "outcome", "refusal", "walks"]

_COORDINATES = st.one_of(st.floats(-10, 10), st.just(float("nan")), st.sampled_from([0.0, 1e-9, -1234.5]))


def names():
    """Return a strategy for names of markers that a line of text can hold."""
    letters = st.characters(categories=("L", "N", "P", "S"), include_characters=" ")
    return st.text(letters, min_size=1, max_size=8).filter(lambda name: name == name.strip() and name != "n/a")


@st.composite
def walks(draw, *, min_frames=1, events=False):
    """Draw a walk with gaps, of 1 to 4 markers with any names."""
    markers = draw(st.lists(names(), min_size=1, max_size=4, unique=True))
    n_frames = draw(st.integers(min_frames, 5))
    size = 3 * n_frames * len(markers)
    positions = np.array(draw(st.lists(_COORDINATES, min_size=size, max_size=size))).reshape(n_frames, -1, 3)
    rate = draw(st.integers(8, 8000)) / 8
    known = draw(st.lists(_events(), max_size=4)) if events else []
    return Walk(positions, rate, MarkerSet(tuple(markers)), "anna", events=tuple(known))


def _events():
    kinds = st.one_of(st.sampled_from(["heel_strike", "toe_off"]), names().filter(lambda name: "_" not in name))
    return st.builds(Event, st.floats(0, 100), kinds, st.sampled_from(["", "left", "right"]))


def body(rng, *, n_frames=6, gaps=0):
    """Return a standing body with the 15 markers, some noise, and gaps in some places."""
    still = body_coefficients(rng)[0].reshape(15, 3)
    positions = still + 0.01 * rng.normal(size=(n_frames, 15, 3))
    positions[tuple(rng.integers((n_frames, 15), size=(gaps, 2)).T)] = np.nan
    return Walk(positions, 120.0, name="anna")


def assert_same_walk(got, expected):
    """Raise unless positions, names and events are the same to the last bit."""
    assert got.marker_set.names == expected.marker_set.names
    assert_array_equal(got.positions, expected.positions)
    assert got.events == expected.events


def refusal(read, path, content, **options):
    """Return the error about a file with the given content, which must name the file on one line."""
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(WalkError) as caught:
        read(path, **options)
    message = str(caught.value)
    assert str(path) in message
    assert "\n" not in message
    return message


def outcome(read, path, content, **options):
    """Return the walk in a file with any content, or the error; only a WalkError that names the file may come."""
    path.write_bytes(content)
    try:
        return read(path, **options), ""
    except WalkError as error:
        message = str(error)
    assert str(path.parent) in message
    return None, message


@st.composite
def faults(draw, content):
    """Draw what becomes of `content` when a few bytes are cut out and others put in."""
    put = [
        b"",
        b",",
        b";",
        b"\t",
        b"\n",
        b"\r",
        b'"',
        b"nan",
        b"1e308",
        b"1e-320",
        b"-",
        b"\0",
        b"\xff",
        b"9999999",
        b"_",
    ]
    for _ in range(draw(st.integers(1, 3))):
        place = draw(st.integers(0, len(content)))
        end = place + draw(st.sampled_from([0, 1, 5, 40, 10_000]))
        new = draw(st.one_of(st.sampled_from(put), st.binary(max_size=6)))
        content = content[:place] + new + content[end:]
    return content
