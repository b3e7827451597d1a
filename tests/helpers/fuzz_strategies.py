"""Damaged datasets: strategies that break one file of a tiny dataset."""

import copy
import json

from fuzz_corpus import PLAIN_VALUES, PLAIN_WORDS, at, places
from hypothesis import strategies as st

ODD_VALUES = st.indefinite_noun(
    st.sampled_from(PLAIN_VALUES),
    st.integers(),
    st.floats(),
    st.text(max_size=8),
    st.recursive(st.none(), lambda inner: st.lists(inner, max_size=3), max_leaves=200),
)
ODD_WORDS = st.indefinite_noun(
    st.sampled_from(PLAIN_WORDS),
    st.text(max_size=6),
    st.integers().map(str),
    st.floats().map(repr),
)


@st.composite
def broken_json(draw: st.DrawFn, document: object) -> str:
    """A JSON document of which a few values are replaced, removed, moved or repeated."""
    document = json.loads(json.dumps(document))
    for _ in range(draw(st.integers(1, 3))):
        path = draw(st.sampled_from(places(document)))
        if not path:
            document = copy.deepcopy(draw(ODD_VALUES))
            break
        parent, key = at(document, path[:-1]), path[-1]
        action = draw(st.sampled_from(["replace", "replace", "remove", "nest", "repeat"]))
        if action == "replace":
            parent[key] = copy.deepcopy(draw(ODD_VALUES))  # later changes must not reach the strategy
        elif action == "remove":
            parent.pop(key)
        elif action == "nest":  # as near to a cycle as a tree comes
            parent[key] = json.loads(json.dumps(at(document, path[: draw(st.integers(0, len(path)))])))
        else:
            parent[key] = [parent[key]] * draw(st.integers(0, 40))
    return json.dumps(document)


@st.composite
def broken_text(draw: st.DrawFn, text: str) -> str:
    """Lines of which a few words are replaced, or which are removed, repeated or swapped."""
    lines = text.split("\n")
    for _ in range(draw(st.integers(1, 4))):
        number = draw(st.integers(0, len(lines) - 1))
        action = draw(st.sampled_from(["word", "word", "insert", "remove", "repeat", "move"]))
        if action == "word":
            words = lines[number].split(" ")
            words[draw(st.integers(0, len(words) - 1))] = draw(ODD_WORDS)
            lines[number] = " ".join(words)
        elif action == "insert":
            lines.insert(number, f"{draw(ODD_WORDS)} {draw(ODD_WORDS)}")
        elif action == "repeat":
            lines[number:number] = [lines[number]] * draw(st.integers(1, 200))
        else:
            line = lines.pop(number) if len(lines) > 1 else ""
            if action == "move":
                lines.insert(draw(st.integers(0, len(lines))), line)
    return "\n".join(lines)


@st.composite
def broken_bytes(draw: st.DrawFn, data: bytes) -> bytes:
    """Bytes that are flipped, cut off, overwritten, inserted or repeated."""
    broken = bytearray(data)
    for _ in range(draw(st.integers(1, 4))):
        place = draw(st.integers(0, max(len(broken) - 1, 0)))
        action = draw(st.sampled_from(["flip", "flip", "cut", "write", "insert", "repeat"]))
        if action == "flip" and broken:
            broken[place] ^= 1 << draw(st.integers(0, 7))
        elif action == "cut":
            del broken[place:]
        elif action == "write":
            junk = draw(st.binary(min_size=1, max_size=8))
            broken[place : place + len(junk)] = junk
        elif action == "insert":
            broken[place:place] = draw(st.binary(min_size=1, max_size=8))
        else:
            broken[place:place] = broken[place : place + draw(st.integers(1, 40))] * draw(st.integers(1, 20))
    return bytes(broken)
