"""Walks from the Carnegie Mellon University motion capture database."""

from os import PathLike
from typing import Any

import numpy as np
import pandas as pd
from sklearn.utils import Bunch

from eigenwalker.datasets._bundle import bundle
from eigenwalker.datasets._manifest import read_manifest
from eigenwalker.datasets._repository import GITHUB, Repository, fetch_files
from eigenwalker.io import read_walks

__all__ = ["fetch_cmu_walks"]

_REPOSITORY = Repository("chrystianosaraujo/motion-viewer", "6d7ca60c300f123528be0fd0939cf7a584a13f65")
_UNIT = 0.0564  # metres; BVH files do not say it. With this one legs are 0.80 to 0.87 m long

_MOTIONS = {
    "07_04": "slow walk",
    "07_05": "slow walk",
    "07_12": "brisk walk",
    "08_04": "slow walk",
    "08_05": "walk/stride",
    "08_07": "walk, exaggerated stride",
    "08_11": "slow walk/stride",
}
"""What the index of the database calls the trials, where it is not "walk"."""

_DESCRIPTION = """\
Walks of the CMU motion capture database
----------------------------------------
27 walks of five subjects of the Carnegie Mellon University motion capture database, in its conversion to BVH.

:Walks: 27, overground, 120 frames a second (JointWalk; metres, x forward, y left, z up)
:Labels: person: the number of the subject, 02 (2 walks), 05 (1), 06 (1), 07 (12), 08 (11); trial; motion: "walk" (20)
    or "slow walk", "brisk walk" and so on, as the index of the database has it
:License: free for all uses; the data may not be resold directly, even in converted form
:Source: http://mocap.cs.cmu.edu, and the files of https://github.com/chrystianosaraujo/motion-viewer
:Cite: The data used in this project was obtained from mocap.cs.cmu.edu. The database was created with funding from
    NSF EIA-0196217.

Known faults:

- The files do not say their unit. It is taken to be 0.0564 m, which gives legs of plausible length.
- Each file holds two to four strides only. In 06_01 and 07_07 a search for the frequency peaks at half of it.
- 07_12 starts with two frames of zeros.
- The database says that one person may appear under more than one subject number.
"""


def fetch_cmu_walks(
    *,
    data_home: str | PathLike[str] | None = None,
    download_if_missing: bool = True,
    return_X_y: bool = False,
    as_frame: bool = True,
    n_jobs: int | None = None,
    progress: bool = False,
    n_retries: int = 3,
    delay: float = 1.0,
    base_url: str = GITHUB,
) -> Bunch | tuple[list[Any], Any]:
    """Return 27 walks of five people at several speeds, downloaded at the first call (7 MB).

    Parameters
    ----------
    data_home : str or path, default None
        The folder to keep the files in, below ``cmu_walks``. None is that of `get_data_home`.
    download_if_missing : bool, default True
        Whether to fetch files that are not there or not as published. Otherwise they are an error.
    return_X_y : bool, default False
        Whether to return ``(data, target)`` instead of a Bunch.
    as_frame : bool, default True
        Whether the target is of pandas, indexed by the names of the walks, or an array.
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

        - data : list of JointWalk, as recorded: not prepared. Named ``07_01``, subject and trial.
        - target : DataFrame with person, trial and motion, all of them str; or array of shape (27, 3).
        - target_names : ["person", "trial", "motion"].
        - groups : ndarray of shape (27,), the person in each walk.
        - frame : DataFrame with the target and the filename of each walk, indexed by its name; None without `as_frame`.
        - filenames : list of str.
        - DESCR : str, with license, citation and known faults.

    (data, target) : tuple
        If `return_X_y`.

    Raises
    ------
    OSError
        If files are missing and cannot be had, with the reason for each.

    Notes
    -----
    The files are those of one commit of the repository. Size and sha256 checksum of each are checked when it is
    downloaded and at every later call: files that were damaged or edited are fetched again, with a warning.

    Examples
    --------
    >>> from eigenwalker.datasets import fetch_cmu_walks
    >>> walks = fetch_cmu_walks()  # doctest: +SKIP
    >>> walks.target.motion["07_12"]  # doctest: +SKIP
    'brisk walk'
    """
    paths = fetch_files(
        _REPOSITORY,
        read_manifest("cmu_walks"),
        "cmu_walks",
        data_home=data_home,
        download_if_missing=download_if_missing,
        n_retries=n_retries,
        delay=delay,
        base_url=base_url,
        progress=progress,
    )
    walks = read_walks(paths, unit=_UNIT, n_jobs=n_jobs, progress=progress)
    target = pd.DataFrame([walk.name.split("_") for walk in walks], columns=["person", "trial"])
    target["motion"] = [_MOTIONS.get(walk.name, "walk") for walk in walks]
    groups = target["person"].to_numpy(dtype=np.str_)
    return bundle(walks, target, paths, _DESCRIPTION, groups=groups, as_frame=as_frame, return_X_y=return_X_y)
