"""README and notebooks say what is true."""

import json
import os
import re
from pathlib import Path

import pytest

from eigenwalker import read_walk, read_walks
from eigenwalker.cli import main
from eigenwalker.io.formats import READERS, WRITERS
from eigenwalker.motion import prepare, prepare_walks, split_passes
from notebooks.synthetic_recordings import write_recordings

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("number", range(len(BLOCKS)))
def test_readme_examples_run(number, tmp_path, monkeypatch, request):
    monkeypatch.chdir(tmp_path)
    for folder in ("bandai2", "horst_c3d", "kinect"):
        if folder in BLOCKS[number]:
            os.symlink((request.getfixturevalue("data_dir") / folder).resolve(), tmp_path / folder)
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


def test_readme_lists_all_formats():
    rows = README.partition("| format |")[2].partition("\n\n")[0]
    for ending in READERS:
        use = re.search(rf"`{re.escape(ending)}`[^|]*\| ([a-z, ]+) \|", rows)
        assert use is not None, ending
        assert use[1] == ("read, write" if ending in WRITERS else "read")


@pytest.mark.parametrize(("title", "command"), [("Any recording", "fit"), ("Gait models from a dozen steps", "style")])
def test_readme_options_are_there(capsys, title, command):
    section = README.partition(f"## {title}\n")[2].partition("\n## ")[0]
    with pytest.raises(SystemExit):
        main([command, "--help"])
    printed = capsys.readouterr().out
    named = re.findall(r"--[a-z][a-z-]+", section)
    assert named
    assert not [option for option in named if option not in printed]


def test_readme_names_all_commands(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    commands = re.findall(r"^    ([a-z]+)\b", capsys.readouterr().out, flags=re.MULTILINE)
    row = README.partition("| `eigenwalker` (command) | ")[2].partition(" |")[0]
    assert row == ", ".join(f"`{command}`" for command in commands)


def test_synthetic_recordings_of_the_notebooks(tmp_path):
    """They are read and prepared like the recorded ones whose places they take."""
    folder = write_recordings(tmp_path)
    acted = read_walks(sorted(folder.glob("bandai2/*.bvh")), unit="cm")
    assert len({walk.name.split("_")[2] for walk in acted}) == 7
    static = read_walk(folder / "horst_c3d" / "S01_0001_Static.c3d")
    optical = read_walks(sorted(folder.glob("horst_c3d/*_Gait.c3d")))
    kinect = split_passes(read_walk(folder / "kinect" / "Person001" / "1.txt").to_markers())
    assert len(prepare_walks([acted[0], *(walk.to_markers(static=static) for walk in optical)])) == 11
    assert [prepare(one, camera="moving").name for one in kinect] == ["1_pass1", "1_pass2"]
