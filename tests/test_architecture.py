"""The order of the house: imports point one way, importing is cheap and clean, files stay small."""

import ast
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "eigenwalker"

# What each part may import of the others. Parts below a part of the same line do not know each other.
ALLOWED = {
    "_validation": set(),
    "_collect": {"_validation"},
    "_whole_files": set(),
    "motion": {"_validation", "_collect"},
    "io": {"_validation", "_collect", "motion"},
    "datasets": {"_validation", "_collect", "motion", "io"},
    "model": {"_validation", "_collect", "motion"},
    "hsmm": {"_validation", "_collect", "motion"},
    "persistence": {"_validation", "_collect", "_whole_files", "motion", "io", "datasets", "model", "hsmm"},
    "batch": {"_validation", "_collect", "motion", "io", "datasets", "model", "hsmm", "persistence"},
    "display": {"_validation", "_collect", "_whole_files", "motion", "io", "datasets", "model", "hsmm", "persistence"},
    "experiment": {
        *("_validation", "_collect", "_whole_files", "motion", "io", "datasets", "model", "hsmm", "persistence"),
        "display",
    },
    "cli": {
        *("_validation", "_collect", "motion", "io", "datasets", "model", "hsmm", "persistence", "batch", "display"),
        "experiment",
    },
    "__main__": {"cli"},
    "__init__": {"_validation", "motion", "io", "datasets", "model", "hsmm", "persistence"},
}

# What each room of `experiment` may import of the others. The modules beside the rooms are for all of them.
ROOMS = {
    "running": {"answers"},
    "answers": set(),
    "simulated": set(),
    "analysis": set(),
    "ratings": {"analysis"},
    "judging": {"analysis"},
}


def _modules():
    return sorted(PACKAGE.rglob("*.py"))


def _part(path):
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def _imported_names(path):
    """Yield the path of each module of the package that a module imports, wherever in the module, from the part on."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            names = (
                [node.module or ""] if node.module != "eigenwalker" else [f"eigenwalker.{a.name}" for a in node.names]
            )
            assert node.level == 0, f"{path}: relative import"
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        yield from (name.split(".")[1:] for name in names if name.startswith("eigenwalker."))


@pytest.mark.parametrize("path", _modules(), ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_point_one_way(path):
    part = _part(path)
    foreign = {name[0] for name in _imported_names(path)} - {part} - ALLOWED[part]
    assert not foreign, f"{path.name} in {part} must not import {sorted(foreign)}"


def _experiment_modules():
    folder = PACKAGE / "experiment"
    return [path for path in sorted(folder.rglob("*.py")) if path != folder / "__init__.py"]


@pytest.mark.parametrize("path", _experiment_modules(), ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_of_rooms_point_one_way(path):
    """The package itself, with its public names, is for other parts alone."""
    room = path.parts[len(PACKAGE.parts) + 1]
    imported = [name[1:] for name in _imported_names(path) if name[0] == "experiment"]
    assert [] not in imported, f"{path.name} must not import from the package itself"
    foreign = {name[0] for name in imported} & set(ROOMS) - {room} - ROOMS.get(room, set())
    assert not foreign, f"{path.name} in {room} must not import {sorted(foreign)}"


def test_every_folder_of_experiment_is_a_room():
    assert {path.parent.name for path in (PACKAGE / "experiment").glob("*/__init__.py")} == set(ROOMS)


@pytest.mark.parametrize("path", _modules(), ids=lambda path: str(path.relative_to(PACKAGE)))
def test_no_module_grows_too_long(path):
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 500


def test_files_are_named_for_an_idea():
    assert not {path.stem for path in _modules()} & {"utils", "helpers", "common", "misc", "base"}


def test_import_loads_no_pictures_and_writes_no_file(tmp_path):
    """Byte code apart, which Python writes itself and is told not to here. In a copy, where no other test compiles."""
    package, home = tmp_path / "copy" / "eigenwalker", tmp_path / "home"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    home.mkdir()
    before = _files(package)
    code = (
        "import sys, eigenwalker, logging; "
        "bad = [name for name in ('matplotlib', 'skops', 'dask', 'anywidget', 'IPython') if name in sys.modules]; "
        "assert not bad, bad; assert not logging.getLogger().handlers; print(eigenwalker.__file__)"
    )
    command = [sys.executable, "-B", "-W", "error", "-c", code]
    environment = {"PYTHONPATH": str(package.parent), "HOME": str(home)}
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, cwd=home, env=environment)
    assert done.stdout.strip() == str(package / "__init__.py")
    assert not list(home.iterdir())
    assert _files(package) == before


def _files(folder):
    """Return when each file of a folder was written."""
    return {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file()}


def test_public_names_are_sorted_and_there():
    import eigenwalker

    # Constants, then classes, then functions, as ruff sorts them.
    kinds = sorted(eigenwalker.__all__, key=lambda name: (not name.isupper(), not name[0].isupper(), name))
    assert eigenwalker.__all__ == kinds
    assert not [name for name in eigenwalker.__all__ if not hasattr(eigenwalker, name)]
