"""The folder that keeps what the fetchers have fetched."""

import os
import shutil
from pathlib import Path

__all__ = ["DATA_SETS", "clear_data_home", "get_data_home"]

DATA_SETS = ("bandai_walks", "cmu_walks", "kinect_gait")
"""The folder of each data set in the data home."""


def get_data_home(data_home: str | os.PathLike[str] | None = None) -> Path:
    """Return the folder that fetched data sets are kept in, and make it if it is not there.

    Parameters
    ----------
    data_home : str or path, default None
        The folder; ``~`` is the user's home. None is the one named by the environment variable ``EIGENWALKER_DATA``,
        or ``~/eigenwalker_data`` where it is not set.

    Returns
    -------
    Path
        The folder, which exists.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from eigenwalker.datasets import get_data_home
    >>> with TemporaryDirectory() as folder:
    ...     get_data_home(folder).is_dir()
    True
    """
    folder = _expand(data_home)
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def clear_data_home(data_home: str | os.PathLike[str] | None = None) -> None:
    """Delete all data sets in the data home, and the folder itself if nothing else is in it.

    Parameters
    ----------
    data_home : str or path, default None
        The folder, as in `get_data_home`.

    Examples
    --------
    >>> from eigenwalker.datasets import clear_data_home
    >>> clear_data_home()  # doctest: +SKIP
    """
    folder = _expand(data_home)
    for name in DATA_SETS:
        if (folder / name).is_dir():
            shutil.rmtree(folder / name)
    if folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()


def _expand(data_home: str | os.PathLike[str] | None) -> Path:
    # A variable that is set to nothing is not set: the working directory is no home.
    chosen = data_home if data_home is not None else os.environ.get("EIGENWALKER_DATA") or "~/eigenwalker_data"
    return Path(chosen).expanduser()
