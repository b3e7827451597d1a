"""Count the contents of a house as read and as compiled, list its semantics, or validate it."""

import argparse
import json
import sys
from dataclasses import asdict
from typing import TYPE_CHECKING

from home_mjx.cli.houses import (
    add_house_arguments,
    add_movable_option,
    add_strict_option,
    compile_options,
    is_dataset_root,
    load_compiled_house,
    load_house,
    open_selected_dataset,
    selected_house,
)
from home_mjx.cli.learning.arguments import add_import_option, import_modules
from home_mjx.core.progress import is_progress_shown, plural, track

if TYPE_CHECKING:
    from home_mjx.datasets.base import Dataset

TOTALS = ("levels", "rooms", "objects", "triangles", "bodies", "problems")  # counts of houses, summed for a dataset


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add `HOUSE`, an id or the root of a dataset, and the options of `home-mjx inspect`.

    `--dataset`, `--strict`, `--max-bodies` and `--max-fronts` are as in `cli.houses`, `--import` as in
    `add_import_option`.
    `--json`, `--semantics` and `--validate` are flags; the last two exclude each other.
    """
    add_house_arguments(
        parser, "id of the house (default: the dataset's first), or root of a dataset for all its houses"
    )
    add_strict_option(parser)
    add_movable_option(parser)
    add_import_option(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    doing = parser.add_mutually_exclusive_group()
    doing.add_argument(
        "--semantics", action="store_true", help="list the class, appearance and support of each object instead"
    )
    doing.add_argument(
        "--validate", action="store_true", help="report all problems instead; exit code 1 if there are errors"
    )


def run(args: argparse.Namespace) -> int:
    """Print counts of a house or a dataset, semantics or findings; return 1 if `--validate` finds errors, else 0.

    Counts of a house are rows: its report, joints, and bytes in a bank. Problems, a large share of unknown materials,
    fallbacks and fixed objects follow, one line each. With `--json` it is one object instead, or one per house with
    `--validate`.
    """
    import_modules(args.modules)
    if args.validate:
        return _validate(args)
    if args.semantics:
        return _print_semantics(args)
    if is_dataset_root(args):
        return _print_dataset(args)
    from home_mjx.bank.usage import bank_usage
    from home_mjx.scene_compile.materials.unknown import MAX_UNKNOWN_SHARE, unknown_material_share
    from home_mjx.scene_compile.objects.fixed_parts import (
        describe_fixed,
        fixed_joints,
        fixed_records,
        object_category,
        object_joints,
    )

    house, metadata = load_house(args)
    compiled = load_compiled_house(args)
    problems = [f"{problem.element}: {problem.message}" for problem in house.problems]
    taken = bank_usage([compiled])
    table, unknown = selected_house(args)[0].joints, unknown_material_share(compiled)
    fixed = fixed_joints(house, table, metadata, compiled, compile_options(args).articulation.max_fronts)
    jointed = sum(map(len, object_joints(house, table).values()))
    fields = compiled.navigation.field.nbytes + compiled.navigation.extrapolated.field.nbytes
    if args.json:
        record = {"id": house.id, "version": house.version, "path": str(house.path), "problems": problems}
        sizes = {"house": taken.houses[house.id], "models": taken.models, "textures": taken.textures}
        sizes["fields"] = fields
        record["fallbacks"] = [asdict(item) for item in house.fallbacks]
        record["stuck"] = compiled.blocked_objects.tolist()
        record["unknown_material"] = unknown
        record["joints"] = jointed
        record["fixed_joints"] = fixed_records(compiled, fixed)
        sys.stdout.write(json.dumps({**record, "counts": dict(compiled.report), "bytes": sizes}) + "\n")
        return 0
    sys.stdout.write(f"{house.id} (format {house.version})\n{house.path}\n")
    for name, count in compiled.report.items():
        _print_row(name.replace("_", " "), count)
    _print_row("joints of objects", jointed)
    _print_row("  of which fixed", sum(map(len, fixed.values())))
    _print_row("bytes of the house alone", taken.houses[house.id])
    _print_row("  of which distance fields", fields)
    _print_row("bytes of its models", sum(taken.models.values()))
    for key in sorted(taken.models, key=lambda key: -taken.models[key])[:3]:
        _print_row(f"  {key}", taken.models[key])
    _print_row("bytes of its textures", taken.textures)
    for problem in problems:
        sys.stdout.write(f"tolerated: {problem}\n")
    if unknown > MAX_UNKNOWN_SHARE:
        sys.stdout.write(
            f"warning: {unknown:.0%} of the area has a default material: acoustics and contact are approximate\n"
        )
    for item in house.fallbacks:
        sys.stdout.write(f"fallback: {item}\n")
    sys.stdout.writelines(f"{line}\n" for line in describe_fixed(compiled, fixed))
    for object_id in compiled.blocked_objects.tolist():
        sys.stdout.write(
            f"stuck: {object_category(compiled, object_id)} {object_id} overlaps another body, so it is fixed\n"
        )
    return 0


def _print_row(name: str, count: int) -> None:
    """Print one line of a table: name padded to 40 characters, and count in 16, with commas for thousands."""
    sys.stdout.write(f"{name:<40}{count:>16,}\n")


def _print_dataset(args: argparse.Namespace) -> int:
    """Print numbers and bank memory of all houses, models and textures of a dataset [bytes]; return 0.

    Houses that are not in the cache are compiled. Means are rounded down. With `--json` one object is printed, with the
    bytes of each house and model as well.
    """
    from home_mjx.bank.usage import bank_usage
    from home_mjx.houses.house_cache import HouseCache

    dataset = open_selected_dataset(args)
    cache = HouseCache(dataset, compile_options(args))
    ids = dataset.house_ids
    loaded = [cache.load(i) for i in track(ids, f"loading {plural(len(ids), 'house')}", "house")]
    taken = bank_usage(loaded)
    houses, models = list(taken.houses.values()), list(taken.models.values())
    counts = {
        "houses": len(houses),
        **{name: sum(house.report[name] for house in loaded) for name in TOTALS},
        "models": len(models),
        "bytes_per_house_mean": sum(houses) // len(houses),
        "bytes_per_house_largest": max(houses),
        "bytes_of_houses": sum(houses),
        "bytes_per_model_mean": sum(models) // len(models),
        "bytes_per_model_largest": max(models),
        "bytes_of_models": sum(models),
        "bytes_of_textures": taken.textures,
    }
    if args.json:
        sizes = {"houses": taken.houses, "models": taken.models, "textures": taken.textures}
        sys.stdout.write(json.dumps({"root": str(dataset.root), "counts": counts, "bytes": sizes}) + "\n")
        return 0
    for name, count in counts.items():
        _print_row(name.replace("_", " "), count)
    return 0


def _print_semantics(args: argparse.Namespace) -> int:
    """Print a line per part and object and one of totals, or complete semantics as one JSON object; return 0.

    A line has index or id, room types, what supports or contains an object, and a description. The totals are objects
    outside of every room, and relations.
    """
    from home_mjx.scene_compile.semantics.engine import house_semantics
    from home_mjx.scene_compile.semantics.records import house_record

    meaning = house_semantics(*load_house(args))
    if args.json:
        sys.stdout.write(json.dumps(house_record(meaning)) + "\n")
        return 0
    for part in meaning.parts:
        sys.stdout.write(_format(f"part {part.index}", "+".join(part.room_types) or "unknown", "", part.description))
    for item in meaning.objects:
        held = meaning.objects_by_id.get(max(item.support.supporter, item.support.container))
        on = f"{held.fine} {held.object_id}" if held else item.support.kind
        room = "+".join(item.room_types) or ("unknown" if item.room >= 0 else "outside")
        sys.stdout.write(_format(f"object {item.object_id}", room, on, item.description))
    sys.stdout.write(
        f"{len(meaning.objects_outside)} objects outside of every room, {len(meaning.relations)} relations\n"
    )
    return 0


def _format(name: str, room: str, support: str, description: str) -> str:
    """Format one line of the list of semantics, with its newline: three padded columns and the description.

    Longer texts are not cut off.
    """
    return f"{name:<12}{room:<16}{support:<22}{description}\n"


def _validate(args: argparse.Namespace) -> int:
    """Print the findings of the house, or of all houses of a root; return 1 if there are errors, else 0.

    Without `HOUSE`, the dataset's first house is validated. Houses that must be generated are generated first.
    """
    dataset = open_selected_dataset(args)
    ids = dataset.house_ids if is_dataset_root(args) else [args.house or dataset.house_ids[0]]
    dataset.prepare(ids, is_progress_shown())
    return int(sum(_validate_one(dataset, house_id, args.json) for house_id in ids) > 0)


def _validate_one(dataset: "Dataset", house_id: str, as_json: bool) -> int:
    """Print a line per finding and one of totals, or all as one line of JSON; return the number of errors.

    Findings are errors and warnings. The totals are the house's id and the number of each.
    """
    from home_mjx.datasets.suncg.validate.validate import validate_house

    findings = validate_house(dataset, house_id)
    errors = sum(finding.severity == "error" for finding in findings)
    if as_json:
        listed = [{"severity": finding.severity, **asdict(finding)} for finding in findings]
        sys.stdout.write(json.dumps({"id": house_id, "errors": errors, "findings": listed}) + "\n")
    else:
        sys.stdout.writelines(f"{finding.severity}: {finding}\n" for finding in findings)
        sys.stdout.write(f"{house_id}: {errors} errors, {len(findings) - errors} warnings\n")
    return errors
