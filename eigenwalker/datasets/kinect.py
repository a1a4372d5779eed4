"""Walks of 164 people before a Kinect, with sex, height, weight and age."""

from collections.abc import Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from sklearn.utils import Bunch

from eigenwalker._collect import collect, report_refusals
from eigenwalker._validation import WalkError, check_choice
from eigenwalker.datasets._bundle import bundle
from eigenwalker.datasets._manifest import RemoteFile, read_manifest
from eigenwalker.datasets._repository import GITHUB, Repository, fetch_files
from eigenwalker.io import read_kinect
from eigenwalker.motion import Walk

__all__ = ["fetch_kinect_gait"]

_REPOSITORY = Repository("Vortander/KinectGait", "b1d8e048973c283808f8625169c3fd7e757adff5")
_HEADER = b"Individual,Height,Weight (Kg),Age,Gender,"
_FIRST_JOINT = b"Head;"

_DESCRIPTION = """\
Walks before a Kinect
---------------------
Recordings of 164 people who walk over a semicircle around a turning depth camera, which follows them, by Andersson and
Araujo.

:Walks: 821, three to six a person, about 30 frames a second (not stated), 20 joints (Walk; metres, z up; x points away
    from the camera, not to where the walker goes, until the walk is prepared)
:Labels: of the person: sex ("F", "M"), height_m, weight_kg and age (NaN for about a third of them), with_backpack,
    high_heels
:License: none stated; the authors ask to be cited, with a link to the repository
:Source: https://github.com/Vortander/KinectGait
:Cite: V. O. Andersson, R. M. Araujo (2015). Person Identification Using Anthropometric and Gait Data from Kinect
    Sensor. Proceedings of the 29th AAAI Conference, 425-431.

Known faults:

- Each file holds two passes, to the left and then to the right: split it at the change of facing and bring both to one
  heading.
- The joints are estimates from depth images: the length of the thigh varies by 8 % within a walk, and some joints flip
  or jump for frames. The period is short of the frames' rate: 0.76 to 0.97 strides a second.
- Persons have several walks: let every split and every resampling take `groups`.
- Backpack and high heels are marked for few persons; for the others nothing says that they had none.
"""


def fetch_kinect_gait(
    *,
    subset: str = "all",
    data_home: str | PathLike[str] | None = None,
    download_if_missing: bool = True,
    return_X_y: bool = False,
    as_frame: bool = True,
    on_error: str = "raise",
    n_jobs: int | None = None,
    progress: bool = False,
    n_retries: int = 3,
    delay: float = 1.0,
    base_url: str = GITHUB,
) -> Bunch | tuple[list[Any], Any]:
    """Return walks of 164 people before a Kinect with sex, height, weight and age, downloaded at the first call.

    Parameters
    ----------
    subset : {"all", "checked"}, default "all"
        "all" are the 821 walks of 164 people, 411 MB. "checked" are the 246 walks whose checksums are known,
        124 MB: the first three of each of 82 people, 27 women and 55 men.
    data_home : str or path, default None
        The folder to keep the files in, below ``kinect_gait``. None is that of `get_data_home`.
    download_if_missing : bool, default True
        Whether to fetch files that are not there or not as published. Otherwise they are an error.
    return_X_y : bool, default False
        Whether to return ``(data, target)`` instead of a Bunch.
    as_frame : bool, default True
        Whether the target is a DataFrame, indexed by the names of the walks, or an array.
    on_error : {"raise", "skip"}, default "raise"
        What to do about recordings that are there and cannot be read. "raise" reads them all and raises one error
        about all that were refused; "skip" leaves those out, with one warning.
    n_jobs : int, default None
        Number of processes that read the files, as in joblib: None is one, -1 is all processors.
    progress : bool, default False
        Whether to show bars on stderr for what takes more than two seconds.
    n_retries : int, default 3
        How often to try again to download a file after a passing fault.
    delay : float, default 1.0
        Seconds to wait before that.
    base_url : str, default "https://raw.githubusercontent.com"
        The server, for mirrors: it must have the files at ``owner/repository/commit/path``.

    Returns
    -------
    sklearn.utils.Bunch
        With the attributes

        - data : list of Walk, as recorded: not prepared, in the frame of the camera. Named ``Person001_1``.
        - target : DataFrame with person, sex ("F" or "M"), height_m, weight_kg, age (years), with_backpack and
          high_heels (bool; False is not marked), or array of objects of shape (n_walks, 7). NaN is not known.
        - target_names : list of str, the columns of the target.
        - groups : ndarray of shape (n_walks,), the person in each walk.
        - frame : DataFrame with the target and the filename of each walk, indexed by its name; None without `as_frame`.
        - filenames : list of str.
        - DESCR : str, with citation and known faults.

    (data, target) : tuple
        If `return_X_y`.

    Raises
    ------
    OSError
        If files are missing and cannot be had, with the reason for each.
    WalkError
        If recordings are refused.

    Notes
    -----
    The files are those of one commit of the repository. When they are downloaded and at every later call, the size of
    every recording is checked, and the sha256 checksum of the "checked" ones: files that were damaged or edited are
    fetched again, with a warning. Without a checksum, a change that keeps the size is found only if it makes the
    recording unreadable; delete one that is refused to fetch it again. Of the table of persons neither is known: it is
    taken if it is delivered whole and starts as it should.

    Examples
    --------
    >>> from eigenwalker.datasets import fetch_kinect_gait
    >>> walks = fetch_kinect_gait(subset="checked", progress=True)  # doctest: +SKIP
    >>> walks.data[0].name, walks.target.sex["Person001_1"]  # doctest: +SKIP
    ('Person001_1', 'F')
    """
    check_choice(subset, ("all", "checked"), name="subset")
    check_choice(on_error, ("raise", "skip"), name="on_error")
    table, *recordings = read_manifest("kinect_gait")
    if subset == "checked":
        recordings = [file for file in recordings if file.sha256 is not None]
    persons, *paths = fetch_files(
        _REPOSITORY,
        [replace(table, start=_HEADER), *(replace(file, start=_FIRST_JOINT) for file in recordings)],
        "kinect_gait",
        data_home=data_home,
        download_if_missing=download_if_missing,
        n_retries=n_retries,
        delay=delay,
        base_url=base_url,
        progress=progress,
    )
    walks, paths = _read(paths, recordings, on_error, n_jobs, progress)
    target = _read_persons(persons, [path.parent.name for path in paths])
    groups = target["person"].to_numpy(dtype=np.str_)
    return bundle(walks, target, paths, _DESCRIPTION, groups=groups, as_frame=as_frame, return_X_y=return_X_y)


def _read(
    paths: Sequence[Path], recordings: Sequence[RemoteFile], on_error: str, n_jobs: int | None, progress: bool
) -> tuple[list[Walk], list[Path]]:
    """Return the walks and their files, without those that were refused."""
    names = [file.path for file in recordings]
    found, refusals = collect(_read_one, paths, names, n_jobs=n_jobs, progress=progress, description="reading")
    report_refusals(refusals, len(paths), on_error=on_error, what="recordings")
    kept = [(walk, path) for walk, path in zip(found, paths, strict=True) if walk is not None]
    return [walk for walk, _ in kept], [path for _, path in kept]


def _read_one(path: Path) -> Walk:
    return read_kinect(path, name=f"{path.parent.name}_{path.stem}")


def _read_persons(path: Path, persons: Sequence[str]) -> pd.DataFrame:
    """Return the labels of the person in each walk."""
    table = pd.read_csv(path, dtype=str, keep_default_na=False).apply(lambda column: column.str.strip())
    table = table.set_index("Individual")
    unknown = sorted(set(persons) - set(table.index))
    if unknown:
        raise WalkError(
            f"{path}: expected one row for every person, got none for {', '.join(unknown)}; delete the file"
        )
    rows = table.loc[list(persons)].reset_index(names="person")
    return pd.DataFrame(
        {
            "person": rows["person"],
            "sex": rows["Gender"],
            "height_m": pd.to_numeric(rows["Height"]),
            "weight_kg": pd.to_numeric(rows["Weight (Kg)"]),
            "age": pd.to_numeric(rows["Age"]),
            "with_backpack": rows["BackPack"] == "S",  # sim, yes
            "high_heels": rows["HighHeels"] == "S",
        }
    )
