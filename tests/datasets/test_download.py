"""Files come whole or not at all, whatever the server and the disk do."""

import hashlib
import os
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from eigenwalker.datasets import _download
from eigenwalker.datasets._manifest import RemoteFile
from eigenwalker.datasets._repository import GITHUB, Repository, fetch_files
from tests.datasets.file_server import serve

REPOSITORY = Repository("owner/walks", "c0ffee")
CONTENTS = {f"data/{name}.bvh": name.encode() * 50_000 for name in ("anna", "berta", "clara", "dora", "emma")}
FIRST = "data/anna.bvh"


def remote(path, content):
    return RemoteFile(path, len(content), hashlib.sha256(content).hexdigest())


FILES = [remote(path, content) for path, content in CONTENTS.items()]


def address(path):
    return f"owner/walks/c0ffee/{path}"


def fetch(server, home, files=FILES, **options):
    options = {
        "data_home": home,
        "download_if_missing": True,
        "n_retries": 0,
        "delay": 0.0,
        "base_url": server if isinstance(server, str) else server.url,
        "progress": False,
    } | options
    return fetch_files(REPOSITORY, files, "walks", **options)


def on_disk(home):
    """Every file below the data set's folder, by its path there."""
    folder = home / "walks"
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def put(home, path, content):
    target = home / "walks" / path
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(content)
    return target


@pytest.fixture
def server():
    with serve({address(path): content for path, content in CONTENTS.items()}) as files:
        yield files


class TestDelivery:
    def test_files_come_whole_and_in_order(self, server, tmp_path):
        paths = fetch(server, tmp_path)
        assert [path.relative_to(tmp_path / "walks").as_posix() for path in paths] == list(CONTENTS)
        assert on_disk(tmp_path) == CONTENTS

    def test_what_is_there_is_not_asked_for(self, server, tmp_path):
        put(tmp_path, FIRST, CONTENTS[FIRST])
        fetch(server, tmp_path)
        assert sorted(path for path, _ in server.requests) == [address(path) for path in CONTENTS if path != FIRST]
        server.requests.clear()
        fetch(server, tmp_path)
        fetch(server, tmp_path, download_if_missing=False)
        assert server.requests == []

    def test_paths_are_quoted_and_slashes_of_the_server_do_not_matter(self, tmp_path):
        path = "data/fünf & mehr #1 %41?.bvh"
        with serve({address(path): b"walk"}) as server:
            fetch(server.url + "/", tmp_path, [remote(path, b"walk")])
        assert on_disk(tmp_path) == {path: b"walk"}

    def test_the_address_is_that_of_raw_files_on_github(self):
        url = REPOSITORY.url(GITHUB, "data/07/07_01.bvh")
        assert url == "https://raw.githubusercontent.com/owner/walks/c0ffee/data/07/07_01.bvh"

    def test_progress_goes_to_stderr(self, server, tmp_path, capsys):
        fetch(server, tmp_path, progress=True)
        assert capsys.readouterr().out == ""

    def test_two_calls_at_once(self, server, tmp_path):
        server.wait = 0.02
        with ThreadPoolExecutor(4) as pool:
            for job in [pool.submit(fetch, server, tmp_path) for _ in range(4)]:
                job.result()
        assert on_disk(tmp_path) == CONTENTS


class TestBrokenDelivery:
    def test_a_retry_continues(self, server, tmp_path):
        server.cuts[address(FIRST)] = [70_000]
        fetch(server, tmp_path, n_retries=1)
        assert server.ranges(FIRST) == [None, "bytes=70000-"]
        assert on_disk(tmp_path) == CONTENTS

    def test_the_next_call_continues(self, server, tmp_path):
        server.cuts[address(FIRST)] = [70_000]
        with pytest.raises(OSError, match=r"anna\.bvh: the delivery ended after 70000 of 200000 bytes from http"):
            fetch(server, tmp_path)
        whole = {path: content for path, content in CONTENTS.items() if path != FIRST}
        assert on_disk(tmp_path) == whole | {FIRST + ".part": CONTENTS[FIRST][:70_000]}
        fetch(server, tmp_path)
        assert server.ranges(FIRST) == [None, "bytes=70000-"]
        assert on_disk(tmp_path) == CONTENTS

    def test_a_server_without_ranges_delivers_anew(self, server, tmp_path):
        server.knows_ranges = False
        server.cuts[address(FIRST)] = [70_000]
        fetch(server, tmp_path, n_retries=1)
        assert server.ranges(FIRST) == [None, "bytes=70000-"]
        assert on_disk(tmp_path) == CONTENTS

    def test_a_part_that_does_not_fit_is_dropped(self, server, tmp_path):
        put(tmp_path, FIRST + ".part", b"of another file")
        fetch(server, tmp_path)
        assert server.ranges(FIRST) == ["bytes=15-", None]
        assert on_disk(tmp_path) == CONTENTS

    def test_a_part_that_is_too_long_is_dropped(self, server, tmp_path):
        put(tmp_path, FIRST + ".part", b"x" * 200_001)
        fetch(server, tmp_path)
        assert server.ranges(FIRST) == [None]
        assert on_disk(tmp_path) == CONTENTS

    def test_a_part_beyond_the_end_of_the_servers_file_does_not_stay(self, server, tmp_path):
        put(tmp_path, FIRST + ".part", CONTENTS[FIRST][:70_000])
        server.contents[address(FIRST)] = b"page"
        with pytest.raises(OSError, match=r"anna\.bvh: HTTP 416"):
            fetch(server, tmp_path, n_retries=3)
        assert FIRST + ".part" not in on_disk(tmp_path)

    def test_a_part_that_is_whole_is_not_asked_for(self, server, tmp_path):
        put(tmp_path, FIRST + ".part", CONTENTS[FIRST])
        fetch(server, tmp_path)
        assert server.ranges(FIRST) == []
        assert on_disk(tmp_path) == CONTENTS

    def test_a_part_of_another_call_is_left_alone_until_it_is_abandoned(self, server, tmp_path):
        part = put(tmp_path, f"{FIRST}.0123.part", CONTENTS[FIRST][:70_000])
        fetch(server, tmp_path)
        assert server.ranges(FIRST) == [None]
        assert part.exists()
        (tmp_path / "walks" / FIRST).unlink()
        os.utime(part, (time.time() - 3600,) * 2)
        fetch(server, tmp_path)
        assert server.ranges(FIRST) == [None, "bytes=70000-"]
        assert on_disk(tmp_path) == CONTENTS

    def test_passing_answers_are_tried_again(self, server, tmp_path):
        server.statuses[address(FIRST)] = [503, 429]
        fetch(server, tmp_path, n_retries=2)
        assert len(server.ranges(FIRST)) == 3
        assert on_disk(tmp_path) == CONTENTS

    def test_a_server_that_hangs_runs_into_the_time_out(self, server, tmp_path, monkeypatch):
        monkeypatch.setattr(_download, "_TIMEOUT", 0.1)
        server.wait = 1.0
        with pytest.raises(OSError, match=r"anna\.bvh: timed out from http"):
            fetch(server, tmp_path, FILES[:1])


class TestRefusals:
    def test_a_wrong_checksum(self, server, tmp_path):
        server.contents[address(FIRST)] = CONTENTS[FIRST].swapcase()
        with pytest.raises(OSError, match=rf"anna\.bvh: expected the sha256 checksum {FILES[0].sha256}, got .* from"):
            fetch(server, tmp_path, n_retries=3)
        assert on_disk(tmp_path) == {path: content for path, content in CONTENTS.items() if path != FIRST}
        assert server.ranges(FIRST) == [None]

    def test_a_wrong_size(self, server, tmp_path):
        server.contents[address(FIRST)] = b"page"
        with pytest.raises(OSError, match=r"anna\.bvh: expected 200000 bytes, got 4 from"):
            fetch(server, tmp_path)
        assert FIRST not in on_disk(tmp_path)

    def test_all_that_failed_are_in_one_error_with_the_way_out(self, server, tmp_path):
        del server.contents[address(FIRST)]
        server.contents[address("data/dora.bvh")] = b"page"
        with pytest.raises(OSError, match="2 of 5 files could not be fetched into") as caught:
            fetch(server, tmp_path, n_retries=3)
        lines = str(caught.value).splitlines()
        assert lines[1].startswith(f"  {FIRST}: HTTP 404 Not Found from {server.url}/owner/walks/c0ffee/data/anna.bvh")
        assert lines[2].startswith("  data/dora.bvh: expected 200000 bytes, got 4")
        assert "Call again" in lines[3]
        assert "base_url=" in lines[3]
        assert len(server.ranges(FIRST)) == 1  # a file that is not there is not there a second later
        assert len(on_disk(tmp_path)) == 3

    def test_a_server_out_of_reach_is_not_asked_for_every_file(self, server, tmp_path):
        with serve({}) as gone:
            url = gone.url
        with pytest.raises(OSError, match=r"5 of 5 files could not(.|\n)*: .* refused from(.|\n)*: not tried, because"):
            fetch(url, tmp_path, n_retries=1)
        assert on_disk(tmp_path) == {}

    def test_without_download(self, server, tmp_path):
        put(tmp_path, FIRST, b"edited")
        with pytest.raises(OSError, match=r"5 of 5 files in .*download_if_missing=True") as caught:
            fetch(server, tmp_path, download_if_missing=False)
        assert f"{FIRST}: expected 200000 bytes, got 6" in str(caught.value)
        assert "data/emma.bvh: missing" in str(caught.value)
        assert server.requests == []

    @pytest.mark.parametrize("change", [lambda content: content[:-1], bytes.swapcase], ids=["shorter", "same size"])
    def test_a_file_that_was_changed_is_fetched_again_with_a_warning(self, server, tmp_path, change):
        fetch(server, tmp_path)
        put(tmp_path, FIRST, change(CONTENTS[FIRST]))
        with pytest.warns(UserWarning, match=r"are fetched again:\n  data/anna\.bvh: expected .*, got [^\n]*$"):
            fetch(server, tmp_path)
        assert on_disk(tmp_path) == CONTENTS

    def test_arguments(self, server, tmp_path):
        with pytest.raises(ValueError, match=r"n_retries must be .* got -1; delay must be .* got nan"):
            fetch(server, tmp_path, n_retries=-1, delay=float("nan"))


class TestWithoutChecksum:
    """Recordings whose content is not known in advance."""

    FILE = RemoteFile(FIRST, None, None, b"anna")

    def test_the_start_tells_a_recording_from_a_page(self, server, tmp_path):
        fetch(server, tmp_path, [self.FILE])
        assert on_disk(tmp_path) == {FIRST: CONTENTS[FIRST]}
        fetch(server, tmp_path, [self.FILE])
        assert len(server.requests) == 1
        put(tmp_path, FIRST, b"<html>")
        server.contents[address(FIRST)] = b"<html>"
        with (
            pytest.warns(UserWarning, match="fetched again"),
            pytest.raises(OSError, match="expected content that starts with 'anna', got '<htm'"),
        ):
            fetch(server, tmp_path, [self.FILE])

    def test_pieces_are_not_put_together(self, server, tmp_path):
        server.cuts[address(FIRST)] = [70_000, 70_000]
        with pytest.raises(OSError, match="ended after 70000 of 200000"):
            fetch(server, tmp_path, [self.FILE], n_retries=1)
        assert on_disk(tmp_path) == {}
        fetch(server, tmp_path, [self.FILE])
        assert server.ranges(FIRST) == [None] * 3
        assert on_disk(tmp_path) == {FIRST: CONTENTS[FIRST]}
