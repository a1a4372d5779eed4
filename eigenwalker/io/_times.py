"""A column of times: whether its frames are evenly spaced, and how many there are in a second."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError
from eigenwalker.io._text import decimal, shown

__all__ = ["check_file_rate", "rate_from_times", "time_words"]

_EVEN = 0.01  # of a frame, by which a step from frame to frame may differ from the usual one
_SAME = 1e-3  # relative difference between two frame rates that are the same
_SLOWEST, _FASTEST = 1e-3, 1e6  # frames a second
_FINE = 0.25  # of a frame: what the last digit may be worth in times that are only rounded


def rate_from_times(words: Sequence[str], lines: Sequence[int], *, frame_rate: float | None = None) -> float:
    """Return the frames per second that a column of times says, or `frame_rate` if the times agree with it.

    Parameters
    ----------
    words : sequence of str
        The times in seconds, as the file writes them.
    lines : sequence of int
        The line of each in the file, for errors.
    frame_rate : float, default None
        Frames per second, where they are known.

    Returns
    -------
    float
        `frame_rate` where it is given, else one over the mean step, or the whole number next to it if that gives
        the same times.

    Raises
    ------
    WalkError
        If a time is no number, if a step differs from the median step by more than 1 % of a frame, or if the times
        contradict `frame_rate` by more than 0.1 %; unless they are those of `frame_rate`, or of a whole number of
        frames a second, rounded to the digits that are there: 0.008, 0.017, 0.025 is 120 Hz in milliseconds.

    Examples
    --------
    >>> rate_from_times(["0", "0.008", "0.017", "0.025"], [2, 3, 4, 5])
    120.0
    """
    times = np.array([_time(word, line) for word, line in zip(words, lines, strict=True)])
    if len(times) < 2:
        if frame_rate is None:
            raise WalkError(f"line {lines[0]}: expected at least two times, or frame_rate=..., got a single frame")
        return frame_rate
    digit = _last_digit(words)
    span = float(times[-1] - times[0])
    rate = (len(times) - 1) / span if span > 0 else 1.0
    usual = min(max(1.0, float(np.round(rate))), _FASTEST) if frame_rate is None else frame_rate
    if _is_rounded(times, usual, digit):
        return usual
    _check_even(times, lines)
    if not _SLOWEST <= rate <= _FASTEST:
        raise WalkError(f"line {lines[0]}: expected times in seconds, got {rate:.3g} frames a second")
    if frame_rate is not None and abs(rate / frame_rate - 1) > _SAME:
        raise WalkError(
            f"line {lines[-1]}: expected time {times[0] + (len(times) - 1) / frame_rate:.6g} at {frame_rate:g} frames "
            f"a second, got {shown(words[-1])}, as if there were {rate:.6g} a second"
        )
    return float(rate) if frame_rate is None else frame_rate


def time_words(n_frames: int, frame_rate: float) -> list[str]:
    """Return the times of frames for a file, in seconds, with all their digits.

    With fewer than nine decimals zeros follow: 0.0128 s alone might be a time of 78 frames a second, rounded.
    """
    words = [repr(time) for time in (np.arange(n_frames) / frame_rate).tolist()]
    if any("e" in word for word in words):
        return words
    return [f"{seconds}.{decimals:0<9}" for seconds, _, decimals in (word.partition(".") for word in words)]


def check_file_rate(word: str, line: int, label: str) -> float:
    """Return the frame rate that a header says, in frames per second."""
    rate = decimal(word.strip())
    if rate is None or not _SLOWEST <= rate <= _FASTEST:
        raise WalkError(f"line {line}: expected {label} in frames per second, 0.001 to 1,000,000, got {shown(word)}")
    return rate


def _time(word: str, line: int) -> float:
    time = decimal(word.strip())
    if time is None or abs(time) > 1e12:
        raise WalkError(f"line {line}: expected a time in seconds, got {shown(word)}")
    return time


def _last_digit(words: Sequence[str]) -> float:
    """Return what one unit of the last printed digit is worth; times with an exponent are not rounded."""
    decimals = [len(word.strip().partition(".")[2]) for word in words if "e" not in word.lower()]
    return 10.0 ** -max(decimals) if len(decimals) == len(words) else 0.0


def _is_rounded(times: NDArray[np.float64], rate: float, digit: float) -> bool:
    """Return whether the times are those of a frame rate, but for digits that were left out."""
    off = times - np.arange(len(times)) / rate
    dust = 4 * float(np.spacing(np.abs(times).max()))
    allowed = dust + (digit if digit * rate <= _FINE else 0.0) / 2
    return bool(np.abs(off).max() <= allowed if times[0] == 0 else np.ptp(off) <= 2 * allowed)


def _check_even(times: NDArray[np.float64], lines: Sequence[int]) -> None:
    """Raise an error about the first step that is longer or shorter than the others."""
    steps = np.diff(times)
    usual = float(np.sort(steps)[(len(steps) - 1) // 2])  # the lower median: a missing frame makes a step longer
    if usual <= 0:
        line = lines[1 + int(np.argmin(steps))]
        raise WalkError(f"line {line}: expected times in seconds that rise from frame to frame, got one that does not")
    dust = 4 * np.spacing(np.abs(times).max())
    wrong = np.flatnonzero(np.abs(steps - usual) > _EVEN * usual + dust)
    if len(wrong):
        line, step = lines[wrong[0] + 1], steps[wrong[0]]
        raise WalkError(
            f"line {line}: expected evenly spaced times, {usual:.6g} s apart within 1 %, got a step of {step:.6g} s; "
            "fill in missing frames as gaps, give times more digits, or resample to even times"
        )
