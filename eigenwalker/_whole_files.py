"""Files that are there as a whole or not at all."""

import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from shutil import copymode

__all__ = ["whole_file", "write_whole"]


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give the path of a file to write, which becomes `path` at the end, and is gone if an error comes first.

    A file that was there before stays until then, and hands on who may read and write it.
    """
    part = path.with_name(f"file.{uuid.uuid4().hex}.part")
    try:
        yield part
        if path.exists():
            copymode(path, part)
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def write_whole(path: Path, data: bytes) -> None:
    """Write a file, or leave what was there before as it is."""
    with whole_file(path) as part, part.open("xb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
