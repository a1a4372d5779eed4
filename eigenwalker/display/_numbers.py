"""Numbers that a user gives: the range they must lie in, and the error that says so."""

import math

__all__ = ["check_count", "check_number"]


def check_number(
    value: object,
    name: str,
    *,
    at_least: float = -math.inf,
    above: float = -math.inf,
    at_most: float = math.inf,
    unit: str = "",
) -> float:
    """Return `value` as a finite float within its range, or raise an error that names it."""
    wanted = _say_range(at_least, above, at_most) + (f", in {unit}" if unit else "")
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise TypeError(f"{name} must be a number{wanted}, got {value!r}") from None
    if isinstance(value, (str, bool)):
        raise TypeError(f"{name} must be a number{wanted}, got {value!r}")
    if not (math.isfinite(number) and at_least <= number <= at_most and number > above):
        raise ValueError(f"{name} must be a number{wanted}, got {value!r}")
    return number


def _say_range(at_least: float, above: float, at_most: float) -> str:
    low = f" of at least {at_least:g}" if at_least > -math.inf else f" above {above:g}" if above > -math.inf else ""
    high = f"at most {at_most:g}" if at_most < math.inf else ""
    return f"{low} and {high}" if low and high else f"{low}{' of ' if high else ''}{high}"


def check_count(value: object, name: str, *, at_least: int = 0, at_most: float = math.inf) -> int:
    """Return `value` as an int, or raise; 40.0, as tables with gaps hold it, is a count."""
    number = check_number(value, name, at_least=at_least, at_most=at_most)
    if number != int(number):
        raise ValueError(f"{name} must be a whole number, got {value!r}")
    return int(number)
