"""Walks to learn from."""

from eigenwalker.datasets.bandai import fetch_bandai_walks
from eigenwalker.datasets.cmu import fetch_cmu_walks
from eigenwalker.datasets.home import clear_data_home, get_data_home
from eigenwalker.datasets.kinect import fetch_kinect_gait
from eigenwalker.datasets.walkers import make_walkers

__all__ = [
    "clear_data_home",
    "fetch_bandai_walks",
    "fetch_cmu_walks",
    "fetch_kinect_gait",
    "get_data_home",
    "make_walkers",
]
