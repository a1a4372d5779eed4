"""The machine and the versions that a benchmark ran on. Nothing large is imported here."""

import os
import platform
import subprocess
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from threadpoolctl import threadpool_info

__all__ = ["PEERS", "describe_machine", "find_machine", "find_versions"]

_FOUNDATIONS = ("numpy", "scipy", "scikit-learn", "numba", "pandas")
PEERS = (
    "scikit-fda",
    "upc-pymotion",
    "bvh",
    "bvhio",
    "hmmlearn",
    "nnmnkwii",
    "matplotlib",
    "pillow",
    "imageio-ffmpeg",
)
"""Packages beside which this project is measured."""


def find_machine() -> dict[str, str]:
    """Return processor, cores, memory, operating system, Python and the commit of this repository, as texts."""
    return {
        "processor": _processor(),
        "cores": str(os.cpu_count()),
        "memory": _memory(),
        "system": f"{platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "commit": _commit(),
    }


def find_versions(packages: Sequence[str] = (*_FOUNDATIONS, *PEERS)) -> dict[str, str]:
    """Return the versions of packages, "not installed" for those that are not."""
    return {package: _version(package) for package in packages}


def describe_machine(packages: Sequence[str] = _FOUNDATIONS) -> str:
    """Return processor, cores, memory, versions and the threads of the linear algebra, in two lines."""
    machine = find_machine()
    pools = ", ".join(f"{pool['internal_api']} {pool['num_threads']}" for pool in threadpool_info()) or "none"
    versions = ", ".join(f"{package} {found}" for package, found in find_versions(packages).items())
    return (
        f"Machine: {machine['processor']}, {machine['cores']} cores, memory {machine['memory']}; {machine['system']}; "
        f"threads a pool: {pools}\nVersions: Python {machine['python']}, {versions}"
    )


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def _memory() -> str:
    try:
        return f"{os.sysconf('SC_PHYS_PAGES') * os.sysconf('SC_PAGE_SIZE') / 2**30:.0f} GiB"
    except (AttributeError, ValueError, OSError):
        return "unknown"


def _commit() -> str:
    command = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty"]
    try:
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
