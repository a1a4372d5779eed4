"""Walks in seven styles, from the motion capture of Bandai Namco Research."""

from os import PathLike
from typing import Any

import pandas as pd
from sklearn.utils import Bunch

from eigenwalker.datasets._bundle import bundle
from eigenwalker.datasets._manifest import read_manifest
from eigenwalker.datasets._repository import GITHUB, Repository, fetch_files
from eigenwalker.io import read_walks

__all__ = ["fetch_bandai_walks"]

_REPOSITORY = Repository(
    "BandaiNamcoResearchInc/Bandai-Namco-Research-Motiondataset", "74ead3ba1ae4696404e6086233779f60de8bf9ef"
)

_DESCRIPTION = """\
Walks in seven styles
---------------------
The 175 straight walks of Bandai-Namco-Research-Motiondataset-2: motion capture of professional actors, made into BVH.

:Walks: 175, overground, 30 frames a second, 21 moving joints (JointWalk; metres, x forward, y left, z up)
:Labels: style: active (32), elderly (17), exhausted (23), feminine (27), masculine (25), normal (24), youthful (27)
:Persons: three actors; which of them walks in which file is not published, so there are no groups
:License: CC BY-NC 4.0, not for commercial use
:Source: https://github.com/BandaiNamcoResearchInc/Bandai-Namco-Research-Motiondataset
:Cite: M. Kobayashi, C.-C. Liao, K. Inoue, S. Yojima, M. Takahashi (2023). Motion Capture Dataset for Practical Use of
    AI-based Motion Editing and Stylization. arXiv:2306.08861.

Known faults:

- The walks start and stop and change speed within a clip. With only a straight line taken out, a search for the
  frequency lands on half the stride frequency in most of them.
- All bodies were brought to the same segment lengths. What differs is the place of the hips in the pelvis, which has
  three values: one for active, elderly and exhausted, one for feminine and youthful, one for masculine and normal.
  Style and source are thus confounded: the structure alone tells groups of styles apart. The styles are acted. The
  data test methods; they say little about people.
- ``joint_Root`` stands still at the origin while ``Hips`` moves; every joint has position channels.
"""


def fetch_bandai_walks(
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
    """Return 175 walks in seven acted styles, downloaded at the first call (58 MB).

    Parameters
    ----------
    data_home : str or path, default None
        The folder to keep the files in, below ``bandai_walks``. None is that of `get_data_home`.
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

        - data : list of JointWalk, as recorded: not prepared. Named after their files.
        - target : Series of str, or array of shape (175,): the style.
        - target_names : ["style"].
        - groups : None. The actors are not identified.
        - frame : DataFrame with the style and the filename of each walk, indexed by its name; None without `as_frame`.
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
    >>> from eigenwalker.datasets import fetch_bandai_walks
    >>> walks = fetch_bandai_walks(progress=True)  # doctest: +SKIP
    >>> walks.target.value_counts()["active"]  # doctest: +SKIP
    32
    """
    paths = fetch_files(
        _REPOSITORY,
        read_manifest("bandai_walks"),
        "bandai_walks",
        data_home=data_home,
        download_if_missing=download_if_missing,
        n_retries=n_retries,
        delay=delay,
        base_url=base_url,
        progress=progress,
    )
    walks = read_walks(paths, unit="cm", n_jobs=n_jobs, progress=progress)
    target = pd.DataFrame({"style": [walk.name.split("_")[2] for walk in walks]})  # dataset-2_walk_active_001
    return bundle(walks, target, paths, _DESCRIPTION, groups=None, as_frame=as_frame, return_X_y=return_X_y)
