"""Which recorded markers make the 15 markers, from a JSON file on the command line."""

import json
from pathlib import Path

from eigenwalker.motion.rig import Rig, as_rig

__all__ = ["read_marker_map"]


def read_marker_map(path: Path) -> Rig:
    """Return the rig in a JSON file.

    Parameters
    ----------
    path : Path
        A dictionary ``{"head": "HEAD", "left_knee": {"LKNE": 0.5, "LKNM": 0.5}, ...}`` with all 15 markers.

    Raises
    ------
    ValueError
        If the file is not JSON, no dictionary, or if its places are missing or wrong; with all that is wrong.
    OSError
        If the file cannot be opened.
    """
    try:
        markers = json.loads(path.read_bytes())
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: expected a JSON file of markers, got other text: {error}") from None
    if not isinstance(markers, dict):
        raise ValueError(
            f"{path}: expected a JSON dictionary such as "
            f'{{"head": "HEAD", "left_knee": {{"LKNE": 0.5, "LKNM": 0.5}}, ...}}, got {type(markers).__name__}'
        )
    try:
        return as_rig(markers)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
