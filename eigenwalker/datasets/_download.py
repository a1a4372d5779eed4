"""One file from a server onto the disk: continued, verified, and there as a whole or not at all."""

import os
import threading
import time
import uuid
from glob import escape
from http.client import HTTPException
from pathlib import Path
from urllib.error import HTTPError, URLError
from urllib.request import Request, urlopen

from eigenwalker.datasets._manifest import RemoteFile, find_fault

__all__ = ["NOT_TRIED", "download_file"]

NOT_TRIED = "not tried, because the server was out of reach for another file"
"""The reason of an error about a file that was not asked for."""

_TIMEOUT = 30.0  # seconds without a sign of the server
_BLOCK = 1 << 16  # bytes
_ABANDONED = 600.0  # seconds after which nobody writes into a part any more: far longer than a time-out
_PASSING = (408, 425, 429, 500, 502, 503, 504)  # answers that may be others a moment later


def download_file(
    url: str, path: Path, file: RemoteFile, *, n_retries: int, delay: float, unreachable: threading.Event
) -> None:
    """Bring one file from `url` to `path`, which holds all of it when this returns and is untouched when it raises.

    What arrives goes into a part beside `path` that no other call writes into; it is verified and then renamed. What
    is left of a broken download is continued by the next call if the checksum can tell that the pieces fit.

    Parameters
    ----------
    url, path : str, Path
        From where and to where.
    file : RemoteFile
        What it should be.
    n_retries, delay : int, float
        How often to try again after a passing fault, and how many seconds to wait before that.
    unreachable : threading.Event
        Shared by all files of one server: set when the server is out of reach, and heeded.

    Raises
    ------
    OSError
        If the file cannot be had, or is not what it should be; with the reason `NOT_TRIED` if `unreachable` was set.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    part = _claim_part(path)
    try:
        _fill(part, url, file, n_retries, delay, unreachable)
        os.replace(part, path)
    finally:
        if part.exists():
            _leave_part(part, path, file)


class _PassingError(OSError):
    """A fault that may be gone a moment later."""


class _OutOfReachError(_PassingError):
    """A passing fault that other files of the server will have too."""


class _MisfitError(OSError):
    """What arrived is not what it should be."""


def _fill(part: Path, url: str, file: RemoteFile, n_retries: int, delay: float, unreachable: threading.Event) -> None:
    """Receive and verify, again after passing faults."""
    while not unreachable.is_set():
        _drop_useless(part, file)
        continued = _size(part) > 0
        try:
            _receive_and_verify(part, url, file)
            return
        except _MisfitError:
            if not continued:
                raise  # else the pieces did not fit: once more, as a whole
        except _PassingError as error:
            if n_retries == 0:
                if isinstance(error, _OutOfReachError):
                    unreachable.set()
                raise
            n_retries -= 1
            time.sleep(delay)
    raise OSError(NOT_TRIED)


def _receive_and_verify(part: Path, url: str, file: RemoteFile) -> None:
    """Make the part whole, or raise; a part that is as long as it should be and wrong is deleted."""
    if find_fault(file, part) is None:  # all of it was there already
        return
    try:
        _receive(part, url)
    except HTTPError as error:
        error.close()
        if error.code == 416:  # the server's file ends before the part does
            part.unlink(missing_ok=True)
        message = f"HTTP {error.code} {error.reason} from {url}"
        kind = _OutOfReachError if error.code == 429 else _PassingError if error.code in _PASSING else OSError
        raise kind(message) from None
    except (URLError, HTTPException, ConnectionError, TimeoutError) as error:
        kind = _OutOfReachError if isinstance(error, URLError) else _PassingError
        raise kind(f"{getattr(error, 'reason', error) or type(error).__name__} from {url}") from None
    fault = find_fault(file, part)
    if fault is not None:
        part.unlink()
        raise _MisfitError(f"{fault} from {url}")


def _receive(part: Path, url: str) -> None:
    """Append to the part what is missing of it, or write it anew where the server delivers wholes only."""
    have = _size(part)
    request = Request(url, headers={"Range": f"bytes={have}-"} if have else {})
    with urlopen(request, timeout=_TIMEOUT) as response:
        continues = response.headers.get("Content-Range", "").startswith(f"bytes {have}-")
        expected = response.headers.get("Content-Length")
        received = 0
        with part.open("ab" if have and continues else "wb") as content:
            while block := response.read(_BLOCK):
                received += content.write(block)
    if expected is not None and received != int(expected):
        raise ConnectionError(f"the delivery ended after {received} of {expected} bytes")


def _size(part: Path) -> int:
    return part.stat().st_size if part.exists() else 0


def _drop_useless(part: Path, file: RemoteFile) -> None:
    """Delete a part that cannot be continued: too long, or without a checksum that tells whether the pieces fit."""
    if file.sha256 is None or file.size is None or _size(part) > file.size:
        part.unlink(missing_ok=True)


def _claim_part(path: Path) -> Path:
    """Return the path of a part of this call's own, which holds what a broken call left, if there is any.

    Renaming is atomic: of two calls that claim the same part, one gets it and the other starts anew.
    """
    own = path.with_name(f"{path.name}.{uuid.uuid4().hex}.part")
    for left in path.parent.glob(f"{escape(path.name)}.*part"):
        try:
            if left == _resting(path) or time.time() - left.stat().st_mtime > _ABANDONED:
                os.utime(left)  # no longer abandoned, before it has its new name
                os.replace(left, own)
                break
        except OSError:  # another call was faster
            continue
    return own


def _leave_part(part: Path, path: Path, file: RemoteFile) -> None:
    """Leave a part to the next call, if it can be continued."""
    _drop_useless(part, file)
    if part.exists():
        os.replace(part, _resting(path))


def _resting(path: Path) -> Path:
    return path.with_name(f"{path.name}.part")
