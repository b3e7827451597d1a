"""Records of ProcTHOR to a `House`: shell, fittings, furniture, and what was stood in for."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from home_mjx.datasets.base import ReadOptions
from home_mjx.datasets.furniture import FurnitureProvider
from home_mjx.datasets.procthor.assets import AssetTable
from home_mjx.datasets.procthor.fittings import Fitting, light_fittings, opening_fitting
from home_mjx.datasets.procthor.placed import PlacedPiece
from home_mjx.datasets.procthor.placing import PiecePlacer
from home_mjx.datasets.procthor.records import ThorHouse
from home_mjx.datasets.procthor.shell import build_shell, room_polygon
from home_mjx.datasets.taxonomy import UNKNOWN
from home_mjx.errors import DatasetError
from home_mjx.schema.house import Fallback, House, ObjectNode, Problem

REASON = "models of AI2-THOR are not public"
STRICT_HINT = "Read it with `strict=False`: our own furniture is shown, and listed."
MAX_SHARE = 1.05  # of the extent of the house, that a thing may have
Categories = Mapping[str, tuple[str, str]]


class HouseBuilder:
    """Builds one house.

    Args:
        records: The house in the file.
        file: The file, for messages.
        assets: Kinds and sizes of models.
        provider: Our furniture.
        options: Parts to leave out, and whether things of unknown kind or size are errors.
        categories: Coarse and NYU40 category by fine one.
    """

    def __init__(
        self,
        records: ThorHouse,
        file: Path,
        assets: AssetTable,
        provider: FurnitureProvider,
        options: ReadOptions,
        categories: Categories,
    ) -> None:
        self.records, self.file, self.assets, self.provider = records, file, assets, provider
        self.options, self.categories = options, categories
        self.problems: list[Problem] = list(records.problems)

    def build(self, house_id: str) -> House:
        """Return the house; paths of its textures are relative.

        Raises:
            DatasetError: It is broken or, if strict, has things of unknown kind or size.
        """
        shell = build_shell(self.records, house_id, self.file, self.provider)
        fittings = list(self._fittings())
        pieces = self._kept(PiecePlacer(self.records.rooms, self.assets, self.provider).place(self.records.objects))
        nodes = [_fitting_node(found) for found in fittings] + [_piece_node(found) for found in pieces]
        rooms = [found.room for found in fittings] + [found.room for found in pieces]
        count = len(shell.levels[0].rooms)
        numbered = tuple(_numbered(node, count + i) for i, node in enumerate(nodes))
        members = [tuple(count + i for i, room in enumerate(rooms) if room == number) for number in range(count)]
        level = replace(
            shell.levels[0],
            objects=numbered,
            rooms=tuple(replace(r, members=m) for r, m in zip(shell.levels[0].rooms, members, strict=True)),
        )
        return replace(
            shell,
            version=f"procthor@{self.records.schema or 'old'}",
            path=self.file,
            levels=(level,),
            models={found.key: found.mesh for found in fittings} | {p.piece.key: p.piece.mesh for p in pieces},
            problems=tuple(self.problems),
            extra=self.records.extra,
            fallbacks=tuple(_fallbacks(pieces)),
        )

    def _fittings(self) -> Iterator[Fitting]:
        yield from (opening_fitting(found, self.records.rooms, self.provider) for found in self.records.openings)
        yield from light_fittings(self.records, self.provider)

    def _kept(self, pieces: Iterable[PlacedPiece]) -> list[PlacedPiece]:
        """Return the pieces that are shown; others are excluded by the options, or larger than the house."""
        corners = np.concatenate([room_polygon(room) for room in self.records.rooms])
        most = MAX_SHARE * float(np.ptp(corners, axis=0).max())
        return [piece for piece in pieces if self._is_kept(piece, most)]

    def _is_kept(self, piece: PlacedPiece, most: float) -> bool:
        self._check_strict(piece)
        element, (coarse, _) = piece.source.element, self.categories.get(piece.fine, (UNKNOWN, ""))
        if max(piece.size) > most:
            self.problems.append(Problem(element, f"`{piece.source.asset}` is larger than the house: it is left out"))
            return False
        if not piece.asset.is_known and self.assets.path is not None:
            self.problems.append(Problem(element, f"asset database lacks `{piece.source.asset}`: its size is a guess"))
        return coarse not in self.options.excluded_categories

    def _check_strict(self, piece: PlacedPiece) -> None:
        """Raise `DatasetError` for a thing of unknown kind or size, if strict."""
        if self.options.strict and not (piece.asset.is_known and piece.asset.word):
            what = "size" if piece.asset.word else "kind"
            message = f"{what} of `{piece.source.asset}` is unknown"
            raise DatasetError(message, file=self.file, element=piece.source.element, hint=STRICT_HINT)


def _fallbacks(pieces: Sequence[PlacedPiece]) -> Iterator[Fallback]:
    """Generate one line per category: how many models our own furniture stands for."""
    counts = Counter((piece.fine, piece.piece.words.partition(" ")[0]) for piece in pieces)
    for (fine, _), count in sorted(counts.items()):
        first = next(piece for piece in pieces if piece.fine == fine)
        words = first.piece.words
        yield Fallback("model", f"{fine} ({count})", first.source.element, f"{words} of its size", REASON)


def _fitting_node(found: Fitting) -> ObjectNode:
    return ObjectNode(
        id="",
        index=0,
        path=found.element,
        bbox=None,
        model_id=found.fine,
        model_key=found.key,
        transform=found.transform,
        materials=found.materials,
        lights=found.lights,
        joints=found.joints,
        extra={"asset": found.asset} if found.asset else {},
    )


def _piece_node(found: PlacedPiece) -> ObjectNode:
    return ObjectNode(
        id="",
        index=0,
        path=found.source.element,
        bbox=None,
        model_id=found.fine,
        model_key=found.piece.key,
        transform=found.transform,
        materials=found.piece.materials,
        lights=found.piece.lights,
        extra={"asset": found.source.asset, "category": found.source.kind},
    )


def _numbered(node: ObjectNode, index: int) -> ObjectNode:
    return replace(node, id=f"0_{index}", index=index)
