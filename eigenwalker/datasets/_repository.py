"""All files of a data set, from a public repository at one commit."""

import threading
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from os import PathLike
from pathlib import Path
from urllib.parse import quote

from joblib import parallel_config

from eigenwalker._collect import Refusal, collect
from eigenwalker.datasets._download import NOT_TRIED, download_file
from eigenwalker.datasets._manifest import RemoteFile, find_fault
from eigenwalker.datasets.home import get_data_home

__all__ = ["GITHUB", "Repository", "fetch_files"]

GITHUB = "https://raw.githubusercontent.com"
"""The server of the raw files of GitHub's repositories, as ``/owner/repository/commit/path``."""

_N_CONNECTIONS = 4  # at once: the files are small, so that waiting is most of the time


@dataclass(frozen=True)
class Repository:
    """Where a data set comes from: ``owner/repository`` on GitHub, and the commit."""

    title: str
    commit: str

    def url(self, base_url: str, path: str) -> str:
        """Return the address of one file."""
        return f"{base_url.rstrip('/')}/{self.title}/{self.commit}/{quote(path)}"


def fetch_files(
    repository: Repository,
    files: Sequence[RemoteFile],
    name: str,
    *,
    data_home: str | PathLike[str] | None,
    download_if_missing: bool,
    n_retries: int,
    delay: float,
    base_url: str,
    progress: bool,
) -> list[Path]:
    """Return the paths of the files of a data set, in their order, after those that are not there were fetched.

    Parameters
    ----------
    repository, files, name : Repository, sequence of RemoteFile, str
        Where from, what, and the folder in the data home.
    data_home, download_if_missing, n_retries, delay, base_url, progress
        As in the public fetchers.

    Raises
    ------
    OSError
        If files cannot be had, with the reason for each. What was fetched before and beside them stays.
    """
    _check(n_retries, delay)
    folder = get_data_home(data_home) / name
    paths = [folder / file.path for file in files]
    faults = [find_fault(file, path) for file, path in zip(files, paths, strict=True)]
    wanted = [(file, path) for file, path, fault in zip(files, paths, faults, strict=True) if fault is not None]
    if wanted and not download_if_missing:
        _raise_incomplete(files, faults, folder)
    _warn_of_changes(files, faults, folder)
    unreachable = threading.Event()
    with parallel_config(backend="threading"):
        _, refusals = collect(
            partial(_download, repository, base_url, n_retries=n_retries, delay=delay, unreachable=unreachable),
            wanted,
            [file.path for file, _ in wanted],
            n_jobs=_N_CONNECTIONS,
            progress=progress,
            description="downloading",
        )
    if refusals:
        _raise_failed(refusals, len(files), folder)
    return paths


def _download(
    repository: Repository,
    base_url: str,
    wanted: tuple[RemoteFile, Path],
    *,
    n_retries: int,
    delay: float,
    unreachable: threading.Event,
) -> None:
    file, path = wanted
    url = repository.url(base_url, file.path)
    download_file(url, path, file, n_retries=n_retries, delay=delay, unreachable=unreachable)


def _check(n_retries: int, delay: float) -> None:
    faults = []
    if n_retries < 0:
        faults.append(f"n_retries must be zero or more, got {n_retries}")
    if not delay >= 0:
        faults.append(f"delay must be a number of seconds, zero or more, got {delay}")
    if faults:
        raise ValueError("; ".join(faults))


def _listed(files: Sequence[RemoteFile], faults: Sequence[str | None]) -> str:
    return "".join(f"\n  {file.path}: {fault}" for file, fault in zip(files, faults, strict=True) if fault is not None)


def _raise_incomplete(files: Sequence[RemoteFile], faults: Sequence[str | None], folder: Path) -> None:
    n_wrong = sum(fault is not None for fault in faults)
    raise OSError(
        f"{n_wrong} of {len(files)} files in {folder} are missing or not as published; fetch them with "
        f"download_if_missing=True, or name the folder that has them with data_home=:{_listed(files, faults)}"
    )


def _warn_of_changes(files: Sequence[RemoteFile], faults: Sequence[str | None], folder: Path) -> None:
    changed = [None if fault == "missing" else fault for fault in faults]
    if any(changed):
        warnings.warn(
            f"files in {folder} are not as published and are fetched again:{_listed(files, changed)}",
            UserWarning,
            stacklevel=4,
        )


def _raise_failed(refusals: Sequence[Refusal], n_files: int, folder: Path) -> None:
    failed = [refusal for refusal in refusals if refusal.reason != NOT_TRIED]
    listed = "".join(f"\n  {refusal.name}: {refusal.reason}" for refusal in failed)
    n_untried = len(refusals) - len(failed)
    more = f"\n  and {n_untried} more: {NOT_TRIED}" if n_untried else ""
    raise OSError(
        f"{len(refusals)} of {n_files} files could not be fetched into {folder}:{listed}{more}\n"
        "The others are kept. Call again to fetch what is left; where the server is out of reach, name a mirror with "
        "base_url=, or put the files into that folder yourself, under their paths in the repository."
    )
