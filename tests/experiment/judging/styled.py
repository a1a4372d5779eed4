"""Walks of two styles: knees bent by a little more in one of them."""

from eigenwalker.motion import prepare
from tests.hsmm.walking import shaken_walks

__all__ = ["styled_walks"]


def styled_walks(n_walks, *, first=0, bends=(0.0, 0.25), **options):
    """Return prepared walks and their styles, so many of each."""
    walks = [
        prepare(walk, representation="joints", joints=walk.channel_joints)
        for number, bend in enumerate(bends)
        for walk in shaken_walks(n_walks, first=first + 100 * number, bend=bend, n_frames=360, **options)
    ]
    return walks, [name for name in ("straight", "bent")[: len(bends)] for _ in range(n_walks)]
