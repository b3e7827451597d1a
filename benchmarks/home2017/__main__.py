"""Print the descriptions of a house's objects by HoME's rules: `python -m benchmarks.home2017 [HOUSE]`."""

import argparse
import json

from benchmarks.home2017.semantics import home2017_semantics
from home_mjx.core.paths import dataset_root
from home_mjx.datasets.registry import open_dataset
from home_mjx.scene_compile.semantics.records import house_record


def main():
    """Print a line per object, or with `--json` one JSON object as of `home-mjx inspect --semantics --json`."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("house", nargs="?", metavar="HOUSE", help="id of the house (default: the dataset's first)")
    parser.add_argument("--dataset", default=dataset_root() or "procedural:1", metavar="ROOT", help="folder or name")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    args = parser.parse_args()
    dataset = open_dataset(args.dataset)
    house_id = args.house or dataset.house_ids[0]
    dataset.prepare((house_id,))
    meaning = home2017_semantics(dataset.load_house(house_id), dataset.metadata)
    if args.json:
        print(json.dumps(house_record(meaning)))
        return
    for item in meaning.objects:
        print(f"object {item.object_id:<5}{item.room_type:<16}{item.description}")


if __name__ == "__main__":
    main()
