"""Count what a house holds, as read and as compiled, say what everything in it is, or validate it."""

import argparse
import json
import sys
from dataclasses import asdict

from home_mjx.cli.houses import add_house_arguments, load_house, open_named_dataset


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the options of `home-mjx inspect`."""
    add_house_arguments(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    doing = parser.add_mutually_exclusive_group()
    doing.add_argument("--semantics", action="store_true", help="instead say what everything is, looks like and is on")
    doing.add_argument("--home", action="store_true", help="as --semantics, by the rules of HoME's code of 2017")
    doing.add_argument(
        "--validate", action="store_true", help="instead report everything that is wrong; exit code 1 if errors are"
    )


def run(args: argparse.Namespace) -> int:
    """Prints the counts and everything odd that was tolerated, or with `--validate` what is wrong."""
    if args.validate:
        return _validate(args)
    if args.semantics or args.home:
        return _semantics(args)
    from home_mjx.scene_compile.compile import compile_house

    house, metadata = load_house(args)
    compiled = compile_house(house, metadata)
    problems = [f"{problem.element}: {problem.message}" for problem in house.problems]
    if args.json:
        record = {"id": house.id, "version": house.version, "path": str(house.path), "problems": problems}
        sys.stdout.write(json.dumps({**record, "counts": dict(compiled.report)}) + "\n")
        return 0
    sys.stdout.write(f"{house.id} (format {house.version})\n{house.path}\n")
    for name, count in compiled.report.items():
        sys.stdout.write(f"{name.replace('_', ' '):<28}{count:>12,}\n")
    for problem in problems:
        sys.stdout.write(f"tolerated: {problem}\n")
    return 0


def _semantics(args: argparse.Namespace) -> int:
    """Prints a line per surface and object, or one JSON object with all that the semantic engine says."""
    from home_mjx.scene_compile.semantics import HOME, SemanticOptions, house_semantics
    from home_mjx.scene_compile.semantics.records import house_record

    meaning = house_semantics(*load_house(args), HOME if args.home else SemanticOptions())
    if args.json:
        sys.stdout.write(json.dumps(house_record(meaning)) + "\n")
        return 0
    for part in meaning.parts:
        sys.stdout.write(_line(f"part {part.index}", part.room_type, "", part.description))
    for item in meaning.objects:
        held = meaning.by_id.get(max(item.support.supporter, item.support.container))
        on = f"{held.fine} {held.object_id}" if held else item.support.kind
        sys.stdout.write(
            _line(f"object {item.object_id}", item.room_type if item.room >= 0 else "outside", on, item.description)
        )
    sys.stdout.write(f"{len(meaning.outside)} objects outside of every room, {len(meaning.relations)} relations\n")
    return 0


def _line(name: str, room: str, support: str, description: str) -> str:
    return f"{name:<12}{room:<16}{support:<22}{description}\n"


def _validate(args: argparse.Namespace) -> int:
    """Prints the findings, or one JSON object of them; 1 if there are errors, else 0."""
    from home_mjx.scene_compile.suncg.validate import validate_house

    dataset = open_named_dataset(args)
    house_id = args.house or dataset.house_ids[0]
    findings = validate_house(dataset, house_id)
    errors = sum(finding.severity == "error" for finding in findings)
    if args.json:
        listed = [{"severity": finding.severity, **asdict(finding)} for finding in findings]
        sys.stdout.write(json.dumps({"id": house_id, "errors": errors, "findings": listed}) + "\n")
    else:
        sys.stdout.writelines(f"{finding.severity}: {finding}\n" for finding in findings)
        sys.stdout.write(f"{house_id}: {errors} errors, {len(findings) - errors} warnings\n")
    return int(errors > 0)
