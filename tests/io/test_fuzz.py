"""5,000 damaged files: each gives a walk or an error that names it, soon and with little memory, and nothing else.

``python -m benchmarks.fuzz`` reads 200,000 of them, and any one again by its number. The kinds of fault that were found
in this way have a test of their own in `test_fuzz_findings`.
"""

import pytest

from tests.mutated_files import (
    FORMATS,
    MisreadError,
    make_mutant,
    make_seeds,
    memory_limit,
    read_mutant,
    recorded_seeds,
)

N_FILES = 500  # of each of ten formats
RECORDED = ("bvh recorded", "kinect recorded", "c3d recorded")


@pytest.fixture(scope="module")
def seeds():
    """Return small sound files of each format."""
    return make_seeds()


def _check(seeds, kind, n_files, folder):
    faults, n_walks = [], 0
    with memory_limit():
        for number in range(n_files):
            try:
                n_walks += not read_mutant(make_mutant(seeds, kind, number), folder)
            except MisreadError as error:
                faults.append(f"python -m benchmarks.fuzz --replay {kind!r} {number}: {error}")
    assert not faults, "\n".join(faults[:10])
    assert 0.03 * n_files < n_walks < 0.8 * n_files  # mutations neither all too mild nor all too harsh


@pytest.mark.parametrize("kind", FORMATS)
def test_the_files_before_are_sound(seeds, kind, tmp_path):
    for seed in seeds[kind]:
        assert read_mutant(seed, tmp_path) == ""


@pytest.mark.parametrize("kind", FORMATS)
def test_damaged_files_give_a_walk_or_an_error(seeds, kind, tmp_path):
    _check(seeds, kind, N_FILES, tmp_path)


@pytest.mark.parametrize("kind", RECORDED)
def test_damaged_heads_of_recorded_files(seeds, kind, tmp_path, data_dir):
    recorded = recorded_seeds(data_dir)
    assert all(read_mutant(seed, tmp_path) == "" for seed in recorded[kind])
    _check(seeds | recorded, kind, N_FILES // 5, tmp_path)


def test_a_number_is_always_the_same_file(seeds):
    again = make_seeds()
    for kind in FORMATS:
        for number in range(20):
            assert make_mutant(seeds, kind, number).files == make_mutant(again, kind, number).files
