"""Studies for JATOS, the server of online studies, as archives that it imports."""

from __future__ import annotations

import json
import os
import re
import uuid
import zipfile
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Any

from eigenwalker._whole_files import whole_file

__all__ = ["write_jzip"]

_STUDY = re.compile(r"[0-9a-f]{12}")
_PAGE = "index.html"
_LONGEST = 255  # letters of a title
_MARKUP = str.maketrans({"<": "‹", ">": "›", "&": "+"})  # JATOS takes no title with what could be HTML
_FIRST_DAY = (1980, 1, 1, 0, 0, 0)  # that an archive can have: it is the same whenever it is written


def write_jzip(
    path: str | os.PathLike[str],
    page_html: str,
    *,
    title: str,
    study_id: str,
    assets: Mapping[str, bytes | str | os.PathLike[str]] | None = None,
    description: str = "",
) -> Path:
    """Write the archive of a study that JATOS imports, as a whole or not at all.

    It is what JATOS itself exports (its handbook, "JATOS Study Archive (JZIP)"): a ZIP file with one folder, the
    assets, and one file beside it that ends in ``.jas``, a JSON object with

    - ``version``: "3", of this form of study;
    - ``data``: the study: its ``uuid``, by which an import finds the study that it replaces; ``title`` and
      ``description``; ``dirName``, the folder of the assets; ``groupStudy``, ``linearStudy`` and ``allowPreview``,
      which it is not; ``comments``; ``jsonData``, ``endRedirectUrl`` and ``studyEntryMsg``, which are empty;
      ``componentList`` and ``batchList``;
    - its only component: ``uuid``, ``title``, ``htmlFilePath`` (``index.html`` in the folder), ``reloadable``, so that
      the page may be opened again, ``active``, ``comments``, ``jsonData``;
    - its only batch: ``uuid``, ``title``, ``active``, no maximum of workers, the ``allowedWorkerTypes`` Jatos,
      PersonalSingle and PersonalMultiple, as of a new study, ``comments``, ``jsonData``.

    Parameters
    ----------
    path : str or path
        Where to, ``study.jzip`` for instance.
    page_html : str
        The page. JATOS gives it ``jatos.js``, which it must load.
    title : str
        What the study is called in JATOS, which allows no markup there: < and > become ‹ and ›, & becomes +.
    study_id : str
        Twelve hexadecimal digits, from which the identifiers are made: the same study is always the same to JATOS.
    assets : mapping of str to bytes or path, default none
        Other files of the page, by where they lie beside it, ``stimuli/sad1.mp4``.
    description : str, default ""
        What is said of the study in JATOS, without markup as well.

    Returns
    -------
    Path
        Of the archive. The same study makes the same bytes, of one version of zlib.

    Raises
    ------
    ValueError
        If title, identifier or names of assets are not as they should be.
    OSError
        If a file cannot be read or written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from eigenwalker.experiment.running.jatos import write_jzip
    >>> with TemporaryDirectory() as folder:
    ...     archive = write_jzip(Path(folder, "a.jzip"), "<!doctype html>", title="Moods", study_id="ab12cd34ef56")
    ...     zipfile.ZipFile(archive).namelist()
    ['study_ab12cd34ef56.jas', 'study_ab12cd34ef56/', 'study_ab12cd34ef56/index.html']
    """
    if not _STUDY.fullmatch(study_id):
        raise ValueError(f"study_id must be 12 hexadecimal digits, got {study_id!r}")
    if not title.strip():
        raise ValueError("title must be a word or more, which JATOS asks for, got none")
    files = dict(sorted((assets or {}).items()))
    _check_assets(files)
    name, target = f"study_{study_id}", Path(path)
    said = json.dumps(_study(study_id, name, title, description), indent=1, ensure_ascii=False)
    with whole_file(target) as part, zipfile.ZipFile(part, "x") as archive:
        archive.writestr(_entry(f"{name}.jas"), said)
        for folder in _folders(files):
            archive.writestr(_entry(f"{name}/{folder}"), b"")
        archive.writestr(_entry(f"{name}/{_PAGE}"), page_html)
        for file, contents in files.items():
            data = contents if isinstance(contents, bytes) else Path(contents).read_bytes()
            archive.writestr(_entry(f"{name}/{file}"), data)
    return target


def _check_assets(files: Mapping[str, object]) -> None:
    """Raise unless names are those of files in the folder, which differ on every system."""
    wrong = [
        name
        for name in files
        if not name
        or PurePosixPath(name).as_posix() != name
        or ".." in name.split("/")
        or re.search(r'[\0-\x1f\\:*?"<>|]|^/|\.$', name)
    ]
    if wrong:
        raise ValueError(f"assets must be named by plain paths in the folder, stimuli/sad1.mp4, got {wrong[0]!r}")
    names = [name.lower() for name in (*files, _PAGE)]
    if len(set(names)) < len(names):
        raise ValueError(f"assets must differ in their names from each other and from {_PAGE}, in small letters too")


def _folders(files: Mapping[str, object]) -> list[str]:
    """Return the folders that files lie in, the outer before the inner, "" among them, with a slash behind each."""
    parents = {parent for name in files for parent in PurePosixPath(name).parents}
    return sorted({"" if parent == PurePosixPath(".") else f"{parent}/" for parent in parents} | {""})


def _entry(name: str) -> zipfile.ZipInfo:
    """Return an entry that says nothing of this machine or hour."""
    entry = zipfile.ZipInfo(name, _FIRST_DAY)
    is_folder = name.endswith("/")
    entry.create_system = 3
    entry.external_attr = (0o40755 << 16 | 0x10) if is_folder else 0o100644 << 16
    entry.compress_type = zipfile.ZIP_STORED if is_folder or name.endswith(".mp4") else zipfile.ZIP_DEFLATED
    return entry


def _study(study_id: str, name: str, title: str, description: str) -> dict[str, Any]:
    """Return what JATOS is told of a study."""
    called = _plain(title)[:_LONGEST]
    component = {
        "uuid": _identifier(study_id, "component"),
        "title": called,
        "htmlFilePath": _PAGE,
        "reloadable": True,
        "active": True,
        "comments": "",
        "jsonData": None,
    }
    batch = {
        "uuid": _identifier(study_id, "batch"),
        "title": "Default",
        "active": True,
        "maxActiveMembers": None,
        "maxTotalMembers": None,
        "maxTotalWorkers": None,
        "allowedWorkerTypes": ["Jatos", "PersonalMultiple", "PersonalSingle"],
        "comments": None,
        "jsonData": None,
    }
    study = {
        "uuid": _identifier(study_id, "study"),
        "title": called,
        "description": _plain(description),
        "groupStudy": False,
        "linearStudy": False,
        "allowPreview": False,
        "dirName": name,
        "comments": f"study {study_id}",
        "jsonData": None,
        "endRedirectUrl": "",
        "studyEntryMsg": None,
        "componentList": [component],
        "batchList": [batch],
    }
    return {"version": "3", "data": study}


def _plain(text: str) -> str:
    """Return words in one line, without what could be markup."""
    return " ".join("".join(letter if letter.isprintable() else " " for letter in text).split()).translate(_MARKUP)


def _identifier(study_id: str, part: str) -> str:
    return str(uuid.uuid5(uuid.NAMESPACE_OID, f"eigenwalker {study_id} {part}"))
