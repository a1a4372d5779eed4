"""Ways in which a file goes wrong: each takes a random generator and bytes, and returns other bytes.

`mutate_text` and `mutate_json` do one of them by chance; `tests.binary_mutations` has those of binary formats.
"""

import json
import re
from collections.abc import Callable, Sequence
from random import Random
from typing import Any

__all__ = ["flip_bytes", "grow", "mutate_json", "mutate_text", "splice"]

Mutation = Callable[[Random, bytes], bytes]

NUMBERS = (
    *("nan", "NaN", "inf", "-inf", "Infinity", "1e308", "-1e308", "1e999", "5e-324", "1e-320", "1e12", "1000000000000"),
    *("-1", "-0", "-0.0", "0", "1", "2", "007", "1.5", "1e5", "65535", "65536", "2147483648", "18446744073709551616"),
    *("1_0", "0x10", "1,5", "1.5.2", "--1", "+1", "+", ".", "-", "e5", "1e", "1 2", "", "n/a", "None", "true", '"1"'),
    *("١٢", "１２", "½", "9" * 400, "0." + "3" * 5000, "9" * 5000, "0" * 3000 + "1", "word"),
)
_NUMBER = re.compile(rb"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_TOKEN = re.compile(rb"[^\s,;{}]+")
_STRANGE = (
    *(b"\0", b"\xff", b"\xe9", b"\x1a", b"\x0b", b"\x0c", b"\x1c", b"\xc2\x85", b"\xe2\x80\xa8", b"\xef\xbb\xbf"),
    *(b'"', b"'", b"#", b",", b";", b"\t", b" ", b"\n", b"\r", b"{", b"}", b"(", b":", b"\\", b"_", b"%s", b"\xcc\x81"),
)
_VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, -1, 1e12, 1e308, float("inf"), float("nan"), 10**30, 10**4000, "", "n/a", "word", "ALS"),
    *([], {}, [[]], [1, 2, 3], {"a": {"b": []}}, "9" * 5000, [0.0, "", ""], [None] * 3, "\ud800", "\0"),
)


def _span(random: Random, length: int, longest: int = 400) -> tuple[int, int]:
    """Return start and end of some bytes, more often few than many."""
    start = random.randrange(length + 1)
    return start, min(length, start + int(longest ** random.random()))


def flip_bytes(random: Random, data: bytes) -> bytes:
    """Put other bytes in some places."""
    changed = bytearray(data)
    for _ in range(random.choice((1, 1, 2, 8, 64)) if data else 0):
        place = random.randrange(len(data))
        changed[place] = random.choice((changed[place] ^ (1 << random.randrange(8)), random.randrange(256), 0, 255))
    return bytes(changed)


def _delete(random: Random, data: bytes) -> bytes:
    start, end = _span(random, len(data))
    return data[:start] + data[end:]


def _duplicate(random: Random, data: bytes) -> bytes:
    start, end = _span(random, len(data))
    return data[:end] + data[start:end] * random.choice((1, 1, 2, 50)) + data[end:]


def _truncate(random: Random, data: bytes) -> bytes:
    return data[: random.randrange(len(data) + 1)]


def _insert(random: Random, data: bytes) -> bytes:
    place = random.randrange(len(data) + 1)
    return data[:place] + random.choice(_STRANGE) * random.choice((1, 1, 1, 3, 3000)) + data[place:]


def _lines(change: Callable[[Random, list[bytes]], list[bytes]]) -> Mutation:
    def mutation(random: Random, data: bytes) -> bytes:
        return b"".join(change(random, data.splitlines(keepends=True) or [b""]))

    return mutation


@_lines
def _swap_lines(random: Random, lines: list[bytes]) -> list[bytes]:
    first, second = (random.randrange(len(lines)) for _ in range(2))
    lines[first], lines[second] = lines[second], lines[first]
    return lines


@_lines
def _drop_lines(random: Random, lines: list[bytes]) -> list[bytes]:
    first, last = _span(random, len(lines), 12)
    return lines[:first] + lines[last:]


@_lines
def _repeat_lines(random: Random, lines: list[bytes]) -> list[bytes]:
    first, last = _span(random, len(lines), 12)
    return lines[:last] + lines[first:last] * random.choice((1, 1, 2, 30)) + lines[last:]


@_lines
def _one_line(random: Random, lines: list[bytes]) -> list[bytes]:
    return random.choice(([random.choice(lines)], lines[:1], [b"\n"], [b" \t \n\n"], [b""]))


def _replace_match(random: Random, data: bytes, pattern: re.Pattern[bytes], choose: Callable[[bytes], bytes]) -> bytes:
    """Replace one of the matches in a part of the file that begins at a random place, or at its head."""
    start = random.choice((0, random.randrange(len(data) + 1)))
    matches = list(pattern.finditer(data, start, start + 2000))
    if not matches:
        return data
    found = random.choice(matches)
    return data[: found.start()] + choose(found[0]) + data[found.end() :]


def _replace_number(random: Random, data: bytes) -> bytes:
    return _replace_match(random, data, _NUMBER, lambda _: random.choice(NUMBERS).encode())


def _count_differently(random: Random, data: bytes) -> bytes:
    """Change one of the first numbers of the file by a little or to a lot."""
    matches = [match for match in _NUMBER.finditer(data[:3000]) if match[0].isdigit()]
    if not matches:
        return data
    found = random.choice(matches)
    counted = random.choice((int(found[0][:18]) + random.choice((-1, 1)), 0, -1, 10**6, 10**12, 10**18))
    return data[: found.start()] + str(counted).encode() + data[found.end() :]


def _replace_token(random: Random, data: bytes) -> bytes:
    tokens = _TOKEN.findall(data[:20_000]) or [b"a"]
    return _replace_match(random, data, _TOKEN, lambda _: random.choice(tokens))


def _repeat_token(random: Random, data: bytes) -> bytes:
    separator = random.choice((b" ", b"\t", b",", b";", b"\n", b""))
    times = random.choice((2, 2, 3, 3, 40, 2000))
    return _replace_match(random, data, _TOKEN, lambda token: separator.join([token] * times))


def _long_word(random: Random, data: bytes) -> bytes:
    letters = random.choice((b"1", b"0", b"9", b"x", b" ", b"a_x,", b"1.", b"-", b"1e"))
    word = letters * random.choice((100, 10_000, 100_000)) + random.choice((b"", b"x", b"e5"))
    return _replace_match(random, data, _TOKEN, lambda _: word)


def _encode_differently(random: Random, data: bytes) -> bytes:
    text = data.decode("utf-8", "replace")
    ways = (
        lambda: text.encode("utf-16"),
        lambda: text.encode("utf-16-be"),
        lambda: b"\xef\xbb\xbf" + data,
        lambda: data.replace(b"\n", b"\r\n"),
        lambda: data.replace(b"\n", b"\r"),
        lambda: data.replace(b"\n", b"\n\n"),
        lambda: data.replace(b"\n", b" \r\r\n\t"),
        lambda: data.upper(),
        lambda: data.lower(),
        lambda: data.replace(b".", b","),
        lambda: data.replace(b"\t", b" "),
        lambda: data.rstrip(b"\n"),
    )
    return random.choice(ways)()


_TEXT: tuple[tuple[Mutation, int], ...] = (
    (flip_bytes, 6),
    (_delete, 5),
    (_duplicate, 4),
    (_truncate, 3),
    (_insert, 6),
    (_swap_lines, 3),
    (_drop_lines, 4),
    (_repeat_lines, 4),
    (_one_line, 1),
    (_replace_number, 14),
    (_count_differently, 6),
    (_replace_token, 8),
    (_repeat_token, 4),
    (_long_word, 2),
    (_encode_differently, 5),
)


def mutate_text(random: Random, data: bytes) -> bytes:
    """Do one of the things to a text that can be done to any."""
    mutations, weights = zip(*_TEXT, strict=True)
    return random.choices(mutations, weights)[0](random, data)


def splice(random: Random, data: bytes, other: bytes) -> bytes:
    """Return the head of one file and the tail of another."""
    return data[: random.randrange(len(data) + 1)] + other[random.randrange(len(other) + 1) :]


def mutate_json(random: Random, data: bytes) -> bytes:
    """Put another value, or none, into a JSON object; or do to it what can be done to any text."""
    try:
        fields = json.loads(data)
    except (ValueError, RecursionError):
        return mutate_text(random, data)
    way = random.randrange(10)
    if way < 3 or not isinstance(fields, dict) or not fields:
        return mutate_text(random, data)
    if way == 3:
        return json.dumps(random.choice(_VALUES)).encode()
    if way == 4:
        depth = random.choice((50, 900, 985, 1000, 100_000))
        return data.replace(b"}", b', "%s": %s1%s}' % (_a_key(random, fields), b"[" * depth, b"]" * depth))
    _change_entry(random, fields)
    return json.dumps(fields).encode()


def _a_key(random: Random, fields: dict[str, Any]) -> bytes:
    return random.choice((*fields, "SpatialAxes", "SamplingFrequency")).encode()


def _change_entry(random: Random, fields: dict[str, Any]) -> None:
    """Change one of the entries of a JSON object, or of an object or list within it."""
    holder: Any = fields
    while True:
        keys: Sequence[Any] = list(holder) if isinstance(holder, dict) else range(len(holder))
        key = random.choice(keys)
        if not isinstance(holder[key], (dict, list)) or not holder[key] or random.random() < 0.4:
            break
        holder = holder[key]
    if random.random() < 0.2:
        del holder[key]
    elif random.random() < 0.2:
        holder[key] = holder[random.choice(keys)]
    else:
        holder[key] = random.choice(_VALUES)


def grow(random: Random, data: bytes, ending: str) -> bytes:
    """Make a text large in the way of its format: more joints, bones or columns, one in another or side by side."""
    count = random.choice((2, 10, 300, 3000))
    if ending == ".bvh":
        return _grow_joints(random, data, count)
    if ending == ".asf":
        return _grow_bones(random, data, count)
    return _grow_columns(random, data, count, {".csv": b",", ".txt": b";"}.get(ending, b"\t"))


def _grow_joints(random: Random, data: bytes, count: int) -> bytes:
    """Hang joints, mostly without channels, side by side or one in another, or end sites, under a joint."""
    channels = random.choice((b"", b"", b"CHANNELS 0\n", b"CHANNELS 1 Xrotation\n"))
    joints = [b"JOINT j%d\n{\nOFFSET 0 0 0\n%s" % (number, channels) for number in range(count)]
    deep = b"".join(joints) + b"}" * count + b"\n"
    wide = b"".join(joint + b"}\n" for joint in joints)
    ends = b"End Site\n{\nOFFSET 0 0 1\n}\n" * count
    place = data.find(b"End Site", random.randrange(len(data) + 1))
    place = place if place >= 0 else max(0, data.find(b"}"))
    data = data[:place] + random.choice((deep, wide, ends)) + data[place:]
    head, motion, frames = data.partition(b"Frame Time:")
    if random.random() < 0.5 or not motion:
        return data
    lines = frames.splitlines(keepends=True)
    return head + motion + b"".join(lines[:1] + lines[1:] * random.choice((20, 1000)))


def _grow_bones(random: Random, data: bytes, count: int) -> bytes:
    """Add bones, in a chain or all at the root, sometimes in a ring."""
    bone = b"begin\nname b%d\ndirection 0 1 0\nlength 1\naxis 0 0 0 XYZ\nend\n"
    bones = b"".join(bone % number for number in range(count))
    first = random.choice((b"root", b"head", b"b%d" % (count - 1)))
    chain = b"".join(b"b%d b%d\n" % (number - 1, number) for number in range(1, count)) + first + b" b0\n"
    wide = b"root " + b" ".join(b"b%d" % number for number in range(count)) + b"\n"
    head, hierarchy, tail = data.partition(b":hierarchy")
    return head + bones + hierarchy + b"\n" + random.choice((chain, wide)) + tail.lstrip()


def _grow_columns(random: Random, data: bytes, count: int, separator: bytes) -> bytes:
    """Add columns to all lines, or to one."""
    lines = data.split(b"\n")
    same = random.random() < 0.3
    only = random.choice((None, random.randrange(len(lines))))
    for place, line in enumerate(lines):
        if line and only in (None, place):
            words = line.split(separator)
            more = [words[-1] if same else words[-1 - number % len(words)] for number in range(count)]
            is_title = not _NUMBER.fullmatch(words[-1].strip() or b"0")
            titles = [b"m%d_%c" % (number // 3, b"xyz"[number % 3]) for number in range(count)]
            lines[place] = separator.join(words + (titles if is_title and not same else more))
    return b"\n".join(lines)
