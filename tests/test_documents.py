"""README and notebooks say what is true."""

import json
import os
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("number", range(len(BLOCKS)))
def test_readme_examples_run(number, tmp_path, monkeypatch, request):
    monkeypatch.chdir(tmp_path)
    if "bandai2" in BLOCKS[number]:
        os.symlink((request.getfixturevalue("data_dir") / "bandai2").resolve(), tmp_path / "bandai2")
    exec(compile(BLOCKS[number], f"README example {number}", "exec"), {"__name__": "readme"})


def test_readme_has_the_two_commands():
    assert 'pip install ".[all]" && eigenwalker demo' in README
    assert 'pip install ".[all,test]" && pytest' in README


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.name)
def test_notebooks_are_stored_without_outputs(path):
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    assert not [cell for cell in cells if cell.get("outputs") or cell.get("execution_count")]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.name)
def test_notebooks_hold_no_logic(path):
    """What a notebook needs a function for belongs into the package."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    code = "".join("".join(cell["source"]) + "\n" for cell in cells if cell["cell_type"] == "code")
    assert not re.findall(r"^\s*(def|class) ", code, flags=re.MULTILINE)
