"""C3D files by hand, in each byte order and with points as integers or reals."""

import struct

import numpy as np

PROCESSORS = {"Intel": (84, "<"), "DEC": (85, "<"), "MIPS": (86, ">")}


class Maker:
    """Writes numbers as one kind of processor does, and files of them."""

    def __init__(self, processor):
        self.code, self.end = PROCESSORS[processor]

    def word(self, *values):
        return struct.pack(f"{self.end}{len(values)}H", *(value % 65536 for value in values))

    def real(self, *values):
        if self.code != 85:
            return struct.pack(f"{self.end}{len(values)}f", *values)
        halves = np.array(values, "<f4") * 4
        return halves.view("<u2").reshape(-1, 2)[:, ::-1].tobytes()

    def entry(self, name, number, content):
        return struct.pack("bb", len(name), number) + name.encode() + self.word(2 + len(content)) + content

    def parameter(self, name, number, kind, sizes, data):
        return self.entry(name, number, struct.pack("b", kind) + bytes([len(sizes), *sizes]) + data + b"\0")

    def texts(self, name, number, words):
        length = max(len(word.encode()) for word in words)
        data = b"".join(word.encode().ljust(length) for word in words)
        return self.parameter(name, number, -1, [length, len(words)], data)

    def file(self, points, *, scale=-1.0, labels=("LANK", "RANK"), units=("mm",), analog=0, first=1, more=b""):
        """Return a file; points has shape (n_frames, n_points, 4), in the numbers that stand in the file."""
        n_frames, n_points, _ = points.shape
        body = self.entry("POINT", -1, b"\0") + self.entry("EVENT", -2, b"\0")
        body += self.parameter("USED", 1, 2, [], self.word(n_points)) + self.parameter("RATE", 1, 4, [1], self.real(50))
        body += self.parameter("SCALE", 1, 4, [1], self.real(scale))
        body += (self.texts("LABELS", 1, labels) if labels else b"") + (self.texts("UNITS", 1, units) if units else b"")
        body += more + b"\0\0"
        parameters = bytes([1, 0x50, 2, self.code]) + body
        assert len(parameters) <= 1024
        last = first + n_frames - 1
        header = bytes([2, 0x50]) + self.word(n_points, analog, first, last, 0) + self.real(scale)
        header += self.word(4, 1) + self.real(50)
        write = self.real if scale < 0 else lambda *values: self.word(*map(int, values))
        data = b"".join(write(*frame.ravel(), *[7] * analog) for frame in points)
        return header.ljust(512, b"\0") + parameters.ljust(1024, b"\0") + data


POINTS = np.array([[[100, -200, 900, 0], [100, 200, 905, 1]], [[0, 0, 0, -1], [110, 210, -905, 0]]])
INTEL = Maker("Intel")


def event_parameters(labels, contexts, times, used=None):
    count = len(labels) if used is None else used
    entries = INTEL.parameter("USED", 2, 2, [], INTEL.word(count)) + INTEL.texts("LABELS", 2, labels)
    return (
        entries
        + INTEL.texts("CONTEXTS", 2, contexts)
        + INTEL.parameter("TIMES", 2, 4, [2, len(times) // 2], INTEL.real(*times))
    )
