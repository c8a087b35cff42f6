#!/usr/bin/env python3
"""remote_build.py KILN KILN_CACHED [MANIFEST] [ROUNDS]: how long a build takes that finds everything on a cache server, as a share of the
cold build's time. Machines are fresh (no local store) and the server is on loopback. Ratios of the best of each kind, all in one run,
in time and in the client's CPU time, which a busy machine disturbs less."""
import json
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/server"))
from cached import Cached

kiln, cached = (os.path.abspath(p) for p in sys.argv[1:3])
manifest = sys.argv[3] if len(sys.argv) > 3 else "manifests/surface.yaml"
rounds = int(sys.argv[4]) if len(sys.argv) > 4 else 3


def build(folder, table, *words):
    env = {k: v for k, v in os.environ.items() if not k.startswith("KILN_CACHE") and not k.lower().endswith("_proxy")}
    shutil.rmtree("local", ignore_errors=True)
    began, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
    out = subprocess.run([kiln, "build", f"{folder}/{manifest}", "-o", table, "--json", *words], env=env, check=True, capture_output=True)
    wall, after = time.monotonic() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, json.loads(out.stdout)


def main():
    for state in ("same", "remark"):
        for part in ("uber", "manifests"):
            shutil.copytree(ROOT / part, f"{state}/{part}")
    # In the second state every source differs in a remark: nothing is known as a whole, every module and text is.
    for path in pathlib.Path("remark/uber").rglob("*"):
        if path.suffix in (".frag", ".vert", ".glsl", ".comp"):
            path.write_text(path.read_text() + "\n// a remark\n")
    times = {}
    for _ in range(rounds):
        def note(name, run):
            wall, cpu, did = run
            best = times.get(name, (1e9, 1e9))
            times[name] = (min(best[0], wall), min(best[1], cpu))
            return did
        note("cold, no cache at all", build("same", "cold.kiln", "--cache", "none"))
        note("cold, into a local store", build("same", "t.kiln", "--cache", "local"))
        with Cached(cached, log="events") as server:
            did = note("cold, into a local store and the server", build("same", "t.kiln", "--cache", "local", "--cache", server.url))
            if did["remote"]["not_sent"]:
                sys.exit(f"not all was sent: {did['remote']}")
            did = note("warm: the whole build is known", build("same", "warm.kiln", "--cache", "local", "--cache", server.url))
            if did["work"]["compiled"] or did["remote"]["misses"]:
                sys.exit("the warm build compiled")
            if pathlib.Path("cold.kiln").read_bytes() != pathlib.Path("warm.kiln").read_bytes():
                sys.exit("the tables differ")
            did = note("warm: every source has a new remark", build("remark", "t.kiln", "--cache", "local", "--cache", server.url, "--cache-read-only"))
            if did["work"]["compiled"] or did["work"]["translated"]:
                sys.exit("the warm build with a remark compiled")
            note("the same without a local store", build("remark", "t.kiln", "--cache", "none", "--cache", server.url, "--cache-read-only"))
            hits, taken = did["remote"]["hits"], did["remote"]["bytes_in"]
            parts = did["ms"]
    cold = times["cold, no cache at all"]
    print(f"{manifest}, best of {rounds}; {os.cpu_count()} cores; with a remark {hits} entries and {taken / 1e6:.1f} MB came from the server")
    for name, (wall, cpu) in times.items():
        print(f"  {name:42} {wall:7.2f} s {wall / cold[0]:7.1%}   CPU of kiln {cpu:6.2f} s {cpu / cold[1]:7.1%}")
    print("  of the last, ms: " + ", ".join(f"{k} {v:.0f}" for k, v in parts.items()))


with tempfile.TemporaryDirectory(prefix="kiln-remote-") as folder:
    os.chdir(folder)
    main()
    os.chdir("/")
