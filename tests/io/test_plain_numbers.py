"""Lines of plain numbers: the same doubles that Python makes of them, and nothing where they are not plain."""

import numpy as np
import pytest

from eigenwalker.io._plain_numbers import parse_lines_of_numbers


@pytest.mark.parametrize(
    "word",
    ["-0", "5.", ".5", "+3", "1E+5", "9007199254740993", "1e22", "1e23", "0.1" + "0" * 30, "4.35e-17", "-2e-310"],
)
def test_plain_numbers_are_those_of_python(word):
    (value,) = parse_lines_of_numbers(word.encode(), 0, (1, 1))[0]
    assert (value, np.signbit(value)) == (float(word), np.signbit(float(word)))


def test_plain_numbers_of_all_lengths_are_those_of_python():
    rng = np.random.default_rng(0)
    numbers = rng.normal(size=30_000) * 10.0 ** rng.integers(-25, 25, 30_000)
    words = [f"{number:.{digits}g}" for number, digits in zip(numbers, rng.integers(1, 19, 30_000), strict=True)]
    assert parse_lines_of_numbers(" ".join(words).encode(), 0, (1, 30_000))[0].tolist() == [
        float(word) for word in words
    ]


@pytest.mark.parametrize(
    "text",
    [
        *("1_0 2", "1..2 3", "1.2.3 4", "e5 1", "1e 2", "1e+ 2", "- 1", "nan 1", "0x1 2", "1,5 2", "1-2 3"),
        *("1\x0b 2", "1 ٢", "1e999 2", "1", "1 2 3", "1\n2", "1 2\n3 4", ""),
    ],
)
def test_what_is_not_plain_is_left_to_others(text):
    assert parse_lines_of_numbers(text.encode(), 0, (1, 2)) is None


@pytest.mark.parametrize("text", ["1 2\n3 4\n", "1 2\r\n3 4\r\n", "1 2\r3 4", "\n 1\t2 \n\n3  4\n \n", "+1 2.\n3 .4e1"])
def test_lines_end_in_all_ways(text):
    assert parse_lines_of_numbers(text.encode(), 0, (2, 2)).tolist() == [[1, 2], [3, 4]]


def test_numbers_of_many_digits_are_as_exact_where_there_are_many_of_them():
    numbers = np.random.default_rng(1).normal(size=(6000, 4))  # 17 digits each
    text = "".join(" ".join(map(repr, row)) + "\n" for row in numbers.tolist())
    assert np.array_equal(parse_lines_of_numbers(text.encode(), 0, (6000, 4)), numbers)


def test_no_shape_is_believed():
    assert parse_lines_of_numbers(b"1 2\n", 0, (10**12, 2)) is None
