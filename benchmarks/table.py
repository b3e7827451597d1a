"""Print the records of `home-mjx bench --json` as a Markdown table."""

import json
import sys
from pathlib import Path

COLUMNS = ("Case", "Value", "Environments", "Compile", "Peer", "Ratio", "What was timed")


def row(record):
    """Return the cells of one record."""
    seconds, peer = record["compile_seconds"], record["peer"]
    return (
        f"`{record['case']}`",
        f"{record['value']:,.4g} {record['unit']}",
        str(record["num_envs"] or ""),
        "" if seconds is None else f"{seconds:.1f} s",
        "" if peer is None else f"{peer}: {record['peer_value']:,.4g}",
        "" if record["ratio"] is None else f"{record['ratio']:.2g}",
        record["note"],
    )


def main():
    """Read the file on the command line and print the table."""
    records = [json.loads(line) for line in Path(sys.argv[1]).read_text().splitlines()]
    for cells in [COLUMNS, ["---"] * len(COLUMNS), *map(row, records)]:
        print("| " + " | ".join(cells) + " |")
    versions = ", ".join(f"{name} {version}" for name, version in records[0]["versions"].items())
    print(f"\n{records[0]['device']}; {versions}")


if __name__ == "__main__":
    main()
