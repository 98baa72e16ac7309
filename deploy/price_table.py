#!/usr/bin/env python3
"""Prints a study's CSV as a Markdown table: a row per setting, at the most samples, the most efficient first."""
import csv
import math
import sys


def words(row, name, digits=3):
    return f"{float(row[name]):.{digits}g}" if row[name] else "–"


def main(path):
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    most = max(int(row["samples"]) for row in rows)
    rows = [row for row in rows if int(row["samples"]) == most]
    base = float(rows[0]["device_seconds"])
    rows.sort(key=lambda row: -float(row["efficiency_ratio"] or 0))
    print(f"| setting | time, base = 1 | error at {most} samples | mean off by, % (z) | efficiency, base = 1 (95 %) |")
    print("|---|---|---|---|---|")
    for row in rows:
        error = math.sqrt(max(0.0, float(row["mse"])))
        print(f"| `{row['variant']}` | {float(row['device_seconds']) / base:.2f} | {error:.3g} "
              f"| {words(row, 'bias_percent', 2)} ({words(row, 'bias_z', 2)}) | {words(row, 'efficiency_ratio')} "
              f"({words(row, 'efficiency_ratio_low', 2)} … {words(row, 'efficiency_ratio_high', 2)}) |")


if __name__ == "__main__":
    main(sys.argv[1])
