"""Reader of the `f` and `vn` lines of an OBJ: corners, their indices, triangles and vertex normals."""

from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from home_mjx.datasets.suncg.formats.json_value import Location
from home_mjx.geometry.faces import FaceError, triangulate_faces

Rows = list[tuple[int, str]]  # line number and the text after the keyword
MAX_DIGITS = 18  # maximum digits of an index that fits 64 bits
MAX_CORNERS = 1 << 22  # maximum corners of one mesh
_KINDS = ("v", "vt", "vn")
MIN_NORMAL_DEVIATION = 1e-3  # minimum deviation from face normals of useful vertex normals


def line_numbers(rows: Rows) -> Int[np.ndarray, " n"]:
    """Return the line numbers of the rows, ascending."""
    return np.array([number for number, _ in rows], np.int64)


def read_corners(rows: dict[str, Rows], path: Path) -> tuple[Int[np.ndarray, "c 3"], Int[np.ndarray, " f"]]:
    """Return one-based v, vt and vn indices of every corner (0 if none), and the number of corners of each face.

    Raises:
        DatasetError: There are more than about `MAX_CORNERS` corners, a face is malformed, or an index is out of range.
    """
    count = sum(rest.count(" ") + rest.count("\t") + 1 for _, rest in rows["f"])
    if count > MAX_CORNERS:
        message = f"faces have about {count} corners, at most {MAX_CORNERS} are read"
        raise Location(path).error(message, "Simplify the model: SUNCG's largest has 33,000 faces.")
    raw, sides = _plain_indices(rows["f"]) or _split_indices(rows["f"])
    if raw is None or sides.min() < 3:
        number, rest = next(row for row in rows["f"] if _malformed(_words(row[1])))
        raise Location(path, f"line {number}").error(
            f"expected a face such as `f 1/1/1 2/2/2 3/3/3`, got `{rest.strip()[:60]}`"
        )
    face = np.repeat(np.arange(len(sides)), sides)
    return _absolute(raw, line_numbers(rows["f"])[face], rows, path), sides


def _plain_indices(rows: Rows) -> tuple[Int[np.ndarray, "c 3"], Int[np.ndarray, " f"]] | None:
    """Return raw indices and corners per face if all corners are like `1/2/3`, one space apart; otherwise None."""
    text = "\n".join(rest for _, rest in rows)
    if not text.isascii():
        return None
    letters = np.frombuffer(text.encode(), np.uint8)
    at = np.flatnonzero((letters < ord("0")) | (letters > ord("9")))
    marks = np.append(letters[at], ord("\n"))
    corners = marks.reshape(-1, 3) if len(marks) % 3 == 0 else np.zeros((1, 3))
    ends = (corners[:, 2] == ord("\n")) | (corners[:, 2] == ord(" "))
    digits = np.diff(at, prepend=-1, append=len(letters)) - 1
    if not (ends.all() and (corners[:, :2] == ord("/")).all() and digits.min() > 0 and digits.max() <= MAX_DIGITS):
        return None
    numbers = np.fromstring(text.replace("/", " "), np.int64, sep=" ").reshape(-1, 3)
    return numbers, np.diff(np.flatnonzero(corners[:, 2] == ord("\n")), prepend=-1)


def _split_indices(rows: Rows) -> tuple[Int[np.ndarray, "c 3"] | None, Int[np.ndarray, " f"]]:
    """Return raw indices (0 if absent; None if a corner is malformed) and the number of corners per face."""
    faces = [_words(rest) for _, rest in rows]
    return _indices(faces), np.array([len(words) for words in faces])


def _words(text: str) -> list[str]:
    """Split the text after the keyword `f` into corners such as `1/2/3`; a comment behind them is omitted."""
    return text.partition("#")[0].split()


def _indices(faces: list[list[str]]) -> Int[np.ndarray, "c 3"] | None:
    """Return v, vt and vn indices of all corners as in the file, 0 if absent; None for a malformed one or none at all.

    `faces` has the corners of each face as words such as `1/2/3`.
    """
    corners = [corner for words in faces for corner in words]
    text = " ".join(corners)
    if not text.isascii() or "_" in text:  # Python would read `1_0`
        return None
    slashes = np.array([corner.count("/") for corner in corners])
    words = text.replace("//", "/0/").replace("/", " ").split()
    try:
        numbers = np.array([int(word) for word in words], np.int64)
    except (ValueError, OverflowError):
        return None
    end = np.cumsum(slashes + 1)
    if not len(corners) or slashes.max() > 2 or len(numbers) != end[-1]:
        return None
    index = np.zeros((len(corners), 3), np.int64)
    for column in range(3):
        has = slashes >= column
        index[has, column] = numbers[(end - slashes - 1)[has] + column]
    return index


def _malformed(words: list[str]) -> bool:
    """Return whether the corners of an `f` line are fewer than three or not indices."""
    return len(words) < 3 or _indices([words]) is None


def _absolute(
    raw: Int[np.ndarray, "c 3"], line: Int[np.ndarray, " c"], rows: dict[str, Rows], path: Path
) -> Int[np.ndarray, "c 3"]:
    """Validate indices and convert negative ones, relative to their face's line, to absolute ones, which start at 1.

    0 is kept for corners without `vt` or `vn`.

    Raises:
        DatasetError: An index is out of range.
    """
    index = raw.copy()
    for column, kind in enumerate(_KINDS):
        above = np.searchsorted(line_numbers(rows[kind]), line)
        index[:, column] += np.where(raw[:, column] < 0, above + 1, 0)
        absent = (raw[:, column] == 0) & (kind != "v")
        bad = ~absent & ((index[:, column] < 1) | (index[:, column] > len(rows[kind])))
        if bad.any():
            first = int(bad.argmax())
            raise Location(path, f"line {line[first]}").error(
                f"face refers to `{kind}` {raw[first, column]}, but the file has {len(rows[kind])}",
                "The file may be truncated: fetch or export it again.",
            )
    return index


def split_faces(
    points: Float[np.ndarray, "c 3"], sides: Int[np.ndarray, " f"], rows: Rows, path: Path, tolerant: bool = False
) -> tuple[Int[np.ndarray, "t 3"], Int[np.ndarray, " t"]]:
    """Split faces into triangles by `triangulate_faces`: indices into `points`, and the face of each triangle.

    `sides` has the number of corners of each face. `tolerant` is as there. `rows` and `path` locate errors.

    Raises:
        DatasetError: A polygon crosses itself, or has too many corners.
    """
    try:
        return triangulate_faces(points, sides, tolerant)
    except FaceError as error:
        hint = "Triangulate the model in the program that wrote it."
        raise Location(path, f"line {rows[error.face][0]}").error(str(error), hint) from None


def smooth_normals(
    rows: Rows, index: Int[np.ndarray, "f 3"], triangles: Float[np.ndarray, "f 3 3"]
) -> Float[np.ndarray, "f 3 3"] | None:
    """Return the `vn` of each corner of the triangles by `keep_smooth_normals`; None if they are useless.

    They are useless if a corner has none, if any of `rows` lacks three finite numbers, or if all equal the face
    normals. No error is raised, since exporters write broken ones for faces without area. `index` is one-based into
    `rows`, the lines of `vn`; 0 for none.
    """
    table = _numbers(rows)
    if table is None or (index == 0).any():
        return None
    return keep_smooth_normals(table[index - 1].reshape(-1, 3), triangles)


def keep_smooth_normals(
    normals: Float[np.ndarray, "c 3"], triangles: Float[np.ndarray, "f 3 3"]
) -> Float[np.ndarray, "f 3 3"] | None:
    """Return normals per corner as unit vectors; None if all equal their face normals.

    Equal means within `MIN_NORMAL_DEVIATION` in each component; faces without area are not compared. Vectors of length
    1e-12 and less become 0.

    Args:
        normals: Vectors of the corners of all faces, in order.
        triangles: Corners of the faces [m].
    """
    normals = _unit(normals).reshape(-1, 3, 3)
    faces = _unit(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))
    sized = np.linalg.norm(faces, axis=1) > 0
    return normals if (abs(normals - faces[:, None])[sized] > MIN_NORMAL_DEVIATION).any() else None


def _numbers(rows: Rows) -> Float[np.ndarray, "n 3"] | None:
    """Return the first three numbers of each row; None if one is missing or not finite."""
    try:
        table = np.array([[float(word) for word in rest.split()[:3]] for _, rest in rows]).reshape(len(rows), 3)
    except ValueError:
        return None
    return table if np.isfinite(table).all() else None


def _unit(vectors: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    """Return vectors scaled to length 1; zero for vectors of length 1e-12 and below."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 1e-12)
