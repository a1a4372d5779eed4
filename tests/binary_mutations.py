"""Ways in which binary files go wrong: the fields of C3D, the entries of NPZ, the elements of MATLAB files."""

import io
import struct
import zipfile
import zlib
from random import Random

from tests.mutations import flip_bytes, mutate_json, mutate_text

__all__ = ["mutate_c3d", "mutate_mat", "mutate_npz"]

_BYTES = (0, 1, 2, 3, 4, 7, 8, 80, 83, 84, 85, 86, 127, 128, 129, 254, 255)
_WORDS = (0, 1, 2, 3, 255, 256, 512, 32767, 32768, 65534, 65535)
_LONGS = (0, 1, 2, 5, 14, 15, 46, 230, 65535, 2**31 - 1, 2**31, 2**32 - 1, 2**32 - 8)
_REALS = (float("nan"), float("inf"), -float("inf"), 0.0, -1.0, 1e-45, 1e30, -1e30, 1e12, 0.5)


def _put(data: bytes, place: int, new: bytes) -> bytes:
    return data[:place] + new + data[place + len(new) :] if place + len(new) <= len(data) else data


def _resize(random: Random, data: bytes) -> bytes:
    """Cut the file, or move all that follows a place."""
    place = random.randrange(len(data) + 1)
    more = bytes(random.choice((1, 2, 8, 512, 4096)))
    return random.choice((data[:place], data[:place] + data[place + len(more) :], data[:place] + more + data[place:]))


def _c3d_header(random: Random, data: bytes) -> bytes:
    """Change a word of the first 40 bytes: counts of points, analog data and frames, the start of the data."""
    place = 2 * random.randrange(20)
    choice = struct.unpack_from("<H", data.ljust(40, b"\0"), place)[0] + random.choice((-1, 1))
    word = random.choice((choice % 65536, *_WORDS))
    return _put(data, place, struct.pack(random.choice(("<H", ">H")), word))


def _c3d_mark(random: Random, data: bytes) -> bytes:
    """Change where the parameters start, one of the marks, or the type of the processor."""
    return _put(data, random.choice((0, 1, 512, 513, 514, 515)), bytes([random.choice(_BYTES)]))


def _c3d_entries(data: bytes) -> list[tuple[int, int]]:
    """Return the place of each entry of the parameters, and of what follows its name and offset."""
    found, place = [], 512 + 4
    while place + 4 < len(data) and data[place]:
        length = data[place] if data[place] < 128 else 256 - data[place]
        after = place + 2 + length
        if after + 3 > len(data):
            break
        found.append((place, after + 2))
        step = int.from_bytes(data[after : after + 2], "big" if data[515] == 86 else "little")
        if step == 0:
            break
        place = after + step
    return found


def _c3d_entry(random: Random, data: bytes) -> bytes:
    """Change length, group, offset, type, number of sizes or a size of a parameter."""
    entries = _c3d_entries(data)
    if not entries:
        return flip_bytes(random, data)
    start, content = random.choice(entries)
    place = random.choice((start, start + 1, content - 2, content - 1, content, content + 1, content + 2, content + 3))
    return _put(data, place, bytes([random.choice(_BYTES)]))


def _c3d_value(random: Random, data: bytes) -> bytes:
    """Put strange real numbers behind the sizes of a parameter, or where points are."""
    entries = _c3d_entries(data)
    places = [content + 2 + data[content + 1] for _, content in entries if content + 1 < len(data)]
    place = random.choice((*places, random.randrange(len(data) + 1)))
    order = random.choice("<>")
    reals = [struct.pack(order + "f", random.choice(_REALS)) for _ in range(random.choice((1, 1, 2, 6)))]
    return _put(data, place, b"".join(reals))


def _c3d_retyped(random: Random, data: bytes) -> bytes:
    """Let parameters hold two reals: where frames are counted in words, they may be NaN."""
    entries = _c3d_entries(data)
    chosen = random.choice((random.sample(entries, min(2, len(entries))), entries[-3:]))
    for _, content in chosen:
        reals = struct.pack("<ff", random.choice(_REALS), random.choice(_REALS))
        data = _put(data, content, b"\x04" + random.choice((b"\x01\x02", b"\x02\x02\x01")) + reals)
    return data


def _c3d_many_points(random: Random, data: bytes) -> bytes:
    """Claim many points in one frame and bring their bytes."""
    count = random.choice((300, 5000, 65535))
    data = _put(data, 2, struct.pack("<HHHH", count, 0, 1, 1))
    return data + bytes(16 * count)


def mutate_c3d(random: Random, data: bytes) -> bytes:
    """Do one of these things to a C3D file."""
    mutations = (_c3d_header, _c3d_mark, _c3d_entry, _c3d_value, _c3d_retyped, _resize, flip_bytes, _c3d_many_points)
    return random.choices(mutations, (6, 2, 8, 5, 3, 2, 5, 0.3))[0](random, data)


def mutate_npz(random: Random, data: bytes) -> bytes:
    """Change the bytes of an archive, or what one of its entries holds."""
    if random.random() < 0.25:
        return random.choice((flip_bytes, _resize))(random, data)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            entries = {name: archive.read(name) for name in archive.namelist()}
    except Exception:  # whatever the mutation before has done
        return flip_bytes(random, data)
    if not entries:
        return data
    name = random.choice(("walk.npy", *entries))
    way = random.randrange(12)
    if way == 0:
        entries.pop(name, None)
    elif way == 1:
        entries[name] = entries[random.choice(list(entries))]
    else:
        entries[name] = _mutate_array(random, entries.get(name, b""), name)
    return _archive(random, entries)


def _archive(random: Random, entries: dict[str, bytes]) -> bytes:
    file = io.BytesIO()
    packing = random.choice((zipfile.ZIP_STORED,) * 9 + (zipfile.ZIP_DEFLATED,))
    with zipfile.ZipFile(file, "w", packing) as archive:
        for name, content in entries.items():
            archive.writestr(zipfile.ZipInfo(name), content, packing)
    return file.getvalue()


def _mutate_array(random: Random, data: bytes, name: str) -> bytes:
    """Change the header or the values of an array, or the JSON that is the text ``walk``."""
    size = 10 + int.from_bytes(data[8:10], "little")
    if name == "walk.npy" and random.random() < 0.7:
        text = data[size:].decode("utf-32-le", "replace")
        return _text_array(mutate_json(random, text.encode("utf-8", "replace")).decode("utf-8", "replace"))
    if random.random() < 0.3:
        return flip_bytes(random, data)
    text = mutate_text(random, data[10:size])
    if random.random() < 0.5:  # with a header of the right length
        text = text[:60_000].rstrip().ljust(max(0, size - 11)) + b"\n"
        return data[:8] + struct.pack("<H", len(text)) + text + data[size:]
    return data[:10] + text + data[size:]


def _text_array(text: str) -> bytes:
    header = f"{{'descr': '<U{len(text)}', 'fortran_order': False, 'shape': (), }}\n".encode()
    body = text.encode("utf-32-le", "replace")
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + body


def _mat_long(random: Random, data: bytes) -> bytes:
    """Change one of the 32-bit numbers of a MATLAB file: types and sizes of elements, flags, dimensions."""
    place = 4 * random.randrange(31, min(len(data) // 4, 80) + 32)
    order = random.choice(("<I", "<I", ">I"))
    return _put(data, place, struct.pack(order, random.choice(_LONGS)))


def _mat_dimensions(random: Random, data: bytes) -> bytes:
    """Give a variable thousands of dimensions."""
    sizes = struct.pack("<i", random.choice((1, 2, 2**31 - 1))) * random.choice((3, 500, 50_000))
    flags = struct.pack("<IIII", 6, 8, 6, 0)
    body = flags + struct.pack("<II", 5, len(sizes)) + sizes.ljust(-(-len(sizes) // 8) * 8, b"\0")
    body += struct.pack("<II", 0x10001, ord("x")) + struct.pack("<II", 9, 0)
    return data + struct.pack("<II", 14, len(body)) + body


def _mat_packed(random: Random, data: bytes) -> bytes:
    """Compress a variable, sometimes one that unpacks to a thousand times its size."""
    body = random.choice((data[128:], bytes(10**6), data[128:] + bytes(10**6)))
    packed = zlib.compress(body)
    return data[:128] + struct.pack("<II", 15, len(packed)) + packed


def mutate_mat(random: Random, data: bytes) -> bytes:
    """Do one of these things to a MATLAB file."""
    mutations = (_mat_long, flip_bytes, _resize, _mat_value, _mat_dimensions, _mat_packed)
    return random.choices(mutations, (8, 4, 2, 4, 0.5, 1))[0](random, data)


def _mat_value(random: Random, data: bytes) -> bytes:
    """Put a strange number where the matrix is."""
    place = 128 + 8 * random.randrange(max(1, (len(data) - 128) // 8))
    return _put(data, place, struct.pack("<d", random.choice((*_REALS, 1e308, 5e-324))))
