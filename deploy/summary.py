#!/usr/bin/env python3
"""Prints what was measured of a finished job: summary.py JOB.json, the answer of GET /v1/jobs/{id}."""
import datetime
import json
import sys


def seconds_between(start, end):
    if not start or not end:
        return None
    parse = lambda text: datetime.datetime.fromisoformat(text.replace("Z", "+00:00"))
    return (parse(end) - parse(start)).total_seconds()


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        job = json.load(file)
    image, frames = job["spec"]["image"], job["spec"]["frames"]["count"]
    samples = image["width"] * image["height"] * job["samplesMerged"] * frames
    wall, device = seconds_between(job.get("startedAt"), job.get("finishedAt")), job["deviceSeconds"]
    print(f"\nsamples          {samples / 1e6:.1f} million ({job['samplesMerged']} per pixel)")
    print(f"device seconds   {device:.1f}, summed over workers")
    if device > 0:
        print(f"samples/s        {samples / device / 1e3:.0f} thousand per device second")
    if wall:
        print(f"wall seconds     {wall:.1f} ({samples / wall / 1e3:.0f} thousand samples/s)")
    if job.get("relativeError") is not None:
        print(f"relative error   {job['relativeError']:.4f}")
    if job.get("droppedSamples"):
        print(f"dropped samples  {job['droppedSamples']} (NaN or infinite)")
    curve = job.get("errorCurve") or []
    if curve:
        print("\nwhat accuracy cost\n   samples  relative error  device seconds")
        for point in curve:
            error = "            --" if point["relativeError"] is None else f"{point['relativeError']:14.4f}"
            print(f"{point['samples']:>10}{error:>16}{point['deviceSeconds']:>16.1f}")


if __name__ == "__main__":
    main()
