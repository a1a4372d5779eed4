"""Where recorded walks are. Nothing large is imported here."""

import os
from pathlib import Path

from benchmarks._findings import Check

__all__ = ["find_recordings", "not_there"]


def find_recordings(source: str = "") -> Path:
    """Return the folder of recorded walks, or that of one source in it, which may not be there.

    It is where EIGENWALKER_TEST_DATA says, else ``../shared/data`` beside this repository.
    """
    default = Path(__file__).resolve().parents[2] / "shared" / "data"
    return Path(os.environ.get("EIGENWALKER_TEST_DATA", default)) / source


def not_there(folder: Path) -> list[Check]:
    """Return what a benchmark finds where its recordings are not there."""
    print(f"no recordings in {folder}: nothing to do")
    return [Check(f"recordings in {folder.name}", "not there; set EIGENWALKER_TEST_DATA", None)]
