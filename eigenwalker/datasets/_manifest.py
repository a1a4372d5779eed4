"""Which files a data set has, and whether a file on disk is one of them."""

import csv
import hashlib
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

__all__ = ["RemoteFile", "find_fault", "read_manifest"]


@dataclass(frozen=True)
class RemoteFile:
    """A file of a public repository, and what is known of its content.

    Parameters
    ----------
    path : str
        Where it is in the repository, with ``/`` between folders.
    size : int or None
        Its number of bytes.
    sha256 : str or None
        Its checksum, 64 hexadecimal digits.
    start : bytes, default b""
        What its content starts with: the only check there is where size and checksum are not known. It tells a
        recording from the page of an error.
    """

    path: str
    size: int | None
    sha256: str | None
    start: bytes = b""


def read_manifest(name: str) -> list[RemoteFile]:
    """Return the files of one data set, from the table that comes with the package.

    Examples
    --------
    >>> len(read_manifest("cmu_walks"))
    27
    """
    text = files("eigenwalker.datasets").joinpath("_manifests", f"{name}.csv").read_text(encoding="utf-8")
    return [
        RemoteFile(row["path"], int(row["size"]) if row["size"] else None, row["sha256"] or None)
        for row in csv.DictReader(text.splitlines())
    ]


def find_fault(file: RemoteFile, path: Path) -> str | None:
    """Return what is wrong with the file at `path`, or None if it is there and as it should be."""
    if not path.is_file():
        return "missing"
    size = path.stat().st_size
    if file.size is not None and size != file.size:
        return f"expected {file.size} bytes, got {size}"
    with path.open("rb") as content:
        start = content.read(len(file.start))
        if start != file.start:
            return f"expected content that starts with {file.start.decode()!r}, got {start.decode(errors='replace')!r}"
        content.seek(0)
        if file.sha256 is not None:
            found = hashlib.file_digest(content, "sha256").hexdigest()
            if found != file.sha256:
                return f"expected the sha256 checksum {file.sha256}, got {found}"
    return None
