"""Alphas on the command line: TRAIT=VALUE."""

import argparse
from collections.abc import Sequence

__all__ = ["add_alpha_argument", "parse_alphas"]


def add_alpha_argument(parser: argparse.ArgumentParser, *, help: str) -> None:
    """Add --alpha, which may be repeated."""
    parser.add_argument("--alpha", required=True, action="append", metavar="TRAIT=VALUE", help=help)


def parse_alphas(texts: Sequence[str]) -> dict[str, float]:
    """Return trait and value of each text, or raise an error that shows the first one that is wrong."""
    return dict(_parse(text) for text in texts)


def _parse(text: str) -> tuple[str, float]:
    trait, equals, value = text.rpartition("=")
    try:
        if equals and trait:
            return trait, float(value)
    except ValueError:
        pass
    raise ValueError(f"--alpha must be TRAIT=NUMBER, such as gender=2, got {text!r}")
