"""Numbers on the command line: those that cannot be are refused before anything is read."""

import argparse
import math

__all__ = ["count", "finite", "not_negative", "positive"]


def positive(text: str) -> float:
    """Return a number above zero, and not infinite."""
    number = _number(text)
    if not 0 < number < math.inf:
        raise argparse.ArgumentTypeError(f"expected a number above zero, got {text!r}")
    return number


def not_negative(text: str) -> float:
    """Return a number of zero or more; inf is one."""
    number = _number(text)
    if not number >= 0:
        raise argparse.ArgumentTypeError(f"expected zero or more, got {text!r}")
    return number


def finite(text: str) -> float:
    """Return any number but inf and nan."""
    number = _number(text)
    if not math.isfinite(number):
        raise argparse.ArgumentTypeError(f"expected a number, got {text!r}")
    return number


def count(text: str, *, least: int = 1) -> int:
    """Return a whole number, `least` or more, which is not negative."""
    if not (text.isdecimal() and int(text) >= least):
        raise argparse.ArgumentTypeError(f"expected a whole number, {least} or more, got {text!r}")
    return int(text)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan
