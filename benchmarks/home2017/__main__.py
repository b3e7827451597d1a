"""Print the descriptions of a house's objects by HoME's rules: `python -m benchmarks.home2017 [HOUSE]`."""

import argparse
import json

from benchmarks.home2017.semantics import home2017_semantics
from home_mjx.cli.houses import add_house_arguments, load_house
from home_mjx.scene_compile.semantics.records import house_record


def main():
    """Print a line per object, or with `--json` one JSON object as of `home-mjx inspect --semantics --json`."""
    parser = argparse.ArgumentParser(description=__doc__)
    add_house_arguments(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    args = parser.parse_args()
    meaning = home2017_semantics(*load_house(args))
    if args.json:
        print(json.dumps(house_record(meaning)))
        return
    for item in meaning.objects:
        print(f"object {item.object_id:<5}{item.room_type:<16}{item.description}")


if __name__ == "__main__":
    main()
