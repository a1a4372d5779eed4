"""MP4 files by ffmpeg: pictures go in through a pipe."""

import shutil
import subprocess
from collections.abc import Iterable
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from tempfile import TemporaryFile

import numpy as np
from numpy.typing import NDArray

__all__ = ["LUMA", "encode_mp4", "find_ffmpeg"]

LUMA = (16, 235)
"""Values of black and of white in a movie."""

# The fastest preset makes larger files than others and, with so fine a quantizer, the truest dots: no edge is smoothed.
# One thread makes one file, whatever the number of cores, and the drawing has the other core.
_QUALITY = ("-c:v", "libx264", "-preset", "ultrafast", "-qp", "8", "-threads", "1")
# What players and browsers show: 4:2:0, the range said aloud, the index in front. Grays need no word on colors.
_SHOWN = ("-pix_fmt", "yuv420p", "-color_range", "tv", "-movflags", "+faststart")


def find_ffmpeg() -> str:
    """Return the path of imageio-ffmpeg's ffmpeg, or that of the system's.

    Raises
    ------
    ImportError
        If there is neither.
    """
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        return str(get_ffmpeg_exe())
    except (ImportError, RuntimeError):  # the second, where the package came without its program
        found = shutil.which("ffmpeg")
    if found is None:
        raise ImportError(
            "MP4 movies need ffmpeg: pip install 'eigenwalker[movie]', or install the system's ffmpeg so that it is "
            "on the PATH; GIF movies do without"
        )
    return found


def encode_mp4(pictures: Iterable[NDArray[np.uint8]], path: Path, *, rate: Fraction, size: tuple[int, int]) -> None:
    """Write gray pictures as an H.264 movie.

    Parameters
    ----------
    pictures : iterable of ndarray of shape (height, width)
        Contiguous, with black and white as in `LUMA`: ffmpeg then has nothing to convert, which saves a quarter.
    path : Path
        Where to.
    rate : Fraction
        Pictures per second.
    size : (int, int)
        Width and height in pixels, both even.

    Raises
    ------
    ImportError, OSError
        If there is no ffmpeg; if it fails, with its words.
    """
    source = ["-f", "rawvideo", "-pix_fmt", "yuv420p", "-s", "{}x{}".format(*size), "-r", str(rate), "-i", "-"]
    command = [find_ffmpeg(), "-v", "error", "-y", *source, *_QUALITY, *_SHOWN, "-f", "mp4", str(path)]
    with TemporaryFile() as words:  # a pipe for them could fill, and stop it
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=words)
        try:
            _feed(process, pictures, bytes([128]) * (size[0] * size[1] // 2))
        except BaseException:
            process.kill()
            process.wait()
            raise
        if process.wait():
            words.seek(0)
            said = " ".join(words.read().decode(errors="replace").split())[-500:]
            raise OSError(f"ffmpeg could not write {path}: {said or f'exit status {process.returncode}'}")


def _feed(process: subprocess.Popen[bytes], pictures: Iterable[NDArray[np.uint8]], no_color: bytes) -> None:
    assert process.stdin is not None  # it was asked for
    try:
        for picture in pictures:  # whose own errors are not ffmpeg's
            try:
                process.stdin.write(picture.data)
                process.stdin.write(no_color)
            except OSError:  # ffmpeg gave up, and says why
                return
    finally:
        with suppress(OSError):
            process.stdin.close()
