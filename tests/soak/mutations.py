"""Inputs that differ from good ones in a few places; the same seed gives the same input."""

import copy
import io
import json
import math
import random
import struct
import zipfile
import zlib
from collections.abc import Callable, Sequence

from fuzz_corpus import PLAIN_VALUES, PLAIN_WORDS, at, places

NUMBERS = (
    0,
    1,
    2,
    7,
    0x7F,
    0x80,
    0xFF,
    0x7FFF,
    0x8000,
    0xFFFF,
    0x7FFFFFFF,
    0x80000000,
    0xFFFFFFFF,
    1 << 40,
    (1 << 64) - 1,
)
Mutation = Callable[[random.Random, bytes], bytes]


def mutated(name: str, case: int, originals: Sequence[bytes], kinds: Sequence[Mutation]) -> bytes:
    """Input number `case` of a target.

    Args:
        name: Of the target and the seed.
        case: From 0.
        originals: Good inputs.
        kinds: Ways to change them.
    """
    rng = random.Random(f"{name}:{case}")
    return rng.choice(kinds)(rng, rng.choice(originals))


def of_bytes(rng: random.Random, data: bytes) -> bytes:
    """Bytes that are flipped, cut off, overwritten by odd numbers, inserted, moved or repeated."""
    broken = bytearray(data)
    for _ in range(rng.randint(1, 4)):
        place, action = rng.randrange(max(len(broken), 1)), rng.randrange(8)
        if action <= 1 and broken:
            broken[place] ^= 1 << rng.randrange(8)
        elif action == 2 and rng.random() < 0.5:
            del broken[place:]
        elif action == 3:
            width = rng.choice((1, 2, 4, 8))
            number = rng.choice(NUMBERS) & ((1 << 8 * width) - 1)
            broken[place : place + width] = number.to_bytes(width, rng.choice(("little", "big")))
        elif action == 4:
            broken[place:place] = rng.randbytes(rng.randint(1, 8))
        elif action == 5:
            broken[place:place] = broken[place : place + rng.randint(1, 40)] * rng.randint(1, 20)
        elif action == 6:
            other = rng.randrange(max(len(broken), 1))
            broken[place : place + 16] = broken[other : other + 16]
        else:
            broken[place : place + rng.randint(1, 8)] = rng.randbytes(rng.randint(0, 8))
    return bytes(broken)


def of_text(rng: random.Random, data: bytes) -> bytes:
    """Lines of which a few words are replaced, or which are removed, repeated or moved."""
    lines = data.decode("utf-8", "surrogateescape").split("\n")
    for _ in range(rng.randint(1, 4)):
        number, action = rng.randrange(len(lines)), rng.randrange(7)
        if action <= 2:
            words = lines[number].split(" ")
            words[rng.randrange(len(words))] = odd_word(rng)
            lines[number] = " ".join(words)
        elif action == 3:
            lines.insert(number, f"{odd_word(rng)} {odd_word(rng)}")
        elif action == 4:
            lines[number:number] = [lines[number]] * rng.choice((1, 2, 5, 200))
        else:
            line = lines.pop(number) if len(lines) > 1 else ""
            if action == 5:
                lines.insert(rng.randint(0, len(lines)), line)
    return "\n".join(lines).encode("utf-8", "surrogateescape" if rng.random() < 0.9 else "surrogatepass")


def of_json(rng: random.Random, data: bytes) -> bytes:
    """A JSON document of which a few values are replaced, removed, nested or repeated."""
    document = json.loads(data)
    for _ in range(rng.randint(1, 3)):
        path = rng.choice(places(document))
        if not path:
            if rng.random() < 0.1:
                return json.dumps(odd_value(rng, document)).encode()
            continue
        parent, key, action = at(document, path[:-1]), path[-1], rng.randrange(6)
        if action <= 2:
            parent[key] = odd_value(rng, parent[key])
        elif action == 3:
            parent.pop(key)
        elif action == 4:
            parent[key] = copy.deepcopy(at(document, path[: rng.randint(0, len(path))]))
        else:
            parent[key] = [parent[key]] * rng.choice((0, 1, 2, 40))
    return json.dumps(document).encode("utf-8", "surrogatepass")


def of_json_lines(rng: random.Random, data: bytes) -> bytes:
    """One line of a file of JSON lines is changed, or the text."""
    lines = data.splitlines()
    if not lines or rng.random() < 0.2:
        return rng.choice((of_text, of_bytes))(rng, data)
    number = rng.randrange(len(lines))
    lines[number] = of_json(rng, lines[number])
    return b"\n".join(lines) + b"\n"


def odd_word(rng: random.Random) -> str:
    """A word that hardly belongs where it comes."""
    if rng.random() < 0.7:
        return rng.choice(PLAIN_WORDS)
    return rng.choice((str(rng.randint(-(10**12), 10**12)), repr(rng.uniform(-1e3, 1e3)), chr(rng.randrange(0x3000))))


def odd_value(rng: random.Random, own: object) -> object:
    """Another value of JSON; often one that is near."""
    if isinstance(own, int | float) and not isinstance(own, bool) and rng.random() < 0.5:
        near = (own + 1, own - 1, -own, own * 1e6, 0, own + rng.uniform(-2, 2), math.nan, math.inf, 2**31, 2**63)
        return rng.choice(near)
    return copy.deepcopy(rng.choice(PLAIN_VALUES))


def of_archive(rng: random.Random, data: bytes) -> bytes:
    """A member of a zip file is changed, with right sums and sizes; or is left out, or there twice."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = [(info.filename, archive.read(info), info.compress_type) for info in archive.infolist()]
    number, action = rng.randrange(len(members)), rng.randrange(10)
    name, content, packing = members[number]
    if action == 0:
        members.pop(number)
    elif action == 1:
        members.append(members[rng.randrange(len(members))])
    elif action == 2:
        members[number] = name, content, zipfile.ZIP_DEFLATED
    elif action == 3:
        members[number] = rng.choice((name + "x", "../a", "", name.upper())), content, packing
    else:
        members[number] = name, of_member(rng, content), packing
    out = io.BytesIO()
    import warnings

    with warnings.catch_warnings(), zipfile.ZipFile(out, "w") as archive:
        warnings.simplefilter("ignore")  # names that are there twice
        for name, content, packing in members:
            archive.writestr(zipfile.ZipInfo(name), content, packing)
    return out.getvalue()


def of_member(rng: random.Random, content: bytes) -> bytes:
    """JSON as JSON; of arrays the head, or a few numbers."""
    if content[:1] == b"{" and rng.random() < 0.9:
        return of_json(rng, content)
    if content[:6] == b"\x93NUMPY" and rng.random() < 0.6:
        return of_bytes(rng, content[:128]) + content[128:]
    return of_bytes(rng, content)


def of_png(rng: random.Random, data: bytes) -> bytes:
    """A chunk of a PNG is changed, with the right sum; or is left out, there twice or moved."""
    chunks, place = [], 8
    while place + 12 <= len(data):
        (size,) = struct.unpack(">I", data[place : place + 4])
        chunks.append((data[place + 4 : place + 8], data[place + 8 : place + 8 + size]))
        place += 12 + size
    number, action = rng.randrange(len(chunks)), rng.randrange(6)
    kind, content = chunks[number]
    if action == 0:
        chunks.pop(number)
    elif action == 1:
        chunks.insert(rng.randint(0, len(chunks)), (kind, content))
    elif action == 2:
        other = rng.choice((b"iTXt", b"zTXt", b"tEXt", b"iCCP", b"PLTE", b"tRNS", b"acTL", b"fdAT", b"eXIf", b"IHDR"))
        chunks.insert(rng.randint(1, len(chunks)), (other, of_bytes(rng, content)))
    else:
        chunks[number] = kind, of_bytes(rng, content)
    parts = [struct.pack(">I", len(c)) + k + c + struct.pack(">I", zlib.crc32(k + c)) for k, c in chunks]
    return data[:8] + b"".join(parts)
