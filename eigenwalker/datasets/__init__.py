"""Walks to learn from."""

from eigenwalker.datasets.walkers import make_walkers

__all__ = ["make_walkers"]
